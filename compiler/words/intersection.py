"""The accepted words of a grammar as a grammar, using its binary normal form."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.time_limits.time_limit import check_time
from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Cfg, Rule, components, nullable, on_cycle, trimmed

# --- Binary normal form: right sides of one terminal or of two symbols ----------------------------
#
# There are no empty and no unit rules (Chomsky 1959, without the restriction that pairs consist of
# nonterminals).  Such a grammar describes only words; derivations are those of the original
# grammar.  The *binary form* keeps the unit rules except their cycles: removing them all can square
# the size.


RightSide: TypeAlias = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class BinaryGrammar:
    """A grammar in binary normal form.

    Symbols below ``terminals`` are terminals.  ``rules[k]`` are the right sides of the nonterminal
    ``terminals + k``: one terminal or two symbols; in binary form also one nonterminal.  The
    language is what any of ``starts`` derives, and the empty word if ``empty_word``.
    """

    terminals: int
    rules: tuple[tuple[RightSide, ...], ...]
    starts: tuple[int, ...]
    empty_word: bool

    def is_empty(self) -> bool:
        """Whether there is no word, not even the empty one; all nonterminals must be useful."""
        return not self.starts and not self.empty_word

    def is_finite(self) -> bool:
        """Whether the language is finite: no nonterminal reaches itself; all must be useful."""
        first = self.terminals
        edges = ((k, s - first) for k, right in self._sides() for s in right if s >= first)
        return not on_cycle(len(self.rules), edges)

    def longest(self) -> int:
        """The length of the longest word of a finite, non-empty language."""
        first = self.terminals
        children = [
            [s - first for right in rights for s in right if s >= first] for rights in self.rules
        ]
        component = components(len(self.rules), children.__getitem__)
        length = [0] * len(self.rules)
        for k in sorted(range(len(self.rules)), key=component.__getitem__):
            lengths = (
                sum(1 if s < first else length[s - first] for s in right) for right in self.rules[k]
            )
            length[k] = max(lengths, default=0)
        return max((length[s - first] for s in self.starts), default=0)

    def shortest(self) -> int | None:
        """The length of the shortest word; None if there is none."""
        return 0 if self.empty_word else self.lightest([1] * self.terminals)

    def lightest(self, weights: Sequence[int]) -> int | None:
        """The least weight of a non-empty word; None if there is no such word.

        Knuth's generalisation of shortest paths, *Inf. Proc. Lett.* 6 (1977), by relaxation.

        Args:
            weights: the weights of the terminals, none negative.
        """
        least: list[int | None] = [None] * len(self.rules)
        users: list[dict[int, None]] = [{} for _ in self.rules]
        for k, right in self._sides():
            for symbol in right:
                if symbol >= self.terminals:
                    users[symbol - self.terminals][k] = None
        todo = OrderedDict.fromkeys(range(len(self.rules)))
        while todo:
            k, _ = todo.popitem(last=False)
            found = self._least(k, least, weights)
            if found != least[k]:
                least[k] = found
                todo.update(users[k])
        totals = [least[start - self.terminals] for start in self.starts]
        return min((total for total in totals if total is not None), default=None)

    def _least(self, k: int, least: Sequence[int | None], weights: Sequence[int]) -> int | None:
        """The least weight of nonterminal number k, from the weights known so far."""
        found = least[k]
        for right in self.rules[k]:
            total = 0
            for symbol in right:
                first = self.terminals
                part = weights[symbol] if symbol < first else least[symbol - first]
                if part is None:
                    break
                total += part
            else:
                found = total if found is None else min(found, total)
        return found

    def _sides(self) -> Iterable[tuple[int, RightSide]]:
        return ((k, right) for k, rights in enumerate(self.rules) for right in rights)


def binary_normal_form(cfg: Cfg) -> BinaryGrammar:
    """The language of ``cfg`` in binary normal form; useless nonterminals have no rules."""
    pairs = _binarised(trimmed(cfg))
    empty = nullable(pairs)
    first = pairs.terminals
    solid: list[dict[RightSide, None]] = [{} for _ in range(pairs.nonterminals)]
    units: list[list[int]] = [[] for _ in range(pairs.nonterminals)]
    for left, right in pairs.rules:
        for side in _without_empty(right, empty):
            if len(side) == 1 and side[0] >= first:
                units[left - first].append(side[0] - first)
            else:
                solid[left - first][side] = None
    rules = tuple(
        tuple(dict.fromkeys(side for k in _reached(n, units) for side in solid[k]))
        for n in range(pairs.nonterminals)
    )
    return BinaryGrammar(first, rules, (pairs.start,), pairs.start in empty)


def binary_form(cfg: Cfg) -> BinaryGrammar:
    """The language of ``cfg`` in binary form: with unit rules, but without cycles of them.

    Nonterminals that derive each other alone derive the same words, and are merged.
    """
    pairs = _binarised(trimmed(cfg))
    empty = nullable(pairs)
    first = pairs.terminals
    sides = [(left, side) for left, right in pairs.rules for side in _without_empty(right, empty)]
    units: list[list[int]] = [[] for _ in range(pairs.nonterminals)]
    for left, side in sides:
        if len(side) == 1 and side[0] >= first:
            units[left - first].append(side[0] - first)
    component = components(pairs.nonterminals, units.__getitem__)
    one: dict[int, int] = {}
    name = [first + one.setdefault(c, n) for n, c in enumerate(component)]
    rules: list[dict[RightSide, None]] = [{} for _ in range(pairs.nonterminals)]
    for left, side in sides:
        renamed = tuple(s if s < first else name[s - first] for s in side)
        if renamed != (name[left - first],):
            rules[name[left - first] - first][renamed] = None
    start = name[pairs.start - first]
    # Nonterminals that derive only the empty word have no rules left; rules that use them are
    # useless.
    kept = trimmed(
        Cfg(
            first,
            pairs.nonterminals,
            tuple(Rule(first + n, side) for n, row in enumerate(rules) for side in row),
            start,
        )
    )
    useful: list[list[RightSide]] = [[] for _ in rules]
    for left, side in kept.rules:
        useful[left - first].append(side)
    starts = (start,) if useful[start - first] else ()
    return BinaryGrammar(first, tuple(map(tuple, useful)), starts, pairs.start in empty)


def _binarised(cfg: Cfg) -> Cfg:
    """A grammar with at most two symbols on right sides; equal rests share a nonterminal."""
    rules: list[Rule] = []
    rest_of: dict[RightSide, int] = {}
    for left, right in cfg.rules:
        head, tail = left, right
        while len(tail) > 2:
            known = tail[1:] in rest_of
            rest = rest_of.setdefault(tail[1:], cfg.terminals + cfg.nonterminals + len(rest_of))
            rules.append(Rule(head, (tail[0], rest)))
            if known:
                break
            head, tail = rest, tail[1:]
        else:
            rules.append(Rule(head, tail))
    return Cfg(cfg.terminals, cfg.nonterminals + len(rest_of), tuple(rules), cfg.start)


def _without_empty(right: RightSide, empty: frozenset[int]) -> list[RightSide]:
    """The right side with nullable symbols omitted in all ways, without the empty right side."""
    sides = [right] if right else []
    if len(right) == 2:
        sides += [(right[1 - i],) for i in (0, 1) if right[i] in empty]
    return sides


def _reached(start: int, edges: list[list[int]]) -> list[int]:
    """The nodes reached from ``start``, itself first."""
    found = {start: None}
    todo = [start]
    while todo:
        for node in edges[todo.pop()]:
            if node not in found:
                found[node] = None
                todo.append(node)
    return list(found)


# --- L(SRG) intersected with L(accept) as a grammar (Bar-Hillel, Perles, Shamir 1961) -------------
#
# The product of a grammar in binary normal form with the automaton has only the nonterminals (p, A,
# q) that are needed: called from the start in state p, returning in state q.


Triple: TypeAlias = tuple[int, int, int]
Call: TypeAlias = tuple[int, int]

CHECKED_RULES = 200_000
"""The most rules of a product that the checks of a file examine."""


class IntersectionTooLargeError(ValueError):
    """The product has more rules than allowed; their number grows with the cube of the states."""


@dataclass(slots=True)
class _Summaries:
    """For each called (A, p), the states q such that A derives a word that leads from p to q.

    Only live states are kept: no word is accepted from the others.
    """

    grammar: BinaryGrammar
    dfa: Dfa
    live: tuple[bool, ...]
    limit: int | None = None
    returns: dict[Call, dict[int, None]] = field(default_factory=dict)
    waiting: dict[Call, list[tuple[Call, int | None]]] = field(default_factory=dict)
    middles: dict[tuple[int, RightSide], dict[int, list[int]]] = field(default_factory=dict)

    def tabulate(self, start: int) -> None:
        """Close the table under the rules, starting with the call of ``start`` in state 0."""
        todo: list[tuple[int, int, Call, int | None]] = []
        done: list[tuple[Call, int | None, int]] = []
        self._call((start, 0), todo)
        steps = 0
        while todo or done:
            check_time()
            steps += 1
            if self.limit is not None and steps > self.limit:
                raise IntersectionTooLargeError
            if done:
                owner, rest, state = done.pop()
                if rest is not None:
                    todo.append((rest, state, owner, None))
                elif state not in self.returns[owner]:
                    self.returns[owner][state] = None
                    done += [(o, r, state) for o, r in self.waiting[owner]]
                continue
            symbol, state, owner, rest = todo.pop()
            if symbol < self.grammar.terminals:
                after = self.dfa.step(state, symbol)
                if self.live[after]:
                    done.append((owner, rest, after))
            else:
                call = (symbol, state)
                self._call(call, todo)
                self.waiting[call].append((owner, rest))
                done += [(owner, rest, q) for q in self.returns[call]]

    def _call(self, call: Call, todo: list[tuple[int, int, Call, int | None]]) -> None:
        if call in self.returns:
            return
        self.returns[call] = {}
        self.waiting[call] = []
        symbol, state = call
        todo += [
            (right[0], state, call, right[1] if len(right) == 2 else None)
            for right in self.grammar.rules[symbol - self.grammar.terminals]
        ]

    def after(self, symbol: int, state: int) -> Iterable[int]:
        """The live states that a symbol leads to."""
        if symbol >= self.grammar.terminals:
            return self.returns[symbol, state]
        target = self.dfa.step(state, symbol)
        return (target,) if self.live[target] else ()

    def splits(self, triple: Triple, right: RightSide) -> list[tuple[Triple, ...]]:
        """The ways in which a right side leads from p to q, as one triple per symbol."""
        p, _, q = triple
        if len(right) == 1:
            return [((p, right[0], q),)] if q in self.after(right[0], p) else []
        middles = self._middles(p, right).get(q, ())
        return [((p, right[0], s), (s, right[1], q)) for s in middles]

    def _middles(self, p: int, right: RightSide) -> dict[int, list[int]]:
        """For each state that two symbols lead to from p, the states between them."""
        known = self.middles.get((p, right))
        if known is None:
            known = self.middles[p, right] = {}
            for s in self.after(right[0], p):
                for q in self.after(right[1], s):
                    known.setdefault(q, []).append(s)
        return known


def intersect(grammar: BinaryGrammar, dfa: Dfa, limit: int | None = None) -> BinaryGrammar:
    """The words of the grammar that the automaton accepts; all nonterminals are useful.

    Args:
        grammar: the grammar.
        dfa: the automaton, over its terminals.
        limit: the most rules, and the most steps to find them; None: no bound.

    Raises:
        IntersectionTooLargeError: there are more.
    """
    live = dfa.live()
    summaries = _Summaries(grammar, dfa, live, limit)
    empty_word = grammar.empty_word and dfa.accepting[0]
    if not live[0]:
        return BinaryGrammar(grammar.terminals, (), (), empty_word)
    first = grammar.terminals
    order: list[Triple] = []
    number: dict[Triple, int] = {}

    def code(triple: Triple) -> int:
        if triple[1] < first:
            return triple[1]
        if triple not in number:
            number[triple] = first + len(order)
            order.append(triple)
        return number[triple]

    starts: list[int] = []
    for start in grammar.starts:
        summaries.tabulate(start)
        ends = sorted(q for q in summaries.returns[start, 0] if dfa.accepting[q])
        starts += [code((0, start, q)) for q in ends]
    rules: list[tuple[RightSide, ...]] = []
    size = 0
    for triple in order:
        sides: dict[RightSide, None] = {}
        for right in grammar.rules[triple[1] - first]:
            for split in summaries.splits(triple, right):
                sides[tuple(map(code, split))] = None
        rules.append(tuple(sides))
        size += len(sides)
        if limit is not None and size > limit:
            raise IntersectionTooLargeError
    return BinaryGrammar(first, tuple(rules), tuple(starts), empty_word)

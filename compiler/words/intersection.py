"""L(SRG) intersected with L(accept) as a grammar (Bar-Hillel, Perles, Shamir 1961).

The product of a grammar in binary normal form with the automaton is built from the nonterminals
(p, A, q) that are really needed: called from the start in state p, returning in state q.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.time_limits.time_limit import check_time
from compiler.words.binary_normal_form import BinaryGrammar, RightSide
from compiler.words.finite_automaton import Dfa

Triple: TypeAlias = tuple[int, int, int]
Call: TypeAlias = tuple[int, int]

CHECKED_RULES = 200_000
"""So many rules of a product are looked at by the checks of a file."""


class IntersectionTooLargeError(ValueError):
    """A product of more rules than were asked for; their number grows with cubes of states."""


@dataclass(slots=True)
class _Summaries:
    """For each called (A, p) the states q such that A derives a word that leads p to q.

    Only live states are kept: from the others no word is accepted any more.
    """

    grammar: BinaryGrammar
    dfa: Dfa
    live: tuple[bool, ...]
    limit: int | None = None
    returns: dict[Call, dict[int, None]] = field(default_factory=dict)
    waiting: dict[Call, list[tuple[Call, int | None]]] = field(default_factory=dict)
    middles: dict[tuple[int, RightSide], dict[int, list[int]]] = field(default_factory=dict)

    def tabulate(self, start: int) -> None:
        """Close the table under the rules, from the call of ``start`` in state 0."""
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
        """The ways in which a right side leads from p to q, as triples per symbol."""
        p, _, q = triple
        if len(right) == 1:
            return [((p, right[0], q),)] if q in self.after(right[0], p) else []
        middles = self._middles(p, right).get(q, ())
        return [((p, right[0], s), (s, right[1], q)) for s in middles]

    def _middles(self, p: int, right: RightSide) -> dict[int, list[int]]:
        """For each state to which two symbols lead from p, the states between them."""
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
        limit: the most rules, and steps towards them; None: as many as there are.

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

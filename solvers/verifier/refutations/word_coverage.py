"""Whether every word of a family is listed or satisfies one of given conditions.

The product of the grammar with a reader of the conditions is searched for a word that is not
covered (Bar-Hillel, Perles & Shamir 1961). The automata, the product and the list share no code
with the searchers: regular expressions use positions (Glushkov 1961) instead of empty moves, states
are built on demand instead of as minimal automata, and one table holds what each nonterminal
derives.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TypeAlias, assert_never

from compiler.time_limits.time_limit import check_time
from grammar_lang import ir

State: TypeAlias = Hashable


@dataclass(frozen=True, slots=True)
class Reader:
    """Reads words symbol by symbol: a first state, a step function, and an acceptance test.

    ``settled``: the answer for all words that lead on from a state; None if it may differ.
    """

    first: State
    step: Callable[[State, str], State]
    accepts: Callable[[State], bool]
    settled: Callable[[State], bool | None] = lambda _: None


def reader(condition: ir.Accept) -> Reader:
    """The reader of a condition on words."""
    match condition:
        case ir.Contains(word):
            return _with_factor(word, kept=True)
        case ir.EndsWith(word):
            return _with_factor(word, kept=False)
        case ir.StartsWith(word):
            return _with_prefix(word)
        case ir.Count(symbol, comparison, bound):
            return _counting(lambda x: symbol is None or x == symbol, comparison, bound)
        case ir.Matches(regex):
            return _matching(regex)
        case ir.NotAccept(part):
            return _opposite(reader(part))
        case ir.AllOf(parts):
            return _together([reader(part) for part in parts], every=True)
        case ir.AnyOf(parts):
            return _together([reader(part) for part in parts], every=False)
        case _:
            assert_never(condition)


def _with_factor(word: Sequence[str], *, kept: bool) -> Reader:
    """A state is the longest suffix of the text read so far that is a prefix of ``word``."""
    whole = tuple(word)

    def step(state: State, symbol: str) -> State:
        if kept and state == whole:
            return state
        read = (*_tuple(state), symbol)
        return next(read[i:] for i in range(len(read) + 1) if whole[: len(read) - i] == read[i:])

    def settled(state: State) -> bool | None:
        return True if kept and state == whole else None

    return Reader((), step, lambda state: state == whole, settled)


def _with_prefix(word: Sequence[str]) -> Reader:
    whole = tuple(word)

    def step(state: State, symbol: str) -> State:
        if state == whole or state is None:
            return state
        read = (*_tuple(state), symbol)
        return read if whole[: len(read)] == read else None

    def settled(state: State) -> bool | None:
        return state == whole if state == whole or state is None else None

    return Reader((), step, lambda state: state == whole, settled)


def _tuple(state: State) -> tuple[str, ...]:
    return state if isinstance(state, tuple) else ()


def _counting(counted: Callable[[str], bool], comparison: ir.Comparison, bound: int) -> Reader:
    def step(state: State, symbol: str) -> State:
        return min(_number(state) + counted(symbol), bound + 1)

    def accepts(state: State) -> bool:
        count = _number(state)
        match comparison:
            case "<=":
                return count <= bound
            case "<":
                return count < bound
            case ">=":
                return count >= bound
            case ">":
                return count > bound
            case "==":
                return count == bound

    def settled(state: State) -> bool | None:
        return accepts(state) if _number(state) > bound else None

    return Reader(0, step, accepts, settled)


def _number(state: State) -> int:
    return state if isinstance(state, int) else 0


def _opposite(inner: Reader) -> Reader:
    def settled(state: State) -> bool | None:
        known = inner.settled(state)
        return None if known is None else not known

    return Reader(inner.first, inner.step, lambda state: not inner.accepts(state), settled)


def _together(parts: Sequence[Reader], *, every: bool) -> Reader:
    """The reader of words that all parts accept, or, without ``every``, that any part accepts."""
    whether = all if every else any

    def step(state: State, symbol: str) -> State:
        return tuple(part.step(s, symbol) for part, s in zip(parts, _states(state), strict=True))

    def accepts(state: State) -> bool:
        return whether(part.accepts(s) for part, s in zip(parts, _states(state), strict=True))

    def settled(state: State) -> bool | None:
        known = [part.settled(s) for part, s in zip(parts, _states(state), strict=True)]
        if (not every) in known:
            return not every
        return None if None in known else every

    return Reader(tuple(part.first for part in parts), step, accepts, settled)


def _states(state: State) -> tuple[State, ...]:
    return state if isinstance(state, tuple) else ()


# --- Regular expressions by positions -------------------------------------------------------------


@dataclass(slots=True)
class _Positions:
    """The symbols at the positions of an expression, from 1, and the successors of each."""

    symbols: list[str] = field(default_factory=lambda: [""])
    follow: dict[int, set[int]] = field(default_factory=lambda: {0: set[int]()})

    def add(self, regex: ir.Regex) -> tuple[set[int], set[int], bool]:
        """The first and last positions of an expression, and whether it can be empty."""
        match regex:
            case ir.RSymbol(name):
                number = len(self.symbols)
                self.symbols.append(name)
                self.follow[number] = set()
                return {number}, {number}, False
            case ir.REmpty():
                return set(), set(), True
            case ir.RSequence(parts):
                return self._sequence(parts)
            case ir.RChoice(parts):
                found = [self.add(part) for part in parts]
                return (
                    set[int]().union(*(first for first, _, _ in found)),
                    set[int]().union(*(last for _, last, _ in found)),
                    any(empty for _, _, empty in found),
                )
            case ir.RRepeat(part, mark):
                first, last, empty = self.add(part)
                if mark in "*+":
                    self._join(last, first)
                return first, last, empty or mark in "*?"
            case _:
                assert_never(regex)

    def _sequence(self, parts: Sequence[ir.Regex]) -> tuple[set[int], set[int], bool]:
        first, last, empty = set[int](), set[int](), True
        for part in parts:
            starts, ends, skipped = self.add(part)
            self._join(last, starts)
            first = first | starts if empty else first
            last = last | ends if skipped else ends
            empty = empty and skipped
        return first, last, empty

    def _join(self, last: Iterable[int], first: Iterable[int]) -> None:
        for position in last:
            self.follow[position] |= set(first)


def _matching(regex: ir.Regex) -> Reader:
    """A state is the set of positions where the text read so far may end; 0 is the start."""
    positions = _Positions()
    first, last, empty = positions.add(regex)
    positions.follow[0] = first
    final = last | ({0} if empty else set())

    def step(state: State, symbol: str) -> State:
        reached = (p for at in _set(state) for p in positions.follow[at])
        return frozenset(p for p in reached if positions.symbols[p] == symbol)

    def settled(state: State) -> bool | None:
        return None if _set(state) else False

    return Reader(frozenset((0,)), step, lambda state: not final.isdisjoint(_set(state)), settled)


def _set(state: State) -> frozenset[int]:
    return state if isinstance(state, frozenset) else frozenset()


# --- The words of a grammar that are not covered --------------------------------------------------


def listed(words: Iterable[Sequence[str]]) -> Reader:
    """The reader of given words: a state is a node of their prefix tree, None outside it."""
    tree: list[dict[str, int]] = [{}]
    ends: set[int] = set()
    for word in words:
        node = 0
        for symbol in word:
            if symbol not in tree[node]:
                tree[node][symbol] = len(tree)
                tree.append({})
            node = tree[node][symbol]
        ends.add(node)

    def step(state: State, symbol: str) -> State:
        return tree[state].get(symbol) if isinstance(state, int) else None

    return Reader(0, step, lambda state: state in ends, _lost)


def within(modules: Iterable[str], bound: int) -> Reader:
    """The reader of the words with at most ``bound`` modules."""
    counted = frozenset(modules)
    return _counting(counted.__contains__, "<=", bound)


def weighing(weights: Mapping[str, Fraction], bound: Fraction, *, strict: bool) -> Reader:
    """The reader of the words whose symbols weigh at most ``bound`` in total; ``strict``: less.

    A state is the weight of what was read so far, None once it is too large; no weight is negative.
    """

    def kept(weight: Fraction) -> Fraction | None:
        return weight if weight < bound or (weight == bound and not strict) else None

    def step(state: State, symbol: str) -> State:
        if not isinstance(state, Fraction):
            return None
        return kept(state + weights.get(symbol, Fraction(0)))

    return Reader(kept(Fraction(0)), step, lambda state: state is not None, _lost)


def _lost(state: State) -> bool | None:
    return False if state is None else None


def word_left(grammar: ir.Grammar, asked: Sequence[Reader], covered: Sequence[Reader]) -> bool:
    """Whether the grammar derives a word that all ``asked`` accept and that no ``covered`` accepts.

    The grammar's own condition is ignored; include it in ``asked``.
    """
    return _Search(grammar, asked, covered).finds()


_Call: TypeAlias = tuple[str, int]
_Item: TypeAlias = tuple[_Call, int, int, int]


@dataclass(slots=True)
class _Search:
    """For each nonterminal and each state before it, the states after the words that it derives.

    States that lead to no uncovered word are skipped.
    """

    grammar: ir.Grammar
    asked: Sequence[Reader]
    covered: Sequence[Reader]
    states: list[tuple[State, ...]] = field(default_factory=list[tuple[State, ...]])
    numbers: dict[tuple[State, ...], int] = field(default_factory=dict[tuple[State, ...], int])
    hopeless: list[bool] = field(default_factory=list[bool])
    moves: dict[tuple[int, str], int] = field(default_factory=dict[tuple[int, str], int])

    def finds(self) -> bool:
        """Whether the start symbol derives a word that is asked for and not covered."""
        rules: dict[str, list[int]] = {}
        for number, production in enumerate(self.grammar.productions):
            rules.setdefault(production.left, []).append(number)
        start = self.grammar.start, self._number(tuple(r.first for r in self._readers()))
        after: dict[_Call, set[int]] = {start: set()}
        callers: dict[_Call, list[_Item]] = {start: []}
        todo: list[_Item] = [(start, rule, 0, start[1]) for rule in rules.get(start[0], ())]
        while todo:
            check_time()
            call, rule, place, state = todo.pop()
            if self.hopeless[state]:
                continue
            right = self.grammar.productions[rule].right
            if place < len(right) and right[place].kind != "nonterminal":
                todo.append((call, rule, place + 1, self._step(state, right[place].name)))
            elif place < len(right):
                inner = right[place].name, state
                if inner not in after:
                    after[inner], callers[inner] = set(), []
                    todo += [(inner, number, 0, state) for number in rules.get(inner[0], ())]
                callers[inner].append((call, rule, place + 1, state))
                todo += [(call, rule, place + 1, reached) for reached in after[inner]]
            elif state not in after[call]:
                after[call].add(state)
                todo += [(c, r, k, state) for c, r, k, _ in callers[call]]
                if call == start and self._is_left(state):
                    return True
        return False

    def _readers(self) -> Sequence[Reader]:
        return (*self.asked, *self.covered)

    def _number(self, state: tuple[State, ...]) -> int:
        if state not in self.numbers:
            self.numbers[state] = len(self.states)
            self.states.append(state)
            self.hopeless.append(self._leads_nowhere(state))
        return self.numbers[state]

    def _step(self, state: int, symbol: str) -> int:
        key = state, symbol
        if key not in self.moves:
            parts = zip(self._readers(), self.states[state], strict=True)
            self.moves[key] = self._number(tuple(r.step(s, symbol) for r, s in parts))
        return self.moves[key]

    def _leads_nowhere(self, state: tuple[State, ...]) -> bool:
        """Whether all words that lead on from a state are covered or not asked for."""
        known = [r.settled(s) for r, s in zip(self._readers(), state, strict=True)]
        count = len(self.asked)
        return False in known[:count] or True in known[count:]

    def _is_left(self, state: int) -> bool:
        accepted = [r.accepts(s) for r, s in zip(self._readers(), self.states[state], strict=True)]
        count = len(self.asked)
        return all(accepted[:count]) and not any(accepted[count:])

"""Reading words from left to right: what may follow, and whether a word is in a language."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import getitem
from sys import intern
from typing import Any, Literal, Protocol, TypeAlias, TypeVar

from compiler.words.continuations import Continuation
from compiler.words.finite_automaton import Dfa
from compiler.words.intersection import BinaryGrammar
from compiler.words.residuals import Residual, Residuals

# --- Reading words from left to right, one state per prefix, with what may still follow -----------
#
# Two kinds of automata do this: a finite one, and the residuals of a grammar, which are made on
# demand.  Enumeration, counting, sampling and comparison use only this interface.


State = TypeVar("State")


class Recogniser(Protocol[State]):
    """A deterministic automaton over terminal numbers.

    ``horizon``: the greatest length for which lengths are exact.
    """

    @property
    def horizon(self) -> int:
        """The greatest length for which lengths are exact."""

    @property
    def root(self) -> State:
        """The state before the first symbol."""

    def moves(self, state: State, /) -> Sequence[tuple[int, State]]:
        """The terminals that may come next, in order, with the states that they lead to."""

    def accepting(self, state: State, /) -> bool:
        """Whether the word may end here."""

    def lengths(self, state: State, /) -> int:
        """Bit m is set if some word of m symbols may follow, up to the horizon."""


# --- A finite automaton read from left to right ---------------------------------------------------


class FiniteRecogniser:
    """The words of a finite automaton; states are numbers."""

    def __init__(self, dfa: Dfa, horizon: int) -> None:
        self.horizon = horizon
        self.root = 0
        self._marks = dfa.accepting
        width = len(dfa.alphabet)
        live = dfa.live()
        rows = [dfa.table[s * width : (s + 1) * width] for s in range(dfa.size)]
        self._moves = [
            [(symbol, target) for symbol, target in enumerate(row) if live[target]] for row in rows
        ]
        self._lengths = self._all_lengths()

    def moves(self, state: int, /) -> list[tuple[int, int]]:
        """The terminals that may come next, in order, with the states that they lead to."""
        return self._moves[state]

    def accepting(self, state: int, /) -> bool:
        """Whether the word may end here."""
        return self._marks[state]

    def lengths(self, state: int, /) -> int:
        """Bit m is set if some word of m symbols may follow, up to the horizon."""
        return self._lengths[state]

    def _all_lengths(self) -> list[int]:
        """For each state, the bit set of the lengths of accepted words."""
        following = [sorted({target for _, target in row}) for row in self._moves]
        bits = [bytearray(self.horizon // 8 + 1) for _ in following]
        level = list(self._marks)
        for length in range(self.horizon + 1):
            place, bit = length >> 3, 1 << (length & 7)
            for state, reached in enumerate(level):
                if reached:
                    bits[state][place] |= bit
            level = [any(level[target] for target in row) for row in following]
        return [int.from_bytes(row, "little") for row in bits]


# --- The residuals of a grammar paired with the states of an automaton: the words of both ---------
#
# Unlike the residuals of the grammar of the intersection, these coincide as often as those of the
# grammar alone, so there are few states.  But a state may be a dead end: the lengths that each of
# both allows are known, not those that both allow together.


Pair = tuple[Residual, int]


class ConditionedRecogniser:
    """A recogniser of the words that a condition accepts as well.

    ``lengths`` contains all lengths of words that may follow, and possibly more.
    """

    def __init__(self, residuals: Residuals, condition: Dfa) -> None:
        self._residuals = residuals
        self._condition = condition
        self._finite = FiniteRecogniser(condition, residuals.horizon)

    @property
    def horizon(self) -> int:
        """The greatest length for which lengths are exact."""
        return self._residuals.horizon

    @property
    def root(self) -> Pair:
        """The state before the first symbol."""
        return self._residuals.root, 0

    def moves(self, pair: Pair, /) -> list[tuple[int, Pair]]:
        """The terminals that may come next, in order, with the states that they lead to."""
        residual, state = pair
        step, lengths = self._condition.step, self._finite.lengths
        found = []
        for symbol, following in self._residuals.moves(residual):
            after = step(state, symbol)
            if lengths(after):
                found.append((symbol, (following, after)))
        return found

    def accepting(self, pair: Pair, /) -> bool:
        """Whether the word may end here."""
        return pair[0].accepting and self._finite.accepting(pair[1])

    def lengths(self, pair: Pair, /) -> int:
        """Bit m is set if some word of m symbols may follow; it may be set wrongly."""
        return pair[0].lengths & self._finite.lengths(pair[1])


# --- The longest prefix of a word that begins some word of a grammar ------------------------------


def viable_prefix(grammar: BinaryGrammar, names: Sequence[str], word: Sequence[str]) -> int:
    """The length of the longest prefix of ``word`` with which some word of the grammar begins.

    ``names`` are the names of the grammar's terminals.  For an empty language the result is 0.
    """
    residual = Residuals(grammar, names).root
    for length, symbol in enumerate(word):
        try:
            residual = residual[symbol]
        except KeyError:
            return length
    return len(word)


# --- Membership by a finite automaton, as fast as Python reads: one dictionary per state ----------
#
# Keys are interned, like names in the text of a program, so they are found by identity.


ACCEPTING = object()
"""A key of the accepting states that equals no symbol."""


class FiniteMembership:
    """Membership in the language of a finite automaton."""

    def __init__(self, dfa: Dfa) -> None:
        live = dfa.live()
        states: list[dict[Any, Any]] = [{} for _ in live]
        width = len(dfa.alphabet)
        for source, row in enumerate(states):
            for symbol, name in enumerate(map(intern, dfa.alphabet)):
                target = dfa.table[source * width + symbol]
                if live[target]:
                    row[name] = states[target]
            if dfa.accepting[source]:
                row[ACCEPTING] = row
        self.initial: Mapping[Any, Any] = states[0]

    def accepts(self, word: Iterable[str]) -> bool:
        """Whether the word is accepted; a word with an unknown token is not."""
        try:
            return ACCEPTING in reduce(getitem, word, self.initial)
        except KeyError:
            return False


# --------------------------------------------------------------------------------------------------
# Membership in any context-free language, by a pushdown automaton made on demand.
#
# Its states are residuals: all that may follow, over all derivations, so that no grammar is read as
# if it were unambiguous.  If everything that may follow goes through one continuation, that is put
# on a stack, and reading goes on with what comes before it.  So words that nest in the same way at
# different depths reach the same states.  When a residual may end, the continuation is taken from
# the stack and joined to it.
#
# Each step is computed once; then reading is one look-up per symbol, as with a finite automaton.


HEIGHT = 3
"""The least height of continuations that are put on the stack."""
CACHE_LIMIT = 50_000
"""The most states that are cached; results never depend on it."""


class _State(dict[Any, Any]):
    """A residual up to the next continuation on the stack, which it does not include.

    It maps a symbol to the next state or a ``_Push``; ``KeyError`` if no word goes on with the
    symbol.
    """

    __slots__ = ("owner", "residual")

    def __init__(self, owner: PushdownMembership, residual: Residual) -> None:
        self.owner = owner
        self.residual = residual

    def __missing__(self, symbol: str) -> _State | _Push:
        following = self.residual[symbol]
        found = self[self.owner.names[symbol]] = self.owner.step(following)
        return found


class _Ending(_State):
    """A state in which the word may end, or reading may go on after the top of the stack.

    It also maps a continuation to the next state if that is the top of the stack.
    """

    __slots__ = ()

    def __missing__(self, key: str | Continuation) -> _State | _Push:
        if isinstance(key, str):
            return super().__missing__(key)
        found = self[key] = self.owner.join(self.residual, key)
        return found


@dataclass(frozen=True, slots=True)
class _Push:
    """Go on with ``state``, with the continuation ``following`` put on the stack."""

    state: _State
    following: Continuation


class PushdownMembership:
    """Membership in the language of a grammar in binary form over named terminals."""

    def __init__(self, grammar: BinaryGrammar, names: Sequence[str]) -> None:
        self._residuals = Residuals(grammar, names)
        self.names = {name: name for name in self._residuals.names}
        self._states: dict[Residual, _State] = {}
        self._initial = self._state(self._residuals.root)

    def accepts(self, word: Iterable[str]) -> bool:
        """Whether the word is in the language; a word with an unknown token is not."""
        stack: list[Continuation] = []
        state: Any = self._initial
        try:
            for symbol in word:
                state = state[symbol]
                while type(state) is not _State:
                    if type(state) is _Push:
                        stack.append(state.following)
                        state = state.state
                    elif stack:
                        state = state[stack.pop()]
                    else:
                        break
        except KeyError:
            return False
        return type(state) is _Ending and not stack

    def step(self, residual: Residual) -> _State | _Push:
        """The next state or push for a residual."""
        if not residual.accepting:
            followings = {following for _, following in residual.agenda}
            if len(followings) == 1:
                (following,) = followings
                if following.height >= HEIGHT:
                    end = self._residuals.end
                    alone = frozenset((symbol, end) for symbol, _ in residual.agenda)
                    before = self._residuals.of(alone, accepting=False)
                    return _Push(self._state(before), following)
        return self._state(residual)

    def join(self, residual: Residual, top: Continuation) -> _State | _Push:
        """The next state or push if a residual may end and ``top`` was on the stack."""
        return self.step(self._residuals.before(residual, top))

    def _state(self, residual: Residual) -> _State:
        known = self._states.get(residual)
        if known is None:
            if len(self._states) >= CACHE_LIMIT:
                self._states.clear()
                self._initial = self._state(self._residuals.root)
            kind = _Ending if residual.accepting else _State
            known = self._states[residual] = kind(self, residual)
        return known


# --- Membership, by the fastest automaton that reads the grammar exactly as it is -----------------
#
# That is a finite automaton if the form of the grammar shows that it is regular; otherwise a
# pushdown automaton whose states are made on demand, which reads any grammar.


Kind: TypeAlias = Literal["finite automaton", "pushdown automaton"]


class MembershipTest(Protocol):
    """A membership test for a language."""

    def accepts(self, word: Iterable[str], /) -> bool:
        """Whether the word is in the language."""


@dataclass(frozen=True)
class Membership:
    """``reader`` for the grammar, ``condition`` for the accept condition (None: in ``reader``)."""

    kind: Kind
    reader: MembershipTest
    condition: MembershipTest | None

    @cached_property
    def accepts(self) -> Callable[[Sequence[str]], bool]:
        """Whether a word is in the language; a word with an unknown token is not."""
        if self.condition is None:
            return self.reader.accepts
        return self._both

    def _both(self, word: Sequence[str]) -> bool:
        return (
            self.condition is not None
            and self.condition.accepts(word)
            and self.reader.accepts(word)
        )

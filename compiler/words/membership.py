"""Membership, by the fastest automaton that reads the grammar exactly as it is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import getitem
from sys import intern
from typing import Any, Literal, Protocol, TypeAlias

from compiler.words.binary_normal_form import BinaryGrammar
from compiler.words.continuations import Continuation
from compiler.words.finite_automaton import Dfa
from compiler.words.residuals import Residual, Residuals

# --- Membership by a finite automaton, as fast as Python reads: one dictionary per state ----------
#
# Keys are interned, as names in the text of a program are, so that these are found by identity.


ACCEPTING = object()
"""A key of the accepting states; no symbol equals it."""


class FiniteMembership:
    """The words of a finite automaton."""

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
# Membership in any context-free language, by a pushdown automaton that is made as it is needed.
#
# Its states are residuals: all that may follow, whatever derivations there are, so that no grammar
# is read as if it were unambiguous.  Where everything that may follow goes through one
# continuation, that is put on a stack, and reading goes on with what comes before it alone: so
# words that nest the same way at different depths meet the same states.  Where a residual may end,
# the continuation is taken from the stack and joined to it.
#
# Each step is worked out once; then reading is one look-up per symbol, as with a finite automaton.


HEIGHT = 3
"""Continuations of this height are put on the stack."""
CACHE_LIMIT = 50_000
"""So many states are remembered; results never depend on it."""


class _State(dict[Any, Any]):
    """A residual up to the next continuation on the stack, which it does not reach.

    By symbol: the next state, or a ``_Push``.  ``KeyError`` where no word goes on like that.
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
    """A state in which the word may end, or reading go on after the stack's top.

    By continuation: the next state where that is the stack's top.
    """

    __slots__ = ()

    def __missing__(self, key: str | Continuation) -> _State | _Push:
        if isinstance(key, str):
            return super().__missing__(key)
        found = self[key] = self.owner.join(self.residual, key)
        return found


@dataclass(frozen=True, slots=True)
class _Push:
    """What comes after ``state`` is put on the stack."""

    state: _State
    following: Continuation


class PushdownMembership:
    """The words of a grammar in binary form over terminals with these names."""

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
        """How to go on with a residual."""
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
        """How to go on where a residual may end and ``top`` was on the stack."""
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
# A finite automaton where the form of the grammar shows that it is regular; else a pushdown
# automaton whose states are made as they are needed, which reads any grammar.


Kind: TypeAlias = Literal["finite automaton", "pushdown automaton"]


class MembershipTest(Protocol):
    """Something that tells the words of a language."""

    def accepts(self, word: Iterable[str], /) -> bool:
        """Whether the word is in the language."""


@dataclass(frozen=True)
class Membership:
    """``reader`` for the grammar; ``condition`` for the accept condition, None: it is in there."""

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

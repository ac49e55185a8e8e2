"""Membership in any context-free language, by a pushdown automaton that is made as it is needed.

Its states are residuals: all that may follow, whatever derivations there are, so that no grammar is
read as if it were unambiguous.  Where everything that may follow goes through one continuation,
that is put on a stack, and reading goes on with what comes before it alone: so words that nest the
same way at different depths meet the same states.  Where a residual may end, the continuation is
taken from the stack and joined to it.

Each step is worked out once; then reading is one look-up per symbol, as with a finite automaton.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from compiler.grammars.binary_normal_form import BinaryGrammar
from compiler.reading.continuations import Continuation
from compiler.reading.residuals import Residual, Residuals

HEIGHT = 3
"""Continuations of this height are put on the stack."""
CACHE_LIMIT = 50_000
"""So many states are remembered; results never depend on it."""


class _State(dict[Any, Any]):
    """A residual up to the next continuation on the stack, which it does not reach.

    By symbol: the next state, or a ``_Push``.  ``KeyError`` where no word goes on like that.
    """

    __slots__ = ("owner", "residual")

    def __init__(self, owner: PushdownReader, residual: Residual) -> None:
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


class PushdownReader:
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

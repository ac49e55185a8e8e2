"""Reading words from left to right, one state per prefix, with what may still follow.

Two kinds of automata do so: a finite one, and the residuals of a grammar, which are made when they
are first needed.  Enumeration, counting, sampling and comparison know this interface only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar

State = TypeVar("State")


class Reading(Protocol[State]):
    """A deterministic automaton over terminals by number.

    ``horizon``: lengths are exact up to so many symbols.
    """

    @property
    def horizon(self) -> int:
        """The greatest length that is known of."""

    @property
    def root(self) -> State:
        """The state before the first symbol."""

    def moves(self, state: State, /) -> Sequence[tuple[int, State]]:
        """The terminals that may come next, in order, with the states that they lead to."""

    def accepting(self, state: State, /) -> bool:
        """Whether the word may end here."""

    def lengths(self, state: State, /) -> int:
        """Bit m is set where some word of m symbols may follow, up to the horizon."""

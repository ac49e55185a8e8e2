"""The search for motions of a robot in one task of a mission, as far as it is needed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from compiler.time_limits.time_limit import OutOfTimeError
from solvers.missions.undecided_robots import Undecided
from solvers.search.path_task import Design
from solvers.search.search_state import NearestMotion, StructureState


class Proved(Exception):
    """Ends a search at its first design."""


@dataclass(slots=True)
class Listener:
    """Collects the results of a search for motions before it ends."""

    designs: list[Design] = field(default_factory=list[Design])
    nearest: NearestMotion | None = None
    at_once: bool = False
    """Whether the first design ends the search."""

    def keep(self, design: Design) -> None:
        """Store a proved design.

        Raises:
            Proved: the first design ends the search.
        """
        self.designs.append(design)
        if self.at_once:
            raise Proved

    def see(self, motion: NearestMotion) -> None:
        """Store a motion that may still become a design."""
        self.nearest = motion


@dataclass(slots=True, eq=False)
class MotionsSought:
    """The search for motions of a robot in a box, attempt by attempt."""

    states: Iterator[StructureState]
    listener: Listener
    best_of: Callable[[Sequence[Design]], Design]
    state: StructureState = field(default_factory=StructureState)
    late: bool = False
    """Whether the time was up before all attempts were made."""

    def first(self) -> Design | None:
        """The first proved design, or at the end of the time the best; None if none is left to try.

        Raises:
            OutOfTimeError: the time was up before a design was proved.
        """
        self._go_on(lambda: self.state.design is not None)
        return self._proved if self.late else self.state.design

    def undecided(self, task: int) -> Undecided:
        """Why there is no design, for the task of this index."""
        return Undecided(f"{self.state.reason}{self.state.obstacle}", task, self.state.cause)

    def at_once(self) -> Design | None:
        """The first proved design, which no search has improved; afterwards nothing is sought.

        Raises:
            OutOfTimeError: the time was up before a design was proved.
        """
        self.listener.at_once = True
        try:
            return self.first()
        except Proved:
            return self.listener.designs[0]

    def best(self) -> Design | None:
        """The best design, by the objectives of the task, of all attempts within the time.

        Raises:
            OutOfTimeError: the time was up before a design was proved.
        """
        self._go_on(lambda: False)
        return self._proved or self.state.design

    @property
    def _proved(self) -> Design | None:
        found = self.listener.designs
        return self.best_of(found) if found else None

    def _go_on(self, enough: Callable[[], bool]) -> None:
        """Make attempts until it is enough or none is left; a design outlives the time."""
        try:
            while not (self.late or self.state.is_over or enough()):
                self.state = next(self.states)
        except OutOfTimeError:
            if not self.listener.designs:
                raise
            self.late = True

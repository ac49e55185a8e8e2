"""Which structure is searched next: structures share the time, smaller ones before larger ones.

Every attempt at a path is a turn.  The k-th structure that is searched (from 0) has its j-th turn
in round k + j.  The first structure is thus always one attempt ahead of the second, and no
structure delays the others for long (dovetailing).  Within a round, the most promising structure
goes first, by the robustness of its nearest motion; a new structure goes last.  A structure for
which no motion is expected along any path is postponed by some rounds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from compiler.robots.candidate import Candidate
from compiler.words.derivation import Derivation
from solvers.search.configuration_search import PathSamples
from solvers.search.path_task import Design
from solvers.search.search_state import NearestMotion, StructureState

LATER = 3
"""The rounds by which a structure without a promising path is postponed."""


def most_robust(designs: Sequence[Design]) -> Design:
    """The most robust of some designs, which is the best if there are no objectives."""
    return max(designs, key=lambda design: design.robustness)


@dataclass(slots=True)
class StructureUnderWay:
    """A structure that is being searched; ``place`` is its index among all that are searched.

    ``incumbent`` is the best proved design, set even before the attempt that gave it has ended.
    ``waiting`` is the last motion reported, whose search or proof may still go on.  ``told`` is
    called whenever a better design is proved; ``best_of`` chooses the best of those ``proved``.
    """

    place: int
    candidate: Candidate
    smt: int
    told: Callable[[], None]
    states: Iterator[StructureState] = field(default_factory=lambda: iter(()))
    state: StructureState = field(default_factory=StructureState)
    incumbent: Design | None = None
    waiting: NearestMotion | None = None
    best_of: Callable[[Sequence[Design]], Design] = field(default=most_robust)
    proved: list[Design] = field(default_factory=list[Design])

    @property
    def number(self) -> int:
        """The number of the structure."""
        return self.candidate.number

    @property
    def derivation(self) -> Derivation:
        """The derivation of the structure."""
        return self.candidate.derivation

    @property
    def samples(self) -> tuple[PathSamples, ...]:
        """The parameters that were evaluated."""
        model = self.candidate.model
        names = () if model is None else tuple(p.label for p in model.parameters)
        return self.state.samples(self.number, names)

    @property
    def round(self) -> int:
        """The round of its next turn."""
        later = LATER if self.state.is_deferred else 0
        return self.place + len(self.state.attempts) + later

    def advance(self) -> None:
        """Make one more attempt."""
        self.state, self.waiting = next(self.states), None

    def keep(self, design: Design) -> None:
        """Store a proved design; it remains, whatever ends the search."""
        self.proved.append(design)
        before, self.incumbent = self.incumbent, self.best_of(self.proved)
        if self.incumbent is not before:
            self.told()

    def see(self, motion: NearestMotion) -> None:
        """Store a motion that may still become a design, with what the last proof lacked."""
        if self.waiting is not None and not motion.text:
            motion = replace(motion, text=self.waiting.text, remedy=self.waiting.remedy)
        self.waiting = motion

    @property
    def nearest(self) -> NearestMotion | None:
        """The motion nearest to a design; one under way only if it is nearer."""
        known = [each for each in (self.state.nearest, self.waiting) if each is not None]
        return max(known, key=lambda motion: motion.rank, default=None)


@dataclass(slots=True)
class SearchQueue:
    """The structures under way.

    If ``every`` structure is wanted, each is searched to its end before the next begins.
    """

    every: bool
    entered: int = 0
    """The number of structures that have entered the search."""
    under_way: list[StructureUnderWay] = field(default_factory=list[StructureUnderWay])
    parked: list[StructureUnderWay] = field(default_factory=list[StructureUnderWay])
    """The structures that currently get no turns."""
    current: StructureUnderWay | None = None
    """The structure that had the last turn."""

    def enter(self, structure: StructureUnderWay, states: Iterator[StructureState]) -> None:
        """Add a structure; its states are drawn from ``states``."""
        structure.states = states
        self.entered += 1
        self.under_way.append(structure)

    def wants_another(self) -> bool:
        """Whether a new structure takes the next turn."""
        if self.every:
            return not self.under_way
        return all(each.round > self.entered for each in self.under_way)

    def turn(self) -> StructureUnderWay:
        """Let the next structure make an attempt; ValueError if there is none."""
        self.current = min(
            self.under_way, key=lambda each: (each.round, -each.state.best, each.place)
        )
        self.current.advance()
        return self.current

    def finish(self, structure: StructureUnderWay) -> None:
        """Let a structure make all its remaining attempts."""
        self.current = structure
        while not structure.state.is_over:
            structure.advance()

    def leave(self, structure: StructureUnderWay) -> None:
        """Remove a structure from the queue."""
        self.under_way.remove(structure)

    def give_turns(self, due: Callable[[StructureUnderWay], bool]) -> None:
        """Give turns only to the structures that are ``due``; park the others."""
        unfinished = sorted([*self.under_way, *self.parked], key=lambda each: each.place)
        self.under_way = [each for each in unfinished if due(each)]
        self.parked = [each for each in unfinished if not due(each)]

"""Which structure is searched next: structures share the time, smaller ones ahead of larger ones.

Every attempt at a path is a turn.  The k-th structure that is searched (from 0) has its j-th turn
in round k + j: the first structure always is one attempt ahead of the second, and no structure
keeps the others waiting for long (dovetailing).  Within a round the most promising goes first, by
the robustness of the nearest motion that it has come to; a new structure goes last.  A structure
that no motion is expected for along any path comes some rounds later.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from compiler.robots.candidate import Candidate
from compiler.words.derivation import Derivation
from solvers.search.configuration_search import PathSamples
from solvers.search.path_task import Design
from solvers.search.search_state import NearestMotion, StructureState

LATER = 3
"""By so many rounds."""


def most_robust(designs: Sequence[Design]) -> Design:
    """The best of some designs where nothing else is asked for."""
    return max(designs, key=lambda design: design.robustness)


@dataclass(slots=True)
class StructureUnderWay:
    """A structure that is searched, and what is known of it; ``place`` is that among all searched.

    ``incumbent`` is a proved design, there before the attempt that it comes from has ended;
    ``waiting`` is the last motion that was seen, whose search or proof may go on.  ``told`` is
    called when a better design was proved; ``best_of`` says which of those ``proved`` is the best.
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
        """What was evaluated."""
        model = self.candidate.model
        names = () if model is None else tuple(p.label for p in model.parameters)
        return self.state.samples(self.number, names)

    @property
    def round(self) -> int:
        """That of its next turn."""
        later = LATER if self.state.is_deferred else 0
        return self.place + len(self.state.attempts) + later

    def advance(self) -> None:
        """One attempt more."""
        self.state, self.waiting = next(self.states), None

    def keep(self, design: Design) -> None:
        """A design was proved: it is there from now on, whatever ends the search."""
        self.proved.append(design)
        before, self.incumbent = self.incumbent, self.best_of(self.proved)
        if self.incumbent is not before:
            self.told()

    def see(self, motion: NearestMotion) -> None:
        """A motion was found that may become a design yet."""
        self.waiting = motion

    @property
    def nearest(self) -> NearestMotion | None:
        """The motion that came nearest to a design; one under way only where it is nearer."""
        known = [each for each in (self.state.nearest, self.waiting) if each is not None]
        return max(known, key=lambda motion: motion.rank, default=None)


@dataclass(slots=True)
class SearchQueue:
    """The structures under way.

    Where ``every`` structure is wanted, each is searched to its end before the next.
    """

    every: bool
    entered: int = 0
    """How many structures have been searched."""
    under_way: list[StructureUnderWay] = field(default_factory=list[StructureUnderWay])
    parked: list[StructureUnderWay] = field(default_factory=list[StructureUnderWay])
    """Those that have no turns for now."""
    current: StructureUnderWay | None = None
    """The one that had the last turn."""

    def enter(self, structure: StructureUnderWay, states: Iterator[StructureState]) -> None:
        """Another structure, whose states are asked for one after another."""
        structure.states = states
        self.entered += 1
        self.under_way.append(structure)

    def wants_another(self) -> bool:
        """Whether a structure that is not under way has the next turn."""
        if self.every:
            return not self.under_way
        return all(each.round > self.entered for each in self.under_way)

    def turn(self) -> StructureUnderWay:
        """Let the structure that is next make an attempt; ValueError: there is none."""
        self.current = min(
            self.under_way, key=lambda each: (each.round, -each.state.best, each.place)
        )
        self.current.advance()
        return self.current

    def finish(self, structure: StructureUnderWay) -> None:
        """Let a structure make all attempts that are left to it."""
        self.current = structure
        while not structure.state.is_over:
            structure.advance()

    def leave(self, structure: StructureUnderWay) -> None:
        """A structure has no turn any more."""
        self.under_way.remove(structure)

    def give_turns(self, due: Callable[[StructureUnderWay], bool]) -> None:
        """Only those structures have turns from now on that are due."""
        unfinished = sorted([*self.under_way, *self.parked], key=lambda each: each.place)
        self.under_way = [each for each in unfinished if due(each)]
        self.parked = [each for each in unfinished if not due(each)]

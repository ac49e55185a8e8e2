"""The search for a robot that minimises the objectives of a task.

Objectives are minimised in turn.  For each, structures are tried in ascending order of a lower
bound on it, among those within the limits that earlier objectives set.  Once there is a design,
only structures that may have less are searched further.  Words give no lower bound on time, effort
or energy, so any structure may have less of these; a later objective therefore does not wait for
all structures.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial

from compiler.objectives.least_values import Amount
from compiler.objectives.ordered_structures import Limit, structures_by
from compiler.robots.candidate import Candidate
from compiler.robots.normal_form import RobotFamily
from compiler.words.free_cycles import has_free_cycle
from grammar_lang import ir
from solvers.conclusion import module_bound
from solvers.search.design_values import limits_of
from solvers.search.family_search import FamilySearch
from solvers.search.search_queue import StructureUnderWay
from solvers.search.structures_left import StructuresLeft

IN_VAIN = 3
"""The search for a later objective ends after this many structures in a row without improvement."""


@dataclass(slots=True)
class LeastSearch:
    """The search of a family for the minimum of each objective in turn."""

    run: FamilySearch
    amounts: tuple[Amount, ...]
    place: int = 0
    """The index of the current objective."""
    tried: set[tuple[str, ...]] = field(default_factory=set[tuple[str, ...]])
    least: Fraction | None = None
    """The least value of the current objective among the designs known at the last check."""
    before: int = 0
    """The number of structures searched when this value was first seen."""
    ended: dict[str, str] = field(default_factory=dict[str, str])
    """Maps the kind of an objective to the limit that ended the search for less of it."""

    def search(self) -> None:
        """Try structures until no other can have less, or the limits of the run are reached."""
        run = self.run
        for place in range(len(self.amounts)):
            self.place, self.least = place, None
            left = StructuresLeft(
                run.program, run.task, run.context, run.whole, run.lemmas, self.tried, self.order
            )
            for _ in run.turns(left, partial(self.prepare, left)):
                pass
            run.family = left.family
            if not run.every_design:
                return

    @property
    def amount(self) -> Amount:
        """The current objective."""
        return self.amounts[self.place]

    def modules(self, family: RobotFamily) -> int | None:
        """The bound on modules of the structures tried; None if the objectives bound them."""
        return searched_modules(family, self.run.task, self.amounts)

    def order(self, family: RobotFamily) -> Iterator[Candidate]:
        """The structures of a family within the limits, in the order of the current objective."""
        limits, _ = self.limits()
        bound, origin = self.modules(family), self.run.task.origin
        return structures_by(self.amount, family, bound, limits[: self.place], origin)

    def limits(self) -> tuple[tuple[Limit, ...], int | None]:
        """The limits that the designs so far set, and the index of the best design."""
        return limits_of(self.run.all_values, self.amounts)

    def prepare(self, left: StructuresLeft) -> None:
        """Restrict the search to structures that may have less than the best design."""
        limits, best = self.limits()
        if best is None:
            return
        least = limits[self.place].least
        if least != self.least:
            self.least, self.before = least, len(self.run.searched)
        before = limits[: self.place]
        self.run.queue.give_turns(lambda each: self.may_be_less(each, before, least))
        following = left.following
        if following is not None and not self.run.every:
            word = following.derivation.word
            if self.amount.of_robot(word, following.model) >= least:
                left.stop()
        if self.is_in_vain() and (left.following is not None or self.run.queue.under_way):
            self.end(left)

    def is_in_vain(self) -> bool:
        """Whether enough structures were searched since a design last improved the objective.

        Never for the first objective, which is the one asked for, nor if words are ordered by the
        objective: each structure refuted there strengthens what is proved.
        """
        if self.run.every or not self.place or self.amount.is_ordering:
            return False
        return len(self.run.searched) - self.before >= IN_VAIN

    def end(self, left: StructuresLeft) -> None:
        """End the search for the current objective, and record the limit."""
        left.stop()
        self.run.queue.give_turns(lambda _: False)
        kind = self.amount.objective.kind
        self.ended[kind] = (
            f"the search for less {kind} ended at its limit of {IN_VAIN} robots in a row that have "
            "no less: narrow `accept`, or search all with `--all`"
        )

    def may_be_less(
        self, structure: StructureUnderWay, before: Sequence[Limit], least: Fraction
    ) -> bool:
        """Whether a structure under way may have less than ``least``, within the limits."""
        if self.run.every:
            return True
        candidate, word = structure.candidate, structure.derivation.word
        if not all(limit.allows(word, candidate) for limit in before):
            return False
        return self.amount.of_robot(word, candidate.model) < least


def searched_modules(family: RobotFamily, task: ir.Task, amounts: Sequence[Amount]) -> int | None:
    """The bound on modules of the structures tried; None if the objectives bound them."""
    if task.modules is not None:
        return task.modules
    weights = [amounts[0].weights.get(name, Fraction(0)) for name in family.language.srg.terminals]
    if has_free_cycle(family.language.product, weights):
        return module_bound(family, task)
    return None

"""What a design has of the objectives of a task, and what is proved of all robots, in words."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from compiler.objectives.least_values import Amount
from compiler.objectives.objective_text import amount_text, gap_text, value_text
from solvers.conclusion import StructureRecord
from solvers.lemma import Lemma
from solvers.search.time_bound import TimeBound


@dataclass(frozen=True, slots=True)
class ObjectiveResult:
    """What the design has of an objective, and the least that is proved of all robots.

    ``value`` and ``least`` are in SI units: no robot that has of the objectives before what these
    leave has less than ``least``.  Of some design they have ``reached`` so much.  So many robots
    that may have less than that are ``undecided``; where not all of them were looked at, there may
    be ``more``.  Robots that were found may have less as well where they have ``other`` parameters
    or motions.
    """

    amount: Amount
    value: Fraction
    least: Fraction
    reached: Fraction
    undecided: int
    more: bool
    other: bool = False

    @property
    def is_least(self) -> bool:
        """Whether no robot has less than the design."""
        return self.least >= self.value and self.is_settled

    @property
    def is_settled(self) -> bool:
        """Whether no robot has less than some design."""
        return self.least >= self.reached and not self.undecided and not self.more

    @property
    def gap(self) -> Fraction | None:
        """By which part of the proved least the best design is above it; None where that is 0."""
        return self.reached / self.least - 1 if self.least > 0 else None

    def with_least(self, least: Fraction) -> ObjectiveResult:
        """The same with what no robot has less of; no robot is open where some design has that."""
        if least < self.reached:
            return replace(self, least=least)
        return replace(self, least=least, undecided=0, more=False)

    @property
    def text(self) -> str:
        """What is known of it, in words."""
        said = self._best_text()
        if self.value > self.reached:
            return f"{amount_text(self.amount.objective, self.value)} ({said})"
        return said

    def _best_text(self) -> str:
        best = amount_text(self.amount.objective, self.reached)
        if self.is_settled:
            return f"least {best}"
        unsettled = self.amount.is_ordering and (self.undecided or self.more)
        if unsettled and not self.other:
            return f"least {best}, unless {self._others()} for less"
        if self.gap is not None:
            least = value_text(self.amount.objective, self.least)
            best = f"{best}; no robot has less than {least} (gap {gap_text(self.gap)})"
        return f"{best}; perhaps {self._others()} for less" if unsettled else best

    def _others(self) -> str:
        """The robots that may have less, and do it."""
        if not self.undecided:
            return "a robot that was not tried does it"
        which = "the undecided robot"
        if self.undecided > 1:
            which = f"one of {self.undecided} undecided robots"
        return f"{which}, or one that was not tried, does it" if self.more else f"{which} does it"


@dataclass(frozen=True, slots=True)
class Optimality:
    """The objectives of a design, and the evidence for the least of each.

    ``modules`` is the bound on modules that they are about, None without one; ``by_default`` it is
    not that of the task.  ``records`` are the structures that may have less, all with coverings,
    and those whose variants the ``lemmas`` are about; ``dearer`` are words of which each robot has
    as much.  The least time rests on ``time``, ``untimed`` says why there is no bound on it.
    """

    objectives: tuple[ObjectiveResult, ...]
    modules: int | None
    by_default: bool
    records: tuple[StructureRecord, ...]
    dearer: tuple[tuple[str, ...], ...]
    lemmas: tuple[Lemma, ...]
    time: TimeBound | None = None
    untimed: str | None = None

    def with_least_time(self, least: Fraction, bound: TimeBound | None = None) -> Optimality:
        """The same with the time that no motion of any robot is below, in s.

        It needs no ``bound`` where the task allows no motion of fewer steps.
        """
        objectives = (
            each.with_least(least) if each.amount.objective.kind == "time" else each
            for each in self.objectives
        )
        return replace(self, objectives=tuple(objectives), time=bound)

    @property
    def text(self) -> str:
        """What is known of the objectives, in words."""
        known = "; then ".join(each.text for each in self.objectives)
        bound = f", of robots with up to {self.modules} modules" if self.by_default else ""
        return known + bound

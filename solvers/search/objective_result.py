"""The values of a design in the objectives of a task, and the proved lower bounds, in words."""

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
    """The value of the design in one objective, and the proved lower bound over all robots.

    ``value`` and ``least`` are in SI units.  No robot within the limits set by the earlier
    objectives has less than ``least``.  ``reached`` is the least value of any design.
    ``undecided`` counts the robots that may have less than that; ``more`` says that there may be
    further ones that were not examined.  ``other`` says that robots with a design may also have
    less, with other parameters or motions.
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
        """Whether no robot has less than this design."""
        return self.least >= self.value and self.is_settled

    @property
    def is_settled(self) -> bool:
        """Whether no robot has less than the best design."""
        return self.least >= self.reached and not self.undecided and not self.more

    @property
    def gap(self) -> Fraction | None:
        """The best design's relative distance from the proved bound; None if the bound is 0."""
        return self.reached / self.least - 1 if self.least > 0 else None

    def with_least(self, least: Fraction) -> ObjectiveResult:
        """This result with another bound; no robot is undecided if some design attains it."""
        if least < self.reached:
            return replace(self, least=least)
        return replace(self, least=least, undecided=0, more=False)

    @property
    def text(self) -> str:
        """The result in words."""
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
        """The robots that may have less, as the subject of a sentence."""
        if not self.undecided:
            return "a robot that was not tried does it"
        which = "the undecided robot"
        if self.undecided > 1:
            which = f"one of {self.undecided} undecided robots"
        return f"{which}, or one that was not tried, does it" if self.more else f"{which} does it"


@dataclass(frozen=True, slots=True)
class Optimality:
    """The objectives of a design, and the evidence for the lower bound on each.

    ``modules`` is the bound on modules, None without one; ``by_default`` says that it is not the
    task's own.  ``records`` are the structures that may have less, all with coverings, and the base
    structures of the ``lemmas``.  ``dearer`` are words for which no robot has less than the bound.
    The least time rests on ``time``; ``untimed`` says why there is no bound on it.
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
        """This result with a lower bound, in s, on the time of any motion of any robot.

        ``bound`` may be None if the task allows no motion of fewer steps.
        """
        objectives = (
            each.with_least(least) if each.amount.objective.kind == "time" else each
            for each in self.objectives
        )
        return replace(self, objectives=tuple(objectives), time=bound)

    @property
    def text(self) -> str:
        """The results for all objectives, in words."""
        known = "; then ".join(each.text for each in self.objectives)
        bound = f", of robots with up to {self.modules} modules" if self.by_default else ""
        return known + bound

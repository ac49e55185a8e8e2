"""The result of checking one condition in the proof of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Context

from flint import arb

from compiler.expressions.evaluators.balls import below
from compiler.robots.state_and_input import SEVERAL_UNITS
from compiler.workspaces.polytope import Polytope
from solvers.verifier.proofs.tube_checks import Status, rows_of

NO_MARGIN = float("inf")
"""The margin of a condition that has no measure of how well it holds."""


@dataclass(frozen=True, slots=True)
class CheckedCondition:
    """A proved, disproved or undecided condition, with its margin and where it is attained.

    ``margin`` is in ``unit``, ``time`` in seconds, ``place`` in metres. If the condition is not
    proved, ``time`` and ``place`` say where this is first seen, and the margin is not positive.
    """

    name: str
    status: Status
    margin: float
    unit: str
    time: float | None = None
    place: tuple[float, ...] = ()
    clause: int | None = None
    """For a formula: the number of its ``satisfy`` in the task, from 0."""
    loose: bool = False
    """Whether a narrower tube may show a larger margin."""
    exact: bool = False
    """Whether the result rests on rational numbers alone, not on balls."""
    why: str = ""
    """Why the condition does not hold, if its name does not say enough."""
    most: float = NO_MARGIN
    """An upper bound of the margin, if one is known."""

    def least(self, digits: int) -> float:
        """The margin rounded down to ``digits`` digits, so that no more is stated than proved."""
        return float(Context(prec=digits, rounding=ROUND_FLOOR).create_decimal(repr(self.margin)))

    @property
    def unit_text(self) -> str:
        """The unit for people: in parentheses if it stands for those of several quantities."""
        return f"({SEVERAL_UNITS})" if self.unit == SEVERAL_UNITS else self.unit

    @property
    def level(self) -> str:
        """The level of the evidence."""
        return "exact" if self.exact else "validated"

    @property
    def reason(self) -> str:
        """Why the condition is not proved, in words."""
        verb = "violated" if self.status is Status.FAILS else "not decided"
        at = "" if self.time is None else f" at {self.time:.4g} s"
        return f"{self.why or f'{self.name}: {verb}'}{at}"


def decisive(conditions: Sequence[CheckedCondition]) -> CheckedCondition | None:
    """The first violated condition, else the earliest undecided one; None if all hold."""
    failed = next((f for f in conditions if f.status is Status.FAILS), None)
    if failed is not None:
        return failed
    still_open = [f for f in conditions if f.status is Status.UNDECIDED]
    return min(still_open, key=lambda f: NO_MARGIN if f.time is None else f.time, default=None)


def inside(name: str, polytope: Polytope, point: Sequence[arb], time: float) -> CheckedCondition:
    """Whether a point (d,) is strictly inside a polytope at an instant in s; the margin is in m."""
    gaps = [
        (r.offset - sum((a * x for a, x in zip(r.normal, point, strict=True)), arb(0))) / r.length
        for r in rows_of(polytope)
    ]
    return least(name, gaps, "m", time, tuple(float(x.mid()) for x in point))


def least(
    name: str, gaps: Sequence[arb], unit: str, time: float, place: tuple[float, ...] = ()
) -> CheckedCondition:
    """Whether all gaps are positive; the margin is a lower bound of the least gap."""
    if any(bool(gap < 0) for gap in gaps):
        worst = min(float(gap.mid()) for gap in gaps)
        return CheckedCondition(name, Status.FAILS, worst, unit, time, place)
    status = Status.HOLDS if all(bool(gap > 0) for gap in gaps) else Status.UNDECIDED
    margin = min((below(gap) for gap in gaps), default=NO_MARGIN)
    return CheckedCondition(name, status, margin, unit, time, place)

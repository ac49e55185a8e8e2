"""How much the constraints of a motion are tightened, and how that grows after a failed proof."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.trajectory.fine_motion import BEYOND
from solvers.trajectory.round_set import LEAST_SLACK
from solvers.trajectory.task_limits import NARROW
from solvers.trajectory.task_size import LEAST_MARGIN
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.end_conditions import FINAL_RATES
from solvers.verifier.proofs.endless_conditions import CLOSED, ENTERED
from solvers.verifier.proofs.state_limits import LIMITS
from solvers.verifier.proofs.tube_checks import Status

WIDENINGS = (1.0, 2.5, 7.5, 20.0, 50.0)
"""The factors by which the initial margin is multiplied."""
LEAST_GROWTH = 0.4
"""The tightening for disturbed motions grows by at least this share of itself."""
MOST_SPREADS = 20.0
MOST_SLACK = 100.0
"""The set of a loop exceeds its estimate by at most this share."""
MOST_NARROWING = 0.4
"""Limits are narrowed by at most this share of a range's width at either end."""
WIDEST = 1.0
"""Metres; disturbances are not worth more tightening than this."""


@dataclass(frozen=True, slots=True)
class ConstraintTightening:
    """A uniform margin, and the number of spreads of disturbed motions.

    The margin is ``least`` (m), multiplied by the ``widened``-th factor.  Spreads grow with time,
    and so does the tightening; a tube around all disturbed motions is wider than their spread to
    first order.  ``slack`` is the share by which the set of a loop is larger than its estimate.
    Limits of coordinates and rates are narrowed by at most the share ``narrowing`` of their width.
    """

    least: float = LEAST_MARGIN
    widened: int = 0
    spreads: float = 1.0
    slack: float = LEAST_SLACK
    narrowing: float = NARROW

    @property
    def is_last(self) -> bool:
        """Whether there is no wider margin."""
        return self.widened == len(WIDENINGS) - 1

    @property
    def margin(self) -> float:
        """The margin in metres."""
        return self.least * WIDENINGS[self.widened]

    def wider(
        self,
        lacking: float,
        spread: DisturbanceSpread | None,
        beyond: float = 0.0,
        *,
        limited: bool = False,
    ) -> ConstraintTightening | None:
        """The tightening to try next; None if more is not worth trying.

        Args:
            lacking: the share of ``spread`` that a proof lacked; 0 if it lacked something else.
            spread: the tightening for disturbed motions; None without disturbances.
            beyond: the share by which a round leaves the set of its loop; 0 if it stays inside.
            limited: whether a proof lacked room at a limit of a coordinate or rate.  More spreads
                do not help there once the limit is narrowed as far as it may be.
        """
        if beyond > 0:
            slack = (1 + self.slack) * (1 + max(LEAST_GROWTH, BEYOND * beyond)) - 1
            return replace(self, slack=slack) if slack <= MOST_SLACK else None
        narrowing = min(2 * self.narrowing, MOST_NARROWING) if limited else self.narrowing
        if narrowing > self.narrowing and lacking <= 0:
            return replace(self, narrowing=narrowing)
        if spread is None or (lacking <= 0 and not limited):
            return None if self.is_last else replace(self, widened=self.widened + 1)
        growth = 1 + max(LEAST_GROWTH, BEYOND * lacking)
        if growth * self.spreads > MOST_SPREADS or growth * spread.widest > WIDEST:
            return None
        return replace(self, spreads=growth * self.spreads, narrowing=narrowing)


def no_margin_text(spread: DisturbanceSpread) -> str:
    """The statement that no motion leaves disturbed motions the clearance they need."""
    return (
        "no motion was found that leaves disturbed ones the clearance they need, "
        f"{spread.widest:.2g} m at the widest"
    )


def missing_margin(conditions: Sequence[CheckedCondition], spread: DisturbanceSpread) -> float:
    """The share by which an enclosure of all disturbed motions exceeds the tightening given.

    It is infinite if the enclosure ends early.  Conditions that disturbances do not affect do not
    lack this tightening but a wider margin.
    """
    states = float(np.max(spread.states, initial=0.0))
    inputs = float(np.max(spread.inputs, initial=0.0))
    pulled = float(np.max(spread.accelerations, initial=0.0))
    most = {"m": spread.widest, "N*m": inputs, "N": inputs, "SI": spread.final}
    most |= {"rad/s^2": pulled, "m/s^2": pulled}
    lacking = [0.0]
    for condition in conditions:
        if condition.name in (ENTERED, CLOSED):
            continue
        if condition.status is not Status.HOLDS and condition.margin < 0:
            final = condition.name.startswith(FINAL_RATES)
            width = spread.final if final else most.get(condition.unit, states)
            if width > 0:
                lacking.append(-condition.margin / width)
            elif np.isinf(condition.margin):
                lacking.append(np.inf)
    return max(lacking)


def beyond_loop(conditions: Sequence[CheckedCondition]) -> float:
    """The share by which motions leave the set of their loop; 0 if they stay in it or it is open.

    It is known only if the tube is complete.
    """
    closing = [each for each in conditions if each.name in (ENTERED, CLOSED)]
    return max((-each.margin for each in closing if each.status is not Status.HOLDS), default=0.0)


def missing_at_limits(
    conditions: Sequence[CheckedCondition], joints: Sequence[str]
) -> tuple[tuple[float, float], ...]:
    """By how much the range and the rate of each of the ``joints`` (names) are not proved, in SI.

    Empty if they all are.  What is not known to be finite counts as 0.
    """
    unproved = (each for each in conditions if each.status is not Status.HOLDS)
    lacks = {each.name: -each.margin for each in unproved if np.isfinite(each.margin)}
    found = [[max(0.0, lacks.get(f"{what} {name}", 0.0)) for what in LIMITS] for name in joints]
    return tuple((of_range, of_rate) for of_range, of_rate in found) if np.any(found) else ()


def without_limits(conditions: Sequence[CheckedCondition]) -> list[CheckedCondition]:
    """The conditions other than limits whose lack is known, which are narrowed by themselves."""
    return [
        each
        for each in conditions
        if not (each.name.startswith(LIMITS) and np.isfinite(each.margin))
    ]

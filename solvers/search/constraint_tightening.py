"""What a motion is asked to keep free, and how that grows where a proof did not go through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.trajectory.fine_motion import BEYOND
from solvers.trajectory.round_set import LEAST_SLACK
from solvers.trajectory.task_size import LEAST_MARGIN
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.endless_conditions import CLOSED, ENTERED
from solvers.verifier.proofs.tube_checks import Status

WIDENINGS = (1.0, 2.5, 7.5, 20.0, 50.0)
"""How many times as wide as at first margins get."""
LEAST_GROWTH = 0.4
"""By at least this part of itself grows what is left for disturbed motions."""
MOST_SPREADS = 20.0
MOST_SLACK = 100.0
"""The set of a loop is not larger than estimated by more than this part."""
WIDEST = 1.0
"""Metres; no disturbances are worth more tightening."""


@dataclass(frozen=True, slots=True)
class ConstraintTightening:
    """A margin, the same everywhere, and the number of spreads of disturbed motions.

    The margin is the ``least`` one (m), ``widened`` so many times.  Spreads grow with time, and so
    does the tightening; a tube of all disturbed motions is wider than their spread to first order.
    ``slack`` is the part by which the set of a loop is larger than its estimate.
    """

    least: float = LEAST_MARGIN
    widened: int = 0
    spreads: float = 1.0
    slack: float = LEAST_SLACK

    @property
    def is_last(self) -> bool:
        """Whether no wider margin is left."""
        return self.widened == len(WIDENINGS) - 1

    @property
    def margin(self) -> float:
        """The margin in metres."""
        return self.least * WIDENINGS[self.widened]

    def wider(
        self, lacking: float, spread: DisturbanceSpread | None, beyond: float = 0.0
    ) -> ConstraintTightening | None:
        """The tightening to try next; None: no more is worth it.

        Args:
            lacking: what a proof has lacked of ``spread``, as a part of it; 0: something else.
            spread: the tightening that disturbed motions were given; None without disturbances.
            beyond: by what part of it a round leaves the set of its loop; 0: it does not.
        """
        if beyond > 0:
            slack = (1 + self.slack) * (1 + max(LEAST_GROWTH, BEYOND * beyond)) - 1
            return replace(self, slack=slack) if slack <= MOST_SLACK else None
        if spread is None or lacking <= 0:
            return None if self.is_last else replace(self, widened=self.widened + 1)
        growth = 1 + max(LEAST_GROWTH, BEYOND * lacking)
        if growth * self.spreads > MOST_SPREADS or growth * spread.widest > WIDEST:
            return None
        return replace(self, spreads=growth * self.spreads)


def no_margin_text(spread: DisturbanceSpread) -> str:
    """Why a path ends at which no motion leaves disturbed motions the clearance they need."""
    return (
        "no motion was found that leaves disturbed ones the clearance they need, "
        f"{spread.widest:.2g} m at the widest"
    )


def missing_margin(conditions: Sequence[CheckedCondition], spread: DisturbanceSpread) -> float:
    """By what part an enclosure of all disturbed motions is wider than the tightening given.

    It is infinite where the enclosure ends.  What the disturbances do not move lacks none of this
    tightening, but a wider margin.
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
            width = most.get(condition.unit, states)
            if width > 0:
                lacking.append(-condition.margin / width)
            elif np.isinf(condition.margin):
                lacking.append(np.inf)
    return max(lacking)


def beyond_loop(conditions: Sequence[CheckedCondition]) -> float:
    """By what part of it motions leave the set of their loop; 0 where they do not, or it is open.

    They are only known to do so where the tube is complete.
    """
    closing = [each for each in conditions if each.name in (ENTERED, CLOSED)]
    return max((-each.margin for each in closing if each.status is not Status.HOLDS), default=0.0)

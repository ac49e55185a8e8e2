"""What a motion is asked to keep free, and how that grows where a proof did not go through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.trajectory.path_following import BEYOND, LEAST_MARGIN
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status

MARGINS = (LEAST_MARGIN, 5e-3, 1.5e-2, 4e-2, 0.1)
LEAST_GROWTH = 0.2
"""By at least this part of itself grows what is left for disturbed motions."""
MOST_SPREADS = 20.0
WIDEST = 1.0
"""Metres; no disturbances are worth more tightening."""


@dataclass(frozen=True, slots=True)
class ConstraintTightening:
    """A margin in metres, the same everywhere, and the number of spreads of disturbed motions.

    Those grow with time, and so does the tightening; a tube of all disturbed motions is wider than
    their spread to first order.
    """

    margin: float = MARGINS[0]
    spreads: float = 1.0

    @property
    def is_last(self) -> bool:
        """Whether no wider margin is left."""
        return self.margin >= MARGINS[-1]

    def wider(
        self, lacking: float, spread: DisturbanceSpread | None
    ) -> ConstraintTightening | None:
        """The tightening to try next; None: no more is worth it.

        Args:
            lacking: what a proof has lacked of ``spread``, as a part of it; 0: something else.
            spread: the tightening that disturbed motions were given; None without disturbances.
        """
        if spread is None or lacking <= 0:
            margin = next((item for item in MARGINS if item > self.margin), None)
            return None if margin is None else replace(self, margin=margin)
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


def missing_margin(findings: Sequence[CheckedCondition], spread: DisturbanceSpread) -> float:
    """By what part an enclosure of all disturbed motions is wider than the tightening given.

    It is infinite where the enclosure ends.  What the disturbances do not move lacks none of this
    tightening, but a wider margin.
    """
    most = {"m": spread.widest}
    states = float(np.max(spread.states, initial=0.0))
    lacking = [0.0]
    for finding in findings:
        if finding.status is not Status.HOLDS and finding.margin < 0:
            width = most.get(finding.unit, states)
            if width > 0:
                lacking.append(-finding.margin / width)
            elif np.isinf(finding.margin):
                lacking.append(np.inf)
    return max(lacking)

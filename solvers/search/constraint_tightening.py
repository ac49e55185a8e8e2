"""What a motion is asked to keep free, and how that grows where a proof did not go through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.trajectory.disturbance_spread import DisturbanceSpread
from solvers.trajectory.path_following import BEYOND, LEAST_MARGIN
from solvers.verifier.proofs.checked_condition import Finding
from solvers.verifier.proofs.tube_checks import Status

MARGINS = (LEAST_MARGIN, 5e-3, 1.5e-2, 4e-2, 0.1)
LEAST_GROWTH = 0.2
"""By at least this part of itself grows what is left for disturbed motions."""
MOST_SPREADS = 20.0
WIDEST = 1.0
"""Metres; no disturbances are worth more room."""


@dataclass(frozen=True, slots=True)
class Room:
    """A margin in metres, the same everywhere, and the number of spreads of disturbed motions.

    Those grow with time, and so does the room; a tube of all disturbed motions is wider than their
    spread to first order.
    """

    margin: float = MARGINS[0]
    spreads: float = 1.0

    @property
    def is_last(self) -> bool:
        """Whether no wider margin is left."""
        return self.margin >= MARGINS[-1]

    def wider(self, lacking: float, spread: DisturbanceSpread | None) -> Room | None:
        """The room to try next; None: no more is worth it.

        Args:
            lacking: what a proof has lacked of ``spread``, as a part of it; 0: something else.
            spread: the room that disturbed motions were given; None without disturbances.
        """
        if spread is None or lacking <= 0:
            margin = next((item for item in MARGINS if item > self.margin), None)
            return None if margin is None else replace(self, margin=margin)
        growth = 1 + max(LEAST_GROWTH, BEYOND * lacking)
        if growth * self.spreads > MOST_SPREADS or growth * spread.widest > WIDEST:
            return None
        return replace(self, spreads=growth * self.spreads)


def no_room_text(room: DisturbanceSpread) -> str:
    """Why a path ends at which no motion leaves that room."""
    return (
        "no motion was found that leaves disturbed ones the room they were to have, "
        f"{room.widest:.2g} m at the widest"
    )


def lacking_room(findings: Sequence[Finding], spread: DisturbanceSpread) -> float:
    """By what part of the room given an enclosure of all disturbed motions is wider than that.

    It is infinite where the enclosure ends.  What the disturbances do not move lacks none of this
    room, but a wider margin.
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

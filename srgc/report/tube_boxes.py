"""The certified tube as it is drawn: boxes of the effectors, and how wide it is at instants."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from solvers.verifier.certified_tube import CertifiedTube

Array = NDArray[np.float64]

MOST_BOXES = 240
MOST_INSTANTS = 90


@dataclass(frozen=True, slots=True)
class TubeBoxes:
    """Boxes that hold the effectors.

    Shapes: ``times`` (m + 1,) the ends of m intervals of time; ``boxes`` (m, e, d, 2) what holds
    the effectors throughout each; ``instants`` (i,); ``half_widths`` (i, e, d) half the sides of
    the boxes that hold them then, in metres.  ``segments`` is how many intervals the proof has.
    """

    times: Array
    boxes: Array
    instants: Array
    half_widths: Array
    segments: int
    disturbed: bool


def tube_boxes(tube: CertifiedTube, effectors: int) -> TubeBoxes:
    """The boxes of a tube; intervals are put together where there are many."""
    points = tube.points[:, :effectors]
    count = len(points)
    groups = np.array_split(np.arange(count), min(count, MOST_BOXES))
    boxes = np.stack(
        [
            np.stack([points[group, ..., 0].min(axis=0), points[group, ..., 1].max(axis=0)], -1)
            for group in groups
        ]
    )
    ends = [0, *(int(group[-1]) + 1 for group in groups)]
    picked = np.unique(np.linspace(0, count, MOST_INSTANTS).round().astype(int))
    instants = tube.times[picked]
    widths = np.stack([_half_widths(tube, float(time), effectors) for time in instants])
    return TubeBoxes(tube.times[ends], boxes, instants, widths, count, tube.disturbed)


def _half_widths(tube: CertifiedTube, time: float, effectors: int) -> Array:
    bounds = tube.points_at(time)[:effectors]
    found: Array = (bounds[..., 1] - bounds[..., 0]) / 2
    return found

"""The points of a robot that refutations speak of, as expressions in (q, theta).

They lie in what they are about: effectors, the points about which bodies and shapes are, and all
corners of hulls; then the differences of those of the pairs that are looked at, and the axes of
effectors' frames.  (A hull's middle, by which the other points of a robot know it, is a combination
of its corners; a refutation that counts on them is of more poses.)
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from compiler.dynamics.kinematics import Kinematics
from compiler.dynamics.robot_points import Numbered

MOST_OF_PAIRS = 2
"""Of pairs in which one has more points, no differences are looked at."""


@dataclass(frozen=True, slots=True)
class CornerPoints:
    """All such points, coordinates (d * count,), and the numbers of the axes of each effector.

    These are counted from the first point behind the effectors; there are none where the turn of
    effectors does not matter.
    """

    points: ca.SX
    axes: tuple[tuple[int, ...], ...]


def corner_points(at: Kinematics) -> CornerPoints:
    """These points of a robot in a pose."""
    model = at.model
    effectors, found = Numbered(model.dimension), Numbered(model.dimension)
    effectors.add([at.origins[frame] for frame in model.effectors])
    colliders = model.colliders
    counts = [len(found.add(at.corners(each))) for each in colliders]
    for one, two in model.apart:
        if max(counts[one], counts[two]) <= MOST_OF_PAIRS:
            seen = at.seen_from_below(colliders[one].frame, colliders[two].frame)
            ones, twos = (seen.corners(colliders[i]) for i in (one, two))
            found.add([a - b for a in ones for b in twos])
    axes = tuple(
        found.add([at.axis(frame, axis) for axis in range(model.dimension)])
        for frame in (model.effectors if model.posed else ())
    )
    return CornerPoints(ca.vertcat(effectors.stacked(), found.stacked()), axes)

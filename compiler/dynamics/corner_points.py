"""The points of a robot that refutations use, as expressions in (q, theta).

These are the effectors, the base points of bodies and shapes, and all corners of hulls; then the
differences of these points for the pairs considered, and the axes of effectors' frames. (Elsewhere
a hull is represented by its middle, which is a combination of its corners; a refutation based on
the corners covers more poses.)
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from compiler.dynamics.kinematics import Kinematics
from compiler.dynamics.robot_points import Numbered

MOST_OF_PAIRS = 2
"""If one collider of a pair has more points, the pair's differences are left out."""


@dataclass(frozen=True, slots=True)
class CornerPoints:
    """All such points, coordinates (d * count,), and the numbers of the axes of each effector.

    The numbers are counted from the first point after the effectors. There are no axes if the
    orientation of effectors does not matter.
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

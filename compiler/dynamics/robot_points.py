"""The points of a robot that searches and proofs use, as expressions in (q, theta).

Effectors come first, then the base points of bodies and shapes; then the differences of these
points for every pair that must not touch, and the directions along which shapes extend; finally the
axes of effectors' frames, if their orientation matters. Differences and directions are not places,
but are called points as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from compiler.dynamics.kinematics import Kinematics
from compiler.time_limits.time_limit import check_time

MADE = "equations of motion were made"


@dataclass(frozen=True, slots=True)
class Extent:
    """A collider, by the numbers of its points, counted from the first one after the effectors.

    It is the hull of its ``bases``, enlarged by its sizes or corners along its ``columns``, the
    directions of the axes of its frame.
    """

    bases: tuple[int, ...]
    columns: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Gap:
    """A pair of colliders: the differences of their ``bases``, and the ``columns`` of each.

    The differences from the first base of the first collider come first.
    """

    bases: tuple[int, ...]
    columns: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())


@dataclass(frozen=True, slots=True)
class Numbering:
    """The numbers of the points of each collider, each pair ``apart``, and each effector's frame.

    ``axes`` are the directions of the axes of effectors' frames, empty if these do not matter;
    numbers are counted from the first point after the effectors.
    """

    extents: tuple[Extent, ...]
    gaps: tuple[Gap, ...]
    axes: tuple[tuple[int, ...], ...]


@dataclass(slots=True)
class Numbered:
    """Expressions (3,) one after another, in ``d`` coordinates each."""

    d: int
    points: list[ca.SX] = field(default_factory=list[ca.SX])

    def add(self, points: Sequence[ca.SX]) -> tuple[int, ...]:
        """Add points and return their numbers."""
        first = len(self.points)
        self.points += [point[: self.d] for point in points]
        return tuple(range(first, len(self.points)))

    def stacked(self, first: int = 0, last: int | None = None) -> ca.SX:
        """The points ``first`` to ``last`` - 1, shape (d * count,)."""
        return ca.vertcat(*self.points[first:last]) if self.points[first:last] else ca.SX(0, 1)


@dataclass(frozen=True, slots=True)
class RobotPoints:
    """All points and what they belong to: coordinates (d * count,) in metres, directions unitless.

    ``bodies`` are the bases of the colliders, ``others`` the differences and the directions;
    ``sizes`` are the sizes of the shapes, in metres, one after another.
    """

    effectors: ca.SX
    bodies: ca.SX
    others: ca.SX
    sizes: ca.SX
    numbering: Numbering


def robot_points(at: Kinematics) -> RobotPoints:
    """The points of a robot in a pose."""
    model = at.model
    found, colliders = Numbered(model.dimension), model.colliders
    bases = [found.add(at.bases(each)) for each in colliders]
    count = len(found.points)
    pairs = list[tuple[Kinematics, tuple[int, ...]]]()
    for one, two in model.apart:
        check_time(MADE)
        seen = at.seen_from_below(colliders[one].frame, colliders[two].frame)
        differences = [
            a - b for a in seen.bases(colliders[one]) for b in seen.bases(colliders[two])
        ]
        pairs.append((seen, found.add(differences)))
    extents = tuple(
        Extent(own, found.add(at.columns(each))) for own, each in zip(bases, colliders, strict=True)
    )
    gaps = tuple(
        Gap(own, (found.add(seen.columns(colliders[one])), found.add(seen.columns(colliders[two]))))
        for (one, two), (seen, own) in zip(model.apart, pairs, strict=True)
    )
    axes = tuple(
        found.add([at.axis(frame, axis) for axis in range(model.dimension)])
        for frame in (model.effectors if model.posed else ())
    )
    effectors = Numbered(model.dimension)
    effectors.add([at.origins[frame] for frame in model.effectors])
    sizes = [at.scalars[size] for shape in model.shapes for size in shape.sizes]
    return RobotPoints(
        effectors.stacked(), found.stacked(0, count), found.stacked(count),
        ca.vertcat(*sizes) if sizes else ca.SX(0, 1), Numbering(extents, gaps, axes),
    )  # fmt: skip

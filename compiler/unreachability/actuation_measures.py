"""What is measured of a motion: coordinates, heights of the effector, and what momentum turns.

A measure is a smooth function of the coordinates.  What keeps it from changing much keeps the robot
from its goal.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_momentum import MomentumMeasure
from compiler.unreachability.motion_conditions import Passage, PointIn
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir

GRID = 4096
"""Directions are rounded to multiples of 1 / GRID: any direction is right."""


@dataclass(frozen=True, slots=True)
class CoordinateMeasure:
    """The coordinate of one degree of freedom; a ``circle`` where full turns lead back."""

    dof: int
    unit: str
    circle: bool

    @property
    def name(self) -> str:
        """Whose it is."""
        return f"joint {self.dof + 1}"


@dataclass(frozen=True, slots=True)
class HeightMeasure:
    """The height ``normal . p`` of an effector p (from 0).

    ``start`` and ``goal`` bound it there if the regions do: lower and upper end.
    """

    effector: int
    normal: tuple[Fraction, ...]
    start: tuple[arb, arb] | None
    goal: tuple[arb, arb] | None
    unit: str = "m"
    circle: bool = False

    @property
    def name(self) -> str:
        """Whose it is."""
        return f"effector {self.effector + 1}"

    @property
    def length(self) -> float:
        """Of the normal, for reports."""
        return math.hypot(*map(float, self.normal))


Measure = CoordinateMeasure | HeightMeasure | MomentumMeasure


def coordinate_measures(model: RobotModel) -> list[CoordinateMeasure]:
    """One per degree of freedom."""
    return [
        CoordinateMeasure(
            number,
            "rad" if dof.kind == "revolute" else "m",
            dof.kind == "revolute" and dof.range is None,
        )
        for number, dof in enumerate(model.dofs)
    ]


def height_measures(
    passage: Passage, bounds: Sequence[ir.HalfSpace], dimension: int
) -> list[HeightMeasure]:
    """Heights along the axes, and along the direction that separates start and goal most."""
    start = None
    if isinstance(passage.start, PointIn) and passage.start.point == passage.reaching:
        start = _corners((*passage.start.rows, *bounds))
    goal = _corners((*passage.goal.rows, *bounds))
    axes = [tuple(Fraction(i == j) for j in range(dimension)) for i in range(dimension)]
    directions = dict.fromkeys(axes)
    if start is not None and goal is not None:
        candidates = [*_normals(passage), *_nearest(start, goal)]
        best = max(candidates, key=lambda n: _separation(n, start, goal), default=None)
        if best is not None:
            directions[best] = None
    return [
        HeightMeasure(passage.reaching, n, _extent(n, start), _extent(n, goal)) for n in directions
    ]


Corners = Sequence[tuple[Fraction, ...]]


def _corners(rows: Sequence[ir.HalfSpace]) -> Corners | None:
    """The vertices of a bounded set with points."""
    polytope = Polytope(tuple(rows))
    return polytope.vertices if polytope.is_bounded and not polytope.is_empty else None


def _extent(normal: Sequence[Fraction], corners: Corners | None) -> tuple[arb, arb] | None:
    if corners is None:
        return None
    heights = [_dot(normal, corner) for corner in corners]
    return ball(min(heights)).lower(), ball(max(heights)).upper()


def _normals(passage: Passage) -> Iterator[tuple[Fraction, ...]]:
    """Of the faces of both regions."""
    starting = passage.start.rows if isinstance(passage.start, PointIn) else ()
    for row in (*starting, *passage.goal.rows):
        if any(row.normal):
            yield _rounded([float(x) for x in row.normal])


def _nearest(start: Corners, goal: Corners) -> Iterator[tuple[Fraction, ...]]:
    """From a corner to the nearest of the other set."""
    pairs = [(_difference(a, b), a, b) for a in start for b in goal]
    difference, _, _ = min(pairs, key=lambda pair: (math.hypot(*pair[0]), pair[1:]))
    if any(difference):
        yield _rounded(difference)


def _difference(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[float]:
    return [float(y - x) for x, y in zip(a, b, strict=True)]


def _rounded(direction: Sequence[float]) -> tuple[Fraction, ...]:
    length = math.hypot(*direction)
    return tuple(Fraction(round(x / length * GRID), GRID) for x in direction)


def _separation(normal: Sequence[Fraction], start: Corners, goal: Corners) -> float:
    """The distance that a direction shows, in floating point."""
    one = [float(_dot(normal, corner)) for corner in start]
    other = [float(_dot(normal, corner)) for corner in goal]
    gap = max(min(other) - max(one), min(one) - max(other))
    return gap / math.hypot(*map(float, normal))


def _dot(normal: Sequence[Fraction], point: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(normal, point, strict=True)), Fraction(0))

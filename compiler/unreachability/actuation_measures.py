"""Measures of a motion that drives change at a bounded rate, including momenta."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from flint import arb

from compiler.dynamics.energy_graph import EnergyGraph
from compiler.expressions.evaluators.balls import ball
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import joint_names
from compiler.unreachability.motion_conditions import Passage, PointIn
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir

# --- The momentum of a coordinate that the mass matrix does not depend on -------------------------
#
# Let M be independent of the coordinate c of a robot with two degrees of freedom; s is the other
# one. Then dT/dq_c = 0, and Lagrange's equation of c, without friction, is
#
# .. math:: \dot p = u_c - g_c, \qquad p = M_{cc}(q_s)\, \dot q_c + M_{cs}(q_s)\, \dot q_s,
#
# so the size of p grows by at most |u_c| + |g_c| per second. With F' = M_cs / M_cc,
#
# .. math:: \xi = q_c + F(q_s), \qquad \dot\xi = p / M_{cc}.
#
# Only the drive of c moves xi, whatever the other one does: for an arm, xi is its rotation without
# the part that comes from folding and unfolding. F is a function only if s has a range: on a full
# turn, folding all the way round may turn the arm.
#
# A coordinate that M does not couple to any other one, of any number, has F = 0. Friction at c then
# only brakes xi.
#
# Source: Goldstein, *Classical Mechanics*, section 2.6 (cyclic coordinates).


CELLS = 128
"""The number of parts of the range of s on which F' is enclosed."""


@dataclass(frozen=True, slots=True)
class MomentumMeasure:
    """The measure xi; ``edges`` of the cells of q_s (exact), F at each edge, and F' on each cell.

    ``name`` is that of the joint c.  It is a ``circle`` if full turns of c lead back. ``shape`` is
    None if xi is q_c.
    """

    name: str
    cyclic: int
    shape: int | None
    unit: str
    circle: bool
    edges: tuple[arb, ...]
    values: tuple[arb, ...]
    slopes: tuple[arb, ...]

    def over(self, box: Sequence[Ends]) -> Ends:
        """The values of xi on a box."""
        if self.shape is None:
            return box[self.cyclic]
        side, found = box[self.shape], None
        for first, last, value, slope in zip(
            self.edges, self.edges[1:], self.values, self.slopes, strict=False
        ):
            if side.high < first or side.low > last:
                continue
            beyond = side.low.max(first).union(side.high.min(last)) - first
            part = value + slope * beyond
            found = part if found is None else found.union(part)
        if found is None:
            return Ends(arb("nan"), arb("nan"))
        own = box[self.cyclic]
        return Ends((own.low + found).lower(), (own.high + found).upper())


@dataclass(frozen=True, slots=True)
class Momentum:
    """Bounds on a box: M_cc at least, |p| at rates up to one at most, and the ends of g_c."""

    inertia: arb
    unit: arb
    pull: Ends

    @property
    def most_pull(self) -> arb:
        """An upper bound of |g_c|."""
        return abs(self.pull.ball()).upper()


def momentum_of(
    cyclic: int, size: int, mass: Sequence[Ends], pull: Sequence[Ends]
) -> Momentum | None:
    """The momentum bounds that M and g give on a box; None if M_cc is not proven positive."""
    row = [mass[j * size + cyclic] for j in range(size)]
    weight = Ends(arb(0), arb(0)) if not pull else pull[cyclic]
    if not (row[cyclic].low > 0 and all(item.finite for item in (*row, weight))):
        return None
    unit = sum((abs(item.ball()).upper() for item in row), arb(0)).upper()
    return Momentum(row[cyclic].low, unit, weight)


def momentum_measures(
    model: RobotModel, graph: EnergyGraph, tail: Sequence[Ends], sides: Sequence[arb]
) -> list[MomentumMeasure]:
    """The measures xi of a robot, one for each coordinate that has one.

    Args:
        model: the robot.
        graph: its graph.
        tail: the parameters and the constants of the graph.
        sides: balls around all coordinates that a motion may take.
    """
    size = len(model.dofs)
    box = [*map(around, sides), *tail]
    mass = graph.mass.evaluate(box, INTERVALS)
    found: list[MomentumMeasure] = []
    for cyclic in (dof for dof in range(size) if dof not in graph.shape):
        others = [mass[j * size + cyclic] for j in range(size) if j != cyclic]
        if all(item.low.is_zero() and item.high.is_zero() for item in others):
            found.append(_measure(model, cyclic, None))
        elif size == 2:
            one = _coupled(model, graph, tail, sides, cyclic)
            found += [] if one is None else [one]
    return found


def _measure(
    model: RobotModel,
    cyclic: int,
    shape: int | None,
    cells: tuple[Sequence[arb], Sequence[arb], Sequence[arb]] = ((), (), ()),
) -> MomentumMeasure:
    """The measure of a coordinate, with the edges, values and slopes of F."""
    dof = model.dofs[cyclic]
    revolute = dof.kind == "revolute"
    unit = "rad" if revolute else "m"
    edges, values, slopes = (tuple(item) for item in cells)
    circle = revolute and dof.range is None
    name = joint_names(model)[cyclic]
    return MomentumMeasure(name, cyclic, shape, unit, circle, edges, values, slopes)


def _coupled(
    model: RobotModel,
    graph: EnergyGraph,
    tail: Sequence[Ends],
    sides: Sequence[arb],
    cyclic: int,
) -> MomentumMeasure | None:
    """The measure of one of two coordinates, if there is one."""
    shape = 1 - cyclic
    if model.dofs[shape].range is None and model.dofs[shape].kind == "revolute":
        return None
    low, high = sides[shape].lower(), sides[shape].upper()
    edges = [low, *((low + (high - low) * i / CELLS).mid() for i in range(1, CELLS)), high]
    values, slopes = [arb(0)], list[arb]()
    for first, last in pairwise(edges):
        box = [Ends(arb(0), arb(0))] * 2
        box[shape] = Ends(first, last)
        mass = graph.mass.evaluate([*box, *tail], INTERVALS)
        own, other = mass[cyclic * 2 + cyclic], mass[shape * 2 + cyclic]
        if not (own.low > 0 and own.finite and other.finite):
            return None
        ends = [a / b for a in (other.low, other.high) for b in (own.low, own.high)]
        slope = ends[0].union(ends[1]).union(ends[2]).union(ends[3])
        slopes.append(slope)
        values.append(values[-1] + slope * (last - first))
    return _measure(model, cyclic, shape, (edges, values, slopes))


# --------------------------------------------------------------------------------------------------
# The measures of a motion: coordinates, heights of the effector, and angles driven by momentum.
#
# A measure is a smooth function of the coordinates. A bound on its change is a bound on how near
# the robot can get to its goal.


GRID = 4096
"""Directions are rounded to multiples of 1 / GRID: any direction is valid."""


@dataclass(frozen=True, slots=True)
class CoordinateMeasure:
    """The coordinate of a degree of freedom with a name; a ``circle`` if full turns lead back."""

    name: str
    dof: int
    unit: str
    circle: bool


@dataclass(frozen=True, slots=True)
class HeightMeasure:
    """The height ``normal . p`` of an effector p (from 0).

    ``start`` and ``goal`` are its lower and upper end there, if the regions bound it.
    """

    effector: int
    normal: tuple[Fraction, ...]
    start: tuple[arb, arb] | None
    goal: tuple[arb, arb] | None
    unit: str = "m"
    circle: bool = False

    @property
    def name(self) -> str:
        """The effector it belongs to."""
        return f"effector {self.effector + 1}"

    @property
    def length(self) -> float:
        """The length of the normal, for reports."""
        return math.hypot(*map(float, self.normal))


Measure = CoordinateMeasure | HeightMeasure | MomentumMeasure


def coordinate_measures(model: RobotModel) -> list[CoordinateMeasure]:
    """The coordinates of all degrees of freedom as measures."""
    return [
        CoordinateMeasure(
            name,
            number,
            "rad" if dof.kind == "revolute" else "m",
            dof.kind == "revolute" and dof.range is None,
        )
        for number, (dof, name) in enumerate(zip(model.dofs, joint_names(model), strict=True))
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
    """The vertices of a non-empty bounded set; None for other sets."""
    polytope = Polytope(tuple(rows))
    return polytope.vertices if polytope.is_bounded and not polytope.is_empty else None


def _extent(normal: Sequence[Fraction], corners: Corners | None) -> tuple[arb, arb] | None:
    if corners is None:
        return None
    heights = [_dot(normal, corner) for corner in corners]
    return ball(min(heights)).lower(), ball(max(heights)).upper()


def _normals(passage: Passage) -> Iterator[tuple[Fraction, ...]]:
    """The normals of the faces of both regions."""
    starting = passage.start.rows if isinstance(passage.start, PointIn) else ()
    for row in (*starting, *passage.goal.rows):
        if any(row.normal):
            yield _rounded([float(x) for x in row.normal])


def _nearest(start: Corners, goal: Corners) -> Iterator[tuple[Fraction, ...]]:
    """The direction between the nearest corners of two sets."""
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
    """The distance between two sets along a direction, in floating point."""
    one = [float(_dot(normal, corner)) for corner in start]
    other = [float(_dot(normal, corner)) for corner in goal]
    gap = max(min(other) - max(one), min(one) - max(other))
    return gap / math.hypot(*map(float, normal))


def _dot(normal: Sequence[Fraction], point: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(normal, point, strict=True)), Fraction(0))

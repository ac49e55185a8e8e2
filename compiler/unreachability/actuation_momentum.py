r"""The momentum of a coordinate that the mass matrix does not depend on.

Let M be independent of the coordinate c of a robot with two degrees of freedom; s is the other one.
Then dT/dq_c = 0, and Lagrange's equation of c, without friction, is

.. math:: \dot p = u_c - g_c, \qquad p = M_{cc}(q_s)\, \dot q_c + M_{cs}(q_s)\, \dot q_s,

so that the size of p grows by at most |u_c| + |g_c| per second.  With F' = M_cs / M_cc,

.. math:: \xi = q_c + F(q_s), \qquad \dot\xi = p / M_{cc}.

Only the drive of c moves xi, whatever the other one does: of an arm, how far it has turned but for
the turning that comes from folding and unfolding.  F is a function where s has a range: on a full
turn it may be that folding all the way round turns the arm.

A coordinate that M does not couple to any other one, of however many, has F = 0.  Friction at c
then only brakes xi.

Source: Goldstein, *Classical Mechanics*, section 2.6 (cyclic coordinates).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import arb

from compiler.dynamics.energy_graph import EnergyGraph
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.robots.robot import RobotModel

CELLS = 128
"""Parts of the range of s on which F' is enclosed."""


@dataclass(frozen=True, slots=True)
class MomentumMeasure:
    """xi; ``edges`` of the cells of q_s (exact), F at each edge, and F' on each cell.

    A ``circle`` where full turns of c lead back.  ``shape`` is None where xi is q_c.
    """

    cyclic: int
    shape: int | None
    unit: str
    circle: bool
    edges: tuple[arb, ...]
    values: tuple[arb, ...]
    slopes: tuple[arb, ...]

    @property
    def name(self) -> str:
        """Whose it is."""
        return f"joint {self.cyclic + 1}"

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
    """On a box: M_cc at least, |p| at rates up to one at most, and the ends of g_c."""

    inertia: arb
    unit: arb
    pull: Ends

    @property
    def most_pull(self) -> arb:
        """|g_c| at most."""
        return abs(self.pull.ball()).upper()


def momentum_of(
    cyclic: int, size: int, mass: Sequence[Ends], pull: Sequence[Ends]
) -> Momentum | None:
    """What M and g say of a box; None where M_cc is not shown to be positive."""
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
    return MomentumMeasure(cyclic, shape, unit, circle, edges, values, slopes)


def _coupled(
    model: RobotModel,
    graph: EnergyGraph,
    tail: Sequence[Ends],
    sides: Sequence[arb],
    cyclic: int,
) -> MomentumMeasure | None:
    """The measure of one of two coordinates, where there is one."""
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

r"""The poses in which drives can keep a robot nearly still for a while, against gravity.

At a start that has to be held, no weight exceeds what its input and dry friction can balance.

The last d seconds of a motion have rates of at most r. For the momentum P_i of a joint, row i of
M q',

.. math:: \dot P_i = u_i - g_i - b_i \dot q_i - f_i
    + \tfrac12 \dot q^\top (\partial_i M)\, \dot q, \qquad |P_i| \le r \sum_j |M_{ij}|

with friction f_i of at most c_i. So if the weight g_i exceeds the input's bound U_i by more than
all of the rest can make up for,

.. math:: d \left(g_i - U_i - |b_i| r - c_i - \tfrac12 r^2 \sum_{jk} |\partial_i M_{jk}|\right)
    > 2 r \sum_j |M_{ij}|

in all poses within r d of a box, no motion ends in this box; the same for -g_i. All that time the
effector is in the target, so g_i is also bounded by where the effector may be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb

from compiler.dynamics.energy_graph import EnergyGraph
from compiler.dynamics.weight_graph import WeightGraph, weight_graph
from compiler.expressions.evaluators.balls import ball, constant_ball
from compiler.expressions.evaluators.intervals import INFINITY, INTERVALS, Ends, around, between
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_bounds import LeafBox
from compiler.workspaces.polytope import Polytope, refuting_polytope
from grammar_lang import ir

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Hold:
    """That drives hold a robot still with its effector in a box (d,): at its start, or at its goal.

    It is for ``duration`` (s), with rates of at most ``rate`` (SI).
    """

    box: tuple[Ends, ...]
    at_start: bool
    rate: arb
    duration: arb


def holds_asked(model: RobotModel, workspace: ir.Workspace, task: ir.Task) -> tuple[Hold, ...]:
    """Where a task asks a robot to hold still against gravity: nowhere, or at start or goal."""
    found = list[Hold]()
    if not any(task.gravity):
        return ()
    if isinstance(task.start, ir.StartIn) and task.start.held:
        # An instant without any rate: the weight alone has to be within the bounds.
        box = _box(model, workspace, task.start.region)
        found.append(Hold(box, at_start=True, rate=ZERO, duration=arb(1)))
    if task.reach is not None and task.final_rates is not None and task.stay:
        rest, box = task.final_rates, _box(model, workspace, task.reach.region)
        found.append(Hold(box, at_start=False, rate=ball(rest.most), duration=ball(task.stay)))
    return tuple(hold for hold in found if hold.box)


def _box(model: RobotModel, workspace: ir.Workspace, region: str) -> tuple[Ends, ...]:
    """A box (d,) around the part of a region within the bounds; () if there is none."""
    shapes = (workspace.region(region).shape, workspace.bounds.shape)
    rows = [row for shape in shapes for row in refuting_polytope(shape, model.dimension).rows]
    corners = Polytope(tuple(rows)).vertices
    return tuple(between(min(side), max(side)) for side in zip(*corners, strict=True))


@dataclass(frozen=True, slots=True)
class Weight:
    """The weight of a robot by the position of one effector, and its constants, enclosed."""

    graph: WeightGraph
    constants: tuple[Ends, ...]


def weights(model: RobotModel, gravity: tuple[Fraction, ...]) -> tuple[Weight, ...]:
    """The weight by the position of each effector, under gravity in m/s^2 (d,).

    Raises:
        ValueError: the rules of the robot have no exact value.
    """
    graphs = [weight_graph(model, gravity, number) for number in range(len(model.effectors))]
    return tuple(
        Weight(graph, tuple(around(constant_ball(item)) for item in graph.constants))
        for graph in graphs
    )


@dataclass(frozen=True, slots=True)
class Holding:
    """The bounds of the forces on the joints of a robot, for parameters of a box.

    ``tail`` holds the sides of so many ``parameters``, then the constants of the graph. ``inputs``,
    ``damping`` and ``friction`` (n,) bound the input of each joint, its b and its dry friction.
    """

    graph: EnergyGraph
    tail: Sequence[Ends]
    parameters: int
    inputs: Sequence[arb]
    damping: Sequence[arb]
    friction: Sequence[arb]


@dataclass(frozen=True, slots=True)
class TooHeavy:
    """A joint, from 0, needs more than its drive has (N m or N) to be held still."""

    joint: int
    needed: arb
    available: arb


def held_boxes(
    holding: Holding, hold: Hold, effector: int, weight: Weight, leaves: Sequence[LeafBox]
) -> tuple[list[LeafBox], list[TooHeavy]]:
    """The boxes, without those starts or goals where the drives cannot hold still, and why not.

    Args:
        holding: the forces.
        hold: how long the ``effector`` (from 0) is held, and where.
        effector: the one that starts or arrives.
        weight: the weight by its position.
        leaves: boxes of coordinates.
    """
    kept, reasons = list[LeafBox](), list[TooHeavy]()
    moved = hold.rate * hold.duration * arb(0, 1)
    for leaf in leaves:
        possible = leaf.start_possible if hold.at_start else leaf.goal_possible
        if possible:
            sides = [around(side + moved) for side in leaf.coordinates]
            place = _within(holding, hold, effector, sides)
            found = [] if place is None else _too_heavy(holding, hold, weight, sides, place)
            possible = place is not None and not found
            reasons += sorted(found, key=lambda each: float(each.available / each.needed))[:1]
        if hold.at_start:
            kept.append(replace(leaf, start_possible=possible))
        else:
            kept.append(replace(leaf, goal_possible=possible))
    return kept, reasons


def _within(
    holding: Holding, hold: Hold, effector: int, sides: Sequence[Ends]
) -> list[Ends] | None:
    """A box (d,) around where an effector may be held; None if it is not there in any pose."""
    places, d = holding.graph.effectors.evaluate([*sides, *holding.tail], INTERVALS), len(hold.box)
    both = [
        Ends(one.low.max(other.low), one.high.min(other.high))
        for one, other in zip(places[d * effector : d * (effector + 1)], hold.box, strict=True)
    ]
    return None if any(side.low > side.high for side in both) else both


def _too_heavy(
    holding: Holding, hold: Hold, weight: Weight, sides: Sequence[Ends], place: Sequence[Ends]
) -> list[TooHeavy]:
    """The joints that cannot be kept still in any pose of a box with the effector in a place."""
    graph = holding.graph
    if graph.potential is None:
        return []
    inputs = [*sides, *holding.tail]
    _, *pull = graph.potential.evaluate(inputs, INTERVALS)
    tail = [*holding.tail[: holding.parameters], *weight.constants, *place]
    by_place = weight.graph.pull.evaluate([*sides, *tail], INTERVALS)
    found = list[TooHeavy]()
    for joint, bounds in enumerate(zip(pull, by_place, strict=True)):
        least, most = max(map(_least_size, bounds)), holding.inputs[joint]
        if least > most and _exceeds(holding, hold, inputs, joint, least - most):
            found.append(TooHeavy(joint, least, most))
    return found


def _least_size(value: Ends) -> arb:
    """A lower bound of the size of a value; negative if it may be zero, or is not known."""
    return value.low.max(-value.high) if value.finite else -INFINITY


def _exceeds(holding: Holding, hold: Hold, inputs: list[Ends], joint: int, excess: arb) -> bool:
    """Whether a weight beyond the input's bound moves the joint too much, whatever else acts."""
    graph, run, count = holding.graph, INTERVALS, len(holding.inputs)
    row = graph.mass.evaluate(inputs, run)[joint * count : (joint + 1) * count]
    turning = ZERO
    if joint in graph.active:
        slopes, size = graph.slopes.evaluate(inputs, run), count * count
        first = graph.active.index(joint) * size
        turning = _sum(slopes[first : first + size])
    other = holding.damping[joint] * hold.rate + holding.friction[joint]
    other += hold.rate * hold.rate * turning / 2
    return bool(hold.duration * (excess - other) > 2 * hold.rate * _sum(row))


def _sum(values: Sequence[Ends]) -> arb:
    """An upper bound of the sum of the sizes of values; infinite or nan if one is unbounded."""
    total = ZERO
    for value in values:
        total += abs(value.low).max(abs(value.high))
    return total.upper()

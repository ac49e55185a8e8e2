r"""The goal poses in which drives can keep a robot nearly still for a while, against gravity.

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

from flint import arb

from compiler.dynamics.energy_graph import EnergyGraph
from compiler.dynamics.weight_graph import WeightGraph, weight_graph
from compiler.expressions.evaluators.balls import constant_ball
from compiler.expressions.evaluators.intervals import INFINITY, INTERVALS, Ends, around, between
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_bounds import LeafBox
from compiler.workspaces.polytope import Polytope, refuting_polytope
from grammar_lang import ir

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Rest:
    """The end of a motion: its last ``duration`` (s) with rates of at most ``rate`` (SI)."""

    rate: arb
    duration: arb


@dataclass(frozen=True, slots=True)
class Target:
    """Where an effector (from 0) is at rest, and the weight by its position there.

    ``box`` (d,) holds the target; ``constants`` are those of the weight.
    """

    effector: int
    box: tuple[Ends, ...]
    weight: WeightGraph
    constants: tuple[Ends, ...]


def targets(model: RobotModel, workspace: ir.Workspace, task: ir.Task) -> tuple[Target, ...]:
    """The target for each effector, if the task asks a robot to hold still there against gravity.

    Raises:
        ValueError: the rules of the robot have no exact value.
    """
    if task.reach is None or not task.stay or not any(task.gravity):
        return ()
    shapes = (workspace.region(task.reach.region).shape, workspace.bounds.shape)
    rows = [row for shape in shapes for row in refuting_polytope(shape, model.dimension).rows]
    corners = Polytope(tuple(rows)).vertices
    box = tuple(between(min(side), max(side)) for side in zip(*corners, strict=True))
    found = list[Target]()
    for effector in range(len(model.effectors)):
        weight = weight_graph(model, task.gravity, effector)
        constants = tuple(around(constant_ball(item)) for item in weight.constants)
        found.append(Target(effector, box, weight, constants))
    return tuple(found) if box else ()


@dataclass(frozen=True, slots=True)
class Holding:
    """The bounds of the forces on the joints of a robot, for parameters of a box.

    ``tail`` holds the sides of so many ``parameters``, then the constants of the graph. ``inputs``,
    ``damping`` and ``friction`` (n,) bound the input of each joint, its b and its dry friction.
    """

    graph: EnergyGraph
    tail: Sequence[Ends]
    parameters: int
    target: Target
    inputs: Sequence[arb]
    damping: Sequence[arb]
    friction: Sequence[arb]


@dataclass(frozen=True, slots=True)
class TooHeavy:
    """A joint, from 0, needs more than its drive has (N m or N) to be held still."""

    joint: int
    needed: arb
    available: arb


def held_goals(
    holding: Holding, rest: Rest, leaves: Sequence[LeafBox]
) -> tuple[list[LeafBox], list[TooHeavy]]:
    """The boxes, without those goals at which the drives cannot keep still, and why not."""
    kept, reasons = list[LeafBox](), list[TooHeavy]()
    for leaf in leaves:
        possible = leaf.goal_possible
        if possible:
            moved = rest.rate * rest.duration * arb(0, 1)
            sides = [around(side + moved) for side in leaf.coordinates]
            place = _in_target(holding, sides)
            found = [] if place is None else _too_heavy(holding, rest, sides, place)
            possible = place is not None and not found
            reasons += sorted(found, key=lambda each: float(each.available / each.needed))[:1]
        kept.append(replace(leaf, goal_possible=possible))
    return kept, reasons


def _in_target(holding: Holding, sides: Sequence[Ends]) -> list[Ends] | None:
    """A box (d,) around where the effector may be in the target; None if it is nowhere in it."""
    target, d = holding.target, len(holding.target.box)
    places = holding.graph.effectors.evaluate([*sides, *holding.tail], INTERVALS)
    near = places[d * target.effector : d * (target.effector + 1)]
    both = [
        Ends(one.low.max(other.low), one.high.min(other.high))
        for one, other in zip(near, target.box, strict=True)
    ]
    return None if any(side.low > side.high for side in both) else both


def _too_heavy(
    holding: Holding, rest: Rest, sides: Sequence[Ends], place: Sequence[Ends]
) -> list[TooHeavy]:
    """The joints that cannot be kept still in any pose of a box with the effector in a place."""
    graph, target = holding.graph, holding.target
    if graph.potential is None:
        return []
    inputs = [*sides, *holding.tail]
    _, *pull = graph.potential.evaluate(inputs, INTERVALS)
    tail = [*holding.tail[: holding.parameters], *target.constants, *place]
    by_place = target.weight.pull.evaluate([*sides, *tail], INTERVALS)
    found = list[TooHeavy]()
    for joint, weights in enumerate(zip(pull, by_place, strict=True)):
        least, most = max(map(_least_size, weights)), holding.inputs[joint]
        if least > most and _exceeds(holding, rest, inputs, joint, least - most):
            found.append(TooHeavy(joint, least, most))
    return found


def _least_size(value: Ends) -> arb:
    """A lower bound of the size of a value; negative if it may be zero, or is not known."""
    return value.low.max(-value.high) if value.finite else -INFINITY


def _exceeds(holding: Holding, rest: Rest, inputs: list[Ends], joint: int, excess: arb) -> bool:
    """Whether a weight beyond the input's bound moves the joint too much, whatever else acts."""
    graph, run, count = holding.graph, INTERVALS, len(holding.inputs)
    row = graph.mass.evaluate(inputs, run)[joint * count : (joint + 1) * count]
    turning = ZERO
    if joint in graph.active:
        slopes, size = graph.slopes.evaluate(inputs, run), count * count
        first = graph.active.index(joint) * size
        turning = _sum(slopes[first : first + size])
    other = holding.damping[joint] * rest.rate + holding.friction[joint]
    other += rest.rate * rest.rate * turning / 2
    return bool(rest.duration * (excess - other) > 2 * rest.rate * _sum(row))


def _sum(values: Sequence[Ends]) -> arb:
    """An upper bound of the sum of the sizes of values; infinite or nan if one is unbounded."""
    total = ZERO
    for value in values:
        total += abs(value.low).max(abs(value.high))
    return total.upper()

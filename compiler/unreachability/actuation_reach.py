"""The proof that a robot's drives cannot reach a goal, for a box of its parameters.

It covers every motion that keeps the effort bounds, the limits of rates and accelerations of the
joints and the horizon, or the earlier deadline of a visit. docs/explanation/out-of-reach.md has the
bounds and their proofs. All computations are in balls and intervals; floats only choose directions
and preconditioners.

Forces are not bounded for a robot whose modules have states or inputs of their own, or a torque
other than ``u - b * rate(q)`` with b >= 0; its rate limits still count. Dry friction dissipates
energy, as this damping does; arguments about momentum, and backwards in time, are then left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

from flint import arb

from compiler.dynamics.energy_graph import EnergyGraph, energy_graph
from compiler.expressions.evaluators.balls import ball, closed_ball, constant_ball
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.robots.robot import RobotDof, RobotModel
from compiler.robots.state_and_input import (
    dry_friction,
    input_bounds,
    joint_names,
    robot_inputs,
    unbounded_kinds,
)
from compiler.unreachability.actuation_bounds import BoxEvaluator, LeafBox
from compiler.unreachability.actuation_levels import Budget, least, needed
from compiler.unreachability.actuation_measures import (
    HeightMeasure,
    Measure,
    MomentumMeasure,
    coordinate_measures,
    height_measures,
    momentum_measures,
)
from compiler.unreachability.actuation_metric import EffortGroup, most_power
from compiler.unreachability.actuation_region import Limits, Region
from compiler.unreachability.actuation_rest import (
    Hold,
    Holding,
    TooHeavy,
    Weight,
    held_boxes,
    holds_asked,
    weights,
)
from compiler.unreachability.covered_poses import NEAR
from compiler.unreachability.motion_conditions import GivenPose, Passage
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir

ROUNDS = 12
"""The most rounds in which the set of boxes is reduced."""


@dataclass(frozen=True, slots=True)
class DriveBound:
    """Why no motion reaches the goal: it needs more of something (``unit``) than is available.

    ``reason`` follows "out of reach of the drives: ". ``needed`` and ``available`` are None if only
    several reasons together exclude all boxes.
    """

    reason: str
    needed: float | None = None
    available: float | None = None
    unit: str = ""


@dataclass(frozen=True, slots=True)
class DriveReach:
    """One robot in a task, for ``out_of_reach``.

    ``weights`` are those by the position of each effector, empty if the robot need not hold still.
    """

    model: RobotModel
    workspace: ir.Workspace
    task: ir.Task
    graph: EnergyGraph
    groups: tuple[EffortGroup, ...] | None
    holds: tuple[Hold, ...]
    weights: tuple[Weight, ...]

    def carried(self, tail: Sequence[Ends]) -> list[arb]:
        """Lower bounds of the masses (kg) that move with the effectors, 0 if none is known.

        ``tail`` holds the sides of the parameters, then the constants of the graph.
        """
        nowhere = [Ends(arb(0), arb(0))] * len(self.model.dofs)
        found = self.graph.carried.evaluate([*nowhere, *tail], INTERVALS)
        count, last = len(self.model.effectors), len(found) - self.graph.minors
        sound = all(each.finite and each.low >= 0 for each in found[count:last])
        if not (sound and all(each.finite and each.low > 0 for each in found[last:])):
            return [arb(0)] * count
        return [each.low.max(arb(0)).lower() if each.finite else arb(0) for each in found[:count]]


def drive_reach(model: RobotModel, workspace: ir.Workspace, task: ir.Task) -> DriveReach:
    """The data of a robot and a task that the proof needs, both without maps.

    Raises:
        ValueError: the rules of the robot have no exact value.
    """
    graph = energy_graph(model, task.gravity)
    # For robots that pick up and put down loads, no energy is known.
    known = graph.damping is not None and not unbounded_kinds(model, task) and not task.carries
    groups = _groups(model, task) if known else None
    still = holds_asked(model, workspace, task) if known else ()
    by_place = weights(model, task.gravity) if still else ()
    return DriveReach(model, workspace, task, graph, groups, still, by_place)


def out_of_reach(
    drive: DriveReach, passage: Passage, parameters: Sequence[Ends], leaves: Sequence[LeafBox]
) -> DriveBound | None:
    """Why no motion makes a passage, for all parameters of a box; None if nothing is proven.

    Args:
        drive: the robot in its task.
        passage: the start and the goal, for one choice of effectors.
        parameters: the sides of the box of parameters.
        leaves: boxes of the joints' own coordinates, in SI units, that contain every pose that a
            motion may take before its goal; full turns are [-pi, pi]. Every start pose (a given
            pose, or one within ``NEAR`` of it) is in a box with ``start_possible``, every goal pose
            in one with ``goal_possible``.
    """
    known = all(side.is_finite() for leaf in leaves for side in leaf.coordinates)
    if not (known and drive.model.dofs):
        return None
    tail = [*parameters, *(around(constant_ball(item)) for item in drive.graph.constants)]
    leaves, not_still = _still(drive, passage, tail, leaves)
    if not_still is not None:
        return not_still
    region = _region(drive, passage, tail, leaves)
    for _ in range(ROUNDS):
        if region.empty:
            return DriveBound(f"no pose of it is reached in {float(passage.by):.6g} s")
        budget = region.budget()
        found = _energy(region, budget) or _change(drive, passage, region, budget)
        if found is not None:
            return found
        if not region.shrink(budget):
            return None
    return None


def _still(
    drive: DriveReach, passage: Passage, tail: Sequence[Ends], leaves: Sequence[LeafBox]
) -> tuple[Sequence[LeafBox], DriveBound | None]:
    """The boxes, without starts and goals at which the drives cannot hold still as the task asks.

    With the reason if no start or no goal is left.
    """
    if drive.groups is None or not drive.holds:
        return leaves, None
    model = drive.model
    bounds = {joint: group.bound for group in drive.groups for joint in group.joints}
    dry = {joint: closed_ball(most) for joint, most in dry_friction(model).items()}
    holding = Holding(
        drive.graph,
        tail,
        len(model.parameters),
        [bounds.get(joint, arb("inf")) for joint in range(len(model.dofs))],
        [abs(side.low).max(abs(side.high)) for side in _damping(drive, tail)],
        [dry.get(joint, arb(0)) for joint in range(len(model.dofs))],
    )
    for hold in drive.holds:
        if not (hold.at_start or passage.arrives):
            continue
        effector = passage.starting if hold.at_start else passage.reaching
        leaves, too_heavy = held_boxes(holding, hold, effector, drive.weights[effector], leaves)
        left = any(leaf.start_possible if hold.at_start else leaf.goal_possible for leaf in leaves)
        if too_heavy and not left:
            return leaves, _not_still(drive, hold, too_heavy)
    return leaves, None


def _not_still(drive: DriveReach, hold: Hold, found: Sequence[TooHeavy]) -> DriveBound:
    """The reason if no pose is left at which the drives keep still."""
    where = "start" if hold.at_start else "target"
    joints = {each.joint for each in found}
    if len(joints) != 1:
        return DriveBound(f"they do not hold it still at any pose at the {where}")
    (joint,) = joints
    needs, has = _apart(float(least([each.needed for each in found])), float(found[0].available))
    unit = "N*m" if drive.model.dofs[joint].kind == "revolute" else "N"
    name, still = joint_names(drive.model)[joint], "to hold still"
    still += " at the start" if hold.at_start else ""
    reason = f"{name} needs {needs} {unit} at least {still}, and has {has} {unit}"
    return DriveBound(reason, float(needs), float(has), unit)


def _region(
    drive: DriveReach, passage: Passage, tail: list[Ends], leaves: Sequence[LeafBox]
) -> Region:
    """All boxes, with the bounds on each."""
    model, task = drive.model, drive.task
    damping = _damping(drive, tail)
    dissipative = all(item.low >= 0 for item in damping)
    bounds = polytope_of(drive.workspace.bounds.shape, model.dimension).rows
    measures: list[Measure] = [
        *coordinate_measures(model),
        *height_measures(passage, bounds, model.dimension),
    ]
    turned = _turned(drive, tail, leaves)
    measures += turned
    rates = tuple(_rate(dof, task, passage.by) for dof in model.dofs)
    reader = BoxEvaluator(
        drive.graph,
        tail,
        measures,
        rates,
        drive.groups if dissipative else None,
        model.dimension,
        drive.carried(tail),
    )
    given = None
    if isinstance(passage.start, GivenPose):
        near = ball(NEAR) * arb(0, 1)
        given = reader.read([closed_ball(value) + near for value in passage.start.values])
    slow = task.final_rates if passage.arrives else None
    lossless = all(item.low.is_zero() and item.high.is_zero() for item in damping)
    backwards = lossless and not dry_friction(model) and not task.carries
    limits = Limits(
        ball(passage.by),
        _first_rate(task),
        ball(slow.most) if slow is not None and backwards else None,
        None if drive.groups is None else most_power(drive.groups, rates),
        _pushes(drive, damping, turned),
    )
    all_bounds = [reader.read(leaf.coordinates) for leaf in leaves]
    return Region(measures, limits, leaves, all_bounds, given)


def _turned(
    drive: DriveReach, tail: Sequence[Ends], leaves: Sequence[LeafBox]
) -> list[MomentumMeasure]:
    """The measures that only the drive of one joint can change, if there are any."""
    if drive.groups is None or not leaves or dry_friction(drive.model):
        return []
    hulls = [leaves[0].coordinates[i] for i in range(len(drive.model.dofs))]
    for leaf in leaves[1:]:
        hulls = [hull.union(side) for hull, side in zip(hulls, leaf.coordinates, strict=True)]
    near = 2 * ball(NEAR) * arb(0, 1)
    return momentum_measures(drive.model, drive.graph, tail, [hull + near for hull in hulls])


def _pushes(
    drive: DriveReach, damping: Sequence[Ends], measures: Sequence[MomentumMeasure]
) -> dict[int, arb]:
    """The input bounds of joints without friction, or whose friction brakes no other joint."""
    bounds = {joint: group.bound for group in drive.groups or () for joint in group.joints}
    return {
        joint: bounds[joint]
        for measure in measures
        for joint in [measure.cyclic]
        if measure.shape is None or (damping[joint].low.is_zero() and damping[joint].high.is_zero())
    }


def _damping(drive: DriveReach, tail: Sequence[Ends]) -> list[Ends]:
    """The friction of all joints; empty if nothing is known about forces."""
    if drive.graph.damping is None:
        return []
    zero = Ends(arb(0), arb(0))
    inputs = [zero] * len(drive.model.dofs)
    return drive.graph.damping.evaluate([*inputs, *tail], INTERVALS)


def _groups(model: RobotModel, task: ir.Task) -> tuple[EffortGroup, ...]:
    """The effort bounds by degrees of freedom."""
    inputs = robot_inputs(model)
    found = []
    for bound in input_bounds(model, task):
        joints = tuple(dof for i in bound.inputs if (dof := inputs[i].dof) is not None)
        found.append(EffortGroup(joints, ball(bound.upper), bound.norm2))
    return tuple(found)


def _first_rate(task: ir.Task) -> arb:
    """The largest absolute rate of any joint at the start."""
    return ball(task.start.rates if isinstance(task.start, ir.StartIn) else Fraction(0))


def _rate(dof: RobotDof, task: ir.Task, by: Fraction) -> arb | None:
    """The largest absolute rate of a joint until a time (s); None if nothing bounds it.

    An acceleration of at most a lets a rate grow by at most a t from the start, and the rate
    exceeds a final rate by at most a (S - t) until the instant S from which that bound holds. So it
    is at most half the sum of all of these until S, and at most the final rate from then on.
    """
    bounds = list[arb]()
    if dof.rate is not None:
        bounds.append(abs(closed_ball(dof.rate.lower)).max(abs(closed_ball(dof.rate.upper))))
    if dof.accel is not None:
        most, first = closed_ball(dof.accel), _first_rate(task)
        bounds.append(first + most * ball(by))
        if task.final_rates is not None:
            whole = most * ball(max(Fraction(0), task.steps * task.step - task.stay))
            final = ball(task.final_rates.most)
            bounds.append(((first + whole + final) / 2).max(final))
    return reduce(arb.min, bounds).upper() if bounds else None


def _energy(region: Region, budget: Budget | None) -> DriveBound | None:
    """The goal requires more energy than the motion can have."""
    if budget is None:
        return None
    goal = least([box_bounds.potential.low for box_bounds in region.goals])
    if not goal > budget.energy:
        return None
    start = -least([-box_bounds.potential.high for box_bounds in region.sources])
    needs, has = _apart(float(goal - start), float(budget.energy - start))
    reason = f"at least {needs} J are needed, at most {has} J can be had"
    return DriveBound(reason, float(needs), float(has), "J")


def _change(
    drive: DriveReach, passage: Passage, region: Region, budget: Budget | None
) -> DriveBound | None:
    """A measure would have to change by more than it can."""
    for number, measure in enumerate(region.measures):
        if isinstance(measure, MomentumMeasure):
            found = _unturned(region, number, measure)
            if found is not None:
                return found
            continue
        if measure.circle:
            continue
        start, goal = region.ends(number, start=True), region.ends(number, start=False)
        low, high = (start.high, goal.low) if goal.low > start.high else (goal.high, start.low)
        if not high > low:
            continue
        takes = needed(number, low, high, region.inside, budget)
        unit = measure.length if isinstance(measure, HeightMeasure) else 1.0
        way = float(high - low) / unit
        if budget is not None and takes.length > budget.length:
            has = way * float(budget.length) / float(takes.length)
            return _too_far(measure.name, way, has, measure.unit)
        if takes.time > region.limits.time:
            return _too_slow(drive, passage, measure.name, float(takes.time))
    return None


def _unturned(region: Region, number: int, measure: MomentumMeasure) -> DriveBound | None:
    """Momentum does not change its measure by enough."""
    name = measure.name
    if measure.shape is not None:
        name += ", apart from what the other joint does,"
    ways = [(region.least_way(number), region.change(number, None))]
    line = region.one_way(number)
    if line is not None:
        ways += [
            (line.goal.low - line.start.high, line.up),
            (line.start.low - line.goal.high, line.down),
        ]
    for way, has in ways:
        if has is not None and way > has:
            return _too_far(name, float(way), float(has), measure.unit)
    return None


def _too_far(name: str, way: float, has: float, unit: str) -> DriveBound:
    needs, can = _apart(way, has)
    reason = f"{name} has to move by {needs} {unit} at least, and can by {can} {unit} at most"
    return DriveBound(reason, float(needs), float(can), unit)


def _too_slow(drive: DriveReach, passage: Passage, name: str, time: float) -> DriveBound:
    needs, has = _apart(time, float(passage.by))
    reason = f"{name} needs {needs} s at least, the {_limit(drive.task, passage)} is {has} s"
    return DriveBound(reason, float(needs), float(has), "s")


def _limit(task: ir.Task, passage: Passage) -> str:
    """What the time of a passage is called."""
    if passage.by == task.steps * task.step:
        return "horizon"
    return "time before the stay in the target" if passage.arrives else "deadline"


def _apart(needs: float, has: float) -> tuple[str, str]:
    """Two different numbers with enough digits to show the first one as the larger."""
    digits = 3
    while digits < 17 and not float(f"{needs:.{digits}g}") > float(f"{has:.{digits}g}"):
        digits += 1
    return f"{needs:.{digits}g}", f"{has:.{digits}g}"

"""Search for a covering that shows that a robot's drives are too weak or too slow.

Boxes of coordinates are halved evenly where the robot may be, and the verifier's own bound is
evaluated at a few sizes; parameters are divided if that does not suffice.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import working_precision
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_reach import DriveReach, drive_reach, out_of_reach
from compiler.unreachability.box_tree import (
    MOST_VARIABLES,
    BoxTreeError,
    CoordinateTree,
    ParameterLeaf,
    Part,
    Parts,
    text,
)
from compiler.unreachability.covered_poses import CoveredPoses
from compiler.unreachability.motion_conditions import motion_conditions
from grammar_lang import ir
from solvers.impossibility.box_growth import Divide
from solvers.impossibility.box_refutation import BoxRefutation
from solvers.impossibility.box_search import EvenGrowth, Search
from solvers.impossibility.pose_search import PoseWitness
from solvers.trajectory.task_limits import InputGroup, input_groups, motion_limits
from solvers.verifier.refutations.box_check import PRECISION, why_not


@dataclass(frozen=True, slots=True)
class DriveEffort:
    """The sizes of the coverings to try in order, and the most boxes of parameters."""

    leaves: tuple[int, ...]
    boxes: int


BEFORE_MOTIONS = DriveEffort((16, 64), 4)
"""Before the search for a motion, which takes far longer."""
BEFORE_LONG_MOTIONS = DriveEffort((16,), 1)
"""The same for robots of many joints: so few boxes show only targets far out of reach."""
AFTER_MOTIONS = DriveEffort((16, 64, 256), 16)
"""After no motion was found."""
AT_GOALS = 4
"""How many times as many leaves coverings have that are fine at the goals alone."""
INSTANTS = 8
"""The instants of a straight motion at which its inputs are checked."""
MISSED = 1e-6
"""The relative error that accelerations caused by the inputs may have."""


def drives_seem_able(
    numeric: NumericRobot,
    task: ir.Task,
    witnesses: Sequence[PoseWitness | None],
    deadlines: Sequence[Fraction | None],
) -> bool:
    """Whether the drives seem strong enough, so that no covering can show the opposite.

    The poses that answer each question are connected by straight motions in joint space, from rest
    to rest until the question's deadline, or over the whole horizon (None); obstacles are left to
    the search for a motion.
    """
    return bool(witnesses) and all(
        witness is not None and _is_driven(numeric, task, witness, by)
        for witness, by in zip(witnesses, deadlines, strict=True)
    )


def _is_driven(
    numeric: NumericRobot, task: ir.Task, witness: PoseWitness, by: Fraction | None
) -> bool:
    """Whether a straight motion between two poses keeps all bounds."""
    strains = straight_strains(numeric, numeric.graph.model, task, witness, by)
    return strains is not None and strains.most <= 1


@dataclass(frozen=True, slots=True)
class Strains:
    """The largest parts of their bounds that a motion takes: above 1 it exceeds them.

    Of the inputs (m,), and of the rates and accelerations of the joints (n,); 0 without a bound.
    """

    inputs: Array
    rates: Array
    accelerations: Array

    @property
    def most(self) -> float:
        """The largest of all of them; nan if one is unknown."""
        return float(np.max(np.concatenate([self.inputs, self.rates, self.accelerations])))


def straight_strains(
    numeric: NumericRobot,
    model: RobotModel,
    task: ir.Task,
    witness: PoseWitness,
    by: Fraction | None,
) -> Strains | None:
    """What a straight motion between two poses takes of the bounds; None without inputs.

    Args:
        numeric: the robot.
        model: the same robot, maybe with other bounds.
        task: the task.
        witness: the poses.
        by: the time (s) of the second pose; None is the end.
    """
    with np.errstate(all="ignore"):
        straight = _straight_motion(numeric, model, task, witness, by)
        if straight is None:
            return None
        inputs, rates, accelerations = straight
        limits = motion_limits(model, task)
        found = np.zeros(inputs.shape[1])
        for group in input_groups(model, task):
            found[list(group.inputs)] = _strains_of(inputs, group)
        below, above = (np.max(side * rates, axis=0) for side in (-1, 1))
        turning = np.maximum(below / -limits.rate_lower, above / limits.rate_upper)
        bounds = limits.accelerations if limits.accelerations.size else np.inf
        return Strains(found, turning, np.max(np.abs(accelerations), axis=0) / bounds)


def _strains_of(inputs: Array, group: InputGroup) -> Array | float:
    """The largest parts of their bound that the inputs (k, m) of a group take."""
    own = inputs[:, list(group.inputs)]
    if group.norm2:
        return float(np.max(np.linalg.norm(own, axis=1)) / group.upper)
    away = np.max(np.abs(own - (group.lower + group.upper) / 2), axis=0)
    return np.where(away > 0, away / group.widest_margin, 0.0)


def _straight_motion(
    numeric: NumericRobot,
    model: RobotModel,
    task: ir.Task,
    witness: PoseWitness,
    by: Fraction | None,
) -> tuple[Array, Array, Array] | None:
    """The inputs, the rates and the accelerations, (k, m) and (k, n), at some instants."""
    limits = motion_limits(model, task)
    start = limits.start_values if witness.start is None else witness.start
    if start is None or numeric.r or not numeric.n:
        return None
    part = np.linspace(0.0, 1.0, INSTANTS)[:, None]
    horizon, way = float(by or task.steps * task.step), witness.target - start
    q = start + way * part**3 * (10 - 15 * part + 6 * part**2)
    rates = way / horizon * 30 * part**2 * (1 - part) ** 2
    wanted = way / horizon**2 * 60 * part * (1 - part) * (1 - 2 * part)
    x, idle = np.concatenate([q, rates], axis=1), np.zeros((INSTANTS, numeric.m))
    free, slope = numeric.acceleration(x, idle, witness.theta)
    by_input = slope[:, :, numeric.size : numeric.size + numeric.m]
    if not np.isfinite(by_input).all():
        return None
    inputs = np.einsum("kmn,kn->km", np.linalg.pinv(by_input), wanted - free)
    found, _ = numeric.acceleration(x, inputs, witness.theta)
    caused = np.all(np.abs(found - wanted) <= MISSED * (1 + np.max(np.abs(free))))
    return (inputs, rates, wanted) if caused else None


def drive_refutation(
    model: RobotModel,
    graph: RobotGraph,
    workspace: ir.Workspace,
    task: ir.Task,
    effort: DriveEffort,
) -> BoxRefutation | None:
    """A covering that shows that the drives are too weak; None if none was found.

    The arguments are those of ``box_refutation``.
    """
    # Drives that fail within the horizon may succeed in a later round.
    if (
        task.repeat
        or not model.dofs
        or max(len(model.dofs), len(model.parameters)) > MOST_VARIABLES
    ):
        return None
    with working_precision(PRECISION):
        try:
            search = _DriveSearch(model, graph, workspace, task)
        except (ValueError, BoxTreeError):  # no exact value, or an unlimited range
            return None
        found = search.covering(effort)
    if found is None or why_not(found.boxes, model, workspace, task) is not None:
        return None
    return found


class _DriveSearch:
    """The search for one robot, in the verifier's precision."""

    def __init__(
        self, model: RobotModel, graph: RobotGraph, workspace: ir.Workspace, task: ir.Task
    ) -> None:
        demands = motion_conditions(model, workspace, task)
        self._poses = CoveredPoses(demands)
        self._drive: DriveReach = drive_reach(model, workspace, task)
        self._searches = [Search(demands, choices, graph) for choices in demands.passages]

    def covering(self, effort: DriveEffort) -> BoxRefutation | None:
        """A covering with its reason, or None."""
        nodes: list[int | ParameterLeaf] = []
        reasons: list[str] = []
        waiting: list[Parts] = [(Part(),) * len(self._poses.parameters)]
        for _ in range(2 * effort.boxes - 1):
            box = waiting.pop()
            found = self._refuted(box, effort.leaves)
            if isinstance(found, Divide):
                nodes.append(found.parameter)
                halves = reversed(box[found.parameter].halves())
                at = found.parameter
                waiting += [(*box[:at], half, *box[at + 1 :]) for half in halves]
            elif found is None:
                return None
            else:
                nodes.append(ParameterLeaf("!", found[0]))
                reasons.append(found[1])
            if not waiting:
                return BoxRefutation(text(tuple(nodes)), _summary(reasons))
        return None

    def _refuted(
        self, box: Parts, sizes: tuple[int, ...]
    ) -> tuple[CoordinateTree, str] | Divide | None:
        """A tree for which some question has no answer, with the reason; else what to divide."""
        divide: Divide | None = None
        for number, search in enumerate(self._searches):
            even = search.even(box, self._drive.graph.shape)
            for tree in self._trees(box, search, even, sizes):
                reason = self._reason(box, tree, number)
                if reason is not None:
                    return tree, reason
            divide = divide or even.parameter()
        return divide

    def _trees(
        self, box: Parts, search: Search, even: EvenGrowth, sizes: tuple[int, ...]
    ) -> Iterator[CoordinateTree]:
        """Finer and finer coverings; where a robot has to hold still, finer ones at the goals."""
        rates = self._drive.task.final_rates
        still = rates is not None and bool(rates.duration)
        fine = search.even(box, ()) if still else None
        for size in sizes:
            yield even.refined(size)
            if fine is not None:
                yield fine.refined(AT_GOALS * size, goals=True)

    def _reason(self, box: Parts, tree: CoordinateTree, question: int) -> str | None:
        """Why no passage of a question is possible on a tree, or None."""
        cover, reason = self._poses.cover(self._poses.parameters_of(box), tree), ""
        for passage in self._poses.demands.passages[question]:
            if not cover.way(passage):
                continue
            leaves = cover.leaves(passage)
            bound = out_of_reach(self._drive, passage, cover.parameters, leaves)
            if bound is None:
                return None
            reason = reason or bound.reason
        return reason or "no way leads there"


def _summary(reasons: list[str]) -> str:
    """One reason for all parameters."""
    if len(set(reasons)) == 1:
        return reasons[0]
    return f"the drives are too weak for all parameters; for a part of them: {reasons[0]}"

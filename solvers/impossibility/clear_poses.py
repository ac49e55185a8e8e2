"""Poses of the whole body, clear of all obstacles, by sampling: the questions they answer.

What is found answers a script "possible" for nothing.  What is not found may still exist.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.encodings.body_smt import Poses
from compiler.encodings.pose_questions import PoseQuestion, effector_choices
from compiler.encodings.reachability_smt import Pose
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.parameters.parameter_space import parameter_space
from solvers.trajectory.body_clearance import Avoidances, BodyClearance, body_clearance, convex_set
from solvers.trajectory.inverse_kinematics import Pool, pool, poses_in
from solvers.trajectory.position_rows import ConvexSet
from solvers.trajectory.task_limits import state_limits

DESIGNS = 24
"""Parameters that are drawn."""
ATTEMPTS = 4
"""How often poses are drawn for a robot without free parameters."""
POSES = 48
"""Poses that are looked at for each of them and each region."""
STRICT = 1e-6
"""Metres by which a witness is clear, so that rounding does not matter."""


def clear_poses(
    numeric: NumericRobot,
    workspace: ir.Workspace,
    task: ir.Task,
    question: PoseQuestion,
    seed: int,
) -> frozenset[Poses]:
    """The scripts of a question that poses were found for; the same arguments, the same answer."""
    search = _Search(numeric, workspace, task, question)
    rng = np.random.default_rng(seed)
    found: set[Poses] = set()
    for theta in designs(numeric, rng):
        found |= search.answered(theta, rng)
        if search.poses in found:
            break
    return frozenset(found)


class _Search:
    """What stays the same for all parameters."""

    def __init__(
        self, numeric: NumericRobot, workspace: ir.Workspace, task: ir.Task, question: PoseQuestion
    ) -> None:
        self.numeric, self.question = numeric, question
        self.poses: Poses = ("target",) if question.start is None else ("start", "target")
        self.clearance: BodyClearance = body_clearance(Avoidances(numeric, workspace, task))
        limits = state_limits(numeric.graph.model)[:, 0]
        self.box = limits[:, 0], limits[:, 1]
        rows: dict[Pose, tuple[ir.HalfSpace, ...]] = {"target": question.target}
        if question.start is not None:
            rows["start"] = question.start
        parts = {pose: Polytope((*region, *question.bounds)) for pose, region in rows.items()}
        self.regions = {pose: convex_set(part) for pose, part in parts.items() if not part.is_empty}

    def answered(self, theta: Array, rng: np.random.Generator) -> set[Poses]:
        """The scripts that poses at these parameters answer."""
        found: set[Poses] = set()
        drawn = pool(self.numeric, theta, self.box, self._reach(), rng)
        seen: dict[tuple[Pose, int], bool] = {}
        for starting, reaching in effector_choices(self.numeric.graph.model, self.question):
            effectors: dict[Pose, int] = {"start": starting, "target": reaching}
            for pose in self.poses:
                key = pose, effectors[pose]
                if key not in seen:
                    seen[key] = self._exists(theta, drawn, *key, rng)
                if seen[key]:
                    found.add((pose,))
            if all(seen[pose, effectors[pose]] for pose in self.poses):
                found.add(self.poses)
        return found

    def _exists(
        self, theta: Array, drawn: Pool, pose: Pose, effector: int, rng: np.random.Generator
    ) -> bool:
        region: ConvexSet | None = self.regions.get(pose)
        if region is None:
            return False
        q = poses_in(self.numeric, theta, drawn, self.box, effector, region, POSES, rng)
        if not len(q):
            return False
        positions = self.numeric.points(q, theta).value
        beyond = np.max(positions[:, effector] @ region.normals.T - region.offsets, axis=1)
        return bool(np.any((beyond <= 0) & (self.clearance.of(positions) > STRICT)))

    def _reach(self) -> float:
        """How far the regions are from the world's origin, in metres."""
        ends = [np.abs(region.vertices) for region in self.regions.values()]
        return max((float(np.max(end)) for end in ends), default=0.0)


def designs(numeric: NumericRobot, rng: np.random.Generator) -> Iterator[Array]:
    """Parameters (p,) drawn from their domains."""
    space = parameter_space(numeric.graph.model)
    for _ in range(ATTEMPTS if space.is_point else DESIGNS):
        yield space.drawn(rng)

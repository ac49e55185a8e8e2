"""Search for a start and a target pose of a robot by random starts and damped least squares.

The search precedes the solver: a witness cheaply shows that the structure may be able to do the
task. Poses that are not found may still exist. Source: Levenberg, *A Method for the Solution of
Certain Non-Linear Problems in Least Squares*.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.encodings.body_smt import Poses
from compiler.encodings.pose_questions import PoseQuestion, effector_choices
from compiler.encodings.reachability_smt import Pose
from compiler.expressions.evaluators.balls import closed_ball
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.parameters.parameter_search import parameter_space
from solvers.trajectory.body_clearance import Avoidances, BodyClearance, body_clearance
from solvers.trajectory.convex_set import ConvexSet, convex_set
from solvers.trajectory.inverse_kinematics import Pool, pool, poses_in
from solvers.trajectory.task_limits import state_limits

RESTARTS = 12
SAMPLES = 64
ROUNDS = 25
STAGNATION = 0.9999
GIVE_UP = 1e6
INTERIOR = 1e-6  # metres: aim inside, so that rounding does not matter
TURN = np.pi


@dataclass(frozen=True, slots=True, eq=False)
class PoseWitness:
    """Parameters (p,) and coordinates (n,) at both poses; ``effector`` (from 0) is in the target.

    All are in SI units. ``start`` is None if the task fixes the start pose; otherwise
    ``start_effector`` is in the start region.
    """

    theta: Array
    start: Array | None
    target: Array
    effector: int
    start_effector: int


@dataclass(frozen=True, slots=True)
class _Region:
    """Unit normals (m, d) and offsets (m,) in metres."""

    normals: Array
    offsets: Array

    def excess(self, points: Array) -> Array:
        """How far points (K, d) violate each row (0: satisfied by INTERIOR), shape (K, m)."""
        return np.maximum(points @ self.normals.T - self.offsets + INTERIOR, 0.0)


@dataclass(frozen=True, slots=True)
class _Pose:
    """One pose to be found: a point, and the region where it has to be."""

    point: int
    region: _Region


def find_poses(numeric: NumericRobot, question: PoseQuestion, seed: int) -> PoseWitness | None:
    """Poses that answer a question positively, for some effector; None if none were found.

    They respect joint limits and parameter ranges and share the parameters. The search is
    deterministic.
    """
    for start, reach in effector_choices(numeric.graph.model, question):
        found = find_poses_of(numeric, question, (start, reach), seed)
        if found is not None:
            return found
    return None


def find_poses_of(
    numeric: NumericRobot, question: PoseQuestion, effectors: tuple[int, int], seed: int
) -> PoseWitness | None:
    """Poses for one choice of the starting and the reaching effector; None if none were found."""
    poses = [_Pose(effectors[1], _region(question.target, question.bounds))]
    if question.start is not None:
        poses.insert(0, _Pose(effectors[0], _region(question.start, question.bounds)))
    rng = np.random.default_rng(seed)
    box = _joint_box(numeric, poses)
    theta, lower, upper = _designs(numeric, rng)
    q = _best_samples(numeric, poses, theta, box, rng)
    found = _descend(numeric, poses, q, box, theta, (lower, upper))
    if found is None:
        return None
    q, best = found
    return PoseWitness(best, q[0] if len(poses) == 2 else None, q[-1], *effectors[::-1])


# --- boxes ---------------------------------------------------------------------------------------


def _region(*parts: tuple[ir.HalfSpace, ...]) -> _Region:
    rows = [row for part in parts for row in part]
    normals = np.array([[float(a) for a in row.normal] for row in rows])
    offsets = np.array([float(row.offset) for row in rows])
    length = np.linalg.norm(normals, axis=1)
    length = np.where(length > 0, length, 1.0)  # a zero row holds everywhere
    return _Region(normals / length[:, None], offsets / length)


def _float(expression: ir.Expr) -> float:
    return float(closed_ball(expression).mid())


def _joint_box(numeric: NumericRobot, poses: list[_Pose]) -> tuple[Array, Array]:
    """Limits of the coordinates (n,); unlimited ones get a range with all useful values."""
    reach = 2 * max(float(np.max(np.abs(pose.region.offsets))) for pose in poses)
    lower, upper = [], []
    for dof in numeric.graph.model.dofs:
        free = TURN if dof.kind == "revolute" else reach
        lower.append(-free if dof.range is None else _float(dof.range.lower))
        upper.append(free if dof.range is None else _float(dof.range.upper))
    return np.array(lower), np.array(upper)


def _designs(numeric: NumericRobot, rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Initial parameters, and the boxes in which they may change, each (RESTARTS, p).

    Choices are drawn once and stay fixed.
    """
    space = parameter_space(numeric.graph.model)
    lower, upper = (np.tile(end, (RESTARTS, 1)) for end in (space.lower, space.upper))
    for i, values in enumerate(space.choices):
        if values is not None:
            lower[:, i] = upper[:, i] = rng.choice(values, RESTARTS)
    return rng.uniform(lower, upper), lower, upper


# --- search --------------------------------------------------------------------------------------


def _best_samples(
    numeric: NumericRobot,
    poses: list[_Pose],
    theta: Array,
    box: tuple[Array, Array],
    rng: np.random.Generator,
) -> Array:
    """The best of random coordinates for each design and pose, shape (designs, poses, n)."""
    count = len(theta)
    samples = rng.uniform(*box, size=(count * SAMPLES, numeric.n))
    points = numeric.effectors(samples, np.repeat(theta, SAMPLES, axis=0)).value
    best = []
    for pose in poses:
        excess = pose.region.excess(points[:, pose.point])
        squares = np.sum(excess**2, axis=1).reshape(count, SAMPLES)
        best.append(
            samples.reshape(count, SAMPLES, -1)[np.arange(count), np.argmin(squares, axis=1)]
        )
    return np.stack(best, axis=1)


def _descend(
    numeric: NumericRobot,
    poses: list[_Pose],
    q: Array,
    box: tuple[Array, Array],
    theta: Array,
    limits: tuple[Array, Array],
) -> tuple[Array, Array] | None:
    """Levenberg-Marquardt on coordinates and parameters together, clipped to their boxes.

    All designs descend in parallel; the result is that of the first one that arrives, or None.
    """
    count, width = len(q), numeric.n * len(poses)
    low = np.concatenate([np.tile(box[0], (count, len(poses))), limits[0]], axis=1)
    high = np.concatenate([np.tile(box[1], (count, len(poses))), limits[1]], axis=1)
    x = np.clip(np.concatenate([q.reshape(count, width), theta], axis=1), low, high)
    at = _residual(numeric, poses, x)
    damping = np.full(count, 1e-3)
    for _ in range(ROUNDS):
        if at.inside.any() or np.all(damping >= GIVE_UP):
            break
        trial = np.clip(x + _step(x, at, (low, high), damping), low, high)
        ahead = _residual(numeric, poses, trial)
        better = ahead.size < at.size
        slow = better & (ahead.size > STAGNATION * at.size)
        damping = np.where(better, np.maximum(damping / 5, 1e-9), damping * 5)
        damping = np.where(slow, GIVE_UP, np.minimum(damping, GIVE_UP))
        x = np.where(better[:, None], trial, x)
        at = at.replaced(ahead, better)
    if not at.inside.any():
        return None
    first = int(np.argmax(at.inside))
    return x[first, :width].reshape(len(poses), numeric.n), x[first, width:]


@dataclass(frozen=True, slots=True, eq=False)
class _Residual:
    """Violations (R, m) of R designs, their Jacobians (R, m, w), and which are inside (R,)."""

    value: Array
    jacobian: Array
    inside: NDArray[np.bool_]

    @property
    def size(self) -> Array:
        """The sums of squares, (R,)."""
        return np.asarray(np.sum(self.value**2, axis=1))

    def replaced(self, other: _Residual, where: NDArray[np.bool_]) -> _Residual:
        """The residual with the other's entries for some designs."""
        return _Residual(
            np.where(where[:, None], other.value, self.value),
            np.where(where[:, None, None], other.jacobian, self.jacobian),
            np.where(where, other.inside, self.inside),
        )


def _step(x: Array, at: _Residual, box: tuple[Array, Array], damping: Array) -> Array:
    """The damped least-squares steps, (R, w).

    A variable at its bound that would leave it is held; otherwise the step would be cut short.
    """
    gradient = np.einsum("rmw,rm->rw", at.jacobian, at.value)
    free = ~(((x <= box[0]) & (gradient > 0)) | ((x >= box[1]) & (gradient < 0)))
    columns = at.jacobian * free[:, None, :]
    normal = columns.transpose(0, 2, 1) @ columns
    normal += damping[:, None, None] * np.eye(x.shape[1])
    return -np.linalg.solve(normal, (gradient * free)[:, :, None])[:, :, 0]


def _residual(numeric: NumericRobot, poses: list[_Pose], x: Array) -> _Residual:
    """The violations of designs x (R, poses * n + p)."""
    n, width, count = numeric.n, numeric.n * len(poses), len(x)
    q = x[:, :width].reshape(count * len(poses), n)
    points = numeric.leading(q, np.repeat(x[:, width:], len(poses), axis=0))
    values, rows = [], []
    inside = np.ones(count, dtype=bool)
    for k, (point, region) in enumerate((pose.point, pose.region) for pose in poses):
        each = slice(k, None, len(poses))
        at = points.value[each, point]
        excess = region.excess(at)
        active = (excess > 0)[:, :, None] * region.normals
        row = np.zeros((count, excess.shape[1], width + numeric.p))
        row[:, :, k * n : (k + 1) * n] = active @ points.by_q[each, point]
        row[:, :, width:] = active @ points.by_theta[each, point]
        values.append(excess)
        rows.append(row)
        inside &= np.all(at @ region.normals.T <= region.offsets, axis=1)
    return _Residual(np.concatenate(values, axis=1), np.concatenate(rows, axis=1), inside)


# --- Poses of the whole body, clear of all obstacles, by sampling ---------------------------------
#
# Poses that are found answer a script cheaply with "possible". Others may still exist.


DESIGNS = 24
"""The number of parameter vectors that are drawn."""
ATTEMPTS = 4
"""How often poses are drawn for a robot without free parameters."""
POSES = 48
"""The poses that are checked for each of them and each region."""
STRICT = 1e-6
"""The clearance of a witness in metres, so that rounding does not matter."""


def clear_poses(
    numeric: NumericRobot,
    workspace: ir.Workspace,
    task: ir.Task,
    question: PoseQuestion,
    seed: int,
) -> frozenset[Poses]:
    """The scripts of a question for which poses were found; the search is deterministic."""
    search = _Search(numeric, workspace, task, question)
    rng = np.random.default_rng(seed)
    found: set[Poses] = set()
    for theta in designs(numeric, rng):
        found |= search.answered(theta, rng)
        if search.poses in found:
            break
    return frozenset(found)


class _Search:
    """The part of a search that does not depend on the parameters."""

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
        """The scripts that poses with these parameters answer."""
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
        positions = self.numeric.positions(q, theta)
        beyond = np.max(positions[:, effector] @ region.normals.T - region.offsets, axis=1)
        return bool(np.any((beyond <= 0) & (self.clearance.of(positions) > STRICT)))

    def _reach(self) -> float:
        """The distance of the regions from the world's origin, in metres."""
        ends = [np.abs(region.vertices) for region in self.regions.values()]
        return max((float(np.max(end)) for end in ends), default=0.0)


def designs(numeric: NumericRobot, rng: np.random.Generator) -> Iterator[Array]:
    """Parameters (p,) drawn from their domains."""
    space = parameter_space(numeric.graph.model)
    for _ in range(ATTEMPTS if space.is_point else DESIGNS):
        yield space.drawn(rng)

"""A start pose and a target pose of one robot by random starts and damped least squares.

Asked before the solver: a witness answers "the structure may do it" for nothing.  What is not
found may still exist.  Source: Levenberg, *A Method for the Solution of Certain Non-Linear
Problems in Least Squares*.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from compiler.arithmetic.balls import closed_ball
from compiler.discretisation.float_reading import Array, FloatReading
from compiler.encodings.pose_questions import PoseQuestion, effector_choices
from grammar_lang import ir

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

    ``start`` is None where the task fixes the start pose, else ``start_effector`` is in its region.
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
        """By how much points (K, d) violate each row (0: satisfied by INTERIOR), shape (K, m)."""
        return np.maximum(points @ self.normals.T - self.offsets + INTERIOR, 0.0)

    def holds(self, points: Array) -> bool:
        """Whether points (K, d) lie in the region."""
        return bool(np.all(points @ self.normals.T <= self.offsets))


@dataclass(frozen=True, slots=True)
class _Pose:
    """One pose that is sought: which point is to lie where."""

    point: int
    region: _Region


def find_poses(reading: FloatReading, question: PoseQuestion, seed: int) -> PoseWitness | None:
    """Poses that answer a question positively, for some effector; None: not found.

    Honours joint limits and parameter ranges; both poses share the parameters.  The same
    arguments give the same answer.
    """
    for start, reach in effector_choices(reading.graph.model, question):
        found = find_poses_of(reading, question, (start, reach), seed)
        if found is not None:
            return found
    return None


def find_poses_of(
    reading: FloatReading, question: PoseQuestion, effectors: tuple[int, int], seed: int
) -> PoseWitness | None:
    """The same for one choice of the starting and the reaching effector."""
    poses = [_Pose(effectors[1], _region(question.target, question.bounds))]
    if question.start is not None:
        poses.insert(0, _Pose(effectors[0], _region(question.start, question.bounds)))
    rng = np.random.default_rng(seed)
    box = _joint_box(reading, poses)
    for theta, limits in _designs(reading, rng):
        found = _descend(reading, poses, _best_samples(reading, poses, theta, box, rng), box,
                         theta, limits)  # fmt: skip
        if found is not None:
            q, best = found
            return PoseWitness(best, q[0] if len(poses) == 2 else None, q[-1], *effectors[::-1])
    return None


# --- boxes ---------------------------------------------------------------------------------------


def _region(*parts: tuple[ir.HalfSpace, ...]) -> _Region:
    rows = [row for part in parts for row in part]
    normals = np.array([[float(a) for a in row.normal] for row in rows])
    offsets = np.array([float(row.offset) for row in rows])
    length = np.linalg.norm(normals, axis=1)
    length = np.where(length > 0, length, 1.0)  # a zero row says "everywhere"
    return _Region(normals / length[:, None], offsets / length)


def _float(expression: ir.Expr) -> float:
    return float(closed_ball(expression).mid())


def _joint_box(reading: FloatReading, poses: list[_Pose]) -> tuple[Array, Array]:
    """Limits of the coordinates (n,); unlimited ones get a range that loses nothing of use."""
    reach = 2 * max(float(np.max(np.abs(pose.region.offsets))) for pose in poses)
    lower, upper = [], []
    for dof in reading.graph.model.dofs:
        free = TURN if dof.kind == "revolute" else reach
        lower.append(-free if dof.range is None else _float(dof.range.lower))
        upper.append(free if dof.range is None else _float(dof.range.upper))
    return np.array(lower), np.array(upper)


def _designs(
    reading: FloatReading, rng: np.random.Generator
) -> Iterator[tuple[Array, tuple[Array, Array]]]:
    """Parameters to start from, and the box they may move in (choices are drawn and stay)."""
    domains = [parameter.domain for parameter in reading.graph.model.parameters]
    for _ in range(RESTARTS):
        lower, upper = np.zeros(reading.p), np.zeros(reading.p)
        for i, domain in enumerate(domains):
            if isinstance(domain, ir.Interval):
                lower[i], upper[i] = _float(domain.lower), _float(domain.upper)
            else:
                lower[i] = upper[i] = _float(domain.values[int(rng.integers(len(domain.values)))])
        yield rng.uniform(lower, upper), (lower, upper)


# --- search --------------------------------------------------------------------------------------


def _best_samples(
    reading: FloatReading,
    poses: list[_Pose],
    theta: Array,
    box: tuple[Array, Array],
    rng: np.random.Generator,
) -> Array:
    """The best of random coordinates for each pose, shape (poses, n)."""
    samples = rng.uniform(*box, size=(SAMPLES, reading.n))
    points = reading.points(samples, theta).value
    rows = [pose.region.excess(points[:, pose.point]) for pose in poses]
    return np.array([samples[np.argmin(np.sum(row**2, axis=1))] for row in rows])


def _descend(
    reading: FloatReading,
    poses: list[_Pose],
    q: Array,
    box: tuple[Array, Array],
    theta: Array,
    limits: tuple[Array, Array],
) -> tuple[Array, Array] | None:
    """Levenberg-Marquardt on coordinates and parameters together, clipped to their boxes."""
    n = reading.n
    low = np.concatenate([np.tile(box[0], len(poses)), limits[0]])
    high = np.concatenate([np.tile(box[1], len(poses)), limits[1]])
    x = np.clip(np.concatenate([q.ravel(), theta]), low, high)
    residual, jacobian, inside = _residual(reading, poses, x)
    damping = 1e-3
    for _ in range(ROUNDS):
        if inside or damping >= GIVE_UP:
            break
        trial = np.clip(x + _step(x, residual, jacobian, (low, high), damping), low, high)
        ahead = _residual(reading, poses, trial)
        before, after = residual @ residual, ahead[0] @ ahead[0]
        if after >= before:
            damping *= 5
            continue
        x, (residual, jacobian, inside) = trial, ahead
        damping = GIVE_UP if after > STAGNATION * before else max(damping / 5, 1e-9)
    width = n * len(poses)
    return (x[:width].reshape(len(poses), n), x[width:]) if inside else None


def _step(
    x: Array, residual: Array, jacobian: Array, box: tuple[Array, Array], damping: float
) -> Array:
    """The damped least-squares step.

    A variable at its bound that would leave it is held, else the step would be cut short.
    """
    gradient = jacobian.T @ residual
    free = ~(((x <= box[0]) & (gradient > 0)) | ((x >= box[1]) & (gradient < 0)))
    columns = jacobian[:, free]
    normal = columns.T @ columns + damping * np.eye(columns.shape[1])
    step = np.zeros(len(x))
    step[free] = -np.linalg.solve(normal, gradient[free])
    return step


def _residual(reading: FloatReading, poses: list[_Pose], x: Array) -> tuple[Array, Array, bool]:
    """Violations (m,), their Jacobian (m, poses * n + p), and whether the points lie inside."""
    n, width = reading.n, reading.n * len(poses)
    points = reading.points(x[:width].reshape(len(poses), n), x[width:])
    residuals, rows, inside = [], [], True
    for k, (point, region) in enumerate((pose.point, pose.region) for pose in poses):
        at = points.value[k, point][None, :]
        excess = region.excess(at)[0]
        active = (excess > 0)[:, None] * region.normals
        row = np.zeros((len(excess), width + reading.p))
        row[:, k * n : (k + 1) * n] = active @ points.by_q[k, point]
        row[:, width:] = active @ points.by_theta[k, point]
        residuals.append(excess)
        rows.append(row)
        inside = inside and region.holds(at)
    return np.concatenate(residuals), np.concatenate(rows), inside

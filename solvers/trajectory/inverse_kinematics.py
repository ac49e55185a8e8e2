"""Inverse kinematics by damped least squares, from many starts at once (Levenberg-Marquardt).

It only provides seeds: poses may exist that it does not find.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from solvers.trajectory.convex_set import ConvexSet

ROUNDS = 60
DAMPING = 1e-3
SLIDE = 10.0
"""Metres beyond the target's distance up to which an unlimited slide is sampled."""
APART = 0.1
"""Branches differ by this much in some coordinate: sin of half an angle, or metres."""


def solve_positions(
    numeric: NumericRobot,
    starts: Array,
    theta: Array,
    point: int | Sequence[int],
    targets: Array,
    box: tuple[Array, Array],
    rounds: int = ROUNDS,
) -> tuple[Array, Array]:
    """Bring one point to targets from K starts; starts (K, n), theta (p,), targets (K, d) in m.

    If ``point`` is a sequence of w points, each has its own target, and targets (K, w d) contain
    these one after the other.  The method is Levenberg-Marquardt with separate damping for each
    start.  Returns coordinates (K, n) within the box, and the remaining distances (K,) in metres.
    """
    lower, upper = box
    moved = [point] if isinstance(point, int) else list(point)
    count, wide = len(starts), len(moved) * numeric.d
    q = np.clip(starts, lower, upper)
    eye = np.eye(numeric.n)
    damping = np.full(len(q), DAMPING)
    effectors = len(numeric.graph.model.effectors)
    points_of = numeric.effectors if max(moved) < effectors else numeric.points

    def placed(q: Array) -> tuple[Array, Array]:
        points = points_of(q, theta)
        error = targets - points.value[:, moved].reshape(count, wide)
        return error, points.by_q[:, moved].reshape(count, wide, numeric.n)

    error, jacobian = placed(q)
    for _ in range(rounds):
        normal = jacobian.transpose(0, 2, 1) @ jacobian + damping[:, None, None] * eye
        gradient = jacobian.transpose(0, 2, 1) @ error[:, :, None]
        step = np.linalg.solve(normal, gradient)[:, :, 0]
        trial = np.clip(q + np.clip(step, -0.5, 0.5), lower, upper)
        trial_error, trial_jacobian = placed(trial)
        better = np.linalg.norm(trial_error, axis=1) < np.linalg.norm(error, axis=1)
        if not better.any() and float(damping.min()) > 1e3:
            break
        q = np.where(better[:, None], trial, q)
        damping = np.clip(np.where(better, damping / 5, damping * 5), 1e-9, 1e6)
        error = np.where(better[:, None], trial_error, error)
        jacobian = np.where(better[:, None, None], trial_jacobian, jacobian)
        if float(np.linalg.norm(error, axis=1).max()) < 1e-10:
            break
    return q, np.linalg.norm(error, axis=1)


def branches(
    numeric: NumericRobot,
    theta: Array,
    point: int,
    target: Array,
    box: tuple[Array, Array],
    seed: int,
    count: int,
) -> Array:
    """Distinct coordinates that bring a point nearest to a target, best first, shape (b, n).

    ``count`` bounds the number of branches.  Random starts are drawn with ``seed`` from the box;
    where it is wider or unlimited, from one turn, or from SLIDE metres about the target's distance.
    """
    turns = _turns(numeric)
    lower, upper = sampled_box(numeric, box, float(np.linalg.norm(target)))
    starts = np.random.default_rng(seed).uniform(lower, upper, size=(24, numeric.n))
    q, distance = solve_positions(
        numeric, starts, theta, point, np.tile(target, (len(starts), 1)), box
    )
    chosen: list[Array] = []
    for index in np.lexsort((*q.T[::-1], np.round(distance, 6))):
        if all(_gap(q[index] - other, turns) > APART for other in chosen):
            chosen.append(q[index])
        if len(chosen) == count:
            break
    return np.array(chosen).reshape(-1, numeric.n)


def _turns(numeric: NumericRobot) -> NDArray[np.bool_]:
    """Which coordinates are angles."""
    return np.array([dof.kind == "revolute" for dof in numeric.graph.model.dofs], dtype=bool)


def sampled_box(
    numeric: NumericRobot, box: tuple[Array, Array], distance: float
) -> tuple[Array, Array]:
    """A bounded part (n,), (n,) of the box of coordinates, from which to draw samples.

    It extends from the box's point nearest to zero by half a turn to either side, or by SLIDE plus
    the ``distance`` of the target in metres.
    """
    lower, upper = box
    width = np.where(_turns(numeric), np.pi, SLIDE + distance)
    centre = np.clip(0.0, lower, upper)
    # A range that does not contain zero in its interior keeps the full width on its side.
    low = np.where(centre == upper, centre - 2 * width, centre - width)
    high = np.where(centre == lower, centre + 2 * width, centre + width)
    return np.maximum(lower, low), np.minimum(upper, high)


def apart(numeric: NumericRobot, q: Array, other: Array) -> bool:
    """Whether two poses (n,) belong to different branches."""
    return _gap(q - other, _turns(numeric)) > APART


def _gap(difference: Array, turns: NDArray[np.bool_]) -> float:
    """The distance between two coordinate vectors: sin of half the angle, metres for slides."""
    apart = np.where(turns, np.abs(np.sin(difference / 2)), np.abs(difference))
    return float(np.max(apart, initial=0.0))


# --------------------------------------------------------------------------------------------------
# Random poses of a robot with one point in a convex region: sampling and inverse kinematics.


POOL = 1024
"""Poses drawn at once."""
POOL_ROUNDS = 20
"""Iterations of inverse kinematics, which suffice for nearly all starts that succeed."""
REACHED = 1e-6
"""Metres within which a point counts as having reached its target."""


@dataclass(frozen=True, slots=True, eq=False)
class Pool:
    """Poses (K, n) drawn from the box of coordinates, with the points' positions (K, m, d)."""

    q: Array
    positions: Array


def pool(
    numeric: NumericRobot,
    theta: Array,
    box: tuple[Array, Array],
    reach: float,
    rng: np.random.Generator,
) -> Pool:
    """Draw poses of a robot with parameters (p,) from a box, lower and upper bounds (n,).

    Unlimited slides are drawn up to ``reach`` metres and somewhat beyond.
    """
    lower, upper = sampled_box(numeric, box, reach)
    q = rng.uniform(lower, upper, size=(POOL, numeric.n))
    return Pool(q, numeric.positions(q, theta))


def poses_in(
    numeric: NumericRobot,
    theta: Array,
    drawn: Pool,
    box: tuple[Array, Array],
    point: int,
    region: ConvexSet,
    count: int,
    rng: np.random.Generator,
) -> Array:
    """At most ``count`` poses (K, n) with a point in a region.

    They are taken from those drawn, if there are enough.  Otherwise the poses nearest to the region
    are added, after inverse kinematics has brought the point to random places in it.
    """
    gap = np.max(drawn.positions[:, point] @ region.normals.T - region.offsets, axis=1)
    order = np.argsort(gap, kind="stable")
    inside = drawn.q[order[gap[order] <= 0]]
    if len(inside) >= count:
        chosen: Array = inside[rng.permutation(len(inside))[:count]]
        return chosen
    starts = drawn.q[order[: 2 * (count - len(inside))]]
    weights = rng.exponential(size=(len(starts), len(region.vertices)))
    targets = weights @ region.vertices / weights.sum(axis=1, keepdims=True)
    q, distance = solve_positions(numeric, starts, theta, point, targets, box, POOL_ROUNDS)
    brought = q[distance < REACHED]
    found: Array = np.concatenate([inside, brought])
    return found[:count]

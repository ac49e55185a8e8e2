"""Inverse kinematics by damped least squares, from many starts at once (Levenberg-Marquardt).

Only a source of seeds: what it does not find may still exist.
"""

from __future__ import annotations

import numpy as np

from compiler.float_reading import Array, FloatReading

ROUNDS = 60
DAMPING = 1e-3


def solve_positions(
    reading: FloatReading,
    starts: Array,
    theta: Array,
    point: int,
    targets: Array,
    box: tuple[Array, Array],
) -> tuple[Array, Array]:
    """Bring one point to targets from K starts; starts (K, n), targets (K, d).

    Returns coordinates (K, n), within the box, and remaining distances (K,) in metres.
    """
    lower, upper = box
    q = np.clip(starts, lower, upper)
    eye = np.eye(reading.n)
    damping = np.full(len(q), DAMPING)
    points = reading.points(q, theta)
    error = targets - points.value[:, point]
    for _ in range(ROUNDS):
        jacobian = points.by_q[:, point]
        normal = jacobian.transpose(0, 2, 1) @ jacobian + damping[:, None, None] * eye
        gradient = jacobian.transpose(0, 2, 1) @ error[:, :, None]
        step = np.linalg.solve(normal, gradient)[:, :, 0]
        trial = np.clip(q + np.clip(step, -0.5, 0.5), lower, upper)
        trial_points = reading.points(trial, theta)
        trial_error = targets - trial_points.value[:, point]
        better = np.linalg.norm(trial_error, axis=1) < np.linalg.norm(error, axis=1)
        if not better.any() and float(damping.min()) > 1e3:
            break
        q = np.where(better[:, None], trial, q)
        damping = np.clip(np.where(better, damping / 5, damping * 5), 1e-9, 1e6)
        points = reading.points(q, theta)
        error = targets - points.value[:, point]
        if float(np.linalg.norm(error, axis=1).max()) < 1e-10:
            break
    return q, np.linalg.norm(error, axis=1)


def branches(
    reading: FloatReading,
    theta: Array,
    point: int,
    target: Array,
    box: tuple[Array, Array],
    seed: int,
    count: int,
) -> Array:
    """Distinct coordinates that bring a point nearest to a target, best first, shape (b, n).

    ``count`` bounds the number of branches; random starts are drawn with ``seed``.
    """
    lower, upper = (np.clip(bound, -np.pi, np.pi) for bound in box)
    starts = np.random.default_rng(seed).uniform(lower, upper, size=(24, reading.n))
    q, distance = solve_positions(
        reading, starts, theta, point, np.tile(target, (len(starts), 1)), box
    )
    chosen: list[Array] = []
    for index in np.lexsort((*q.T[::-1], np.round(distance, 6))):
        apart = [np.max(np.abs(np.sin((q[index] - other) / 2))) for other in chosen]
        if all(gap > 0.1 for gap in apart):
            chosen.append(q[index])
        if len(chosen) == count:
            break
    return np.array(chosen)

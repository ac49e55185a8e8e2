"""Random poses of a robot with one point in a convex region: sampling and inverse kinematics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from solvers.motions.inverse_kinematics import sampled_box, solve_positions
from solvers.motions.position_rows import ConvexSet

POOL = 1024
"""Poses drawn at once."""
ROUNDS = 20
"""Of inverse kinematics: nearly all that ends well has by then."""
REACHED = 1e-6
"""Metres within which a point counts as brought to its target."""


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
    """Draw poses; unlimited slides up to the ``reach`` in metres and some more."""
    lower, upper = sampled_box(numeric, box, reach)
    q = rng.uniform(lower, upper, size=(POOL, numeric.n))
    return Pool(q, numeric.points(q, theta).value)


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

    As drawn, if there are as many; else also those nearest to the region, with the point brought
    to random places of it by inverse kinematics.
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
    q, distance = solve_positions(numeric, starts, theta, point, targets, box, ROUNDS)
    brought = q[distance < REACHED]
    found: Array = np.concatenate([inside, brought])
    return found[:count]

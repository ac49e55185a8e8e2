"""Estimate volumes of hulls from extreme points along fixed directions, for many trials."""

from __future__ import annotations

from functools import cache

import numpy as np

from srgc.imports.meshes.few_corners import hull_volume, sphere_directions
from srgc.imports.meshes.mesh import Bools, Floats, Ints

COUNT = 60
"""The number of directions on the spiral."""


@cache
def directions() -> Floats:
    """Unit vectors (d, 3): a spiral over the sphere, and the axes."""
    return np.concatenate([sphere_directions(COUNT), np.eye(3), -np.eye(3)])


def estimated_volume(points: Floats) -> float:
    """A lower bound of the volume of the hull of points (n, 3), usually close to it."""
    along = points @ directions().T
    return hull_volume(points[np.unique(along.argmax(axis=0))])


class Estimates:
    """Hull volumes on both sides of planes, for a surface with points (n, 3) and edges (e, 2)."""

    def __init__(self, points: Floats, edges: Ints) -> None:
        self.points, self.edges = points, edges
        self.directions = directions()
        self.along = points @ self.directions.T
        self.near = 1e-9 * float(np.ptp(points, axis=0).max())

    def both_sides(self, normal: Floats, offset: float) -> float:
        """The estimated sum of hull volumes below and above a plane; inf if a side is empty.

        The plane has a ``normal`` (3,) and an ``offset`` in metres.
        """
        below, above, between = self._cut(normal, offset)
        if not below.any() or not above.any():
            return float("inf")
        cut = between @ self.directions.T
        return self._side(below, between, cut) + self._side(above, between, cut)

    def both_hulls(self, normal: Floats, offset: float) -> float:
        """The sum of the hull volumes on both sides, from all points; inf if a side is empty.

        The plane is that of ``both_sides``, with a ``normal`` (3,).
        """
        below, above, between = self._cut(normal, offset)
        sides = [np.concatenate([self.points[side], between]) for side in (below, above)]
        return sum(map(hull_volume, sides)) if below.any() and above.any() else float("inf")

    def _cut(self, normal: Floats, offset: float) -> tuple[Bools, Bools, Floats]:
        """Which points are below and above a plane, and where edges cross it.

        A point on the plane is on each side where it has a neighbour.
        """
        heights = self.points @ normal - offset
        heights[np.abs(heights) <= self.near] = 0.0
        first, last = self.edges.T
        over, under = heights > 0, heights < 0
        above, below = over.copy(), under.copy()
        for one, other in ((first, last), (last, first)):
            above[one[over[other] & ~under[one]]] = True
            below[one[under[other] & ~over[one]]] = True
        crossing = (over[first] & under[last]) | (under[first] & over[last])
        one, other = first[crossing], last[crossing]
        share = heights[one] / (heights[one] - heights[other])
        between = self.points[one] + share[:, None] * (self.points[other] - self.points[one])
        return below, above, between

    def _side(self, side: Bools, between: Floats, cut: Floats) -> float:
        numbers = np.flatnonzero(side)
        chosen = self.points[numbers[np.unique(self.along[numbers].argmax(axis=0))]]
        if len(between):
            chosen = np.concatenate([chosen, between[np.unique(cut.argmax(axis=0))]])
        return hull_volume(chosen)

"""Where two convex hulls of points are nearest, in floats: it guides a proof and proves nothing.

Source: Wolfe, *Finding the nearest point in a polytope* (1976), on the differences of the points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array

MOST_STEPS = 60
CLOSELY = 1e-13
"""Relative to the largest square: a step that gains less is none."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """The vector between the nearest points of two hulls, and their weights on the points."""

    difference: tuple[float, ...]
    left: tuple[float, ...]
    right: tuple[float, ...]


def nearest_points(left: Sequence[Sequence[float]], right: Sequence[Sequence[float]]) -> Nearest:
    """The point of the hull of ``left`` nearest to that of ``right``, less the latter's."""
    apart = np.array(left)[:, None, :] - np.array(right)[None, :, :]
    search = _Search(apart.reshape(-1, apart.shape[-1]))
    weights = search.weights().reshape(apart.shape[:2])
    return Nearest(
        tuple(search.point.tolist()),
        tuple(weights.sum(axis=1).tolist()),
        tuple(weights.sum(axis=0).tolist()),
    )


@dataclass(slots=True)
class _Search:
    """The point of least norm in the hull of ``points``, shape (n, d)."""

    points: Array
    corral: list[int] = field(default_factory=list[int])
    shares: Array = field(default_factory=lambda: np.ones(1))
    point: Array = field(default_factory=lambda: np.zeros(0))

    def weights(self) -> Array:
        """What every point counts in it, shape (n,)."""
        squares = np.einsum("ij,ij->i", self.points, self.points)
        least_gain = CLOSELY * float(squares.max())
        self.corral = [int(squares.argmin())]
        self.point = self.points[self.corral[0]]
        for _ in range(MOST_STEPS):
            along = self.points @ self.point
            best = int(along.argmin())
            if float(self.point @ self.point - along[best]) <= least_gain or best in self.corral:
                break
            self.corral.append(best)
            self.shares = np.append(self.shares, 0.0)
            self._settle()
        found = np.zeros(len(self.points))
        found[self.corral] = self.shares
        return found

    def _settle(self) -> None:
        """Go to the point of least norm of the affine hull, or as far as the hull goes."""
        while True:
            aim = self._affine()
            if bool((aim > 0).all()):
                self.shares = aim
                break
            falling = aim <= 0
            share = float((self.shares[falling] / (self.shares[falling] - aim[falling])).min())
            moved = (1 - share) * self.shares + share * aim
            moved[falling & (moved <= moved[falling].min())] = 0.0
            kept = moved > 0
            self.corral = [item for item, keep in zip(self.corral, kept, strict=True) if keep]
            self.shares = moved[kept] / moved[kept].sum()
        self.point = self.shares @ self.points[self.corral]

    def _affine(self) -> Array:
        """The weights, of any sign, of the point of least norm of the affine hull."""
        chosen = self.points[self.corral]
        size = len(chosen)
        system = np.ones((size + 1, size + 1))
        system[0, 0] = 0.0
        system[1:, 1:] = chosen @ chosen.T
        right = np.zeros(size + 1)
        right[0] = 1.0
        return np.asarray(np.linalg.lstsq(system, right, rcond=None)[0][1:], dtype=np.float64)

"""How far the effectors and bodies of a robot in some poses are from what they have to avoid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.time_limits.time_limit import check_time
from solvers.motions.avoidances import Avoidances
from solvers.motions.position_rows import Dwell, Separation, separating_planes

ENOUGH = 0.5
"""Metres: clearances are told apart up to this."""


@dataclass(frozen=True, slots=True)
class BodyClearance:
    """The demands that hold at any instant, to be measured on many poses at once."""

    separations: tuple[Separation, ...]
    dwells: tuple[Dwell, ...]

    def of(self, positions: Array, enough: float = ENOUGH) -> Array:
        """The least clearance (K,) of positions (K, m, d), in metres, at most ``enough``.

        Negative where a demand is broken: by how much, along the best separating direction.
        """
        found = np.full(len(positions), enough)
        for dwell in self.dwells:
            values = positions[:, dwell.point] @ dwell.region.normals.T
            found = np.minimum(found, np.min(dwell.region.offsets - values, axis=1))
        for separation in self.separations:
            check_time()
            moving = positions[:, list(separation.points)]
            near = np.flatnonzero(_box_gap(moving, separation) < found)
            near = near[_facet_gap(moving[near], separation) < found[near]]
            if len(near):
                gap = _gap(moving[near], separation)
                found[near] = np.minimum(found[near], gap)
        return found


def body_clearance(avoidances: Avoidances) -> BodyClearance:
    """The demands of a task, those of its bounds included."""
    bounds = avoidances.bounds
    effectors = range(len(avoidances.numeric.graph.model.effectors))
    dwells = [Dwell(effector, 0, 0, bounds) for effector in effectors]
    dwells += avoidances.bodies_within_bounds(0)
    return BodyClearance(tuple(avoidances.separations()), tuple(dwells))


def _box_gap(moving: Array, separation: Separation) -> Array:
    """A lower bound (K,) of the gaps, by the boxes about both."""
    lower, upper = separation.obstacle.box
    apart = np.maximum(lower - moving.max(axis=1), moving.min(axis=1) - upper)
    return np.asarray(np.max(apart, axis=1) - separation.distance)


def _facet_gap(moving: Array, separation: Separation) -> Array:
    """A lower bound (K,) of the gaps, by the facets of the obstacle."""
    obstacle = separation.obstacle
    ahead = np.min(moving @ obstacle.normals.T, axis=1) - obstacle.offsets
    return np.asarray(np.max(ahead, axis=1) - separation.distance)


def _gap(moving: Array, separation: Separation) -> Array:
    normal, support = separating_planes(moving, separation.obstacle)
    nearest = np.min(np.einsum("kd,kwd->kw", normal, moving), axis=1)
    return np.asarray(nearest - support - separation.distance)

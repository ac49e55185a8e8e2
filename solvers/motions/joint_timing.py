"""When a robot is where on a way in joint space: smooth, from rest to rest, with given entries."""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from solvers.motions.corridor import Corridor
from solvers.motions.path_timing import Entries
from solvers.motions.roadmap import JointPath

DENSE = 400
"""Poses on a way that are looked at for when cells are entered."""
ROUNDED = 0.06
"""Corners are rounded over this part of the time."""


def timed(corridor: Corridor, path: JointPath, entries: Entries, steps: int) -> Array:
    """Coordinates (steps + 1, n) along a way that enter the cells at given samples.

    A monotone cubic in time through the gates, half a step before each entry; corners are rounded
    where the body stays clear.
    """
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

    ways = np.linalg.norm(np.diff(path.q, axis=0) * corridor.levers, axis=1)
    along = np.concatenate([[0.0], np.cumsum(ways)])
    if along[-1] <= 0:
        return np.tile(path.q[0], (steps + 1, 1))
    dense = np.linspace(0.0, along[-1], DENSE)
    gates = dense[_gates(corridor, _at(path, along, dense))]
    times = np.array([0.0, *(entry - 0.5 for entry in entries[1:]), float(steps)])
    values = np.array([0.0, *gates, along[-1]])
    slopes = PchipInterpolator(times, values).derivative()(times)
    slopes[0] = slopes[-1] = 0.0
    curve = np.asarray(CubicHermiteSpline(times, values, slopes)(np.arange(steps + 1)))
    q = _at(path, along, np.clip(curve.astype(np.float64), 0.0, along[-1]))
    rounded = _rounded(q, steps)
    clear = corridor.clearance.of(corridor.positions(rounded)).min()
    return rounded if clear >= min(0.0, corridor.clearance.of(corridor.positions(q)).min()) else q


def _at(path: JointPath, along: Array, places: Array) -> Array:
    """Coordinates at lengths along a way."""
    # Nodes that coincide have no way between them.
    kept = np.concatenate([[True], np.diff(along) > 0])
    columns = [np.interp(places, along[kept], column) for column in path.q[kept].T]
    return np.stack(columns, axis=1)


def _gates(corridor: Corridor, q: Array) -> list[int]:
    """The first of dense poses (s, n) that belongs to each cell behind the first."""
    beyond = corridor.beyond(corridor.positions(q))
    gates, at = [], 0
    for cell in range(1, beyond.shape[1]):
        nearer = np.flatnonzero(beyond[at:, cell] <= beyond[at:, cell - 1])
        at = at + int(nearer[0]) if len(nearer) else len(q) - 1
        gates.append(at)
    return gates


def _rounded(q: Array, steps: int) -> Array:
    """Means over a window of samples; both ends stay, as the motion goes on backwards there."""
    half = max(1, round(ROUNDED * steps / 2))
    if len(q) <= 2 * half:
        return q
    before, after = 2 * q[0] - q[half:0:-1], 2 * q[-1] - q[-2 : -half - 2 : -1]
    padded = np.concatenate([before, q, after])
    kernel = np.hanning(2 * half + 3)[1:-1]
    columns = [np.convolve(column, kernel / kernel.sum(), mode="valid") for column in padded.T]
    return np.stack(columns, axis=1)

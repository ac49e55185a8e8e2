"""A few differences of points of two bodies that represent all of them, in many poses at once.

Two hulls of 32 corners have 1,024 differences. The point of their hull nearest to zero is needed.
Gilbert, Johnson and Keerthi's algorithm needs no list of them: the lowest difference in a direction
is that of the lowest point of one body and the highest point of the other. The differences kept are
those between which the nearest point lies, and the lowest ones in its direction. Floats: the result
guides a search.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.hull_distance import GAIN, MOST_ROUNDS, reduced

Indices = NDArray[np.int64]

KEPT = 16
"""The differences kept per pair: twice as many as there are rows in a convex step."""
LOWEST = 4
"""The number of points of each body that are considered for the lowest differences."""
FAR = 1.0
"""If the gap of two boxes exceeds this fraction of their extent, the boxes give the direction."""


def near_differences_of_pairs(
    pairs: Sequence[tuple[Array, Array]],
) -> list[tuple[Indices, Indices]]:
    """``near_differences``, (K, KEPT), for many pairs in K poses, with any numbers of points."""
    count = len(pairs[0][0])
    ones, twos = (_stacked([pair[i] for pair in pairs]) for i in range(2))
    low, high = near_differences(ones, twos)
    # Points were repeated so that all bodies have equally many.
    return [
        (
            np.minimum(low[place : place + count], one.shape[1] - 1),
            np.minimum(high[place : place + count], two.shape[1] - 1),
        )
        for place, (one, two) in zip(range(0, len(low), count), pairs, strict=True)
    ]


def _stacked(bodies: Sequence[Array]) -> Array:
    """The points (K, w, d) of bodies one after another; missing ones repeat the last point."""
    most = max(each.shape[1] for each in bodies)
    filled = (
        np.concatenate([each, np.repeat(each[:, -1:], most - each.shape[1], axis=1)], axis=1)
        for each in bodies
    )
    return np.concatenate(list(filled))


def near_differences(one: Array, two: Array) -> tuple[Indices, Indices]:
    """The points of two bodies whose differences to take: numbers (K, KEPT) for each body.

    The points are (K, a, d) and (K, b, d).
    """
    away, firsts, seconds = _far(one, two)
    near = np.flatnonzero(firsts[:, 0] < 0)
    if len(near):
        away[near], firsts[near], seconds[near] = nearest_differences(one[near], two[near])
    extent = np.ptp(one, axis=1).max(axis=1) + np.ptp(two, axis=1).max(axis=1)
    meeting = np.linalg.norm(away, axis=1) <= 1e-9 * extent
    along = np.where(meeting[:, None], one.mean(axis=1) - two.mean(axis=1), away)
    low, high = _lowest_pairs(one, two, along)
    kept_low = np.concatenate([firsts, low], axis=1)[:, :KEPT]
    kept_high = np.concatenate([seconds, high], axis=1)[:, :KEPT]
    if meeting.any():
        # The bodies separate along an axis or that direction: the lowest differences in these are
        # kept.
        d, size = one.shape[2], firsts.shape[1]
        axes = np.concatenate([np.eye(d), -np.eye(d)])
        places = slice(size, size + 2 * d)
        kept_low[meeting, places] = np.argmin(one[meeting] @ axes.T, axis=1)
        kept_high[meeting, places] = np.argmax(two[meeting] @ axes.T, axis=1)
        rest = KEPT - size - 2 * d
        kept_low[meeting, size + 2 * d :] = low[meeting, :rest]
        kept_high[meeting, size + 2 * d :] = high[meeting, :rest]
    return kept_low, kept_high


def _far(one: Array, two: Array) -> tuple[Array, Indices, Indices]:
    """The directions (K, d) from the boxes, and numbers of points, -1 where bodies are near."""
    least, most = one.min(axis=1), one.max(axis=1)
    lower, upper = two.min(axis=1), two.max(axis=1)
    away = np.maximum(least - upper, 0.0) - np.maximum(lower - most, 0.0)
    extent = np.maximum((most - least).max(axis=1), (upper - lower).max(axis=1))
    near = ~(np.abs(away).max(axis=1) > FAR * extent)
    first = np.argmin(np.einsum("kad,kd->ka", one, away), axis=1)
    second = np.argmax(np.einsum("kbd,kd->kb", two, away), axis=1)
    size = one.shape[2] + 1
    numbers = (np.where(near, -1, each)[:, None] for each in (first, second))
    firsts, seconds = (np.repeat(each, size, axis=1) for each in numbers)
    return away, firsts, seconds


def _lowest_pairs(one: Array, two: Array, along: Array) -> tuple[Indices, Indices]:
    """The lowest differences in a direction (K, d), lowest first, from few of the points."""
    ours, theirs = np.einsum("kad,kd->ka", one, along), -np.einsum("kbd,kd->kb", two, along)
    low = np.argsort(ours, axis=1, kind="stable")[:, :LOWEST]
    high = np.argsort(theirs, axis=1, kind="stable")[:, :LOWEST]
    heights = (
        np.take_along_axis(ours, low, axis=1)[:, :, None]
        + np.take_along_axis(theirs, high, axis=1)[:, None, :]
    ).reshape(len(one), -1)
    order = np.argsort(heights, axis=1, kind="stable")
    first, second = order // high.shape[1], order % high.shape[1]
    filled = -(-KEPT // order.shape[1])
    found = np.take_along_axis(low, first, axis=1), np.take_along_axis(high, second, axis=1)
    return np.tile(found[0], filled), np.tile(found[1], filled)


def nearest_differences(one: Array, two: Array) -> tuple[Array, Indices, Indices]:
    """The points (K, d) nearest to zero of the hulls of differences of (K, a, d) and (K, b, d).

    Also the points (K, d + 1) of each body between whose differences it lies; points are repeated
    if there are fewer.
    """
    ours = np.ascontiguousarray(one.transpose(2, 1, 0))
    theirs = np.ascontiguousarray(two.transpose(2, 1, 0))
    d, _, k = ours.shape
    reach = np.maximum(np.sum(ours**2, axis=0).max(axis=0), np.sum(theirs**2, axis=0).max(axis=0))
    apart = ours.mean(axis=1) - theirs.mean(axis=1)
    scale = np.maximum(reach, np.finfo(float).tiny)
    row, slots = np.arange(k), np.arange(d + 1)[:, None]
    firsts, seconds = np.full((d + 1, k), -1), np.full((d + 1, k), -1)
    firsts[0], seconds[0] = _supports(ours, theirs, apart)
    simplex = np.zeros((d, d + 1, k))
    simplex[:, 0] = ours[:, firsts[0], row] - theirs[:, seconds[0], row]
    nearest, todo = simplex[:, 0].copy(), row
    for _ in range(MOST_ROUNDS):
        x = nearest[:, todo]
        first, second = _supports(ours[:, :, todo], theirs[:, :, todo], x)
        lowest = ours[:, first, todo] - theirs[:, second, todo]
        gain = np.sum(x * x, axis=0) - np.sum(x * lowest, axis=0)
        known = ((firsts[:, todo] == first) & (seconds[:, todo] == second)).any(axis=0)
        full = (firsts[:, todo] >= 0).all(axis=0)
        still = (gain > GAIN * scale[todo]) & ~known & ~full
        todo = todo[still]
        if not len(todo):
            break
        free = np.argmax(firsts[:, todo] < 0, axis=0)
        firsts[free, todo], seconds[free, todo] = first[still], second[still]
        simplex[:, free, todo] = lowest[:, still]
        chosen = np.where(firsts[:, todo] >= 0, slots, -1)
        kept, nearest[:, todo] = reduced(simplex[:, :, todo], chosen, scale[todo])
        firsts[:, todo] = np.where(kept >= 0, firsts[:, todo], -1)
        seconds[:, todo] = np.where(kept >= 0, seconds[:, todo], -1)
    there = np.argmax(firsts >= 0, axis=0)
    filled = (np.where(firsts >= 0, each, each[there, row]).T for each in (firsts, seconds))
    found = tuple(np.ascontiguousarray(each) for each in filled)
    return np.ascontiguousarray(nearest.T), found[0], found[1]


def _supports(ours: Array, theirs: Array, along: Array) -> tuple[Indices, Indices]:
    """The lowest of the points (d, a, k), and the highest of (d, b, k), in directions (d, k)."""
    return (
        np.einsum("dk,dak->ak", along, ours).argmin(axis=0),
        np.einsum("dk,dbk->bk", along, theirs).argmax(axis=0),
    )

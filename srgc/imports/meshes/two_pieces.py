"""Find triangles that two convex pieces hold together, in bulk, in doubles with error bounds.

A point is in neither piece if and only if it is beyond a plane of each.  By the minimax theorem no
point of a triangle is beyond both planes if and only if some weighted mean of their heights is at
most zero at all three corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from srgc.imports.meshes.convex_piece import ROUNDING
from srgc.imports.meshes.mesh import Bools, Floats, Ints
from srgc.imports.meshes.plane_heights import Heights

TRIED = 3
"""Pairs are tried among this many pieces that hold the most corners of a triangle."""
PLANES = 6
"""A piece is not tried if a triangle may be beyond more of its planes than this."""
BLOCK = 4096
"""The number of triangles that are processed together."""


def in_two(sides: Floats, pieces: Sequence[Heights]) -> Bools:
    """Which triangles (n, 3, 3) two pieces together hold for sure; False is not conclusive."""
    found = np.zeros(len(sides), dtype=bool)
    for start in range(0, len(sides), BLOCK):
        block = slice(start, start + BLOCK)
        found[block] = _block(sides[block], pieces)
    return found


@dataclass(frozen=True, slots=True)
class _Met:
    """Pairs of a triangle and a piece, with the planes that the triangle may be beyond.

    ``heights`` (m, 3, p) are the heights of its corners, ``doubts`` (m, p) bounds on their errors,
    and ``valid`` (m, p) says which entries are planes.
    """

    triangles: Ints
    inside: Ints
    heights: Floats
    doubts: Floats
    valid: Bools


def _block(sides: Floats, pieces: Sequence[Heights]) -> Bools:
    lower, upper = sides.min(axis=1), sides.max(axis=1)
    met = [*_meetings(sides, lower, upper, pieces)]
    found = np.zeros(len(sides), dtype=bool)
    if not met:
        return found
    triangles = np.concatenate([each.triangles for each in met])
    inside = np.concatenate([each.inside for each in met])
    heights = np.concatenate([each.heights for each in met])
    doubts = np.concatenate([each.doubts for each in met])
    valid = np.concatenate([each.valid for each in met])
    table = _likely(triangles, inside, len(sides))
    for one, other in combinations(range(TRIED), 2):
        due = np.flatnonzero(~found & (table[:, one] >= 0) & (table[:, other] >= 0))
        first, second = table[due, one], table[due, other]
        within = _union_holds(heights[first], doubts[first], heights[second], doubts[second])
        within |= ~valid[first][:, :, None] | ~valid[second][:, None, :]
        found[due] = within.all(axis=(1, 2))
    return found


def _meetings(
    sides: Floats, lower: Floats, upper: Floats, pieces: Sequence[Heights]
) -> Iterator[_Met]:
    for each in pieces:
        near = np.flatnonzero(((lower <= each.upper) & (upper >= each.lower)).all(axis=1))
        if not len(near):
            continue
        over, doubt = each.over(sides[near])
        above: Bools = over > doubt[:, None]
        beyond: Bools = over > -doubt[:, None]
        apart: Bools = np.logical_or.reduce(np.logical_and.reduce(above, axis=1), axis=1)
        crossed: Bools = np.logical_or.reduce(beyond, axis=1)
        rows = np.flatnonzero(~apart & (crossed.sum(axis=1) <= PLANES))
        order = np.argsort(~crossed[rows], axis=1, kind="stable")[:, :PLANES]
        missing = PLANES - order.shape[1]
        chosen = np.take_along_axis(over[rows], order[:, None], axis=2)
        yield _Met(
            near[rows],
            (~beyond[rows]).all(axis=2).sum(axis=1),
            np.pad(chosen, ((0, 0), (0, 0), (0, missing))),
            np.pad(np.take_along_axis(doubt[rows], order, axis=1), ((0, 0), (0, missing))),
            np.pad(np.take_along_axis(crossed[rows], order, axis=1), ((0, 0), (0, missing))),
        )


def _likely(triangles: Ints, inside: Ints, count: int) -> Ints:
    """For each triangle the rows (count, TRIED) that hold most of its corners, padded with -1."""
    order = np.lexsort((np.arange(len(triangles)), -inside, triangles))
    owner = triangles[order]
    rank = np.arange(len(order)) - np.searchsorted(owner, owner)
    kept = rank < TRIED
    table = np.full((count, TRIED), -1)
    table[owner[kept], rank[kept]] = order[kept]
    return table


def _union_holds(one: Floats, doubt: Floats, other: Floats, other_doubt: Floats) -> Bools:
    """For which pairs of planes (m, p, q) no point of the triangle is beyond both."""
    a, b = one[:, :, :, None], other[:, :, None, :]
    bound = doubt[:, :, None] + other_doubt[:, None, :]
    bound = bound + ROUNDING * (np.abs(a).max(axis=1) + np.abs(b).max(axis=1))
    # The share s that makes s a + (1 - s) b least at the worst corner lies between bounds from
    # the corners.  Any share is sound, since the mean is checked afterwards.
    slope, rest = a - b, -b - bound[:, None]
    with np.errstate(all="ignore"):
        limit = rest / slope
    most = np.where(slope > 0, limit, 1.0).min(axis=1)
    least = np.where(slope < 0, limit, 0.0).max(axis=1)
    share = np.clip((np.clip(least, 0.0, 1.0) + np.clip(most, 0.0, 1.0)) / 2, 0.0, 1.0)
    mean = share[:, None] * a + (1 - share[:, None]) * b
    held: Bools = np.less_equal(mean, -bound[:, None]).all(axis=1)
    return held

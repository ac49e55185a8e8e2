"""The points nearest to zero of many convex hulls, computed all at once.

Gilbert, Johnson and Keerthi's algorithm keeps a simplex of at most d + 1 points of a hull, whose
point nearest to zero determines the next point. Here every step is carried out for all hulls.
Arrays have hulls last and coordinates first.

Source: Gilbert, Johnson, Keerthi, *A fast procedure for computing the distance between complex
objects in three-dimensional space* (1988).
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array

Flags = NDArray[np.bool_]

MOST_ROUNDS = 40
GAIN = 1e-14
"""A smaller gain than this fraction of the largest square does not count as nearer."""
FLAT = 1e-14
"""A simplex is flat if its squared volume is below this fraction of that of a cube."""


def nearest_to_zero(points: Array) -> Array:
    """The points (k, d) nearest to zero of the hulls of w points, (k, w, d) each.

    If a hull contains zero, or nearly so, the point is zero up to rounding.
    """
    p = np.ascontiguousarray(points.transpose(2, 1, 0))
    d, _, k = p.shape
    squares = np.sum(p**2, axis=0)
    scale = np.maximum(squares.max(axis=0), np.finfo(float).tiny)
    row = np.arange(k)
    simplex = np.full((d + 1, k), -1)
    simplex[0] = squares.argmin(axis=0)
    nearest = p[:, simplex[0], row]
    todo = row
    for _ in range(MOST_ROUNDS):
        x, part = nearest[:, todo], p[:, :, todo]
        along = np.einsum("dk,dwk->wk", x, part)
        best = along.argmin(axis=0)
        gain = np.sum(x * x, axis=0) - along[best, np.arange(len(todo))]
        known = (simplex[:, todo] == best).any(axis=0)
        full = (simplex[:, todo] >= 0).all(axis=0)
        still = (gain > GAIN * scale[todo]) & ~known & ~full
        todo = todo[still]
        if not len(todo):
            break
        chosen = simplex[:, todo]
        free = np.argmax(chosen < 0, axis=0)
        chosen[free, np.arange(len(todo))] = best[still]
        simplex[:, todo], nearest[:, todo] = reduced(p[:, :, todo], chosen, scale[todo])
    return np.ascontiguousarray(nearest.T)


def reduced(points: Array, chosen: Array, scale: Array) -> tuple[Array, Array]:
    """The least face (d + 1, k) of each simplex with its point nearest to zero, and it (d, k)."""
    d, _, k = points.shape
    corners = points[:, np.maximum(chosen, 0), np.arange(k)]
    there = chosen >= 0
    least, place = np.full(k, np.inf), np.zeros((d, k))
    kept = np.full_like(chosen, -1)
    for size in range(1, d + 2):
        for face in combinations(range(d + 1), size):
            shares, known = _shares(corners[:, face, :], scale)
            sound = known & there[list(face)].all(axis=0) & (shares >= 0).all(axis=0)
            at = np.einsum("fk,dfk->dk", shares, corners[:, face, :])
            square = np.where(sound, np.sum(at * at, axis=0), np.inf)
            better = square < least
            if better.any():
                least = np.where(better, square, least)
                place = np.where(better, at, place)
                members = np.full_like(chosen, -1)
                members[list(face)] = chosen[list(face)]
                kept = np.where(better, members, kept)
    return kept, place


def _shares(corners: Array, scale: Array) -> tuple[Array, Flags]:
    """The weights (f, k) of the point nearest to zero of the plane through corners (d, f, k).

    Also returns whether they are known, that is, whether the corners are not flat.
    """
    count, k = corners.shape[1:]
    if count == 1:
        return np.ones((1, k)), np.ones(k, dtype=bool)
    edges = corners[:, 1:] - corners[:, :1]
    gram = np.einsum("dak,dbk->abk", edges, edges)
    right = -np.einsum("dak,dk->ak", edges, corners[:, 0])
    if count == 2:
        volume, solved = gram[0, 0], right
    elif count == 3:
        (a, b), (_, c) = gram
        volume = a * c - b * b
        solved = np.stack([c * right[0] - b * right[1], a * right[1] - b * right[0]])
    else:
        volume, solved = _cramer(gram, right)
    sound = volume > FLAT * scale ** (count - 1)
    weights = solved / np.where(sound, volume, 1.0)
    return np.concatenate([1 - weights.sum(axis=0, keepdims=True), weights]), sound


def _cramer(gram: Array, right: Array) -> tuple[Array, Array]:
    """The determinant (k,) of symmetric matrices (3, 3, k), and it times their solutions (3, k)."""
    (a, b, c), (_, e, f), (_, _, i) = gram
    cofactors = np.stack(
        [
            np.stack([e * i - f * f, c * f - b * i, b * f - c * e]),
            np.stack([c * f - b * i, a * i - c * c, b * c - a * f]),
            np.stack([b * f - c * e, b * c - a * f, a * e - b * b]),
        ]
    )
    determinant = a * cofactors[0, 0] + b * cofactors[0, 1] + c * cofactors[0, 2]
    return determinant, np.einsum("abk,bk->ak", cofactors, right)

"""A convex piece about points: few corners, short decimals, and surely all points inside."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from srgc.imports.meshes.containment import beyond, polygon_of, surely_inside
from srgc.imports.meshes.convex_piece import LARGEST, MOST_CORNERS, ConvexPiece, convex_piece
from srgc.imports.meshes.few_corners import few_corners, hull_corners, principal_axes
from srgc.imports.meshes.mesh import Floats

FINE = 1000
"""The grid is finer than so many parts of the least width of a piece."""
LEAST_DIGITS, MOST_DIGITS = 3, 9
THINNEST, THINNEST_SHARE = 1e-5, 1e-4
"""A piece is at least so thick, in metres and as a share of its size."""


@dataclass(frozen=True, slots=True)
class Enclosed:
    """A piece, and whether it had to be made thicker to have an interior."""

    piece: ConvexPiece
    thickened: bool


def enclosing(points: Floats) -> Enclosed:
    """A convex piece that holds the points (n, 3), n >= 1, in metres.

    It is deterministic, and holds them exactly: this is checked here, and it grows until it does.
    """
    points = np.unique(points, axis=0)
    points, thickened, width = _full(points)
    corners = few_corners(hull_corners(points), MOST_CORNERS)
    digits = _digits(corners, width)
    for rounded in _roundings(corners, digits, 10.0**-digits / width):
        piece = convex_piece((tuple(map(int, row)) for row in rounded.tolist()), digits)
        if piece is not None and holds(piece, points):
            return Enclosed(piece, thickened)
    raise ArithmeticError("no piece of the grid holds the points")


def _roundings(corners: Floats, digits: int, step: float) -> Iterator[Floats]:
    """The corners in steps of the grid: the nearest, then farther and farther from their middle."""
    yield np.rint(corners * 10.0**digits)
    middle = corners.mean(axis=0)
    for power in range(-1, 40):
        farther = corners if power < 0 else middle + (1 + step * 2.0**power) * (corners - middle)
        yield np.array(
            [
                [_away(x, m, digits) for x, m in zip(row, middle.tolist(), strict=True)]
                for row in farther.tolist()
            ]
        )


def _away(value: float, middle: float, digits: int) -> int:
    """The step of the grid next to a value, on the side that is away from the middle; exact."""
    steps = Fraction(value) * 10**digits
    return math.ceil(steps) if value >= middle else math.floor(steps)


def holds(piece: ConvexPiece, points: Floats) -> bool:
    """Whether a piece holds all points (n, 3), exactly."""
    sure = surely_inside(points, piece)
    return not any(beyond([polygon_of(p[None])], [piece]) for p in points[~sure])


def _full(points: Floats) -> tuple[Floats, bool, float]:
    """The corners of the hull of points, whether they are thickened, and their least width."""
    size = float(np.ptp(points, axis=0).max())
    least = max(THINNEST, THINNEST_SHARE * size)
    if len(points) < 3:
        points = np.concatenate([points, points, points])
    axes = principal_axes(points)
    along = (points - points[0]) @ axes.T
    widths = np.ptp(along, axis=0)
    thickened = False
    for axis in range(3):
        if widths[axis] < least:
            half = (least - widths[axis]) / 2 + least / 100
            points = np.concatenate([points - half * axes[axis], points + half * axes[axis]])
            thickened = True
    return hull_corners(points), thickened, max(float(widths.min()), least)


def _digits(corners: Floats, width: float) -> int:
    """So many decimals that the grid is fine against the width, and the corners fit on it."""
    digits = max(LEAST_DIGITS, math.ceil(-math.log10(width / FINE)))
    size = float(np.ptp(corners, axis=0).max())
    return min(digits, MOST_DIGITS, math.floor(math.log10(LARGEST / (4 * size))))

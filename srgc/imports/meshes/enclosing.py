"""Enclose points in a convex piece with few corners that are short decimals, exactly."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from srgc.imports.meshes.containment import polygon_of, surely_inside
from srgc.imports.meshes.convex_piece import LARGEST, MOST_CORNERS, ConvexPiece, convex_piece
from srgc.imports.meshes.few_corners import few_corners, hull_corners, principal_axes
from srgc.imports.meshes.mesh import Floats

FINE = 1000
"""The grid step is at most the least width of a piece divided by this."""
SAME = 1e-9
"""Coordinates that differ by less than this share of the size are equal up to rounding."""
LEAST_DIGITS, MOST_DIGITS = 3, 9
FEW, OWN_DIGITS = 8, 6
"""Pieces with few corners whose coordinates have few decimals keep them exactly."""
THINNEST, THINNEST_SHARE = 1e-5, 1e-4
"""The least thickness of a piece, in metres and as a share of its size."""


@dataclass(frozen=True, slots=True)
class Enclosed:
    """A piece, and whether it had to be made thicker to have an interior."""

    piece: ConvexPiece
    thickened: bool


def enclosing(points: Floats, fine: int = FINE, slack: float = 0.0) -> Enclosed:
    """A convex piece that holds the points (n, 3), n >= 1, in metres.

    The result is deterministic.  It is checked to hold the points exactly, and grows until it does.
    ``fine`` is the least number of grid steps in its least width.  With a ``slack`` (m) it holds
    the points to within that in each coordinate, and coordinates this close to a grid step are
    rounded to it: 0.1 as a double is slightly more than the 1/10 that was meant.

    Raises:
        ArithmeticError: no piece of the grid holds the points, a bug.
    """
    points, thickened, width = _full(np.unique(points, axis=0))
    corners = few_corners(points, MOST_CORNERS)
    digits = _digits(corners, width / fine)
    if slack and len(corners) <= FEW:
        digits = _own_digits(corners, digits, slack)
    for rounded in _roundings(corners, digits, 10.0**-digits / width, slack):
        piece = convex_piece(((int(x), int(y), int(z)) for x, y, z in rounded.tolist()), digits)
        if piece is not None and holds(piece, points, slack):
            return Enclosed(piece, thickened)
    raise ArithmeticError("no piece of the grid holds the points")


def _roundings(corners: Floats, digits: int, step: float, slack: float) -> Iterator[Floats]:
    """The corners in grid steps: first the nearest, then farther and farther from their centre."""
    yield np.rint(corners * 10.0**digits)
    middle = corners.mean(axis=0)
    level = _level(corners, middle)
    for power in range(-1, 40):
        farther = level if power < 0 else middle + (1 + step * 2.0**power) * (level - middle)
        yield np.array(
            [
                [_away(x, m, digits, slack) for x, m in zip(row, middle.tolist(), strict=True)]
                for row in farther.tolist()
            ]
        )


def _level(corners: Floats, middle: Floats) -> Floats:
    """The corners; coordinates equal up to rounding become the one farthest from the centre.

    So corners of a flat side stay in one plane.
    """
    found = corners.copy()
    near = SAME * float(np.ptp(corners, axis=0).max())
    for axis in range(3):
        order = np.argsort(corners[:, axis], kind="stable")
        breaks = np.flatnonzero(np.diff(corners[order, axis]) > near) + 1
        for group in np.split(order, breaks):
            values = corners[group, axis]
            found[group, axis] = values.max() if values.mean() >= middle[axis] else values.min()
    return found


def _away(value: float, middle: float, digits: int, slack: float) -> int:
    """The grid step next to a value on the side away from the centre, exactly.

    A step within the slack is used as it is.
    """
    steps = Fraction(value) * Fraction(10) ** digits
    if slack and abs(steps - round(steps)) <= Fraction(slack) * 10**digits:
        return round(steps)
    return math.ceil(steps) if value >= middle else math.floor(steps)


def holds(piece: ConvexPiece, points: Floats, slack: float = 0.0) -> bool:
    """Whether a piece holds all points (n, 3), exactly or to within a slack (m) along the axes."""
    sure = surely_inside(points, piece)
    more = Fraction(slack) * 10**piece.digits
    limits = [d + more * (abs(a) + abs(b) + abs(c)) for a, b, c, d in piece.planes]
    return not any(
        (a * x + b * y + c * z) * 10**piece.digits > limit
        for point in points[~sure]
        for x, y, z in polygon_of(point[None])
        for (a, b, c, _), limit in zip(piece.planes, limits, strict=True)
    )


def _full(points: Floats) -> tuple[Floats, bool, float]:
    """The corners of the hull of points, whether it was thickened, and its least width."""
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


def _own_digits(corners: Floats, digits: int, slack: float) -> int:
    """The number of decimals that the corners have if it is small, otherwise ``digits``."""
    most = min(OWN_DIGITS, _most_digits(corners))
    for own in range(digits, most + 1):
        steps = corners * 10.0**own
        if np.abs(steps - np.rint(steps)).max() <= slack * 10.0**own:
            return own
    return digits


def _most_digits(corners: Floats) -> int:
    """The number of decimals of the finest grid that can represent the corners."""
    size = float(np.ptp(corners, axis=0).max())
    return min(MOST_DIGITS, math.floor(math.log10(LARGEST / (4 * size))))


def _digits(corners: Floats, step: float) -> int:
    """The number of decimals of a grid with at most this step, if it can represent the corners."""
    digits = max(LEAST_DIGITS, math.ceil(-math.log10(step)))
    return min(digits, _most_digits(corners))

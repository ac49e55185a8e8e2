"""A convex polytope with few corners that are short decimals, and its exact planes.

The corners are integers on a grid of 10^-k metres.  The planes of their hull are found by trying
all triples of corners: with at most 32 corners that is quick, and no hull algorithm has to be
trusted.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
from typing import TypeAlias

import numpy as np

from srgc.imports.meshes.mesh import Floats, Ints

MOST_CORNERS = 32
"""The language replaces a hull with more corners by 26 planes (decision 110)."""
LARGEST = 1 << 29
"""Corners differ by less than this, in grid steps: cross products are then exact in 64 bits."""
ROUNDING = 2.0**-49
"""A bound on the relative rounding error of four products and sums in doubles."""

IntPoint: TypeAlias = tuple[int, int, int]
Plane: TypeAlias = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True)
class ConvexPiece:
    """The convex hull of points on a grid.

    ``corners`` times 10^-``digits`` m are its corners, sorted; none lies in the hull of the others.
    ``planes`` are primitive (a, b, c, d): the piece is where a x + b y + c z <= d holds for all of
    them, with x, y, z in steps of the grid.
    """

    corners: tuple[IntPoint, ...]
    digits: int
    planes: tuple[Plane, ...]

    def points(self) -> Floats:
        """The corners (c, 3) in metres, in doubles."""
        return np.array(
            [[float(Fraction(x, 10**self.digits)) for x in corner] for corner in self.corners]
        )

    def decimals(self) -> tuple[tuple[str, str, str], ...]:
        """The corners in metres, as exact decimals."""
        return tuple(
            (
                decimal_text(x, self.digits),
                decimal_text(y, self.digits),
                decimal_text(z, self.digits),
            )
            for x, y, z in self.corners
        )

    def box(self) -> tuple[IntPoint, IntPoint] | None:
        """The least and the greatest corner if the piece is an axis-aligned box, otherwise None."""
        if len(self.planes) != 6 or any(sum(map(bool, plane[:3])) != 1 for plane in self.planes):
            return None
        return self.corners[0], self.corners[-1]

    def outward(self) -> tuple[tuple[int, int, int], ...]:
        """A triangulation of the surface by indices of corners, counter-clockwise from outside."""
        found: list[tuple[int, int, int]] = []
        for plane in self.planes:
            on = [i for i, corner in enumerate(self.corners) if height(plane, corner) == 0]
            ring = _around(plane, on, self.corners)
            found += [(ring[0], b, c) for b, c in pairwise(ring[1:])]
        return tuple(found)


def height(plane: Plane, point: IntPoint) -> int:
    """A multiple of the height above a plane: negative inside, zero on it."""
    a, b, c, d = plane
    return a * point[0] + b * point[1] + c * point[2] - d


def convex_piece(points: Iterable[IntPoint], digits: int) -> ConvexPiece | None:
    """The hull of points on a grid of 10^-``digits`` metres, digits >= 0; None if it is flat.

    Raises:
        ValueError: there are more than twice :data:`MOST_CORNERS` points, they are too far apart
            for the grid, or the grid is coarser than a metre.
    """
    if digits < 0:
        raise ValueError("a grid of a metre or finer is expected")
    given = sorted(set(points))
    if len(given) < 4:
        return None
    origin = given[0]
    local = np.array([[x - o for x, o in zip(p, origin, strict=True)] for p in given], dtype=object)
    if len(given) > 2 * MOST_CORNERS or max(map(abs, local.flat)) >= LARGEST:
        raise ValueError("so many corners, or corners so far apart, are no piece of this grid")
    found = _planes(local.astype(np.int64))
    if len(found) < 4:
        return None
    planes = tuple(
        (a, b, c, d + a * origin[0] + b * origin[1] + c * origin[2]) for a, b, c, d in found
    )
    corners = tuple(p for p in given if _is_corner(p, planes))
    return ConvexPiece(corners, digits, planes)


def _planes(points: Ints) -> list[Plane]:
    """The supporting planes through three of the points (n, 3), sorted; empty if all are flat.

    Doubles only select candidate triples; integers decide.
    """
    triples = np.array(list(combinations(range(len(points)), 3)))
    first = points[triples[:, 0]]
    normals = np.cross(points[triples[:, 1]] - first, points[triples[:, 2]] - first)
    kept = normals.any(axis=1)
    normals, first = normals[kept], first[kept]
    floats = normals.astype(np.float64)
    heights = floats @ points.T.astype(np.float64)
    heights -= np.einsum("ij,ij->i", floats, first.astype(np.float64))[:, None]
    size = np.abs(floats).sum(axis=1) * (2.0 * np.abs(points).max())
    doubt = (ROUNDING * size)[:, None]
    found = set[Plane]()
    for sign in (1, -1):
        side = np.flatnonzero((sign * heights <= doubt).all(axis=1))
        found |= _supporting(_distinct(sign * normals[side], first[side]), points)
    # A flat set has its plane twice, with opposite signs, and no interior.
    return sorted(found) if _spans(found) else []


def _distinct(normals: Ints, through: Ints) -> set[Plane]:
    divisors = np.gcd.reduce(normals, axis=1)
    primitive = normals // divisors[:, None]
    rows = set[Plane]()
    for (a, b, c), (x, y, z) in zip(primitive.tolist(), through.tolist(), strict=True):
        rows.add((a, b, c, a * x + b * y + c * z))
    return rows


def _supporting(planes: set[Plane], points: Ints) -> set[Plane]:
    """The planes that no point is beyond, decided exactly."""
    if not planes:
        return planes
    rows = sorted(planes)
    largest = max(max(map(abs, row)) for row in rows)
    # In 64 bits if nothing can overflow, otherwise in Python's integers.
    exact = np.int64 if 8 * largest * (int(np.abs(points).max()) + 1) < 1 << 62 else object
    array = np.array(rows, dtype=object).astype(exact)
    beyond = (array[:, :3] @ points.T.astype(exact) > array[:, 3:]).any(axis=1)
    return {row for row, bad in zip(rows, beyond.tolist(), strict=True) if not bad}


def _spans(planes: set[Plane]) -> bool:
    return not any((-a, -b, -c, -d) in planes for a, b, c, d in planes)


def _is_corner(point: IntPoint, planes: tuple[Plane, ...]) -> bool:
    """Whether the normals of the planes through the point span space."""
    on = [plane[:3] for plane in planes if height(plane, point) == 0]
    return any(
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
        for a, b, c in combinations(on, 3)
    )


def _around(plane: Plane, on: list[int], corners: tuple[IntPoint, ...]) -> list[int]:
    """The corners of a facet, counter-clockwise from outside, beginning with the least index."""
    drop = max(range(3), key=lambda axis: abs(plane[axis]))
    u, v = [axis for axis in range(3) if axis != drop]
    if (plane[drop] > 0) == (drop == 1):
        u, v = v, u
    flat = {(corners[i][u], corners[i][v]): i for i in on}
    ordered = sorted(flat)
    ring = [*_chain(ordered)[:-1], *_chain(ordered[::-1])[:-1]]
    numbers = [flat[point] for point in ring]
    start = numbers.index(min(numbers))
    return [*numbers[start:], *numbers[:start]]


def _chain(points: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """One half of the hull by Andrew's monotone chain."""
    chain: list[tuple[int, int]] = []
    for x, y in points:
        while len(chain) >= 2:
            (ax, ay), (bx, by) = chain[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            chain.pop()
        chain.append((x, y))
    return chain


def decimal_text(value: int, digits: int) -> str:
    """``value`` times 10^-``digits``, without trailing zeros."""
    sign, size = ("-" if value < 0 else ""), abs(value)
    if digits <= 0:
        return f"{sign}{size * 10**-digits}"
    whole, part = divmod(size, 10**digits)
    shown = f"{part:0{digits}d}".rstrip("0")
    return f"{sign}{whole}.{shown}" if shown else f"{sign}{whole}"

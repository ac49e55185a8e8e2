"""Heights of points above the planes of a convex piece: in doubles with error bounds, or exact."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from srgc.imports.meshes.convex_piece import ROUNDING, ConvexPiece, Plane
from srgc.imports.meshes.exact_places import ExactPlaces, Point
from srgc.imports.meshes.mesh import Bools, Floats, Ints


class Crossing(NamedTuple):
    """The planes of a piece that a triangle may cross, with the heights of its corners (3, f).

    The triangle is in the halfspaces of all other planes for sure.  ``scale`` is the number of
    units of the planes in a metre.
    """

    planes: tuple[Plane, ...]
    scale: int
    heights: Floats
    doubt: Floats


class Heights:
    """Heights of points above the planes of a piece in doubles, with error bounds."""

    def __init__(self, piece: ConvexPiece, shift: float = 0.0) -> None:
        """Prepare for points whose coordinates are within ``shift`` (m) of the exact ones."""
        self.piece, self.shift = piece, shift
        self.scale = 10.0**piece.digits
        planes = np.array(piece.planes, dtype=object)
        self.origin = np.array([float(x) for x in piece.corners[0]])
        # Integer offsets from a corner avoid differences of large numbers in heights.
        local = planes[:, 3] - planes[:, :3] @ np.array(piece.corners[0], dtype=object)
        self.normals = planes[:, :3].astype(np.float64)
        self.offsets = local.astype(np.float64)
        self.weights = np.abs(self.normals).sum(axis=1)
        points = np.array(piece.corners, dtype=np.float64) / self.scale
        slack = 1e-9 * np.abs(points).max() + 2 * shift + 1e-300
        self.lower, self.upper = points.min(axis=0) - slack, points.max(axis=0) + slack

    def of(self, points: Floats) -> tuple[Floats, Floats]:
        """The heights (n, f) of points (n, 3) above the planes, and bounds on their errors."""
        scaled = points * self.scale
        local = scaled - self.origin
        size = (np.abs(scaled) + np.abs(self.origin)).max(axis=1, initial=0.0) + 1.0
        found = local @ self.normals.T - self.offsets
        doubt = ROUNDING * (size[:, None] * self.weights + np.abs(self.offsets))
        return found, doubt + 2 * self.shift * self.scale * self.weights

    def surely_hold(self, points: Floats) -> Bools:
        """Whether each of the points (n, 3) is in the piece for sure."""
        held: Bools = ((points >= self.lower) & (points <= self.upper)).all(axis=1)
        near = np.flatnonzero(held)
        found, doubt = self.of(points[near])
        held[near] = (found <= -doubt).all(axis=1)
        return held

    def around(self, lower: Floats, upper: Floats) -> Ints:
        """The indices of the boxes (m, 3) that lie in the bounding box of the piece."""
        near = (lower >= self.lower) & (upper <= self.upper)
        return np.flatnonzero(near.all(axis=1))

    def hold(self, vertices: Floats, places: ExactPlaces, triangles: Ints) -> Bools:
        """Which triangles (m, 3) have all their corners in the piece, exactly."""
        used, corners = np.unique(triangles, return_inverse=True)
        corners = corners.reshape(-1, 3)
        points = vertices[used]
        within = np.flatnonzero(((points >= self.lower) & (points <= self.upper)).all(axis=1))
        found, doubt = self.of(points[within])
        sure = np.zeros(len(used), dtype=bool)
        sure[within] = (found <= -doubt).all(axis=1)
        may = np.zeros(len(used), dtype=bool)
        may[within] = (found <= doubt).all(axis=1)
        open_to = np.zeros(len(used), dtype=bool)
        open_to[corners[may[corners].all(axis=1)]] = True
        beyond: Bools = np.greater(found, -doubt)
        for row in np.flatnonzero((open_to & may & ~sure)[within]).tolist():
            point = places.of(int(used[within[row]]))
            sure[within[row]] = all(
                self._holds(self.piece.planes[i], point) for i in np.flatnonzero(beyond[row])
            )
        held: Bools = np.logical_and.reduce(sure[corners], axis=1)
        return held

    def _holds(self, plane: Plane, point: Point) -> bool:
        a, b, c, d = plane
        x, y, z = point
        return bool((a * x + b * y + c * z) * 10**self.piece.digits <= d)

    def over(self, sides: Floats) -> tuple[Floats, Floats]:
        """The heights (n, 3, f) of the corners of triangles (n, 3, 3), and error bounds (n, f).

        The bounds also hold for weighted means of the corners.
        """
        found, doubts = self.of(sides.reshape(-1, 3))
        found = found.reshape(len(sides), 3, len(self.offsets))
        doubt = doubts.reshape(found.shape).max(axis=1) + ROUNDING * np.abs(found).max(axis=1)
        return found, doubt

    def crossings(self, numbers: Ints, sides: Floats) -> Iterator[tuple[int, Crossing]]:
        """How triangles (n, 3, 3) meet the piece, with their numbers; omit those apart for sure."""
        found, doubt = self.over(sides)
        above: Bools = found > doubt[:, None]
        beyond: Bools = found > -doubt[:, None]
        apart: Bools = np.logical_or.reduce(np.logical_and.reduce(above, axis=1), axis=1)
        crossed: Bools = np.logical_or.reduce(beyond, axis=1)
        scale = 10**self.piece.digits
        for row in np.flatnonzero(~apart).tolist():
            chosen = np.flatnonzero(crossed[row])
            planes = tuple(self.piece.planes[i] for i in chosen.tolist())
            crossing = Crossing(planes, scale, found[row][:, chosen], doubt[row][chosen])
            yield int(numbers[row]), crossing

"""Parts of a mesh, each to be held by one convex piece, and how to split them, in doubles.

Solids are cut by planes.  The triangles of a shell are divided, but none is cut.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from srgc.imports.meshes.enclosing import Enclosed, enclosing
from srgc.imports.meshes.few_corners import hull_of, hull_volume, principal_axes
from srgc.imports.meshes.hull_estimates import Estimates, estimated_volume
from srgc.imports.meshes.mesh import Bools, Floats, Ints
from srgc.imports.meshes.solids import connected

if TYPE_CHECKING:
    from manifold3d import Manifold

GAIN = 0.02
"""If a split saves less than this share of the hull, the part is halved across its length."""


NEAR = 2.0**-48
"""The error of the points of a region, as a share of their size."""


class Region(ABC):
    """A part of a mesh: ``points`` (n, 3) with their hull, and the ``volume`` of its solids."""

    def __init__(self, points: Floats, volume: float) -> None:
        self.points, inside = hull_of(points)
        self.volume = volume
        self.hull_volume = max(inside, volume)

    @property
    def excess(self) -> float:
        """The volume that its hull adds (m^3)."""
        return self.hull_volume - self.volume

    @cached_property
    def enclosed(self) -> Enclosed:
        """The piece that holds it, up to the rounding of its points."""
        return enclosing(self.points, slack=NEAR * float(np.abs(self.points).max()))

    @cached_property
    def piece_volume(self) -> float:
        """The volume of the piece that holds it (m^3)."""
        return hull_volume(self.enclosed.piece.points())

    @abstractmethod
    def split(self) -> list[Region]:
        """The regions that replace this one; only itself if it cannot be split."""


class MergedRegion(Region):
    """Two regions to be held by one piece."""

    def __init__(self, one: Region, other: Region) -> None:
        super().__init__(np.concatenate([one.points, other.points]), one.volume + other.volume)
        self.pair = (one, other)

    def split(self) -> list[Region]:
        """The two regions."""
        return list(self.pair)


class PointRegion(Region):
    """Points to be held by one piece: a hull from another source."""

    def __init__(self, points: Floats) -> None:
        super().__init__(points, 0.0)

    def split(self) -> list[Region]:
        """Only itself."""
        return [self]


# --- Solids ---------------------------------------------------------------------------------------


COARSE = 3000
"""Planes are searched on a mesh with at most about this many triangles."""
MOST_TOLERANCE = 5e-3
"""The error of the simplified mesh, as a share of its size: thin walls have to remain."""
SHORTLIST = 6
"""For this many planes the hulls are computed, not estimated."""
PLACES = 5
"""The number of positions that are tried first along each axis."""
PARALLEL = 0.999
"""A principal axis this close to an axis of the world is not tried separately."""
FACETS = 20
"""The number of planes of large flat parts of the surface that are tried."""


class SolidRegion(Region):
    """A connected solid."""

    def __init__(self, solid: Manifold) -> None:
        super().__init__(_vertices(solid), float(solid.volume()))
        self.solid = solid

    def split(self) -> list[Region]:
        """The parts on both sides of a plane."""
        for normal, offset in self._planes():
            sides = self.solid.split_by_plane(normal.tolist(), offset)
            parts = [part for side in sides for part in connected(side)]
            found = [part for part in parts if part.volume() > 1e-9 * self.volume]
            if len(found) >= 2:
                return [SolidRegion(part) for part in found]
            # A cut along a flat side may have left a flap without volume, which is dropped here.
            if found and found[0].hull().volume() < (1 - GAIN) * self.hull_volume:
                return [SolidRegion(found[0])]
        return [self]

    def _planes(self) -> list[tuple[Floats, float]]:
        """Candidate planes to cut along, the best first."""
        points, triangles = _coarse(self.solid)
        axes = principal_axes(points)
        estimates = Estimates(points, _edge_ends(triangles))
        tried: list[tuple[float, int, Floats, float]] = []

        def attempt(normal: Floats, offset: float) -> None:
            tried.append((estimates.both_sides(normal, offset), len(tried), normal, offset))

        for normal, offset in _facet_planes(points, triangles):
            attempt(normal, offset)
        sweeps = [*np.eye(3), *(a for a in axes if np.abs(a).max() < PARALLEL)]
        for axis in sweeps:
            along = points @ axis
            for share in np.arange(1, PLACES + 1) / (PLACES + 1):
                attempt(axis, float(along.min() + share * np.ptp(along)))
        for _, _, normal, offset in sorted(tried, key=lambda each: each[:2])[:2]:
            step = float(np.ptp(points @ normal)) / (PLACES + 1)
            for share in (-0.5, -0.25, 0.25, 0.5):
                attempt(normal, offset + share * step)
        tried.sort(key=lambda each: each[:2])
        likely = [(normal, offset) for _, _, normal, offset in tried[:SHORTLIST]]
        totals = [estimates.both_hulls(normal, offset) for normal, offset in likely]
        along = points @ axes[0]
        halves = (axes[0], float(along.min() + along.max()) / 2)
        chosen = [likely[i] for i in np.argsort(totals, kind="stable").tolist()]
        if min(totals) > (1 - GAIN) * hull_volume(points):
            return [halves, *chosen]
        return [*chosen, halves]


def _vertices(solid: Manifold) -> Floats:
    found: Floats = np.asarray(solid.to_mesh64().vert_properties, dtype=np.float64)[:, :3]
    return found


def _coarse(solid: Manifold) -> tuple[Floats, Ints]:
    """Vertices and triangles of a solid, simplified if it has many."""
    box = solid.bounding_box()
    size = max(box[3] - box[0], box[4] - box[1], box[5] - box[2])
    tolerance = 5e-4 * size
    while solid.num_tri() > COARSE and tolerance < MOST_TOLERANCE * size:
        simpler = solid.simplify(tolerance)
        if simpler.is_empty():
            break
        solid, tolerance = simpler, 2 * tolerance
    mesh = solid.to_mesh64()
    points = np.asarray(mesh.vert_properties, dtype=np.float64)[:, :3]
    return points, np.asarray(mesh.tri_verts, dtype=np.int64)


def _edge_ends(triangles: Ints) -> Ints:
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    found: Ints = np.unique(edges, axis=0)
    return found


def _facet_planes(points: Floats, triangles: Ints) -> list[tuple[Floats, float]]:
    """The planes of the largest flat parts that have points on both sides."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    crossed = np.cross(b - a, c - a)
    areas = np.linalg.norm(crossed, axis=1)
    kept = areas > 0
    normals = crossed[kept] / areas[kept, None]
    lead = np.sign(normals[np.arange(len(normals)), np.abs(normals).argmax(axis=1)])
    normals = normals * lead[:, None]
    offsets = np.einsum("ij,ij->i", normals, a[kept])
    size = float(np.ptp(points, axis=0).max())
    keys = np.column_stack([np.round(normals, 2), np.round(offsets / (0.005 * size))])
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    weights = np.bincount(inverse.reshape(-1), weights=areas[kept])
    found = list[tuple[Floats, float]]()
    for group in np.lexsort((first, -weights)).tolist():
        normal, offset = normals[first[group]], float(offsets[first[group]])
        along = points @ normal - offset
        if min(along.max(), -along.min()) > 0.01 * size:
            found.append((normal, offset))
        if len(found) == FACETS:
            break
    return found


# --- Shells ---------------------------------------------------------------------------------------


SAMPLED = 1000
"""Divisions are compared on a sample of about this many triangles."""


class ShellRegion(Region):
    """Triangles (m, 3, 3) that enclose nothing."""

    def __init__(self, sides: Floats) -> None:
        super().__init__(sides.reshape(-1, 3), 0.0)
        self.sides = sides

    def split(self) -> list[Region]:
        """Two parts of the triangles, divided by their normals or positions."""
        if len(self.sides) < 2:
            return [self]
        best, least = None, np.inf
        for chosen in self._divisions():
            if not 0 < chosen.sum() < len(chosen):
                continue
            estimate = _estimated(self.sides[chosen]) + _estimated(self.sides[~chosen])
            if best is None or estimate < (1 - GAIN) * least:
                best, least = chosen, estimate
        if best is None:
            return [self]
        return [ShellRegion(self.sides[best]), ShellRegion(self.sides[~best])]

    def _divisions(self) -> list[Bools]:
        """Ways to divide the triangles: by their normals, by position, and into halves."""
        middles = self.sides.mean(axis=1)
        crossed = np.cross(self.sides[:, 1] - self.sides[:, 0], self.sides[:, 2] - self.sides[:, 0])
        areas = np.linalg.norm(crossed, axis=1)
        normals = crossed / np.maximum(areas, 1e-300)[:, None]
        spread = normals - (areas @ normals) / max(float(areas.sum()), 1e-300)
        axes = np.linalg.eigh((spread * areas[:, None]).T @ spread)[1].T[::-1]
        found: list[Bools] = [spread @ axis > 0 for axis in axes]
        for axis in (*np.eye(3), *principal_axes(self.points)):
            along = middles @ axis
            lower, width = along.min(), np.ptp(along)
            found += [along > lower + share * width for share in (0.5, 0.25, 0.75)]
        order = np.argsort(middles @ principal_axes(self.points)[0], kind="stable")
        halves = np.zeros(len(order), dtype=bool)
        halves[order[: len(order) // 2]] = True
        return [*found, halves]


def _estimated(sides: Floats) -> float:
    step = 1 + len(sides) // SAMPLED
    return estimated_volume(sides[::step].reshape(-1, 3))

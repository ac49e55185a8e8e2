"""Measure the volume that pieces add to a mesh, with manifold3d, and how far they protrude."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from srgc.imports.meshes.convex_piece import ConvexPiece
from srgc.imports.meshes.mesh import Floats, Ints
from srgc.imports.meshes.solids import Anatomy, manifold_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from manifold3d import Manifold

NOTHING = 1e-7
"""Smaller shares of a solid are rounding errors of volumes, and do not count as uncovered."""

NEAR = 40
"""The distance of a corner to the mesh is measured to this many triangles near it."""


@dataclass(frozen=True, slots=True)
class Measures:
    """Volumes in m^3, and a length in m.

    ``volume`` is the volume of the solids, ``reference`` includes the hulls of open parts, and
    ``union`` is the volume of all pieces together.  ``added`` is the volume of the union beyond the
    solids as a share of the reference.  ``farthest`` is about how far a corner of a piece is from
    the mesh.
    """

    volume: float
    reference: float
    union: float
    added: float
    farthest: float


def measured(
    parts: Anatomy,
    reference: float,
    pieces: Sequence[ConvexPiece],
    vertices: Floats,
    triangles: Ints,
) -> Measures:
    """The volumes of a mesh with vertices (n, 3) and triangles (m, 3), and of its pieces."""
    union = float(union_of(pieces).volume())
    volume = float(sum(each.volume() for each in parts.solids))
    added = max(union - volume, 0.0)
    share = added / reference if reference else 0.0
    return Measures(volume, reference, union, share, _farthest(pieces, vertices, triangles))


def union_of(pieces: Sequence[ConvexPiece]) -> Manifold:
    """The union of the pieces as a solid."""
    from manifold3d import Manifold, OpType

    found = [solid_of(each) for each in pieces]
    return found[0] if len(found) == 1 else Manifold.batch_boolean(found, OpType.Add)


def solid_of(piece: ConvexPiece) -> Manifold:
    """A piece as a solid.

    Raises:
        ArithmeticError: the piece is so thin that it has no interior in doubles.
    """
    found = manifold_of(piece.points(), np.array(piece.outward(), dtype=np.int64))
    if found is None:
        raise ArithmeticError("a piece without an inside")
    return found


def not_covered(solids: Sequence[Manifold], pieces: Sequence[ConvexPiece]) -> list[Floats]:
    """The vertices (n, 3) of each part of the solids that no piece covers."""
    from manifold3d import Manifold, OpType

    if not solids:
        return []
    rest = Manifold.batch_boolean(
        [Manifold.batch_boolean(list(solids), OpType.Add), union_of(pieces)], OpType.Subtract
    )
    least = NOTHING * sum(each.volume() for each in solids)
    return [
        np.asarray(part.to_mesh64().vert_properties, dtype=np.float64)[:, :3]
        for part in rest.decompose()
        if part.volume() > least
    ]


def _farthest(pieces: Sequence[ConvexPiece], vertices: Floats, triangles: Ints) -> float:
    """The largest distance from a corner of a piece to the triangles near it."""
    from scipy.spatial import KDTree
    from trimesh.triangles import closest_point

    sides = vertices[triangles]
    corners = np.concatenate([piece.points() for piece in pieces])
    near = KDTree(sides.mean(axis=1)).query(corners, k=min(NEAR, len(sides)))[1]
    near = near.reshape(len(corners), -1)
    least = np.full(len(corners), np.inf)
    for column in near.T:
        nearest = closest_point(sides[column], corners)  # type: ignore[no-untyped-call]
        least = np.minimum(least, np.linalg.norm(nearest - corners, axis=1))
    return float(least.max())

"""Decompose a mesh into convex pieces that hold all of it, and measure the volume they add.

The part whose hull adds most volume is split until little is added; then neighbours are joined if
that adds little.  This search uses doubles and need not be trusted: the pieces have decimal
corners, and whether they hold every triangle is decided exactly.  If they do not, a piece grows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from srgc.faults import UsageFault
from srgc.imports.meshes.containment import uncovered
from srgc.imports.meshes.convex_piece import ConvexPiece
from srgc.imports.meshes.enclosing import enclosing
from srgc.imports.meshes.exact_places import ExactPlaces
from srgc.imports.meshes.few_corners import hull_volume
from srgc.imports.meshes.measures import Measures, measured, not_covered
from srgc.imports.meshes.mesh import Floats, Ints
from srgc.imports.meshes.regions import Region
from srgc.imports.meshes.solids import Anatomy, anatomy
from srgc.imports.meshes.splitting import refined, regions_of

if TYPE_CHECKING:
    from collections.abc import Sequence

DETAIL = 0.1
"""The default share of the volume of a mesh that its pieces may add."""
MOST_PIECES = 1500
"""The most pieces, whatever the detail."""

TRIALS, LESS = 4, 0.85
"""If grown pieces add too much, how often and by which factor the budget is reduced."""
ROUNDS = 40
"""The most rounds of growing; in the second half whatever is missing becomes a piece."""
CANDIDATES = 5
"""So many of the nearest pieces may grow to hold what is missing."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """Convex pieces that hold every triangle of a mesh, as was checked exactly.

    ``thickened`` are the indices of pieces that were flat, and ``notes`` say what was done.
    """

    pieces: tuple[ConvexPiece, ...]
    measures: Measures
    thickened: tuple[int, ...]
    notes: tuple[str, ...]


def decomposed(
    vertices: Floats,
    triangles: Ints,
    *,
    detail: float = DETAIL,
    pieces: int | None = None,
    places: ExactPlaces | None = None,
) -> Pieces:
    """Convex pieces whose union holds every triangle, and the interior of closed parts.

    Args:
        vertices: (n, 3) in metres, finite.
        triangles: (m, 3) indices of vertices, m >= 1.
        detail: the share of the volume of the mesh (of the hull for an open part) that pieces may
            add.  It is kept unless :data:`MOST_PIECES` or ``pieces`` prevents it.
        pieces: the most pieces.
        places: the vertices as rationals; if None, the doubles are exact.

    Raises:
        UsageFault: there is no triangle, or the detail or the number of pieces is not positive.
    """
    _refuse(triangles, detail, pieces)
    parts = anatomy(vertices, triangles)
    reference = reference_volume(parts)
    most = min(pieces or MOST_PIECES, MOST_PIECES)
    regions = regions_of(parts, vertices, triangles, detail * reference, most)
    allowed, trials = detail * reference, 0
    while True:
        regions = refined(regions, allowed, most)
        found, thickened = covering(vertices, triangles, parts, regions, places)
        measures = measured(parts, reference, found, vertices, triangles)
        trials += 1
        if measures.added <= detail or len(regions) >= most or trials == TRIALS:
            break
        allowed *= LESS  # pieces have grown
    order = sorted(range(len(found)), key=lambda i: found[i].corners)
    notes = list(parts.notes)
    if measures.added > detail:
        notes.append(f"more volume than {100 * detail:g} %: more pieces would add less")
    return Pieces(
        tuple(found[i] for i in order),
        measures,
        tuple(place for place, i in enumerate(order) if i in thickened),
        tuple(notes),
    )


def _refuse(triangles: Ints, detail: float, pieces: int | None) -> None:
    if len(triangles) == 0:
        raise UsageFault("a mesh without triangles has no pieces")
    if not 0 < detail < float("inf"):
        raise UsageFault(f"a detail of {detail} is no positive share of the volume")
    if pieces is not None and pieces < 1:
        raise UsageFault("at least one piece is expected")


def reference_volume(parts: Anatomy) -> float:
    """The volume that added volume is a share of (m^3): of solids, and of hulls of open parts."""
    hulls = sum(hull_volume(shell.reshape(-1, 3)) for shell in parts.shells)
    return float(sum(solid.volume() for solid in parts.solids)) + hulls


# --- The exact check, and growing -----------------------------------------------------------------


def covering(
    vertices: Floats,
    triangles: Ints,
    parts: Anatomy,
    regions: Sequence[Region],
    places: ExactPlaces | None = None,
) -> tuple[list[ConvexPiece], set[int]]:
    """Pieces that exactly hold every triangle and the solids, and the indices of thickened ones.

    Args:
        vertices: the points (n, 3) of a mesh, in metres.
        triangles: indices (m, 3) of vertices.
        parts: the solids and shells of the mesh.
        regions: a division of them.
        places: the exact vertices, if they are known.

    Raises:
        ArithmeticError: pieces that grow again and again do not hold all triangles, a bug.
    """
    held = [region.points for region in regions]
    found = [region.enclosed for region in regions]
    for turn in range(ROUNDS):
        missing = [
            np.array([[float(x) for x in point] for point in polygon])
            for each in uncovered(vertices, triangles, [e.piece for e in found], places)
            for polygon in each.polygons
        ]
        if not missing:
            missing = not_covered(parts.solids, [e.piece for e in found])
        if not missing:
            break
        grown, nearby = set[int](), _Nearby([each.piece.points() for each in found])
        for points in missing:
            if 2 * turn > ROUNDS:  # a growing piece may lose what it held, by rounding
                held.append(points)
                found.append(enclosing(_a_bit_beyond(points, points)))
                continue
            nearest = nearby.least_growth(points)
            held[nearest] = np.concatenate([held[nearest], _a_bit_beyond(points, held[nearest])])
            grown.add(nearest)
        for number in grown:
            found[number] = enclosing(held[number])
    else:
        raise ArithmeticError("pieces that were grown again and again do not hold all triangles")
    return [each.piece for each in found], {i for i, e in enumerate(found) if e.thickened}


def _a_bit_beyond(points: Floats, held: Floats) -> Floats:
    """The points and others a little farther out, since they are rounded values of exact ones."""
    middle = held.mean(axis=0)
    return np.concatenate([points, points + 1e-9 * (points - middle)])


class _Nearby:
    """Pieces by their corners, to choose the one that is to hold more points."""

    def __init__(self, corners: Sequence[Floats]) -> None:
        self.corners = corners
        self.volumes = [hull_volume(each) for each in corners]
        self.lower = np.array([each.min(axis=0) for each in corners])
        self.upper = np.array([each.max(axis=0) for each in corners])

    def least_growth(self, points: Floats) -> int:
        """The index of the piece that grows least when it has to hold the points (n, 3)."""
        apart = np.maximum(points.min(axis=0) - self.upper, self.lower - points.max(axis=0))
        order = np.argsort(np.maximum(apart, 0.0).sum(axis=1), kind="stable")
        near: list[int] = order[:CANDIDATES].tolist()
        return min(
            near,
            key=lambda i: hull_volume(np.concatenate([self.corners[i], points])) - self.volumes[i],
        )

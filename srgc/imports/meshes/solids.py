"""Separate a mesh into solids and shells, by connected parts, their winding and what they enclose.

Parts are connected across edges.  A part is closed if each edge is traversed equally often in both
directions.  Then it is a solid, or if its triangles face inwards a cavity of the enclosing part.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from srgc.imports.meshes.mesh import Floats, Ints

if TYPE_CHECKING:
    from manifold3d import Manifold


WELD = 1e-6
"""Vertices closer than this share of the size of the mesh are merged if that closes a surface."""
HOLES = 0.01
"""Holes of at most this share of the surface are cracks; larger ones are intended."""


@dataclass(slots=True)
class Anatomy:
    """The solids of a mesh, and the triangles (s, 3, 3) of its shells, in metres."""

    solids: list[Manifold] = field(default_factory=list)
    shells: list[Floats] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def anatomy(vertices: Floats, triangles: Ints) -> Anatomy:
    """The solids and shells of a mesh with vertices (n, 3) and triangles (m, 3) of their indices.

    Solids that overlap or touch are merged.  Each returned solid is connected, except for solids
    with cavities.
    """
    found = Anatomy()
    size = float(np.ptp(vertices, axis=0).max()) or 1.0
    closed: list[tuple[Manifold, float]] = []
    counts = {"turned": 0, "welded": 0, "filled": 0, "refused": 0}
    points, faces = _merged(vertices, triangles)
    for part in parts(faces):
        done = _closed(points, part, WELD * size, counts)
        solid = None if done is None else manifold_of(*done)
        if done is None or solid is None:
            counts["refused"] += done is not None
            found.shells.append(points[part])
        else:
            closed.append((solid, _signed_volume(done[0][done[1]])))
    said = {
        "turned": "with mixed winding: turned to agree",
        "welded": f"with cracks of less than {WELD:g} of the size: closed",
        "filled": f"with holes of less than {100 * HOLES:g} % of the surface: filled",
        "refused": "closed, and without an inside: taken as a shell",
    }
    found.notes += [f"{counted(n, 'part')} {said[what]}" for what, n in counts.items() if n]
    open_parts = len(found.shells) - counts["refused"]
    if open_parts:
        found.notes.append(f"{counted(open_parts, 'part')} open: a shell, its triangles alone")
    found.solids = _nested(closed, found.notes)
    return found


def _closed(
    points: Floats, part: Ints, weld: float, counts: dict[str, int]
) -> tuple[Floats, Ints] | None:
    """The vertices and triangles of a part as a closed surface; None if it is open."""
    corners, faces = _used(points, _one_sided(part))
    if balanced(faces):
        return corners, faces
    joined_corners, joined_faces = _welded(corners, faces, weld)
    if len(joined_faces) and balanced(joined_faces):
        counts["welded"] += 1
        return joined_corners, joined_faces
    turned = _rewound(faces)
    if balanced(turned):
        counts["turned"] += 1
        return corners, turned
    for one, other in ((joined_corners, joined_faces), (corners, turned)):
        filled = filled_holes(one, other) if len(other) else None
        if filled is not None:
            counts["filled"] += 1
            return filled
    return None


def _one_sided(faces: Ints) -> Ints:
    """One of each pair of triangles if all triangles occur twice, once from either side."""
    _, first, counts = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    found: Ints = faces[np.sort(first)] if (counts == 2).all() else faces
    return found


def _used(points: Floats, faces: Ints) -> tuple[Floats, Ints]:
    used, local = np.unique(faces, return_inverse=True)
    return points[used], local.reshape(-1, 3).astype(np.int64)


def _welded(corners: Floats, faces: Ints, grid: float) -> tuple[Floats, Ints]:
    """Merge the corners within each cell of a grid."""
    _, first, inverse = np.unique(
        np.round(corners / grid), axis=0, return_index=True, return_inverse=True
    )
    numbers = inverse.reshape(-1)[faces]
    a, b, c = numbers.T
    return corners[first], numbers[(a != b) & (b != c) & (a != c)].astype(np.int64)


def counted(number: int, what: str) -> str:
    """``1 part`` or ``2 parts``."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def _merged(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Merge equal vertices; remove degenerate and repeated triangles."""
    points, inverse = np.unique(vertices + 0.0, axis=0, return_inverse=True)
    faces = inverse.reshape(-1)[triangles]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (a != c)]
    start = faces.argmin(axis=1)[:, None]
    turned = np.take_along_axis(faces, (start + np.arange(3)) % 3, axis=1)
    _, first = np.unique(turned, axis=0, return_index=True)
    kept: Ints = faces[np.sort(first)]
    return points, kept


def _edges(faces: Ints) -> Ints:
    """The directed edges (3 m, 2), grouped by triangle."""
    found: Ints = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    return found


def parts(faces: Ints) -> list[Ints]:
    """The triangles (m, 3) grouped by connection across edges, the largest group first."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    if len(faces) == 0:
        return []
    _, numbers = np.unique(_undirected(_edges(faces)), return_inverse=True)
    numbers = numbers.reshape(-1)
    owner = np.repeat(np.arange(len(faces)), 3)
    size = len(faces) + int(numbers.max()) + 1
    graph = coo_matrix((np.ones(len(owner)), (owner, len(faces) + numbers)), shape=(size, size))
    _, labels = connected_components(graph, directed=False)
    labels = labels[: len(faces)]
    order = np.argsort(labels, kind="stable")
    bounds = np.flatnonzero(np.diff(labels[order])) + 1
    return sorted((faces[part] for part in np.split(order, bounds)), key=lambda part: -len(part))


def balanced(faces: Ints) -> bool:
    """Whether triangles (m, 3) traverse every edge equally often in both directions."""
    edges = _edges(faces)
    _, numbers = np.unique(_undirected(edges), return_inverse=True)
    return not np.bincount(numbers.reshape(-1), weights=_signs(edges)).any()


def _undirected(edges: Ints) -> Ints:
    """A number for each edge (m, 2) that does not depend on its direction."""
    found: Ints = edges.min(axis=1) * (int(edges.max()) + 1) + edges.max(axis=1)
    return found


def _signs(edges: Ints) -> Ints:
    """1 for edges (m, 2) that lead to the larger index, -1 for others."""
    return np.where(edges[:, 0] < edges[:, 1], 1, -1)


def _rewound(faces: Ints) -> Ints:
    """Connected triangles with consistent winding, if no edge has more than two triangles.

    Most of them keep their winding.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import breadth_first_order

    edges = _edges(faces)
    keys = _undirected(edges)
    order = np.argsort(keys, kind="stable")
    same = np.flatnonzero(np.diff(keys[order]) == 0)
    if (np.diff(same) == 1).any():
        return faces
    first, second = order[same], order[same + 1]
    one, other = first // 3, second // 3
    disagree = _signs(edges)[first] == _signs(edges)[second]
    size = len(faces)
    ends = np.concatenate([one, other]), np.concatenate([other, one])
    graph = csr_matrix((np.ones(len(ends[0])), ends), shape=(size, size))
    visited, before = breadth_first_order(graph, 0, directed=False)
    pairs = np.concatenate([one * size + other, other * size + one])
    by_pair = np.argsort(pairs, kind="stable")
    steps = before[visited[1:]].astype(np.int64) * size + visited[1:]
    places = by_pair[np.searchsorted(pairs[by_pair], steps)]
    flips = np.tile(disagree, 2)[places].tolist()
    turned = np.zeros(size, dtype=bool).tolist()
    for child, parent, flip in zip(
        visited[1:].tolist(), before[visited[1:]].tolist(), flips, strict=True
    ):
        turned[child] = turned[parent] != flip
    marked = np.array(turned)
    if 2 * marked.sum() > size:
        marked = ~marked
    found: Ints = np.where(marked[:, None], faces[:, ::-1], faces)
    return found


def filled_holes(corners: Floats, faces: Ints) -> tuple[Floats, Ints] | None:
    """The surface with its holes filled by cones; None if they are larger than :data:`HOLES`.

    Corners have the shape (n, 3), faces (m, 3).
    """
    rings = _borders(faces)
    caps, tops = list[tuple[int, int, int]](), list[Floats]()
    for ring in rings:
        top = len(corners) + len(tops)
        tops.append(corners[ring].mean(axis=0))
        caps += [(b, a, top) for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)]
    points = np.concatenate([corners, np.array(tops).reshape(-1, 3)])
    added = np.array(caps, dtype=np.int64).reshape(-1, 3)
    if _area(points, added) > HOLES * _area(points, faces):
        return None
    whole = np.concatenate([faces, added])
    return (points, whole) if balanced(whole) else None


def _borders(faces: Ints) -> list[list[int]]:
    """Rings of directed edges that are traversed more often than their opposites."""
    edges = _edges(faces)
    _, first, numbers = np.unique(_undirected(edges), return_index=True, return_inverse=True)
    surplus = np.bincount(numbers.reshape(-1), weights=_signs(edges)).astype(np.int64)
    onward = dict[int, list[int]]()
    for number in np.argsort(first, kind="stable").tolist():
        count = int(surplus[number])
        if count:
            one, other = sorted(edges[first[number]].tolist())
            start, end = (one, other) if count > 0 else (other, one)
            onward.setdefault(start, []).extend([end] * abs(count))
    rings = list[list[int]]()
    for start in list(onward):
        while onward.get(start):
            ring, at = [start], onward[start].pop()
            while at != start and onward.get(at):
                ring.append(at)
                at = onward[at].pop()
            rings.append(ring)
    return rings


def _area(points: Floats, faces: Ints) -> float:
    a, b, c = (points[faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2


def _signed_volume(sides: Floats) -> float:
    base = sides[0, 0]
    a, b, c = (sides[:, i] - base for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6


def manifold_of(corners: Floats, faces: Ints) -> Manifold | None:
    """The solid bounded by triangles that face outwards; None if manifold3d rejects it.

    Corners have the shape (n, 3), faces (m, 3).
    """
    from manifold3d import Error, Manifold, Mesh64

    if _signed_volume(corners[faces]) < 0:
        faces = faces[:, ::-1]
    mesh: Any = Mesh64(
        vert_properties=np.ascontiguousarray(corners, dtype=np.float64),
        tri_verts=np.ascontiguousarray(faces, dtype=np.uint64),
    )
    solid = Manifold(mesh)
    if solid.status() != Error.NoError or solid.is_empty() or solid.volume() <= 0:
        return None
    return solid


def _nested(closed: list[tuple[Manifold, float]], notes: list[str]) -> list[Manifold]:
    """The connected solids without their cavities; inverted parts that are none are turned."""
    from manifold3d import Manifold, OpType

    if not closed:
        return []
    signs = [1 if volume > 0 else -1 for _, volume in closed]
    if sum(volume for _, volume in closed) < 0:
        signs = [-sign for sign in signs]
        notes.append("the triangles look inwards: turned")
    wholes = [solid for (solid, _), sign in zip(closed, signs, strict=True) if sign > 0]
    cavities: list[list[Manifold]] = [[] for _ in wholes]
    turned = 0
    for (solid, _), sign in zip(closed, signs, strict=True):
        if sign > 0:
            continue
        about = _smallest_about(solid, wholes)
        if about is None:
            turned += 1
            wholes.append(solid)
            cavities.append([])
        else:
            cavities[about].append(solid)
    if turned:
        notes.append(f"{counted(turned, 'part')} whose triangles look inwards: turned")
    found = [
        Manifold.batch_boolean([whole, *inside], OpType.Subtract) if inside else whole
        for whole, inside in zip(wholes, cavities, strict=True)
    ]
    whole = found[0] if len(found) == 1 else Manifold.batch_boolean(found, OpType.Add)
    return connected(whole)


def connected(solid: Manifold) -> list[Manifold]:
    """The connected parts of a solid; a solid with cavities stays whole."""
    parts = solid.decompose()
    return parts if all(part.volume() > 0 for part in parts) else [solid]


def _smallest_about(solid: Manifold, wholes: list[Manifold]) -> int | None:
    """The index of the smallest solid that encloses this one, or None."""
    about = [
        i
        for i, whole in enumerate(wholes)
        if _boxed(solid, whole) and (solid - whole).volume() <= 1e-9 * solid.volume()
    ]
    return min(about, key=lambda i: wholes[i].volume(), default=None)


def _boxed(solid: Manifold, whole: Manifold) -> bool:
    inner, outer = solid.bounding_box(), whole.bounding_box()
    return all(inner[i] >= outer[i] and inner[i + 3] <= outer[i + 3] for i in range(3))

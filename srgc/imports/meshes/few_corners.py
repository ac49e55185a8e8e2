"""Enclose points in a polytope with at most 32 corners and little added volume, in doubles.

Two methods are tried, and the smaller result is used.  By planes: a box whose farthest corners are
cut off by planes that touch the points, for parts with flat sides.  By corners: the points that
protrude most, one after another, then moved outwards as little as the others require, for round
parts.  The result is not proved: the caller checks that the points are inside.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from srgc.imports.meshes.mesh import Floats, Ints

MANY = 1200
"""If there are more points, at first only the extreme ones along fixed directions are used."""
TOUCHING = 1e-9
"""Points this close to a plane, as a share of the size, count as on it."""


def few_corners(points: Floats, most: int) -> Floats:
    """At most ``most`` corners (c, 3) whose hull holds the points (n, 3), up to rounding.

    The points have to span space and be the corners of their hull.
    """
    if len(points) <= most:
        return points
    if len(points) > MANY:
        along = points @ sphere_directions(MANY // 2).T
        few = few_corners(points[np.unique(along.argmax(axis=0))], most)
        wider = _about(points, few)
        return _box(points) if wider is None else wider
    found = [
        each for each in (_by_planes(points, most), _by_corners(points, most)) if each is not None
    ]
    return min(found, key=hull_volume) if found else _box(points)


def sphere_directions(count: int) -> Floats:
    """Unit vectors (count, 3) spread over the sphere, along a spiral."""
    turns = np.arange(count) + 0.5
    height = 1 - 2 * turns / count
    angle = np.pi * (1 + 5**0.5) * turns
    width = np.sqrt(1 - height**2)
    return np.column_stack([width * np.cos(angle), width * np.sin(angle), height])


def hull_volume(points: Floats) -> float:
    """The volume of the hull of points (n, 3); zero if they are flat."""
    from manifold3d import Manifold

    return float(Manifold.hull_points(points).volume()) if len(points) > 3 else 0.0


def hull_corners(points: Floats) -> Floats:
    """The points, of some (n, 3), that are corners of the hull; all of them if they are flat."""
    return hull_of(points)[0]


def hull_of(points: Floats) -> tuple[Floats, float]:
    """The corners (k, 3) of the hull of points and its volume; all and 0 if they are flat."""
    from scipy.spatial import ConvexHull, QhullError

    if len(points) < 4:
        return points, 0.0
    try:
        hull = ConvexHull(points)
    except QhullError:
        return points, 0.0
    found: Floats = points[np.sort(hull.vertices)]
    return found, float(hull.volume)


# --- By planes ------------------------------------------------------------------------------------


def _box(points: Floats) -> Floats:
    lower, upper = points.min(axis=0), points.max(axis=0)
    return np.array([[(lower, upper)[i >> a & 1][a] for a in range(3)] for i in range(8)])


def principal_axes(points: Floats) -> Floats:
    """The principal axes (3, 3) of points (n, 3) as rows, the longest first, with fixed signs."""
    spread = points - points.mean(axis=0)
    axes = np.linalg.eigh(spread.T @ spread)[1].T[::-1]
    signs = np.sign(axes[np.arange(3), np.abs(axes).argmax(axis=1)])
    found: Floats = axes * signs[:, None]
    return found


def _frames(points: Floats, equations: Floats) -> list[Floats]:
    """Axes of initial boxes: of the world, the principal axes, and those of a facet."""
    frames = [np.eye(3), principal_axes(points)]
    normal = equations[0, :3]
    side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    side /= np.linalg.norm(side)
    frames.append(np.array([normal, side, np.cross(normal, side)]))
    return frames


def _by_planes(points: Floats, most: int) -> Floats | None:
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    hull = ConvexHull(points)
    equations = _merged(hull.equations)
    middle = points.mean(axis=0)
    best: Floats | None = None
    least = np.inf
    for frame in _frames(points, equations):
        along = points @ frame.T
        volume = float(np.prod(along.max(axis=0) - along.min(axis=0)))
        if volume < least * (1 - 1e-6):
            least = volume
            best = np.concatenate(
                [
                    np.column_stack([frame, -along.max(axis=0)]),
                    np.column_stack([-frame, along.min(axis=0)]),
                ]
            )
    if best is None:
        return None
    planes, found = best, None
    while True:
        try:
            corners = _distinct(HalfspaceIntersection(planes, middle).intersections, points)
        except (QhullError, ValueError):
            return found
        if len(corners) > most or not np.isfinite(corners).all():
            return found
        found = corners
        beyond = corners @ equations[:, :3].T + equations[:, 3]
        if beyond.max() <= TOUCHING * np.abs(points - middle).max():
            return found
        corner = int(beyond.max(axis=1).argmax())
        planes = np.concatenate([planes, equations[[int(beyond[corner].argmax())]]])


def _merged(equations: Floats) -> Floats:
    """Each plane once: qhull returns one for each triangle."""
    rounded = np.round(equations, 9)
    _, first = np.unique(rounded, axis=0, return_index=True)
    found: Floats = equations[np.sort(first)]
    return found


def _distinct(corners: Floats, points: Floats) -> Floats:
    grid = 1e-8 * np.ptp(points, axis=0).max()
    _, first = np.unique(np.round(corners / grid), axis=0, return_index=True)
    found: Floats = corners[np.sort(first)]
    return found


# --- By corners -----------------------------------------------------------------------------------


def _by_corners(points: Floats, most: int) -> Floats | None:
    from scipy.spatial import ConvexHull, QhullError

    chosen = _extremes(points)
    try:
        hull = ConvexHull(points[chosen], incremental=True)
        while len(chosen) < most:
            beyond = (points @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
            beyond[chosen] = -np.inf
            farthest = int(beyond.argmax())
            if beyond[farthest] <= 0:
                break
            chosen.append(farthest)
            hull.add_points(points[[farthest]])
        hull.close()
        final = ConvexHull(points[chosen])
    except QhullError:
        return None
    moved = _moved(points, points[chosen], final.simplices, final.equations)
    return _about(points, moved)


def _extremes(points: Floats) -> list[int]:
    found = dict[int, None]()
    for axis in (*np.eye(3), *principal_axes(points), np.ones(3)):
        along = points @ axis
        found[int(along.argmin())] = None
        found[int(along.argmax())] = None
    return list(found)


def _moved(points: Floats, corners: Floats, simplices: Ints, equations: Floats) -> Floats:
    """The corners, each moved as little as possible so that each of its planes holds all points."""
    due = np.maximum((points @ equations[:, :3].T + equations[:, 3]).max(axis=0), 0.0)
    sides = corners[simplices]
    areas = np.linalg.norm(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0]), axis=1)
    moved = corners.copy()
    for number in range(len(corners)):
        at = np.flatnonzero((simplices == number).any(axis=1))
        if len(at) and due[at].max() > 0:
            moved[number] += _least_move(equations[at, :3], due[at], areas[at])
    return moved


def _least_move(normals: Floats, due: Floats, areas: Floats) -> Floats:
    """The w with ``normals w >= due`` that adds the least volume, at a corner of that set."""
    triples = np.array(list(combinations(range(len(normals)), 3)))
    systems = normals[triples]
    sound = np.abs(np.linalg.det(systems)) > 1e-6
    if not sound.any():
        return np.zeros(3)
    moves = np.linalg.solve(systems[sound], due[triples[sound]][:, :, None])[:, :, 0]
    slack = moves @ normals.T - due
    allowed = (slack >= -1e-9 * (due.max() + 1e-300)).all(axis=1)
    if not allowed.any():
        return np.zeros(3)
    cost = moves[allowed] @ (areas @ normals)
    found: Floats = moves[allowed][int(cost.argmin())]
    return found


def _about(points: Floats, corners: Floats) -> Floats | None:
    """The corners scaled about their centre until they hold the points; None if this fails."""
    from scipy.spatial import ConvexHull, QhullError

    middle = points.mean(axis=0)
    try:
        planes = _merged(ConvexHull(corners).equations)
    except QhullError:
        return None
    inner = -(middle @ planes[:, :3].T + planes[:, 3])
    if (inner <= 0).any():
        return None
    reach = ((points - middle) @ planes[:, :3].T).max(axis=0)
    factor = max(1.0, float((reach / inner).max()))
    found: Floats = middle + factor * (corners - middle)
    return found if factor < 4 else None

"""Random workspaces, and what others say of their cells: shapely in the plane, numpy in space."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import combinations

import numpy as np
import shapely
from shapely.ops import polygonize

from grammar_lang.ir import Hull, Region, Workspace
from tests.oracles.planes import box, hull

NEAR = 1e-9


def plane_world(seed, *, obstacles, side, grid=4):
    """Quadrilaterals and boxes with corners on a grid, some of them repeated, nested, touching."""
    rng = random.Random(seed)
    regions = []
    for i in range(obstacles):
        x, y = (Fraction(rng.randrange(-grid, side * grid), grid) for _ in range(2))
        kind = rng.choice(["obstacle", "obstacle", "target", "region"])
        match rng.randrange(6):
            case 0 if regions:
                regions.append(Region(f"R{i}", kind, rng.choice(regions).shape))
            case 1 | 2:
                w, h = (Fraction(rng.randrange(0, 3 * grid), grid) for _ in range(2))
                regions.append(box(f"R{i}", kind, (x, x + w), (y, y + h)))
            case _:
                corners = [
                    (x + Fraction(rng.randrange(-grid, 2 * grid), grid),
                     y + Fraction(rng.randrange(-grid, 2 * grid), grid))
                    for _ in range(4)
                ]  # fmt: skip
                regions.append(hull(f"R{i}", kind, *corners))
    return Workspace("W", 2, box("bounds", "bounds", (0, side), (0, side)), tuple(regions))


def tilted_boxes(seed, *, obstacles, side):
    """Rotated rectangles, corners in millimetres: nothing touches but by accident."""
    rng = np.random.default_rng(seed)
    regions = []
    for i in range(obstacles):
        centre, half = rng.uniform(0, side, 2), rng.uniform(0.2, 1.5, 2)
        angle = rng.uniform(0, np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        corners = [centre + turn @ (half * s) for s in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        shape = Hull(tuple(tuple(Fraction(round(1000 * x), 1000) for x in c) for c in corners))
        regions.append(Region(f"O{i}", "obstacle", shape))
    return Workspace("W", 2, box("bounds", "bounds", (0, side), (0, side)), tuple(regions))


def space_world(seed, *, obstacles, side=4):
    """Boxes and tetrahedra with whole corners."""
    rng = random.Random(seed)
    regions = []
    for i in range(obstacles):
        if rng.random() < 0.5:
            sides = [sorted(rng.sample(range(-1, side + 2), 2)) for _ in range(3)]
            regions.append(box(f"R{i}", "obstacle", *sides))
        else:
            corners = [tuple(rng.randrange(0, side + 1) for _ in range(3)) for _ in range(4)]
            regions.append(hull(f"R{i}", "target", *corners))
    return Workspace("W", 3, box("bounds", "bounds", *[(0, side)] * 3), tuple(regions))


def polygons_of(abstraction):
    return [
        shapely.Polygon([tuple(map(float, v)) for v in cell.polytope.vertices])
        for cell in abstraction.cells
    ]


def neighbours_by_shapely(shapes):
    """The pairs i < j whose boundaries have a stretch in common, longer than rounding can make."""
    tree = shapely.STRtree(shapes)
    first, second = tree.query(shapes, predicate="dwithin", distance=NEAR)
    return {
        (int(i), int(j))
        for i, j in zip(first, second, strict=True)
        if i < j
        and shapes[i].boundary.buffer(NEAR).intersection(shapes[j].boundary).length > 1e4 * NEAR
    }


def touching_by_shapely(shapes):
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=NEAR)
    return {(int(i), int(j)) for i, j in zip(first, second, strict=True) if i < j}


def reflex_bounds(workspace):
    """Of all faces of the regions' boundaries: the fewest convex pieces, and one cut per corner.

    With r reflex corners and h holes, r cuts make r + 1 - h pieces, and no cut serves more than
    two corners (Chazelle & Dobkin 1985).
    """
    shapes = [shapely.Polygon([tuple(map(float, p)) for p in r.shape.points])
              for r in workspace.regions]  # fmt: skip
    side = max(float(row.offset) for row in workspace.bounds.shape.rows)
    frame = shapely.box(0, 0, side, side)
    lines = [frame.boundary, *(s.convex_hull.boundary.intersection(frame) for s in shapes)]
    least = most = 0
    for face in polygonize(shapely.unary_union(lines)):
        reflex = sum(_reflex(ring, hole) for ring, hole in
                     [(face.exterior, False), *((r, True) for r in face.interiors)])  # fmt: skip
        holes = len(face.interiors)
        least += max(1, (reflex + 1) // 2 + 1 - holes)
        most += reflex + 1 - holes
    return least, most


def _reflex(ring, hole):
    corners = np.array(ring.coords)[:-1]
    if ring.is_ccw == hole:
        corners = corners[::-1]
    before, after = corners - np.roll(corners, 1, 0), np.roll(corners, -1, 0) - corners
    before /= np.linalg.norm(before, axis=1)[:, None]
    after /= np.linalg.norm(after, axis=1)[:, None]
    return int(np.sum(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < -1e-7))


def common_dimension(first, second):
    """The dimension of the intersection of two polyhedra of space, -1 if none: all its corners."""
    a, b = np.concatenate([first.A, second.A]), np.concatenate([first.b, second.b])
    chosen = np.array(list(combinations(range(len(b)), 3)))
    planes = a[chosen]
    regular = np.abs(np.linalg.det(planes)) > 1e-9
    points = np.linalg.solve(planes[regular], b[chosen[regular]][..., None])[..., 0]
    points = points[(points @ a.T <= b + 1e-7).all(axis=1)]
    if not len(points):
        return -1
    return int(np.linalg.matrix_rank(points - points[0], tol=1e-6))

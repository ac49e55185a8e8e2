"""The abstraction of random workspaces against shapely, exact sampling and brute force."""

from __future__ import annotations

import random
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
import shapely
from scipy.spatial import ConvexHull

from compiler.workspaces.abstraction import abstract
from compiler.workspaces.bisection import bisections
from compiler.workspaces.polytope import polytope_of
from grammar_lang.ir import Workspace
from tests.oracles.planes import box, hull, in_shape
from tests.oracles.random_worlds import (
    common_dimension,
    neighbours_by_shapely,
    plane_world,
    polygons_of,
    reflex_bounds,
    space_world,
    tilted_boxes,
    touching_by_shapely,
)
from tests.oracles.some_cases import some

WORLDS = [(seed, 4 + 5 * (seed % 6), 4 + 2 * (seed % 3)) for seed in range(12)]


def inner_point(cell, rng):
    """A random point of the interior: all corners with positive weights."""
    weights = [rng.randrange(1, 50) for _ in cell.polytope.vertices]
    return tuple(
        sum((w * x for w, x in zip(weights, axis, strict=True)), Fraction(0)) / sum(weights)
        for axis in zip(*cell.polytope.vertices, strict=True)
    )


def check_labels(abstraction, workspace, rng):
    shapes = {r.name: polytope_of(r.shape, workspace.dimension) for r in workspace.regions}
    for cell in abstraction.cells:
        point = inner_point(cell, rng)
        assert cell.propositions == {n for n, s in shapes.items() if s.contains_point(point)}


@pytest.mark.parametrize(("seed", "obstacles", "side"), some(WORLDS, 6))
@pytest.mark.parametrize("finer", [False, True])
def test_cells_of_the_plane_against_shapely(seed, obstacles, side, finer):
    workspace = plane_world(seed, obstacles=obstacles, side=side)
    abstraction = abstract(workspace)
    if finer:
        abstraction = abstraction.cut(bisections(abstraction, 3 * len(abstraction.cells) // 2))
    assert sum(cell.volume for cell in abstraction.cells) == side * side
    shapes = polygons_of(abstraction)
    assert shapely.unary_union(shapes).area == pytest.approx(side * side)
    for i, j in touching_by_shapely(shapes):
        assert shapes[i].intersection(shapes[j]).area < 1e-9
    assert set(abstraction.adjacency) == neighbours_by_shapely(shapes)
    assert set(abstraction.touches) == touching_by_shapely(shapes)
    for (i, j), ends in abstraction.facets.items():
        # a facet is a whole common edge, not a part of it
        common = shapes[i].boundary.buffer(1e-9).intersection(shapes[j].boundary).length
        length = np.linalg.norm(np.array(ends[0], float) - np.array(ends[1], float))
        assert length == pytest.approx(common, abs=1e-5)
    check_labels(abstraction, workspace, random.Random(seed))


@pytest.mark.parametrize("seed", some(range(6), 2))
def test_labels_of_random_points(seed):
    workspace = plane_world(seed, obstacles=20, side=6)
    abstraction = abstract(workspace)
    rng = random.Random(seed)
    for _ in range(60):
        point = tuple(Fraction(rng.randrange(1, 6 * 97), 97) for _ in range(2))
        inside = abstraction.containing(point)
        named = {r.name for r in workspace.regions if polytope_of(r.shape, 2).contains_point(point)}
        assert inside
        assert all(abstraction.cells[i].propositions <= named for i in inside)
        if len(inside) == 1:
            assert abstraction.cells[inside[0]].propositions == named
        assert named == {r.name for r in workspace.regions if in_shape(r.shape, point)} or any(
            polytope_of(r.shape, 2).affine_dimension < 2 for r in workspace.regions
        )


@pytest.mark.parametrize(("obstacles", "side"), some([(10, 8), (30, 20), (30, 8), (60, 30)], 2))
def test_the_cells_are_few(obstacles, side):
    workspace = tilted_boxes(obstacles, obstacles=obstacles, side=side)
    least, one_cut_each = reflex_bounds(workspace)
    cells = len(abstract(workspace).cells)
    assert least <= cells <= one_cut_each
    # cuts that serve two corners are found: a part of what could be saved at most
    assert one_cut_each - cells >= (one_cut_each - least) / 6


def test_boxes_are_divided_into_boxes():
    rng = random.Random(5)
    spans = [[sorted(rng.sample(range(13), 2)) for _ in range(2)] for _ in range(12)]
    regions = tuple(box(f"R{i}", "obstacle", *sides) for i, sides in enumerate(spans))
    abstraction = abstract(Workspace("W", 2, box("bounds", "bounds", (0, 12), (0, 12)), regions))
    for cell in abstraction.cells:
        assert len(cell.polytope.vertices) == 4
        assert all(0 in row.normal for row in cell.polytope.rows)


def test_cuts_between_aligned_corners_are_shared():
    # both gaps between the boxes are closed by one cut for two corners: 5 pieces fewer than 9
    regions = (box("A", "obstacle", (1, 2), (1, 2)), box("B", "obstacle", (3, 4), (1, 2)))
    abstraction = abstract(Workspace("W", 2, box("bounds", "bounds", (0, 5), (0, 3)), regions))
    assert len(abstraction.cells_of("A")) == len(abstraction.cells_of("B")) == 1
    assert len(abstraction.cells) - 2 == 8 + 1 - 2 - 2  # r + 1 - h - shared


def test_pinched_free_space():
    """Obstacles that touch in corners, touch the bounds, and enclose a pocket."""
    regions = (
        hull("A", "obstacle", (2, 0), (3, 1), (2, 2), (1, 1)),
        hull("B", "obstacle", (4, 0), (5, 1), (4, 2), (3, 1)),
        hull("C", "obstacle", (2, 2), (4, 2), (3, 3)),
        hull("D", "obstacle", (0, 1), (1, 1), (0, 2)),
        hull("E", "region", (2, 2), (4, 2)),
        hull("F", "region", (5, 5)),
    )
    workspace = Workspace("W", 2, box("bounds", "bounds", (0, 6), (0, 4)), regions)
    abstraction = abstract(workspace)
    shapes = polygons_of(abstraction)
    assert sum(cell.volume for cell in abstraction.cells) == 24
    assert set(abstraction.adjacency) == neighbours_by_shapely(shapes)
    assert set(abstraction.touches) == touching_by_shapely(shapes)
    assert abstraction.cells_of("E") == abstraction.cells_of("F") == ()
    (a,), (b,) = abstraction.cells_of("A"), abstraction.cells_of("B")
    assert (a, b) in abstraction.touches
    assert (a, b) not in abstraction.adjacency
    check_labels(abstraction, workspace, random.Random(0))


def test_the_order_of_declaration_names_cells_and_nothing_else():
    workspace = tilted_boxes(3, obstacles=25, side=12)
    turned = Workspace("W", 2, workspace.bounds, workspace.regions[::-1])
    first, second = abstract(workspace), abstract(turned)
    found = [
        {(cell.polytope.vertices, cell.propositions) for cell in one.cells}
        for one in (first, second)
    ]
    shared = found[0] & found[1]
    assert len(shared) > 0.9 * len(found[0])
    assert {p for _, p in found[0]} == {p for _, p in found[1]}


@pytest.mark.parametrize("seed", some(range(10), 3))
def test_cells_of_space_against_brute_force(seed):
    workspace = space_world(seed, obstacles=1 + seed % 4)
    abstraction = abstract(workspace)
    if seed % 2:
        abstraction = abstraction.cut(bisections(abstraction, len(abstraction.cells) + 6))
    shapes = [cell.polytope for cell in abstraction.cells]
    assert sum(shape.volume for shape in shapes) == 64
    for shape in shapes:
        corners = np.array(shape.vertices, dtype=float)
        assert float(shape.volume) == pytest.approx(ConvexHull(corners).volume)
    met = {}
    for i, j in combinations(range(len(shapes)), 2):
        (low, high), (below, above) = shapes[i].box, shapes[j].box
        if (low <= above).all() and (below <= high).all():
            met[i, j] = common_dimension(shapes[i], shapes[j])
    assert max(met.values(), default=-1) <= 2
    assert set(abstraction.adjacency) == {pair for pair, size in met.items() if size == 2}
    assert set(abstraction.touches) == {pair for pair, size in met.items() if size >= 0}
    for (i, j), corners in abstraction.facets.items():
        assert all({i, j} <= set(abstraction.containing(corner)) for corner in corners)
    check_labels(abstraction, workspace, random.Random(seed))
    if seed % 3 == 0:
        rng = random.Random(seed)
        for _ in range(40):
            point = tuple(Fraction(rng.randrange(1, 4 * 97), 97) for _ in range(3))
            inside = abstraction.containing(point)
            if len(inside) == 1:
                named = {r.name for r in workspace.regions
                         if polytope_of(r.shape, 3).contains_point(point)}  # fmt: skip
                assert abstraction.cells[inside[0]].propositions == named

import os
import subprocess
import sys
from fractions import Fraction
from itertools import combinations
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.workspaces.abstraction import abstract
from compiler.workspaces.polytope import polytope_of
from grammar_lang.ir import Inequalities, Region, Workspace
from tests.oracles.planes import (
    bench,
    box,
    cuts_of_the_bench,
    hull,
    in_shape,
    row,
    share_edge,
    strictly_inside,
    workspaces,
)
from tests.oracles.some_cases import examples

SETTINGS = settings(max_examples=examples(15, 60), deadline=None)
inner_points = st.tuples(
    st.integers(0, 6 * 12).map(lambda n: Fraction(n, 12)),
    st.integers(0, 5 * 12).map(lambda n: Fraction(n, 12)),
)


@SETTINGS
@given(workspaces())
def test_the_cells_partition_the_bounds_and_refine_every_region(workspace):
    abstraction = abstract(workspace)
    shapes = [cell.polytope for cell in abstraction.cells]
    assert sum(shape.volume for shape in shapes) == 30
    assert all(shape.has_interior for shape in shapes)
    assert all(a.separated_interiors(b) for a, b in combinations(shapes, 2))
    for region in workspace.regions:
        whole = polytope_of(region.shape, 2)
        for cell in abstraction.cells:
            if region.name in cell.propositions:
                assert whole.contains(cell.polytope)
            else:
                assert whole.separated_interiors(cell.polytope)


@SETTINGS
@given(workspaces(), st.lists(inner_points, min_size=8, max_size=8))
def test_a_point_has_the_propositions_of_its_cell(workspace, points):
    abstraction = abstract(workspace)
    for point in points:
        containing = abstraction.containing(point)
        assert containing
        named = {r.name for r in workspace.regions if in_shape(r.shape, point)}
        for i in containing:
            # closed regions: on a boundary a point may have more propositions than the cell
            assert abstraction.cells[i].propositions <= named
        assert abstraction.locate([float(x) for x in point]) in containing
        inside = [
            i for i in containing if strictly_inside(abstraction.cells[i].polytope.vertices, point)
        ]
        if inside:
            assert containing == tuple(inside)


@SETTINGS
@given(workspaces())
def test_the_centre_of_a_cell_has_exactly_its_propositions(workspace):
    abstraction = abstract(workspace)
    for i, cell in enumerate(abstraction.cells):
        centre = cell.polytope.centre
        named = {r.name for r in workspace.regions if in_shape(r.shape, centre)}
        assert cell.propositions == named
        assert abstraction.locate([float(x) for x in centre]) == i


@SETTINGS
@given(workspaces())
def test_adjacency_is_a_common_stretch_of_edge(workspace):
    abstraction = abstract(workspace)
    shapes = [cell.polytope.vertices for cell in abstraction.cells]
    expected = [
        (i, j) for i, j in combinations(range(len(shapes)), 2) if share_edge(shapes[i], shapes[j])
    ]
    assert list(abstraction.adjacency) == expected
    for i, j in expected:
        assert j in abstraction.neighbours[i]
        assert i in abstraction.neighbours[j]
        ends = abstraction.facets[i, j]
        assert len(ends) == 2
        for end in ends:
            assert {i, j} <= set(abstraction.containing(end))
        assert np.array_equal(abstraction.facet_centre(i, j), abstraction.facet_centre(j, i))
    graph = nx.Graph(expected)
    graph.add_nodes_from(range(len(shapes)))
    assert nx.is_connected(graph)  # the bounds are convex
    assert set(expected) <= set(abstraction.touches)


@SETTINGS
@given(workspaces(max_regions=3))
def test_touching_cells_have_a_common_point(workspace):
    abstraction = abstract(workspace)
    corners = {v for cell in abstraction.cells for v in cell.polytope.vertices}
    met = {pair for v in corners for pair in combinations(abstraction.containing(v), 2)}
    # polygons with disjoint interiors that meet do so in a point or stretch that ends in a corner
    assert set(abstraction.touches) == met


def test_the_running_example():
    abstraction = abstract(bench())
    names = [cell.name for cell in abstraction.cells]
    assert names == ["O", "T", "S", *(f"free.{i}" for i in range(1, len(names) - 2))]
    assert len(names) <= 13
    assert [abstraction.cells[abstraction.index(n)].kind for n in "OTS"] == [
        "obstacle", "target", "region",
    ]  # fmt: skip
    assert sorted(abstraction.describe()["O"]) == [
        "-x <= -17/10", "-y <= -2", "x <= 3", "y <= 3",
    ]  # fmt: skip
    graph = nx.Graph(abstraction.adjacency)
    start, target, obstacle = (abstraction.index(n) for n in "STO")
    graph.remove_node(obstacle)
    # both ways round: no cut from the obstacle to the lower or to the upper bound separates them
    for cut in cuts_of_the_bench():
        crossing = {i for i, cell in enumerate(abstraction.cells) if cell.polytope.meets(cut)}
        assert crossing.isdisjoint({start, target})
        assert nx.has_path(graph.subgraph(set(graph) - crossing), start, target)


def test_overlaps_are_named_after_the_obstacle_then_the_target():
    workspace = Workspace(
        "W",
        2,
        box("bounds", "bounds", (0, 4), (0, 4)),
        (
            box("A", "region", (0, 3), (0, 1)),
            box("B", "region", (0, 4), (0, 1)),
            box("T", "target", (2, 3), (0, 4)),
            box("O", "obstacle", (2, 3), (0, 3)),
        ),
    )
    named = {cell.name: cell.propositions for cell in abstract(workspace).cells}
    assert named == {
        "O.1": {"A", "B", "T", "O"},
        "O.2": {"T", "O"},
        "T": {"T"},
        "A": {"A", "B"},
        "B": {"B"},
        "free.1": frozenset(),
        "free.2": frozenset(),
    }


def test_corner_contact_touches_but_is_no_adjacency():
    workspace = Workspace(
        "W",
        2,
        box("bounds", "bounds", (0, 2), (0, 2)),
        (box("A", "region", (0, 1), (0, 1)), box("B", "region", (1, 2), (1, 2))),
    )
    abstraction = abstract(workspace)
    pair = tuple(sorted((abstraction.index("A"), abstraction.index("B"))))
    assert pair in abstraction.touches
    assert pair not in abstraction.adjacency
    assert len(abstraction.cells) == 4
    assert len(abstraction.adjacency) == 4
    with pytest.raises(KeyError):
        abstraction.facet_centre(*pair)


def test_no_regions_and_regions_of_no_effect():
    empty = Workspace("W", 2, box("bounds", "bounds", (0, 2), (0, 2)), ())
    outside = Workspace(
        "W", 2, empty.bounds, (box("A", "region", (2, 3), (0, 2)), hull("B", "region", (1, 1)))
    )
    for workspace in (empty, outside):
        (cell,) = abstract(workspace).cells
        assert (cell.name, cell.kind, cell.propositions) == ("free", "free", frozenset())
        assert abstract(workspace).locate([3.0, 1.0]) is None
        assert abstract(workspace).locate([2.0, 2.0]) == 0


def test_unbounded_regions_end_at_the_bounds():
    half = Region("A", "region", Inequalities((row(1, 1, 2),)))
    abstraction = abstract(Workspace("W", 2, box("bounds", "bounds", (0, 2), (0, 2)), (half,)))
    assert [(c.name, c.polytope.volume) for c in abstraction.cells] == [("A", 2), ("free", 2)]
    assert abstraction.facet_centre(0, 1).tolist() == [1.0, 1.0]


def test_bounds_must_be_a_polytope():
    half = Region("bounds", "bounds", Inequalities((row(1, 1, 2),)))
    for bounds in (half, box("bounds", "bounds", (0, 0), (0, 1))):
        with pytest.raises(ValueError, match=r"bounded|interior"):
            abstract(Workspace("W", 2, bounds, ()))


sides = st.lists(st.integers(0, 4), min_size=2, max_size=2, unique=True).map(sorted)


@settings(max_examples=examples(12, 25), deadline=None)
@given(st.lists(st.tuples(sides, sides, sides), max_size=3))
def test_boxes_in_space_against_unit_cubes(regions):
    bounds = box("bounds", "bounds", (0, 4), (0, 4), (0, 4))
    named = tuple(box(f"R{i}", "obstacle", *region) for i, region in enumerate(regions))
    abstraction = abstract(Workspace("W", 3, bounds, named))
    assert sum(cell.polytope.volume for cell in abstraction.cells) == 64
    owner = {}
    for cube in np.ndindex(4, 4, 4):
        (owner[cube],) = abstraction.containing([Fraction(2 * x + 1, 2) for x in cube])
        expected = {
            f"R{i}"
            for i, region in enumerate(regions)
            if all(low <= x < high for x, (low, high) in zip(cube, region, strict=True))
        }
        assert abstraction.cells[owner[cube]].propositions == expected
    expected_pairs = set()
    for cube, cell in owner.items():
        for axis in range(3):
            other = owner.get(tuple(x + (k == axis) for k, x in enumerate(cube)), cell)
            if other != cell:
                expected_pairs.add((min(cell, other), max(cell, other)))
    assert set(abstraction.adjacency) == expected_pairs


def test_a_tetrahedron_in_space():
    region = hull("A", "target", (0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2))
    abstraction = abstract(
        Workspace("W", 3, box("bounds", "bounds", (-1, 2), (-1, 2), (-1, 2)), (region,))
    )
    volumes = {cell.name: cell.polytope.volume for cell in abstraction.cells}
    assert volumes["A"] == Fraction(4, 3)
    assert sum(volumes.values()) == 27
    assert len(abstraction.neighbours[abstraction.index("A")]) >= 4


@pytest.mark.slow
def test_two_hundred_obstacles():
    rng = np.random.default_rng(7)
    regions = []
    for i in range(200):
        x, y = (Fraction(int(n), 10) for n in rng.integers(0, 480, 2))
        corners = [
            (x + Fraction(int(a), 10), y + Fraction(int(b), 10))
            for a, b in rng.integers(0, 20, (4, 2))
        ]
        regions.append(hull(f"O{i}", "obstacle", *corners))
    bounds = box("bounds", "bounds", (0, 50), (0, 50))
    abstraction = abstract(Workspace("W", 2, bounds, tuple(regions)))
    assert sum(cell.polytope.volume for cell in abstraction.cells) == 2500
    assert len(abstraction.cells) < 2000


SCRIPT = """
from compiler.workspaces.abstraction import abstract
from compiler.views.dot import to_dot
from compiler.views.workspace_view import workspace_view
from grammar_lang.ir import Workspace
from tests.oracles.planes import box, hull
from tests.oracles.some_cases import examples
shapes = [("B", "region", (0, 0), (3, 1), (1, 3)), ("A", "target", (2, 0), (4, 4), (1, 2)),
          ("O", "obstacle", (1, 1), (4, 1), (4, 2), (1, 2))]
regions = tuple(hull(*shape) for shape in shapes)
w = Workspace("W", 2, box("bounds", "bounds", (0, 5), (0, 5)), regions)
a = abstract(w)
print(a.describe(), a.adjacency, a.facets, a.touches, to_dot(workspace_view(a, w)))
"""


@pytest.mark.slow
def test_the_same_whatever_the_hash_seed():
    root = Path(__file__).resolve().parents[2]
    outputs = {
        subprocess.run(
            [sys.executable, "-c", SCRIPT],
            cwd=root,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(root)},
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("0", "1")
    }
    assert len(outputs) == 1

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from itertools import pairwise

import numpy as np
import pytest

from compiler.workspaces.abstraction import abstract
from compiler.workspaces.bisection import bisections
from grammar_lang.ir import Workspace
from srgc.render.workspace_picture import workspace_svg
from tests.oracles.planes import bench, box
from tests.oracles.random_worlds import plane_world, space_world

SVG = "{http://www.w3.org/2000/svg}"


def written(svg: str) -> list[str]:
    """The texts of a picture, line by line."""
    texts = [element for tag in ("text", "tspan") for element in ET.fromstring(svg).iter(SVG + tag)]
    return [element.text or "" for element in texts]


def of_class(svg: str, tag: str, name: str) -> list[ET.Element]:
    found = ET.fromstring(svg).iter(SVG + tag)
    return [element for element in found if name in element.get("class", "").split()]


def corners(element: ET.Element) -> list[tuple[float, float]]:
    """The points of a path, whose steps may be relative."""
    data = element.get("d", "")
    numbers = [float(x) for x in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", data)]
    points = np.array(numbers).reshape(-1, 2)
    return [tuple(each) for each in (points.cumsum(axis=0) if "l" in data else points).tolist()]


def sets(svg: str, kind: str) -> list[ET.Element]:
    """The marks of all sets of a kind, without those of the legend, which have no title."""
    return [each for each in of_class(svg, "g", kind) if each.find(f"{SVG}title") is not None]


def ways(svg: str) -> list[ET.Element]:
    """The paths, without those of the legend."""
    return [each for each in of_class(svg, "path", "path") if "h" not in each.get("d", "")]


def test_the_running_example_with_a_path() -> None:
    workspace = bench()
    abstraction = abstract(workspace)
    path = [abstraction.index(name) for name in ("S", "free.5", "free.8", "T")]
    svg = workspace_svg(abstraction, workspace, [path], title="PickAndPlace")
    assert svg == workspace_svg(abstract(bench()), bench(), [path], title="PickAndPlace")
    texts = written(svg)
    assert {cell.name for cell in abstraction.cells} <= set(texts)
    assert {"PickAndPlace", "path", "obstacle", "target", "region", "x (m)"} <= set(texts)
    [line] = ways(svg)
    stops = corners(line)
    assert len(stops) == 5
    (a, b), *_, (c, d) = stops
    # from the middle of S to that of T, in one scale on both axes, y down on paper
    assert (c - a) / (3.85 - 1.0) == pytest.approx((b - d) / (4.15 - 1.2), rel=1e-3)
    scale = (c - a) / 2.85
    crossings = [((x - a) / scale + 1.0, (b - y) / scale + 1.2) for x, y in stops[1:-1]]
    expected = [abstraction.facet_centre(i, j) for i, j in pairwise(path)]
    for found, centre in zip(crossings, expected, strict=True):
        assert found == pytest.approx(tuple(centre), abs=2e-3)
    # one filled polygon per obstacle and target, of the size of its cell on that scale
    [obstacle] = sets(svg, "obstacle")
    face = obstacle.find(f"{SVG}path")
    assert face is not None
    xs, ys = zip(*corners(face), strict=True)
    assert (max(xs) - min(xs)) / scale == pytest.approx(1.3, abs=2e-3)
    assert (max(ys) - min(ys)) / scale == pytest.approx(1.0, abs=2e-3)
    assert len(sets(svg, "target")) == 1


def test_propositions_that_a_name_does_not_say() -> None:
    regions = (box("A", "region", (0, 3), (0, 2)), box("B", "obstacle", (1, 2), (0, 2)))
    workspace = Workspace("W", 2, box("bounds", "bounds", (0, 4), (0, 3)), regions)
    texts = written(workspace_svg(abstract(workspace), workspace))
    assert "{A, B}" in texts
    assert "A.1" in texts
    assert "{A}" not in texts


def test_small_cells_have_no_names_and_every_cell_is_drawn() -> None:
    workspace = plane_world(3, obstacles=30, side=8)
    abstraction = abstract(workspace)
    svg = workspace_svg(abstraction, workspace)
    names = [cell.name for cell in abstraction.cells]
    shown = set(written(svg)) & set(names)
    assert 0 < len(shown) < len(names)
    assert len(of_class(svg, "path", "face")) >= len(names)
    finer = abstract(bench())
    finer = finer.cut(bisections(finer, 500))
    assert len(sets(workspace_svg(finer, bench()), "cell")) >= 400


def test_a_path_that_comes_back_goes_through_the_cell() -> None:
    workspace = bench()
    abstraction = abstract(workspace)
    start, free = abstraction.index("S"), abstraction.index("free.5")
    svg = workspace_svg(abstraction, workspace, [[start, start, free, start]])
    [line] = ways(svg)
    there = corners(line)
    assert len(there) == 5
    assert there[1] == there[3] != there[2]
    several = workspace_svg(abstraction, workspace, [[start], [], [start, free]])
    assert {"path 1", "path 3"} <= set(written(several))


def test_between_cells_that_are_no_neighbours_a_path_is_straight() -> None:
    workspace = bench()
    abstraction = abstract(workspace)
    start, target = abstraction.index("S"), abstraction.index("T")
    assert target not in abstraction.neighbours[start]
    [line] = ways(workspace_svg(abstraction, workspace, [[start, target]]))
    assert len(set(corners(line))) == 2


def test_space_with_a_path() -> None:
    workspace = space_world(2, obstacles=3)
    abstraction = abstract(workspace)
    svg = workspace_svg(abstraction, workspace, [abstraction.adjacency[-1]])
    assert svg == workspace_svg(abstraction, workspace, [abstraction.adjacency[-1]])
    assert {"x", "y", "z", "path", workspace.name} <= set(written(svg))
    obstacles = [cell for cell in abstraction.cells if cell.kind == "obstacle"]
    drawn = sets(svg, "obstacle")
    assert len(drawn) == len(obstacles)
    # every edge is drawn once: by Euler's formula there are as many as faces and vertices, less two
    edges = [each.findall(f"{SVG}path")[1].get("d", "").count("M") for each in drawn]
    expected = [len(c.polytope.facets) + len(c.polytope.vertices) - 2 for c in obstacles]
    assert sorted(edges) == sorted(expected)


@pytest.mark.parametrize("name", ["x" * 400, "<&>\"'", "a\u202eb"])
def test_titles_of_any_kind_stay_in_the_picture(name: str) -> None:
    svg = workspace_svg(abstract(bench()), bench(), title=name)
    root = ET.fromstring(svg)
    titles = of_class(svg, "text", "title")
    assert "".join(each.text or "" for each in titles)[:5] == name.replace("\u202e", "\ufffd")[:5]
    width = float(root.get("width", ""))
    assert all(7.0 * len(each.text or "") <= width for each in titles)
    assert len(titles) <= 3

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import matplotlib as mpl
import pytest

from compiler.geometry.abstraction import abstract
from compiler.geometry.bisection import bisections
from grammar_lang.ir import Workspace
from srgc.render.workspace_picture import workspace_svg
from tests.conftest import ROOT, srgc_process
from tests.oracles.planes import bench, box
from tests.oracles.random_worlds import plane_world, space_world

SVG = "{http://www.w3.org/2000/svg}"
BLUE, RED, GREEN = "#2e6fba", "#d1495b", "#4c956c"


def written(svg: str) -> list[str]:
    """The texts of a figure: matplotlib leaves them as comments beside their outlines."""
    return [text.strip() for text in re.findall(r"<!--(.*?)-->", svg, re.DOTALL)]


def drawn_paths(svg: str, style: str) -> list[ET.Element]:
    root = ET.fromstring(svg)
    return [element for element in root.iter(f"{SVG}path") if style in element.get("style", "")]


def corners(element: ET.Element) -> list[tuple[float, float]]:
    numbers = re.findall(r"[ML] ([-\d.]+) ([-\d.]+)", element.get("d", ""))
    return [(float(x), float(y)) for x, y in numbers]


def test_the_running_example_with_a_path() -> None:
    workspace = bench()
    abstraction = abstract(workspace)
    path = [abstraction.index(name) for name in ("S", "free.5", "free.8", "T")]
    svg = workspace_svg(abstraction, workspace, [path], title="PickAndPlace")
    assert svg == workspace_svg(abstract(bench()), bench(), [path], title="PickAndPlace")
    texts = written(svg)
    assert {cell.name for cell in abstraction.cells} <= set(texts)
    assert {"PickAndPlace", "path", "obstacle", "target", "region", "x (m)"} <= set(texts)
    (line,) = [p for p in drawn_paths(svg, f"stroke: {BLUE}; stroke-width: 2.4")
               if len(corners(p)) == 5]  # fmt: skip
    (a, b), *_, (c, d) = corners(line)
    # from the middle of S to that of T, in one scale on both axes, y down on paper
    stops = corners(line)
    assert (c - a) / (3.85 - 1.0) == pytest.approx((b - d) / (4.15 - 1.2))
    scale = (c - a) / 2.85
    crossings = [((x - a) / scale + 1.0, (b - y) / scale + 1.2) for x, y in stops[1:-1]]
    expected = [abstraction.facet_centre(i, j) for i, j in pairwise(path)]
    for found, centre in zip(crossings, expected, strict=True):
        assert found == pytest.approx(tuple(centre), abs=1e-3)
    # one filled polygon per obstacle and target, of the size of its cell on that scale
    (obstacle,) = drawn_paths(svg, f"fill: {RED}; fill-opacity: 0.45; stroke: #8d94a3")
    xs, ys = zip(*corners(obstacle), strict=True)
    assert (max(xs) - min(xs)) / scale == pytest.approx(1.3, abs=1e-3)
    assert (max(ys) - min(ys)) / scale == pytest.approx(1.0, abs=1e-3)
    assert len(drawn_paths(svg, f"fill: {GREEN}; fill-opacity: 0.45; stroke: #8d94a3")) == 1


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
    assert len(drawn_paths(svg, "stroke: #8d94a3")) >= len(names)
    finer = abstract(bench())
    finer = finer.cut(bisections(finer, 500))
    assert len(drawn_paths(workspace_svg(finer, bench()), "stroke: #8d94a3")) >= 500


def test_a_path_that_comes_back_goes_through_the_cell() -> None:
    workspace = bench()
    abstraction = abstract(workspace)
    start, free = abstraction.index("S"), abstraction.index("free.5")
    svg = workspace_svg(abstraction, workspace, [[start, start, free, start]])
    (line,) = [p for p in drawn_paths(svg, f"stroke: {BLUE}; stroke-width: 2.4")
               if len(corners(p)) == 5]  # fmt: skip
    there = corners(line)
    assert there[1] == there[3] != there[2]
    several = workspace_svg(abstraction, workspace, [[start], [], [start, free]])
    assert {"path 1", "path 3"} <= set(written(several))
    with pytest.raises(KeyError):
        workspace_svg(abstraction, workspace, [[start, abstraction.index("T")]])


def test_space_with_a_path() -> None:
    workspace = space_world(2, obstacles=3)
    abstraction = abstract(workspace)
    svg = workspace_svg(abstraction, workspace, [abstraction.adjacency[-1]])
    assert svg == workspace_svg(abstraction, workspace, [abstraction.adjacency[-1]])
    assert {"x", "y", "z", "path", workspace.name} <= set(written(svg))
    faces = sum(len(cell.polytope.facets) for cell in abstraction.cells if cell.kind == "obstacle")
    assert len(drawn_paths(svg, f"fill: {RED}; fill-opacity: 0.16")) == faces


def test_neither_settings_of_others_nor_threads_change_a_picture() -> None:
    workspace = bench()
    abstraction = abstract(workspace)

    def picture(number: int) -> str:
        return workspace_svg(abstraction, workspace, [[number % 3]], title="PickAndPlace")

    expected = [picture(number) for number in range(6)]
    with mpl.rc_context({"axes.grid": True, "font.size": 30, "axes.facecolor": "red"}):
        assert picture(0) == expected[0]
        assert mpl.rcParams["axes.grid"]
        with ThreadPoolExecutor(6) as threads:
            assert list(threads.map(picture, range(6))) == expected
        assert mpl.rcParams["font.size"] == 30


def test_the_backend_of_another_program_is_not_looked_for(tmp_path):
    spec = tmp_path / "arm.srg"
    spec.write_bytes((ROOT / "specs" / "nested.srg").read_bytes())
    arguments = ["plan", "arm.srg", "-o", "plan.svg"]
    with srgc_process(arguments, tmp_path, MPLBACKEND="nonsense") as process:
        _, err = process.communicate(timeout=120)
    assert (process.returncode, err) == (0, b"")
    assert (tmp_path / "plan.svg").read_text(encoding="utf-8").rstrip().endswith("</svg>")

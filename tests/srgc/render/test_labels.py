"""Labels never lie on each other, stay in their pictures, and can be read."""

from __future__ import annotations

import random
import re
import string
from dataclasses import replace

import networkx as nx
import numpy as np
import pytest
from shapely import LineString, Polygon, box

from compiler.workspaces.abstraction import abstract
from compiler.workspaces.bisection import bisections
from solvers.search.configuration_search import Sample
from srgc.landscapes.landscape import Landscape
from srgc.landscapes.landscape_picture import landscape_svg
from srgc.landscapes.landscape_request import Axis, Mark
from srgc.render.charts import Curve, line_chart
from srgc.render.label_placement import Label, LabelPlacer, leader_ends
from srgc.render.region_names import name_boxes, page_name_boxes, page_names, shape_names
from srgc.render.svg import View, document, fitted, from_above
from srgc.render.text_size import text_width
from srgc.render.workspace_drawing import WorkspaceShape, measure_box, scale_bar
from srgc.render.workspace_picture import workspace_svg
from tests.oracles.drawn_texts import drawn_texts, outside, overlaps, true_width
from tests.oracles.planes import bench
from tests.oracles.random_worlds import space_world, tilted_boxes

SQUARE = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
LEAST = 9.0
"""Pixels of a text that can be read on a screen of 1280, which the widest pictures fill."""


@pytest.mark.parametrize("bold", [False, True])
def test_texts_are_as_wide_as_the_font_says(bold: bool) -> None:
    rng = random.Random(1)
    letters = string.ascii_letters + string.digits + string.punctuation + " "
    for length in (1, 2, 7, 40):
        for _ in range(25):
            says = "".join(rng.choice(letters) for _ in range(length))
            width, true = text_width(says, 11.0, bold=bold), true_width(says, 11.0, bold=bold)
            assert true - 1e-9 <= width <= true + 0.011 * length + 1e-9
    for says in ("é", "ü", "ε", "ρ", "Ж", "—"):
        assert text_width(says, 10.0, bold=bold) >= true_width(says, 10.0, bold=bold)


def placed(seed: int, count: int) -> list[tuple[Label, np.ndarray | None]]:
    rng = np.random.default_rng(seed)
    placer = LabelPlacer((600.0, 400.0), rng.uniform(0, 400, (50, 2)))
    labels = []
    for _ in range(count):
        at = rng.uniform((0, 0), (600, 400))
        size = rng.uniform(20, 90), rng.uniform(10, 30)
        labels.append(Label(at, size, at if rng.random() < 0.3 else None))
    return [(label, placer.place(label)) for label in labels]


@pytest.mark.parametrize("seed", range(2))
def test_placed_labels_are_apart_and_inside(seed: int) -> None:
    first, again = placed(seed, 40), placed(seed, 40)
    found = [(label, middle) for label, middle in first if middle is not None]
    assert len(found) >= 38
    for i, (label, middle) in enumerate(found):
        half = np.array(label.size) / 2
        assert (middle - half >= 0).all()
        assert (middle + half <= (600, 400)).all()
        for other, place in found[:i]:
            gap = np.abs(middle - place) - half - np.array(other.size) / 2
            assert gap.max() >= 2 - 1e-9
        ends = leader_ends(label, middle)
        off = np.hypot(*np.maximum(np.abs(middle - label.at) - half, 0))
        assert (ends is not None) == (off >= 12)
    assert [str(middle) for _, middle in first] == [str(middle) for _, middle in again]


def test_a_full_picture_has_no_place() -> None:
    placer = LabelPlacer((50.0, 20.0))
    label = Label(np.array([25.0, 10.0]), (40.0, 15.0))
    assert placer.place(label) is not None
    assert placer.place(label) is None
    assert placer.place(Label(np.array([99.0, 10.0]), (4.0, 4.0))) is None


def legible(svg: str) -> None:
    texts = drawn_texts(svg)
    assert overlaps(texts) == []
    assert outside(texts, svg) == []
    assert min(text.size for text in texts) >= LEAST


def test_four_hundred_cells_among_tilted_boxes_can_be_read() -> None:
    workspace = tilted_boxes(7, obstacles=40, side=40)
    cells = abstract(workspace)
    cells = cells.cut(bisections(cells, 400))
    first = next(i for i, each in enumerate(cells.neighbours) if len(each) > 1)
    second = sorted(cells.neighbours[first])[0]
    svg = workspace_svg(cells, workspace, [[first, second]])
    legible(svg)
    texts = {text.says for text in drawn_texts(svg)}
    named = [cell.name for cell in cells.cells if cell.name in texts]
    assert len(named) >= 0.75 * len(cells.cells)
    assert {cells.cells[first].name, cells.cells[second].name} <= texts
    (said,) = [each for each in texts if "too small" in each]
    assert int(said.split()[0]) == len(cells.cells) - len(named)


def test_few_cells_can_be_read() -> None:
    workspace = bench()
    cells = abstract(workspace)
    path = [cells.index(name) for name in ("S", "free.5", "free.8", "T")]
    legible(workspace_svg(cells, workspace, [path]))
    fine = cells.cut(bisections(cells, 400))
    legible(workspace_svg(fine, workspace))


def test_names_in_space_can_be_read() -> None:
    workspace = space_world(3, obstacles=12)
    legible(workspace_svg(abstract(workspace), workspace))


def crowd(count: int, side: float) -> list[WorkspaceShape]:
    """Squares in rows, close to each other, with names that are wider than they are."""
    shapes = []
    for k in range(count):
        low = np.array([k % 8, k // 8], dtype=float) * 1.2
        corners = low + np.array([[0, 0], [side, 0], [side, side], [0, side]])
        name = f"Obstacle_number_{k}"[: 6 + 3 * (k % 4)]
        shapes.append(WorkspaceShape("obstacle", name, name, corners, ()))
    return shapes


@pytest.mark.parametrize(("count", "side"), [(3, 1.0), (40, 0.2), (40, 1.0)])
def test_names_of_regions_are_apart_at_both_sizes(count: int, side: float) -> None:
    shapes = crowd(count, side)
    view = from_above(np.concatenate([shape.corners for shape in shapes]))
    for kind, size in (("names", 13.0), ("names narrow", 24.0)):
        names = shape_names(shapes, view, size=size, kind=kind)
        svg = document(names, (view.width, view.height), "scene", "x")
        texts = [text for text in drawn_texts(svg, size) if text.says != "x"]
        assert overlaps(texts) == []
        assert outside(texts, svg) == []
        if size == 13.0:
            assert len(texts) == count
    assert page_names(shapes, view).count("<text") == 2 * count


# --- landscapes ----------------------------------------------------------------------------------


def axis(place: int, count: int) -> Axis:
    return Axis(place, f"{4 + place}.length", "Link", "m", np.linspace(1.0, 2.0, count), False)


def line(values: list[float]) -> Landscape:
    grid = [
        Sample(np.array([x]), value, value >= 0)
        for x, value in zip(axis(0, len(values)).values, values, strict=True)
    ]
    design = max(grid, key=lambda sample: sample.robustness)
    marks = (Mark((1.5,), "here"),)
    return Landscape((axis(0, len(values)),), tuple(grid), marks, (grid[0],), (grid[-1],), design)


def numbers(data: str) -> list[float]:

    return [float(x) for x in re.findall(r"-?\d+\.?\d*", data)]


def rails(svg: str) -> list[tuple[float, float]]:
    """The tops and bases of the frames of the plots, from above."""

    found = re.findall(
        r'class="spine" x="[\d.]+" y="([\d.]+)" width="[\d.]+" height="([\d.]+)"', svg
    )
    return sorted((float(y), float(y) + float(h)) for y, h in found)


def test_what_is_infeasible_has_a_scale_of_its_own() -> None:
    """A value of -50 beside values near 8 leaves these a scale on which they differ."""

    values = [-50.0, -20.0, 7.0, 8.0, 9.0, -10.0]
    svg = landscape_svg(line(values), "x")
    upper, lower = rails(svg)
    assert upper[1] < lower[0]
    dots = re.findall(r'class="(good|lacks)" transform="translate\([\d.]+ ([\d.]+)\)', svg)
    good = [float(y) for kind, y in dots if kind == "good"]
    lacks = [float(y) for kind, y in dots if kind == "lacks"]
    assert len(good) == 3
    assert all(upper[0] <= y <= upper[1] for y in good)
    assert good[0] - good[2] > 0.5 * (upper[1] - upper[0])
    assert all(lower[0] <= y <= lower[1] for y in lacks)
    # linear on its own scale: -50, -20, -10
    assert (lacks[0] - lacks[1]) / (lacks[1] - lacks[2]) == pytest.approx(3, rel=0.02)
    legible(svg)


@pytest.mark.parametrize("values", [[9.0, 8.0, 7.0], [-1.0, -2.0, -3.0], [1.0, -1.0, 1.0, -1.0]])
def test_a_landscape_has_no_scraps(values: list[float]) -> None:
    """No mark without an area: no line of one point, no band or field without a width."""

    svg = landscape_svg(line(values), "x")
    for width, height in re.findall(
        r'<rect class="infeasible"[^>]* width="([\d.]+)" height="([\d.]+)"', svg
    ):
        assert min(float(width), float(height)) > 1
    for data in re.findall(r'class="line[^"]*" d="([^"]*)"', svg):
        for part in data.split("M")[1:]:
            assert len(numbers(part)) >= 4 or "h" in part
    legible(svg)


def test_a_plane_has_two_scales_and_no_short_lines() -> None:

    xs = np.linspace(1.0, 2.0, 9)
    grid = []
    for x in xs:
        for y in xs:
            # one grid point sticks out: lines of equal values about it are scraps
            value = x + y + (0.3 if (x, y) == (xs[4], xs[4]) else 0.0)
            grid.append(Sample(np.array([x, y]), value if x < 1.8 else -x, bool(x < 1.8)))
    content = Landscape((axis(0, 9), axis(1, 9)), tuple(grid), (), (), (), grid[40])
    svg = landscape_svg(content, "x")
    fields = re.findall(r'<rect [^>]*fill="(#[0-9a-f]{6})"><title>\(([\d.]+), ([\d.]+)\)', svg)
    assert len(fields) == 81
    feasible = {colour for colour, x, _ in fields if float(x) < 1.8}
    lacking = {colour for colour, x, _ in fields if float(x) > 1.8}
    assert not feasible & lacking
    (data,) = re.findall(r'class="contour" d="([^"]*)"', svg)
    ends = np.array(numbers(data)).reshape(-1, 2, 2)
    assert (np.hypot(*(ends[:, 1] - ends[:, 0]).T) > 0).all()

    graph = nx.Graph()
    for a, b in ends.tolist():
        graph.add_edge(tuple(a), tuple(b), long=float(np.hypot(a[0] - b[0], a[1] - b[1])))
    for part in nx.connected_components(graph):
        assert sum(long for _, _, long in graph.subgraph(part).edges(data="long")) >= 45
    legible(svg)


@pytest.mark.parametrize("scale", [1e-7, 1.0, 12345.0])
def test_values_along_an_axis_are_apart(scale: float) -> None:
    """On a phone letters of charts are larger, by the style sheet of the report."""
    times = np.linspace(0.0, scale, 20)
    svg = line_chart(Curve("q", "q", "m", times, np.sin(times / scale)))
    svg = svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1)
    assert overlaps(drawn_texts(svg)) == []
    assert len(drawn_texts(svg)) > 5


def test_names_are_nearer_to_their_own_sets_than_to_others() -> None:
    """Two shelves side by side, and two boxes one above the other."""
    sets = {
        "ShelfOnTheLeftSide": (0.2, 0.4, 0.6, 0.9),
        "ShelfOnTheRight": (0.42, 0.6, 0.6, 0.9),
        "StartOfTheConveyor": (0.9, 1.1, -0.1, 0.1),
        "PalletForFinishedParts": (0.9, 1.1, 0.12, 0.3),
    }
    shapes = [
        WorkspaceShape("region", name, name, np.array([(a, c), (b, c), (b, d), (a, d)]), ())
        for name, (a, b, c, d) in sets.items()
    ]
    view = View(np.eye(2), np.array([0.5, 0.3]), 170.0, 600.0, 600.0)
    own = [view.project(shape.corners) for shape in shapes]
    boxes = name_boxes(shapes, view)
    assert len(boxes) == len(shapes)
    for number, each in enumerate(boxes):
        middle = (each[:2] + each[2:]) / 2
        away = [np.linalg.norm(corners.mean(axis=0) - middle) for corners in own]
        assert np.argmin(away) == number, shapes[number].name


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("angle", [15, 30, 60, 105])
def test_names_on_pages_keep_off_paths_and_edges(angle: int, side: int) -> None:
    """A beam as wide as its name, but tilted, and a path close to it."""
    along, across = turned(angle).T
    corners = np.array([[-0.26, -0.1], [0.26, -0.1], [0.26, 0.1], [-0.26, 0.1]]) @ [along, across]
    shapes = [
        WorkspaceShape("bounds", "bounds", "", 1.5 * np.array(SQUARE), ()),
        WorkspaceShape("obstacle", "Beam", "Beam", corners, ()),
    ]
    view = fitted([shape.corners for shape in shapes])
    path = np.linspace(-0.5, 0.5, 400)[:, None] * along + 0.16 * side * across
    drawn = view.project(path)
    beam_shape = Polygon(view.project(corners))
    names = page_name_boxes(shapes, view, drawn)[1:]
    assert len(names) == 2
    for left, top, right, bottom in names:
        name = box(left, top, right, bottom)
        assert beam_shape.contains(name) or not beam_shape.intersects(name)
        assert not name.intersects(LineString(drawn))
    # Where there is room in the set, the name stays there.
    large = replace(shapes[1], corners=3 * corners)
    for left, top, right, bottom in page_name_boxes([shapes[0], large], view)[1:2]:
        assert Polygon(view.project(large.corners)).contains(box(left, top, right, bottom))


@pytest.mark.parametrize("size", [12.0, 24.0])
@pytest.mark.parametrize("side", [0.03, 1.0, 1.5, 40.0])
def test_the_length_of_the_scale_bar_is_off_the_bounds(side: float, size: float) -> None:
    """Letters are 12 high on a wide page, 24 on a phone."""
    bounds = side * np.array(SQUARE)
    view = fitted([bounds])
    bar = scale_bar(view)
    svg = document(bar, (view.width, view.height), "scene", "x")
    (says,) = re.findall(r">([\d.]+) m</text>", bar)
    ((begin, base),) = re.findall(r'<text x="([\d.]+)" y="([\d.]+)"', bar)
    # Digits of DejaVu Sans are 0.73 of the size above their base line.
    assert float(base) - 0.73 * size > view.project(bounds)[:, 1].max()
    assert float(base) <= view.height
    ((x, wide),) = re.findall(r'd="M([\d.]+) [\d.]+v4h([\d.]+)v-4"', bar)
    assert float(begin) > float(x) + float(wide)
    assert float(wide) == pytest.approx(float(says) * view.scale, abs=0.06)
    assert outside(drawn_texts(svg, size), svg) == []
    width, box_end = true_width(f"{says} m", size), measure_box(view, size)[0, 2]
    assert float(begin) + width <= box_end + 0.1


def turned(angle: float) -> np.ndarray:
    """The rotation by an angle in degrees."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.array([[c, -s], [s, c]])

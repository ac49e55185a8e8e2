"""Pictures as files: whole in themselves, with a style for every mark."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from compiler.workspaces.abstraction import abstract
from srgc.render.svg import LETTER, MARGIN, closed_path, document, marks_style, moved, place
from srgc.render.workspace_picture import workspace_svg
from tests.oracles.planes import bench
from tests.oracles.random_worlds import space_world

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize(
    ("value", "shown"), [(1.0, "1"), (-0.04, "0"), (2.25, "2.2"), (-3.46, "-3.5"), (0.0, "0")]
)
def test_places_are_short(value: float, shown: str) -> None:
    assert place(value) == shown


def test_a_closed_path_comes_back_to_its_corners() -> None:
    corners = np.array([[10.04, -3.26], [0.0, 0.5], [-0.26, 7.0], [12.0, 7.0]])
    data = closed_path(corners)
    assert data.endswith("Z")
    numbers = [float(x) for x in re.findall(r"-?(?:\d+\.?\d*|\.\d+)", data)]
    found = np.array(numbers).reshape(-1, 2).cumsum(axis=0)
    np.testing.assert_allclose(found, corners, atol=0.051)


def test_a_path_of_one_corner_is_a_dot() -> None:
    """SVG 1.1, 8.3.9: an `l` has coordinates; 11.4: a path without length has round caps."""
    assert closed_path(np.array([[3.0, 4.5]])) == "M3 4.5Z"


def test_a_file_needs_nothing_else() -> None:
    """No variable of a page, no address but that of the namespace, a size of its own."""
    svg = document(moved(1, 2, '<path class="line"/>'), (100, 50), "chart", "a <b>\nc", [("", "d")])
    assert "var(" not in svg
    assert re.findall(r"https?://[^\"]*", svg) == ["http://www.w3.org/2000/svg"]
    root = ET.fromstring(svg)
    assert root.get("viewBox") == f"0 0 {root.get('width')} {root.get('height')}"
    assert [text.text for text in root.iter(f"{SVG}text")] == ["a <b>", "c", "d"]


def test_a_legend_breaks_its_lines() -> None:
    entries = [("", "x" * count) for count in (10, 20, 30, 5)]
    root = ET.fromstring(document("", (300, 50), "chart", "t", entries))
    [legend] = [each for each in root.iter(f"{SVG}g") if each.get("class") == "legend"]
    places = [[float(x) for x in each.get("transform", "")[10:-1].split()] for each in legend]
    assert len({y for _, y in places}) == 3
    width = float(root.get("width", ""))
    for (x, _), (_, says) in zip(places, entries, strict=True):
        assert MARGIN + x + 30 + LETTER * len(says) <= width


@pytest.mark.parametrize(
    "workspace", [bench(), space_world(2, obstacles=3)], ids=["plane", "space"]
)
def test_every_mark_has_a_style(workspace) -> None:
    cells = abstract(workspace)
    svg = workspace_svg(cells, workspace, [cells.adjacency[0]])
    used = {name for each in ET.fromstring(svg).iter() for name in each.get("class", "").split()}
    grouping = {"picture", "names", "shape", "here", "tick"}
    assert used - grouping <= set(re.findall(r"\.([a-z][a-z0-9-]*)", marks_style()))

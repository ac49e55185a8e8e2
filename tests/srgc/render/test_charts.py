"""Scales, curves and text of the pictures."""

from __future__ import annotations

import json
import math
import re
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from srgc.render.axes import padded, tick_labels, ticks
from srgc.render.charts import LEFT, MOST_POINTS, Curve, Point, line_chart, scatter_chart, thinned
from srgc.render.heat_map import plane_chart
from srgc.render.html_text import json_script, number, text, with_unit
from srgc.report.evidence import covering_size
from tests.oracles.html_page import Page

WIDTHS = {"-": 3.8, ".": 3.4, "e": 6.5}
"""Of characters on the picture, in a wide font (DejaVu Sans of 10.5 px); digits have 6.7."""
VALUES = st.floats(-1e6, 1e6, allow_nan=False)


@given(VALUES, VALUES, st.integers(4, 8))
def test_ticks_are_round_inside_and_told_apart(a: float, b: float, most: int) -> None:
    low, high = padded(min(a, b), max(a, b))
    found = ticks(low, high, most)
    span = high - low
    assert 2 <= len(found) <= most + 1
    assert all(low - 1e-6 * span <= value <= high + 1e-6 * span for value in found)
    steps = [after - before for before, after in pairwise(found)]
    assert max(steps) - min(steps) <= 1e-6 * span
    digits = f"{steps[0]:.0e}"[0]
    assert digits in "125"
    labels = tick_labels(found)
    assert len(set(labels)) == len(labels)
    for label, value in zip(labels, found, strict=True):
        assert float(label) == pytest.approx(value, abs=1e-3 * steps[0] + 1e-4 * abs(value))


@pytest.mark.parametrize("size", [1e-8, 3.7e-6, 1e-4, 0.02, 1.0, 700.0, 2.3e6, 8e11])
def test_labels_have_room_beside_the_axis(size: float) -> None:
    """A label that is cut off on the left would be another number."""
    times = np.array([0.0, 1.0, 2.0])
    values = np.array([-size, 0.3 * size, size])
    curve = Page(line_chart(Curve("u1", "u1", "N", times, values)))
    points = [Point(float(t), float(v), "good", "") for t, v in zip(times, values, strict=True)]
    for page in (curve, Page(scatter_chart(points, "x", "m"))):
        labels = [e for e in page.all("text", text_anchor="end") if e.attributes["x"] != "348.0"]
        assert len(labels) > 1
        assert max(sum(WIDTHS.get(c, 6.7) for c in e.text) for e in labels) <= LEFT - 5
        shown = [float(e.text) for e in labels]
        assert shown == sorted(shown)
        assert min(shown) < 0 < max(shown)
        heights = [float(e.attributes["y"]) for e in labels]
        fitted = np.polyval(np.polyfit(shown, heights, 1), shown)
        np.testing.assert_allclose(fitted, heights, atol=0.2)


def test_the_unit_stands_behind_the_last_time() -> None:
    times = np.array([0.0, 0.6, 1.2])
    page = Page(line_chart(Curve("q1", "q1", "rad", times, times)))
    labels = [e.text for e in page.all("text", text_anchor="middle")]
    assert labels[-1] == "1.2 s"
    assert not any(label.endswith("s") for label in labels[:-1])
    assert "s" not in [e.text for e in page.all("text")]


def test_counts_have_whole_labels() -> None:
    points = [Point(1.0, 2.0, "good", "")]
    page = Page(scatter_chart(points, "the evaluations", "evaluation", counted=True))
    assert [e.text for e in page.all("text", text_anchor="middle")] == ["1"]


def test_a_constant_has_a_scale() -> None:
    low, high = padded(5.0, 5.0)
    assert low < 5 < high
    assert high - low > 0.1


@pytest.mark.parametrize("count", [MOST_POINTS + 1, 777, 5 * MOST_POINTS])
def test_of_held_values_the_largest_stays(count: int) -> None:
    values = np.random.default_rng(count).normal(size=count)
    times = np.arange(len(values) + 1, dtype=float)
    curve = thinned(Curve("u1", "u1", "N", times, values, held=True))
    assert len(curve.values) == len(curve.times) - 1 <= MOST_POINTS
    assert (curve.times[0], curve.times[-1]) == (0, len(values))
    assert np.abs(curve.values).max() == np.abs(values).max()


def test_of_a_held_band_the_widest_stays() -> None:
    count = 3 * MOST_POINTS + 7
    values = np.random.default_rng(3).normal(size=count)
    band = np.stack([values - 1, values + 2], axis=-1)
    times = np.arange(count + 1, dtype=float)
    curve = thinned(Curve("u1", "u1", "N", times, values, held=True, band=band))
    assert curve.band is not None
    assert curve.band.shape == (len(curve.values), 2)
    assert (curve.band[:, 0].min(), curve.band[:, 1].max()) == (values.min() - 1, values.max() + 2)
    page = Page(line_chart(curve))
    (tube,) = page.all("path", class_="tube series-1")
    assert tube.attributes["d"].count("L") == 4 * len(curve.values) - 1


def test_a_curve_passes_through_its_values() -> None:
    """Where a path is drawn is read back from the picture, by its own labelled grid lines."""
    curve = Curve("q1", "q1", "rad", np.array([0.0, 1.0, 2.0]), np.array([0.0, 4.0, 2.0]))
    page = Page(line_chart(curve))
    path = next(e for e in page.all("path") if e.attributes["class"].startswith("line"))
    points = [tuple(map(float, p.split())) for p in re.split("[ML]", path.attributes["d"]) if p]
    (svg,) = page.all("svg")
    first, last = float(svg.attributes["data-x0"]), float(svg.attributes["data-x1"])
    assert [x for x, _ in points] == pytest.approx([first, (first + last) / 2, last], abs=0.06)
    lines = [
        float(e.attributes["y1"])
        for e in page.all("line", x1=str(LEFT))
        if "class" not in e.attributes
    ]
    labels = [float(e.text) for e in page.all("text", text_anchor="end")]
    heights = np.polyfit(labels, lines, 1)
    for (_, y), value in zip(points, curve.values, strict=True):
        assert y == pytest.approx(np.polyval(heights, value), abs=0.2)


def test_near_bounds_are_lines_and_far_ones_stand_at_the_gauge() -> None:
    times, values = np.array([0.0, 1.0]), np.array([0.0, 1.0])
    near = Page(line_chart(Curve("q1", "q1", "m", times, values, bounds=(-0.5, 1.5))))
    far = Page(line_chart(Curve("q1", "q1", "m", times, values, bounds=(-50.0, 50.0))))
    assert len(near.all("line", class_="bound")) == 2
    assert not far.all("line", class_="bound")
    for page, bound in ((near, 1.5), (far, 50)):
        shown = {
            float(e.attributes["data-bound"])
            for e in page.all("text")
            if "data-bound" in e.attributes
        }
        assert shown == {bound, -0.5 if bound == 1.5 else -50}


def test_a_tube_is_drawn_where_it_can_be_seen() -> None:
    times, values = np.array([0.0, 1.0]), np.array([0.0, 1.0])
    for width, drawn in ((0.2, True), (1e-9, False)):
        band = np.stack([values - width, values + width], axis=-1)
        curve = Curve("q1", "q1", "m", times, values, band=band)
        assert ("tube" in line_chart(curve)) == drawn


def test_infeasible_points_stand_apart_from_feasible_ones() -> None:
    points = [Point(0, 1, "good", "a"), Point(1, -9, "bad", "<b>"), Point(2, 2, "design", "c")]
    page = Page(scatter_chart(points, "x", "m"))
    assert page.faults == []
    assert len(page.all("circle")) == 1
    assert len(page.all("path", class_="bad")) == 1
    assert [each.text for each in page.all("title")] == ["a", "<b>", "c"]
    assert len(page.all("rect", class_="rail")) == 1
    assert not Page(scatter_chart(points[1:2], "x", "m")).all("rect", class_="rail")


def test_a_landscape_has_a_field_per_point() -> None:
    cells = [(x, y, -1.0 if x == y else x + y, x != y) for x in (0.0, 1.0, 2.0) for y in (5.0, 1.0)]
    page = Page(plane_chart(cells, (1.0, 5.0), ("a", "b")))
    assert len(page.all("title")) == len(cells)
    said = [each.text for each in page.all("title")]
    assert [each for each in said if "infeasible" in each] == ["(1, 1): infeasible, robustness -1"]


@pytest.mark.parametrize(
    ("value", "shown"),
    [(0.0, "0"), (-0.0, "0"), (1234567.0, "1235000"), (1.25e-5, "0.0000125"), (2.0, "2"),
     (1e-9, "1e-9"), (-2.5e12, "-2.5e12"), (math.inf, "∞"), (-1.5, "-1.5")],
)  # fmt: skip
def test_numbers_are_short(value: float, shown: str) -> None:
    assert number(value) == shown


def test_units_are_written_behind() -> None:
    assert with_unit(2.0, "N*m") == "2 N*m"
    assert with_unit(2.0, "1") == "2"


@given(st.text())
def test_any_text_stays_text(content: str) -> None:
    page = Page(f'<p title="{text(content)}">{text(content)}</p>')
    (element,) = page.elements
    assert page.faults == []
    assert element.attributes["title"] == element.text
    allowed = [a for a, b in zip(content, element.text, strict=True) if b != "\ufffd"]
    assert all(a.isprintable() or a.isspace() or ord(a) > 159 for a in allowed)
    again = Page(json_script("x", {content: content}))
    assert again.faults == []
    assert json.loads(again.elements[0].text) == {content: content}


def test_a_covering_is_counted(tmp_path) -> None:
    path = tmp_path / "0000.boxes"
    path.write_text("boxes 1\nA|a..!aa...\n", encoding="ascii")
    size = covering_size(path.parent, path.name)
    assert size is not None
    assert (size.parameters, size.coordinates, size.by_drives) == (2, 5, 1)
    path.write_text("no", encoding="ascii")
    assert covering_size(path.parent, path.name) is None
    assert covering_size(tmp_path, "none") is None

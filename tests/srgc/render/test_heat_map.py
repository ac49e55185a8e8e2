"""Fields and lines of equal values, against functions whose level sets are known."""

from __future__ import annotations

import re

import numpy as np
import pytest

from srgc.render.heat_map import COLOURS, colour, contours, edges, heat_marks, heat_plot
from tests.oracles.html_page import Page

XS, YS = [0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0]
BOX = (0.0, 0.0, 400.0, 300.0)


def segments(path: str) -> np.ndarray:  # type: ignore[type-arg]
    """The ends of all lines, (m, 2, 2)."""
    return np.array([float(x) for x in re.findall(r"-?[\d.]+", path.partition(' d="')[2])]).reshape(
        -1, 2, 2
    )


def test_level_lines_of_a_plane_are_straight() -> None:
    """x + 2 y is linear in every square, so that each line lies on its level, to a tenth."""
    plot = heat_plot(XS, YS, BOX)
    values = np.array([[x + 2 * y for y in YS] for x in XS])
    found = segments(contours(XS, YS, values, plot, 6))
    x = plot.across.low + found[..., 0] / 400 * (plot.across.high - plot.across.low)
    y = plot.up.low + (300 - found[..., 1]) / 300 * (plot.up.high - plot.up.low)
    levels = np.arange(1, 7)
    off = np.abs((x + 2 * y)[..., None] - levels).min(axis=-1)
    assert off.max() < 5e-3
    assert {int(level) for level in np.rint(x + 2 * y).ravel()} == set(levels.tolist())


def test_a_saddle_has_two_lines() -> None:
    values = np.array([[1.0, -1.0], [-1.0, 1.0]])
    plot = heat_plot([0.0, 1.0], [0.0, 1.0], BOX)
    assert len(segments(contours([0.0, 1.0], [0.0, 1.0], values, plot, 1))) == 2


def test_no_line_goes_where_something_is_infeasible() -> None:
    values = np.array([[x + 2 * y for y in YS] for x in XS])
    values[1, 1] = np.nan
    plot = heat_plot(XS, YS, BOX)
    found = segments(contours(XS, YS, values, plot, 6))
    x = plot.across.low + found[..., 0] / 400 * (plot.across.high - plot.across.low)
    assert x.min() >= 2 - 1e-3
    assert contours(XS, YS, np.full((4, 3), np.nan), plot, 6) == ""
    assert contours(XS, YS, np.ones((4, 3)), plot, 6) == ""


def test_a_field_for_every_point() -> None:
    values = np.arange(12.0).reshape(4, 3)
    values[0, 1] = np.nan
    page = Page(f"<svg>{heat_marks(XS, YS, values, heat_plot(XS, YS, BOX))}</svg>")
    titles = [each.text for each in page.all("title")]
    assert len(titles) == 12
    assert titles[1] == "(0, 1): infeasible"
    assert titles[11] == "(3, 2): robustness 11"
    assert page.all("rect", fill=COLOURS[0])
    assert page.all("rect", fill=COLOURS[-1])


@pytest.mark.parametrize(
    ("values", "expected"), [([2.0], [1.5, 2.5]), ([0.0, 1.0, 4.0], [-0.5, 0.5, 2.5, 5.5])]
)
def test_borders_are_between_values(values: list[float], expected: list[float]) -> None:
    assert edges(values) == expected


def test_colours_go_from_the_first_to_the_last() -> None:
    assert [colour(part) for part in (-1.0, 0.0, 0.2, 1.0, 2.0)] == [
        COLOURS[0], COLOURS[0], COLOURS[1], COLOURS[-1], COLOURS[-1],
    ]  # fmt: skip

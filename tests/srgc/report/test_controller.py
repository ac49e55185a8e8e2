"""The report of a design with feedback: gains, the width of the tube, inputs with their band."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from srgc.report.charts import motion_curves
from srgc.report.evidence import Evidence
from tests.oracles import result_files
from tests.oracles.html_page import Page

Pages = Callable[[str], tuple[Path, Page]]


def drawn(page: Page, chart: str, colour: int) -> list[tuple[float, float]]:
    """The corners of a curve of a chart, in units of the picture."""
    path = next(
        each
        for each in page.all("path", class_=f"line series-{colour}")
        if each.within("data-name", chart)
    )
    return [
        (float(x), float(y))
        for x, y in (point.split() for point in re.split("[ML]", path.attributes["d"]) if point)
    ]


def values(page: Page, chart: str, colour: int) -> list[float]:
    """What a curve shows at its corners, by the labelled lines of the chart."""
    lines = [
        float(each.attributes["y1"])
        for each in page.all("line")
        if each.within("data-name", chart)
        and "class" not in each.attributes
        and each.attributes["y1"] == each.attributes["y2"]
    ]
    labels = [
        float(each.text)
        for each in page.all("text", text_anchor="end")
        if each.within("data-name", chart)
    ]
    slope, offset = np.polyfit(lines, labels, 1)
    return [float(slope * y + offset) for _, y in drawn(page, chart, colour)]


def test_gains_are_those_of_the_certificate(pages: Pages) -> None:
    folder, page = pages("closed")
    (controller,) = result_files.read(folder)["claims"]
    gains = np.array(controller["gains"], dtype=float)
    for place, unit in enumerate(("rad", "rad/s")):
        # A gain is held from a sample to the next, so that each has two corners.
        held = np.repeat(gains[:, 0, place], 2)
        shown = values(page, f"gain-1-{unit}", 1)
        np.testing.assert_allclose(shown, held, atol=2e-3 * np.ptp(held))


def test_the_width_is_that_of_the_disturbances_at_first(pages: Pages) -> None:
    """0.5 degrees to either side, at the start exactly."""
    page = pages("closed")[1]
    assert "coordinates (rad)" in page.section("width")
    for chart in ("width-coordinates-rad", "width-rates-rad/s"):
        assert values(page, chart, 1)[0] == pytest.approx(np.radians(1.0), rel=0.02)


def test_the_band_of_an_input_holds_what_corners_command(
    evidence_on: Callable[[str], Evidence],
) -> None:
    """At the first sample: gains times the largest deviations measured there, and rounding."""
    evidence = evidence_on("closed")
    claim = evidence.found and evidence.found.claim
    assert claim is not None
    assert claim.controller is not None
    (curve,) = next(g for g in motion_curves(evidence) if g.title == "Inputs").curves
    assert curve.band is not None
    assert curve.band.shape == (len(claim.inputs), 2)
    assert (curve.band[:, 0] <= curve.values).all()
    assert (curve.values <= curve.band[:, 1]).all()
    gains = np.array([[float(text) for text in row] for row in claim.controller.gains[0]])
    off = np.radians([0.5 + 0.05, 0.5 + 0.1])
    most = float(claim.inputs[0][0]) + float(np.abs(gains[0]) @ off)
    assert claim.controller.rounding is not None
    most += float(claim.controller.rounding[0])
    assert curve.band[0, 1] == pytest.approx(most, rel=1e-6)


def test_figures_say_what_the_tube_commands(pages: Pages) -> None:
    head = pages("closed")[1].section("verdict")
    assert "controlfeedback" in head
    assert "peak effort in the tube" in head
    assert "controlopen loop" in pages("turner")[1].section("verdict")


def test_an_open_loop_has_neither_gains_nor_widths(pages: Pages) -> None:
    page = pages("turner")[1]
    assert not page.all("section", id="gains")
    assert not page.all("section", id="width")
    assert "The band of an input" not in page.section("charts")
    assert "The band of an input" in pages("closed")[1].section("charts")

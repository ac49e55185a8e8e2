"""What comes first on a page and what last; of an unknown task the nearest motion moves."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.oracles import result_files
from tests.oracles.html_page import Page
from tests.oracles.nearest_folder import without_claim
from tests.srgc.report.conftest import page_of

Pages = Callable[[str], tuple[Path, Page]]


@pytest.fixture(scope="module")
def near(
    made: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Page]:
    folder = tmp_path_factory.mktemp("near") / "out"
    without_claim(made("turner") / "out", folder)
    return folder, page_of(folder)


def sections(page: Page) -> list[str]:
    return [each.attributes["id"] for each in page.all("section")]


def test_the_motion_is_first_and_the_derivation_last(pages: Pages) -> None:
    _, page = pages("turner")
    assert sections(page)[:3] == ["motion", "next", "verdict"]
    assert sections(page)[-2:] == ["check", "derivation"]
    assert "srgc verify ." in page.section("next")
    assert page.source.index('<p class="verdict') < page.source.index('<section id="motion"')


def test_after_impossible_the_next_is_why(pages: Pages) -> None:
    _, page = pages("beyond_reach")
    assert sections(page)[:3] == ["motion", "next", "verdict"]
    assert "srgc why ." in page.section("next")
    assert not page.all("section", id="derivation")


def test_the_legend_tells_the_tube_from_obstacles(pages: Pages) -> None:
    _, page = pages("turner")
    legend = page.source.partition('<ul class="legend">')[2].partition("</ul>")[0]
    assert 'class="tube"' in legend
    assert "proved tube" in legend
    assert 'class="shape obstacle"' in legend
    assert "no collision" in page.section("motion")
    _, without = pages("beyond_reach")
    assert "proved" not in without.section("motion")


def test_the_nearest_motion_moves_as_its_table_says(near: tuple[Path, Page]) -> None:
    """The pole of the spec turns about the origin: its tip is at length * (cos, sin) of q1."""
    folder, page = near
    assert sections(page)[:4] == ["motion", "nearest", "next", "verdict"]
    said = page.section("motion")
    assert "nothing of it is proved" in said
    assert "does not do it" in said
    assert "it is stuck at 1 s at (0.5, 1) m" in page.section("nearest")
    assert "Try first more steps." in page.section("next")
    data = page.data("motion-data")
    motion = data["motion"]
    assert motion["tube"] is None
    with (folder / "nearest.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    (length,) = (
        each["value"] for each in result_files.read(folder, "design.json")["nearest"]["parameters"]
    )
    times = np.array(motion["times"])
    points = np.array(motion["points"]).reshape(len(times), -1, 2) * data["unit"]
    foot, tip = points[:, 0], points[:, motion["effectors"][0]]
    for row in rows:
        at = int(np.abs(times - float(row["t"])).argmin())
        assert times[at] == pytest.approx(float(row["t"]), abs=1e-6)
        angle = float(row["q1"])
        expected = length * np.array([np.cos(angle), np.sin(angle)])
        np.testing.assert_allclose(tip[at] - foot[at], expected, atol=3 * data["unit"])


@pytest.mark.parametrize("broken", ["table", "number", "robot", "missing"])
def test_what_is_kept_and_fits_nothing_is_not_shown(
    near: tuple[Path, Page], tmp_path: Path, broken: str
) -> None:
    folder = tmp_path / "out"
    shutil.copytree(near[0], folder)
    (folder / "report.html").unlink()
    design = result_files.read(folder, "design.json")
    if broken == "table":
        (folder / "nearest.csv").write_text("t,q1,qd1\n0,nan,0\n", encoding="utf-8")
    elif broken == "missing":
        (folder / "nearest.csv").unlink()
    elif broken == "robot":
        design["nearest"]["derivation"] = ["link", "base"]
    else:
        design["nearest"]["parameters"] = [{"value": "much"}]
    result_files.write(folder, design, "design.json")
    page = page_of(folder)
    assert "There is no robot" in page.section("motion")
    assert "it lacks a little" in page.section("nearest")

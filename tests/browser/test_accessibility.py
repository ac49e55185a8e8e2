"""Reports for people who use a keyboard, a screen reader or strong contrasts."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from srgc.cli import run
from tests.oracles.axe import SEEN, serious, show, source
from tests.oracles.browsers import Opened
from tests.oracles.nearest_folder import without_claim

Open = Callable[[str], Opened]


def findings(page: Opened, width: int, colours: str) -> list[str]:
    """What is seriously wrong, all details unfolded."""
    show(page.driver, width, colours)
    page.run("document.querySelectorAll('details').forEach((each) => { each.open = true; });")
    return serious(page.driver, source())


@pytest.mark.parametrize(("width", "colours"), SEEN)
@pytest.mark.parametrize("spec", ["planar_arm", "spatial", "beyond_reach", "plotter"])
def test_a_report_has_no_serious_finding(opened: Open, spec: str, width: int, colours: str) -> None:
    assert findings(opened(spec), width, colours) == []


@pytest.mark.parametrize(("width", "colours"), SEEN)
def test_the_page_of_an_unknown_task_has_no_serious_finding(
    opened: Open, made: Callable[[str], Path], tmp_path: Path, width: int, colours: str
) -> None:
    page = opened("turner")
    folder = without_claim(made("turner") / "out", tmp_path / "out")
    assert run(["report", str(folder), "-q"]) == 0
    page.driver.get((folder / "report.html").as_uri())
    assert findings(page, width, colours) == []


def test_a_fault_is_found(opened: Open) -> None:
    """An image without words for it, and a text that is hardly darker than its paper."""
    page = opened("turner")
    faulty = '<img src="data:,"><p style="color: #ccc; background: #fff">pale</p>'
    page.run("document.body.insertAdjacentHTML('beforeend', arguments[0]);", faulty)
    found = findings(page, 1280, "light")
    assert {each.partition(":")[0] for each in found} == {"image-alt", "color-contrast"}

"""The front of designs of a report in a real browser: a click on a design shows it moving."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from srgc.cli import run
from tests.oracles.browsers import Opened
from tests.oracles.priced_slides import priced_slides


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("front")
    text = priced_slides("minimize sum(price) then mass then effort;")
    (place / "slides.srg").write_text(text, encoding="utf-8")
    out = place / "out"
    assert run(["synth", str(place / "slides.srg"), "--all", "-o", str(out), "-q"]) == 0
    assert run(["report", str(out), "--no-verify", "-q"]) == 0
    return out / "report.html"


@pytest.fixture
def page(driver: Any, page_file: Path) -> Iterator[Opened]:
    opened = Opened(driver, page_file)
    opened.command("Emulation.clearDeviceMetricsOverride")
    opened.media("screen", prefers_color_scheme="light", prefers_reduced_motion="no-preference")
    driver.get("about:blank")
    opened.complaints()
    driver.get(page_file.as_uri())
    yield opened
    opened.command("Emulation.setScriptExecutionDisabled", value=False)


Visible = Callable[[], list[str]]


def visible(page: Opened) -> list[str]:
    groups = page.all("[data-robot]")
    return [
        each.get_attribute("data-robot")
        for each in groups
        if each.get_attribute("visibility") == "visible"
    ]


def test_the_chosen_design_is_shown_first(page: Opened) -> None:
    assert visible(page) == ["1"]
    assert page.one(".front-name").text.startswith("Base e Heavy e Hand: price 10")
    assert page.complaints() == []


def test_a_click_on_a_design_shows_it_moving(page: Opened) -> None:
    place = "[data-robot='2'] .effector"
    diamond = page.one(".front-chart:not([hidden]) [data-front='2']")
    page.run("arguments[0].scrollIntoView({block: 'center'});", diamond)
    diamond.click()
    assert visible(page) == ["2"]
    assert page.one(".front-name").text.startswith("Base e Light e Hand: price 30")
    before = page.on_screen(page.one(place))
    time.sleep(0.6)
    after = page.on_screen(page.one(place))
    assert after[0] > before[0]
    page.one(".front-play").click()
    still = page.on_screen(page.one(place))
    time.sleep(0.3)
    assert page.on_screen(page.one(place)) == still
    assert page.complaints() == []


def test_buttons_do_without_a_pointer(page: Opened) -> None:
    button = page.one("button[data-front='2']")
    page.run("arguments[0].focus();", button)
    button.send_keys(" ")
    assert visible(page) == ["2"]
    assert button.get_attribute("aria-pressed") == "true"


def test_with_little_motion_a_click_shows_the_end(page: Opened) -> None:
    page.media("screen", prefers_reduced_motion="reduce")
    page.run("document.querySelector(\"button[data-front='2']\").click();")
    place = "[data-robot='2'] .effector"
    before = page.on_screen(page.one(place))
    time.sleep(0.3)
    assert page.on_screen(page.one(place)) == before


def test_axes_are_chosen(page: Opened) -> None:
    select = page.one(".axes-choice select")
    page.run("arguments[0].value = '1-2'; arguments[0].dispatchEvent(new Event('change'));", select)
    shown = [each.get_attribute("data-axes") for each in page.all(".front-chart:not([hidden])")]
    assert shown == ["1-2"]


def test_without_scripts_there_is_the_table(page: Opened) -> None:
    page.command("Emulation.setScriptExecutionDisabled", value=True)
    page.driver.refresh()
    assert page.one(".front-table").is_displayed()
    assert all(head.text.strip() for head in page.all(".front-table th"))
    assert page.one(".front-chart").is_displayed()
    assert not page.one(".front-scene").is_displayed()
    assert not [each for each in page.all("button.choice") if each.is_displayed()]

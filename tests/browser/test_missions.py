"""The page about a mission in a real browser: motions in turn, on phones, in the dark, on paper."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest

from tests.browser.test_whole_page import CONTRASTS
from tests.oracles.browsers import Opened

Open = Callable[[str], Opened]
SLIDER = "#motion input[type=range]"


def shown(page: Opened) -> list[str]:
    """The tasks whose pictures are seen."""
    parts = page.all("#motion .part")
    return [part.get_attribute("data-task") for part in parts if part.is_displayed()]


def to(page: Opened, value: int) -> None:
    page.run(
        "arguments[0].value = arguments[1];"
        "arguments[0].dispatchEvent(new Event('input', {bubbles: true}));",
        page.one(SLIDER), value,
    )  # fmt: skip


def test_the_slider_runs_through_all_tasks(opened: Open) -> None:
    page = opened("mission_grow")
    places = {}
    for value in (0, 12, 13, 25, 26, 38):
        to(page, value)
        (task,) = shown(page)
        (part,) = [each for each in page.all("#motion .part") if each.is_displayed()]
        (said,) = [each for each in page.all("#motion .said") if each.is_displayed()]
        places[value] = page.on_screen(part.find_element("css selector", ".robot .effector"))
        sample = said.find_element("css selector", ".sample").text
        assert (task, int(sample)) == (("Long", "Wide", "Again")[value // 13], value % 13)
        pressed = page.all("#motion .jumps [aria-pressed=true]")
        assert [button.text for button in pressed] == [task]
    assert len({(round(x), round(y)) for x, y in places.values()}) >= 4
    assert page.one(SLIDER).get_attribute("aria-valuetext") == "Again, 1.2 s"
    assert page.complaints() == []


def test_a_button_begins_its_task(opened: Open) -> None:
    page = opened("mission_grow")
    page.one("#motion .jumps [data-part='1']").click()
    assert shown(page) == ["Wide"]
    assert page.one(SLIDER).get_attribute("value") == "13"


def test_play_goes_on_to_the_last_task_and_stops(opened: Open) -> None:
    page = opened("mission_retune")
    page.run("document.querySelector('#motion .speed select').value = '4';")
    page.one("#motion .play").click()
    seen: set[str] = set()
    end = time.monotonic() + 20
    while page.one("#motion .play").get_attribute("aria-label") == "Pause":
        seen |= set(shown(page))
        assert time.monotonic() < end
    assert seen | set(shown(page)) == {"Long", "Short"}
    assert shown(page) == ["Short"]
    assert page.one(SLIDER).get_attribute("value") == "25"
    page.one("#motion .play").click()
    assert shown(page) == ["Long"]
    page.one("#motion .play").click()


@pytest.mark.parametrize("width", [320, 768])
@pytest.mark.parametrize("name", ["grow", "nobody"])
def test_it_does_not_scroll_sideways(opened: Open, name: str, width: int) -> None:
    page = opened(f"mission_{name}")
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=740, deviceScaleFactor=2, mobile=True,
    )  # fmt: skip
    wide = page.run(
        "return [document.documentElement.scrollWidth, document.documentElement.clientWidth];"
    )
    assert wide == [width, width]


def test_every_text_can_be_read_by_day_and_in_the_dark(opened: Open) -> None:
    page = opened("mission_grow")
    for scheme in ("light", "dark"):
        page.media("screen", prefers_color_scheme=scheme)
        assert page.run(CONTRASTS) == [], scheme


def test_names_in_the_line_of_robots_do_not_cover_each_other(opened: Open) -> None:
    page = opened("mission_grow")
    covered = page.run(
        "const found = [];"
        "for (const svg of document.querySelectorAll('#robots .modules')) {"
        "  const boxes = Array.from(svg.querySelectorAll('.name text')).map((e) => e.getBBox());"
        "  boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => {"
        "    const w = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);"
        "    const h = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);"
        "    if (w > 1 && h > 3) found.push([w, h]); }));"
        "}"
        "return found;"
    )
    assert covered == []


def test_paper_has_the_poses_of_every_task(opened: Open) -> None:
    page = opened("mission_grow")
    page.media("print")
    assert not page.one("#motion .controls").is_displayed()
    assert len([e for e in page.all("#motion .poses svg") if e.is_displayed()]) == 18
    heads = [e.text for e in page.all("#motion .stills h3") if e.is_displayed()]
    assert heads == ["Long", "Wide", "Again"]

"""The animation of a report in a real browser, against the trajectory that the folder holds."""

from __future__ import annotations

import csv
import re
import time
from collections.abc import Callable
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.oracles.browsers import Opened

Open = Callable[[str], Opened]

BOUNDS = {
    "planar_arm": ((0, 0), (5, 5)),
    "turner": ((-1, -1), (3, 3)),
    "spatial": ((-1.2, -1.2, -0.5), (1.2, 1.2, 1.2)),
}
"""As the specs say; the picture of the bounds is what a test measures the picture by."""
SLIDER = "#motion input[type=range]"


def rows(made: Callable[[str], Path], spec: str) -> list[dict[str, str]]:
    text = (made(spec) / "out" / "trajectory.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def to_sample(page: Opened, sample: int) -> None:
    page.run(
        "arguments[0].value = arguments[1];"
        "arguments[0].dispatchEvent(new Event('input', {bubbles: true}));",
        page.one(SLIDER), sample,
    )  # fmt: skip


def expected(page: Opened, spec: str, point: tuple[float, float], axes: tuple[int, int]) -> Any:
    """Where a point is on the screen, measured by where the bounds are drawn."""
    left, top, right, bottom = page.run(
        "const f = arguments[0], b = f.getBBox(), m = f.getScreenCTM();"
        "const x = m.e + scrollX, y = m.f + scrollY;"
        "return [m.a * b.x + x, m.d * b.y + y,"
        " m.a * (b.x + b.width) + x, m.d * (b.y + b.height) + y];",
        page.one("#motion .bounds .face"),
    )
    low, high = BOUNDS[spec]
    i, j = axes
    x = left + (point[0] - low[i]) / (high[i] - low[i]) * (right - left)
    y = bottom + (point[1] - low[j]) / (high[j] - low[j]) * (top - bottom)
    return pytest.approx((x, y), abs=1)


@pytest.mark.parametrize("spec", ["planar_arm", "turner"])
def test_slider_moves_the_arm_as_the_trajectory_says(
    opened: Open, made: Callable[[str], Path], spec: str
) -> None:
    page, table = opened(spec), rows(made, spec)
    tip = page.one("#motion .robot .effector")
    seen = []
    for sample in (0, len(table) // 3, 2 * len(table) // 3, len(table) - 1):
        to_sample(page, sample)
        point = float(table[sample]["e1_x"]), float(table[sample]["e1_y"])
        seen.append(page.on_screen(tip))
        assert seen[-1] == expected(page, spec, point, (0, 1))
        assert float(page.one("#motion .time").text.split()[0]) == pytest.approx(
            float(table[sample]["t"]), abs=1e-3
        )
    assert len(set(seen)) == 4
    assert page.complaints() == []


def test_rods_keep_their_length_and_end_in_the_effector(opened: Open) -> None:
    page = opened("planar_arm")
    lengths = set()
    for sample in (0, 25, 50, 81):
        to_sample(page, sample)
        ends = [
            [float(rod.get_attribute(name)) for name in ("x1", "y1", "x2", "y2")]
            for rod in page.all("#motion > figure > .scene .rod")
        ]
        for a, b in pairwise(ends):
            assert a[2:] == pytest.approx(b[:2], abs=0.15)
        lengths.add(tuple(round(((a - c) ** 2 + (b - d) ** 2) ** 0.5) for a, b, c, d in ends))
        shift = page.one("#motion .effector").get_attribute("transform")
        assert [float(v) for v in re.findall(r"[-\d.]+", shift)] == pytest.approx(
            ends[-1][2:], abs=0.15
        )
    assert len(lengths) == 1


@pytest.mark.parametrize(("view", "axes"), [("Front", (0, 2)), ("Side", (1, 2)), ("Top", (0, 1))])
def test_views_of_space(
    opened: Open, made: Callable[[str], Path], view: str, axes: tuple[int, int]
) -> None:
    page, table = opened("spatial"), rows(made, "spatial")
    button = next(each for each in page.all("#motion .views button") if view in each.text)
    button.click()
    assert button.get_attribute("aria-pressed") == "true"
    for sample in (0, 4, len(table) - 1):
        to_sample(page, sample)
        place = [float(table[sample][f"e1_{axis}"]) for axis in "xyz"]
        point = place[axes[0]], place[axes[1]]
        assert page.on_screen(page.one("#motion .effector")) == expected(
            page, "spatial", point, axes
        )
    assert page.complaints() == []


def test_dragging_turns_space_but_not_the_robot_within_it(opened: Open) -> None:
    from selenium.webdriver.common.action_chains import ActionChains

    page = opened("spatial")
    picture = page.one("#motion > figure > .scene")
    page.run("arguments[0].scrollIntoView({block: 'center'});", picture)
    before = page.on_screen(page.one("#motion .effector"))
    edges = page.one("#motion .target .edges").get_attribute("d")
    ActionChains(page.driver).drag_and_drop_by_offset(picture, 90, 20).perform()
    assert page.on_screen(page.one("#motion .effector")) != pytest.approx(before, abs=2)
    assert page.one("#motion .target .edges").get_attribute("d") != edges
    page.one("#motion .views button").click()
    assert page.on_screen(page.one("#motion .effector")) == pytest.approx(before, abs=0.2)
    assert page.one("#motion .target .edges").get_attribute("d") == edges
    assert page.complaints() == []


def test_keyboard(opened: Open) -> None:
    from selenium.webdriver.common.keys import Keys

    page = opened("turner")
    slider = page.one(SLIDER)
    start = page.on_screen(page.one("#motion .effector"))
    slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
    assert slider.get_attribute("value") == "2"
    assert slider.get_attribute("aria-valuetext") == "0.4 s"
    assert page.on_screen(page.one("#motion .effector")) != pytest.approx(start, abs=0.5)
    slider.send_keys(Keys.END)
    assert page.one("#motion .sample").text == "10"
    slider.send_keys(Keys.HOME)
    assert page.on_screen(page.one("#motion .effector")) == pytest.approx(start, abs=0.2)


@pytest.mark.parametrize("motion", ["no-preference", "reduce"])
def test_play_runs_to_the_end_and_stops(opened: Open, motion: str) -> None:
    page = opened("turner")
    page.media("screen", prefers_reduced_motion=motion)
    page.run("document.querySelector('#motion .speed select').value = '4';")
    page.run(
        "window.times = [];"
        "document.addEventListener('srgc-time', (event) => window.times.push(event.detail.t));"
    )
    button = page.one("#motion .play")
    button.click()
    assert button.get_attribute("aria-label") == "Pause"
    until = time.monotonic() + 30
    while button.get_attribute("aria-label") == "Pause" and time.monotonic() < until:
        time.sleep(0.05)
    times = page.run("return window.times;")
    assert page.one("#motion .sample").text == "10"
    assert times == sorted(times)
    assert times[-1] == pytest.approx(2)
    if motion == "reduce":
        assert len(times) <= 3
    assert page.complaints() == []


def test_other_parts_of_the_page_can_seek(opened: Open) -> None:
    page = opened("turner")
    page.run("document.dispatchEvent(new CustomEvent('srgc-seek', {detail: {t: 1.1}}));")
    assert page.one("#motion .time").text == "1.1 s"
    page.run("document.dispatchEvent(new CustomEvent('srgc-seek', {detail: {t: 'no'}}));")
    page.run("document.dispatchEvent(new CustomEvent('srgc-seek'));")
    assert page.one("#motion .time").text == "1.1 s"
    page.run("document.dispatchEvent(new CustomEvent('srgc-seek', {detail: {t: 99}}));")
    assert page.one("#motion .time").text == "2 s"
    assert page.complaints() == []


def test_inputs_change_at_the_samples(opened: Open, made: Callable[[str], Path]) -> None:
    """A product of step and sample may round to just below the sample: 3 times 0.15 does."""
    page, table = opened("planar_arm"), rows(made, "planar_arm")
    output = page.one("output[data-for=u1]")
    for row in table[:-1]:
        before = float(row["t"]) - 1e-12
        page.run(
            "document.dispatchEvent(new CustomEvent('srgc-time', {detail: {t: arguments[0]}}));",
            before,
        )
        assert float(output.text) == pytest.approx(float(row["u1"]), rel=6e-4, abs=1e-9)


def test_cell_is_that_of_the_plan(opened: Open) -> None:
    page = opened("planar_arm")
    to_sample(page, 0)
    assert page.one("#motion .cell.here title").get_attribute("textContent") == "S"
    to_sample(page, 81)
    assert page.one("#motion dd.cell").text == "T"
    assert page.one("#motion .cell.here title").get_attribute("textContent") == "T"


@pytest.mark.parametrize("spec", ["planar_arm", "spatial"])
def test_script_draws_the_first_picture_as_the_page_has_it(opened: Open, spec: str) -> None:
    page = opened(spec)
    whole = page.path.read_text(encoding="utf-8").partition('id="motion"')[2]
    written = whole.partition('<div class="controls')[0]
    lines = re.findall(
        r'<line class="(\w+)" x1="([-\d.]+)" y1="([-\d.]+)" x2="([-\d.]+)" y2="([-\d.]+)"', written
    )
    shown = page.run(
        "return Array.from(document.querySelectorAll('#motion > figure > .scene line'))"
        ".map((line) => [line.getAttribute('class'),"
        "  ...['x1', 'y1', 'x2', 'y2'].map((name) => Number(line.getAttribute(name)))]);"
    )
    assert len(lines) == len(shown) > 2
    for text, drawn in zip(lines, shown, strict=True):
        assert text[0] == drawn[0]
        assert [float(v) for v in text[1:]] == pytest.approx(drawn[1:], abs=0.25)


def test_boxes_can_be_hidden(opened: Open) -> None:
    page = opened("turner")
    tube, switch = page.one("#motion .tube"), page.one("#motion [data-show=tube]")
    assert tube.is_displayed()
    switch.click()
    assert not tube.is_displayed()
    assert not page.one("#motion .ribbon").is_displayed()
    page.one("#motion [data-show=ribbon]").click()
    assert page.one("#motion .ribbon").is_displayed()


TOUCHING = """
const box = (mark) => mark.getBoundingClientRect();
const seen = (mark) => mark.getAttribute('visibility') !== 'hidden' && box(mark).width > 0;
const all = (selector) => Array.from(document.querySelectorAll(selector)).filter(seen);
const discs = all('#motion > figure > .scene .robot .number');
const others = all('#motion > figure > .scene .names text');
const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
const found = [];
for (const [i, disc] of discs.entries()) {
  for (const mark of others.concat(discs.slice(i + 1))) {
    if (meet(box(disc), box(mark))) found.push([disc.textContent, mark.textContent]);
  }
}
return [discs.length, others.length, found];
"""
"""The numbers of effectors, the names of regions, and which of them overlap on the screen."""


@pytest.mark.parametrize("width", [1100, 320])
def test_numbers_of_effectors_touch_no_name_at_any_sample(opened: Open, width: int) -> None:
    page = opened("plotter")
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=800, deviceScaleFactor=1, mobile=width < 800,
    )  # fmt: skip
    for sample in range(11):
        to_sample(page, sample)
        assert page.run(TOUCHING) == [2, 3, []]
    assert page.complaints() == []


def test_numbers_move_when_the_window_becomes_narrow(opened: Open) -> None:
    page = opened("plotter")
    number = "return document.querySelector('#motion .number').getAttribute('transform');"
    wide = page.run(number)
    page.command(
        "Emulation.setDeviceMetricsOverride", width=320, height=800, deviceScaleFactor=1,
        mobile=True,
    )  # fmt: skip
    page.run("window.dispatchEvent(new Event('resize'));")
    assert page.run(number) != wide
    assert page.run(TOUCHING) == [2, 3, []]


def test_regions_have_the_colour_that_the_legend_gives(opened: Open) -> None:
    """Of two regions, the first pen leaves one and the second the other, at another time."""
    page = opened("plotter")
    places = (
        "return Array.from(document.querySelectorAll(arguments[0])).map((mark) => {"
        "  const box = mark.getBoundingClientRect();"
        "  return [box.left + 6, box.top + (arguments[1] ? box.height / 2 : box.height - 6)];"
        "});"
    )
    colours = set()
    for sample in (0, 5, 10):
        to_sample(page, sample)
        page.run("document.querySelector('#motion').scrollIntoView();")
        found = page.run(places, "#motion > figure > .scene .region .face", False)
        shown = Image.open(BytesIO(page.driver.get_screenshot_as_png())).convert("RGB")
        colours |= {shown.getpixel((round(x), round(y))) for x, y in found}
        assert len(found) == 2
    page.run("document.querySelector('#motion .legend').scrollIntoView({block: 'center'});")
    (sample_at,) = page.run(places, "#motion .legend .region .face", True)
    shown = Image.open(BytesIO(page.driver.get_screenshot_as_png())).convert("RGB")
    colours.add(shown.getpixel((round(sample_at[0]), round(sample_at[1]))))
    assert max(np.ptp(np.array(list(colours)), axis=0)) <= 2, colours


def test_a_symbol_marks_its_module_everywhere(opened: Open) -> None:
    page = opened("planar_arm")
    chip = page.one('#robot .chip[data-symbol="4"]')
    page.run("arguments[0].focus();", chip)
    lit = page.all("#robot .lit")
    assert {mark.get_attribute("data-symbol") for mark in lit} == {"4"}
    assert {mark.tag_name for mark in lit} == {"li", "g", "tr"}
    page.run("arguments[0].blur();", chip)
    assert page.all("#robot .lit") == []


def test_no_robot_no_motion(opened: Open) -> None:
    page = opened("beyond_reach")
    assert page.all(SLIDER) == []
    assert page.all("#motion .robot") == []
    assert len(page.all("#motion > figure > .scene .target .face")) == 1
    assert "no robot" in page.one("#motion figcaption").text
    assert page.complaints() == []

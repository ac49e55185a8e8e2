"""A report in a real browser: it loads nothing, fits a phone, can be read in the dark, on paper."""

from __future__ import annotations

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from srgc.cli import run
from tests.oracles.browsers import Opened
from tests.oracles.nearest_folder import without_claim

TAB = "\ue004"
"""The key, as the WebDriver protocol names it."""

Open = Callable[[str], Opened]

SPECS = ["planar_arm", "spatial", "beyond_reach"]

CONTRASTS = """
const rgba = (text) => {
  const parts = (text.match(/[\\d.]+/g) || []).map(Number);
  if (parts.length < 3) return [0, 0, 0, 0];
  return parts.length > 3 ? parts : [...parts, 1];
};
const linear = (v) => (v /= 255) <= 0.03928 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4);
const light = (c) => 0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2]);
const paper = (element) => {
  for (let e = element; e; e = e.parentElement) {
    const c = rgba(getComputedStyle(e).backgroundColor);
    if (c[3] === 1) return c;
  }
  return rgba(getComputedStyle(document.documentElement).backgroundColor);
};
const found = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walker.nextNode()) {
  const element = walker.currentNode.parentElement;
  if (!walker.currentNode.data.trim() || !element.getClientRects().length) continue;
  if (element.closest('title, script, style, option, select')) continue;
  const style = getComputedStyle(element);
  const ink = rgba(element.closest('svg') ? style.fill : style.color);
  const a = light(ink), b = light(paper(element));
  const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  const kind = element.className.baseVal ?? element.className;
  const words = walker.currentNode.data.trim().slice(0, 40);
  if (ratio < 4.5) found.push([ratio.toFixed(2), element.tagName, kind, words].join(' '));
}
return found;
"""
"""All texts whose contrast with what is behind them is below 4.5, by the formula of WCAG 2."""


@pytest.mark.parametrize("spec", SPECS)
def test_nothing_is_loaded_and_the_console_is_silent(opened: Open, spec: str) -> None:
    page = opened(spec)
    assert page.requests() == [page.path.as_uri()]
    assert page.complaints() == []
    assert page.path.stat().st_size < 1_000_000


def test_without_a_network(opened: Open) -> None:
    page = opened("turner")
    page.command("Network.enable")
    conditions = {"latency": 0, "downloadThroughput": 0, "uploadThroughput": 0}
    page.command("Network.emulateNetworkConditions", offline=True, **conditions)
    try:
        page.driver.refresh()
        assert page.one("#motion.live").is_displayed()
        assert page.complaints() == []
    finally:
        unlimited = dict.fromkeys(("downloadThroughput", "uploadThroughput"), -1)
        page.command("Network.emulateNetworkConditions", offline=False, latency=0, **unlimited)


@pytest.mark.parametrize("width", [320, 360])
@pytest.mark.parametrize("spec", SPECS)
def test_a_phone_does_not_scroll_sideways(opened: Open, spec: str, width: int) -> None:
    page = opened(spec)
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width,
        height=740,
        deviceScaleFactor=2,
        mobile=True,
    )
    wide = page.run(
        "return [document.documentElement.scrollWidth, document.documentElement.clientWidth];"
    )
    assert wide == [width, width]


BROKEN = """
const parts = /[A-Z][a-z]{3,}/g, found = [];
const walker = document.createTreeWalker(document.querySelector('main'), NodeFilter.SHOW_TEXT);
let seen = 0;
while (walker.nextNode()) {
  const node = walker.currentNode, element = node.parentElement;
  if (element.closest('svg, pre, script, select') || !element.getClientRects().length) continue;
  for (const word of node.data.matchAll(parts)) {
    const range = document.createRange();
    range.setStart(node, word.index);
    range.setEnd(node, word.index + word[0].length);
    const tops = new Set(Array.from(range.getClientRects()).map((box) => box.top));
    seen += 1;
    if (tops.size > 1) found.push(word[0]);
  }
}
return [seen, found];
"""
"""How many capitalised words there are on the page, and those that are on two lines."""


@pytest.mark.parametrize("width", [320, 360])
def test_long_names_are_broken_between_their_words(opened: Open, width: int) -> None:
    page = opened("plotter")
    page.command(
        "Emulation.setDeviceMetricsOverride", width=width, height=740, deviceScaleFactor=2,
        mobile=True,
    )  # fmt: skip
    page.run("document.querySelectorAll('details').forEach((each) => { each.open = true; });")
    seen, broken = page.run(BROKEN)
    assert seen > 60
    assert broken == []
    wide = "return [document.documentElement.scrollWidth, document.documentElement.clientWidth];"
    assert page.run(wide) == [width, width]


@pytest.mark.parametrize("spec", SPECS)
def test_every_text_can_be_read_by_day_and_in_the_dark(opened: Open, spec: str) -> None:
    page = opened(spec)
    page.run("document.querySelectorAll('details').forEach((each) => { each.open = true; });")
    papers = set()
    for scheme in ("light", "dark"):
        page.media("screen", prefers_color_scheme=scheme)
        papers.add(page.run("return getComputedStyle(document.body).backgroundColor;"))
        assert page.run(CONTRASTS) == [], scheme
    assert len(papers) == 2


def test_print_has_poses_instead_of_controls(opened: Open) -> None:
    page = opened("planar_arm")
    controls, poses = page.one("#motion .controls"), page.one("#motion .poses")
    assert controls.is_displayed()
    assert not poses.is_displayed()
    page.media("print")
    assert not controls.is_displayed()
    assert poses.is_displayed()
    assert len(page.all("#motion .poses svg")) == 6


@pytest.mark.parametrize("spec", ["planar_arm", "spatial"])
def test_poses_have_the_sets_in_their_colours(opened: Open, spec: str) -> None:
    page = opened(spec)
    page.media("print")
    pose = page.one("#motion .poses svg")
    picture = Image.open(BytesIO(pose.screenshot_as_png)).convert("RGB")
    red, green, blue = np.moveaxis(np.asarray(picture, dtype=int), -1, 0)
    dark = np.maximum(np.maximum(red, green), blue) < 60
    reddish = (red > green + 25) & (red > blue + 25)
    assert dark.mean() < 0.05
    assert reddish.mean() > 0.002


def test_print_is_legible_whatever_the_screen_is(opened: Open) -> None:
    """A browser set to dark may print with that preference; paper is white all the same."""
    page = opened("planar_arm")
    page.media("print", prefers_color_scheme="dark")
    assert page.run(CONTRASTS) == []


def test_the_tab_key_stops_at_what_does_something(opened: Open) -> None:
    """Links, the word, controls and times, each once; of pictures none that cannot be turned."""
    page = opened("planar_arm")
    stops = []
    for _ in range(200):
        page.driver.switch_to.active_element.send_keys(TAB)
        stop = page.run(
            "const e = document.activeElement;"
            "if (e === document.body || e.dataset.stopped) return '';"
            "e.dataset.stopped = '1'; return e.tagName.toLowerCase();"
        )
        if not stop:
            break
        stops.append(stop)
    assert {*stops} <= {"a", "li", "button", "input", "select", "summary", "pre", "div"}
    assert stops.count("li") == len(page.all("#robot .chip"))
    assert "button" in stops


def test_names_of_any_length_stay_on_a_phone(opened: Open) -> None:
    """A name is one word, which nothing but the style breaks."""
    page = opened("planar_arm")
    width = 320
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=740, deviceScaleFactor=2, mobile=True,
    )  # fmt: skip
    page.run(
        "const long = 'a_name_without_any_blank_'.repeat(4);"
        "const texts = 'h1, .word, .chip, .parts th, .readings dd, .facts dd, .kicker, li code';"
        "document.querySelectorAll(texts).forEach((e) => { e.textContent = long; });"
    )
    assert page.run("return document.documentElement.scrollWidth;") == width


COVERED = """
const found = [];
for (const svg of document.querySelectorAll('#motion > figure > .scene, #robot .modules, .chart')) {
  const shown = Array.from(svg.querySelectorAll('text')).filter((e) => e.checkVisibility({
    visibilityProperty: true }) && e.getBoundingClientRect().width > 0);
  const boxes = shown.map((e) => [e.textContent, e.getBoundingClientRect()]);
  const frame = svg.getBoundingClientRect();
  boxes.forEach(([says, a], i) => {
    if (a.left < frame.left - 1 || a.right > frame.right + 1) found.push([says, 'outside']);
    boxes.slice(i + 1).forEach(([other, b]) => {
      const w = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const h = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
      if (w > 1 && h > 3) found.push([says, other]); });
    });
}
return found;
"""
"""Texts of pictures that meet, or leave them, as the browser has set them."""


@pytest.mark.parametrize("width", [320, 768, 1280])
@pytest.mark.parametrize("spec", ["planar_arm", "spatial"])
def test_no_label_lies_on_another(opened: Open, spec: str, width: int) -> None:
    page = opened(spec)
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=740, deviceScaleFactor=1, mobile=width < 500,
    )  # fmt: skip
    assert page.run(COVERED) == []
    if spec == "spatial":
        for button in page.all("#motion [data-view]"):
            page.run("arguments[0].click();", button)
            assert page.run(COVERED) == []


@pytest.mark.parametrize("width", [320, 768, 1280])
def test_the_scale_bar_is_below_the_bounds(opened: Open, width: int) -> None:
    page = opened("planar_arm")
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=740, deviceScaleFactor=1, mobile=width < 500,
    )  # fmt: skip
    length, bar, frame, picture = page.run(
        "return ['.ruler text', '.ruler path', '.bounds .face', ''].map((each) => {"
        "const b = document.querySelector('#motion > figure > .scene ' + each)"
        ".getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; });"
    )
    assert length[1] > frame[3] - 1
    assert bar[1] > frame[3]
    assert length[0] > bar[2]
    assert length[3] < picture[3] + 1


@pytest.mark.parametrize("width", [320, 1280])
def test_the_page_of_an_unknown_task_is_as_wide_as_the_screen(
    opened: Open, made: Callable[[str], Path], tmp_path: Path, width: int
) -> None:
    page = opened("turner")
    folder = without_claim(made("turner") / "out", tmp_path / "out")
    assert run(["report", str(folder), "-q"]) == 0
    page.command(
        "Emulation.setDeviceMetricsOverride",
        width=width, height=740, deviceScaleFactor=1, mobile=width < 500,
    )  # fmt: skip
    page.driver.get((folder / "report.html").as_uri())
    assert page.run("return document.documentElement.scrollWidth;") <= width
    before = page.on_screen(page.one("#motion .robot .effector"))
    page.run(
        "const e = arguments[0]; e.value = e.max; e.dispatchEvent(new Event('input'));",
        page.one("#motion input[type=range]"),
    )
    assert page.on_screen(page.one("#motion .robot .effector")) != before
    assert page.complaints() == []


def test_without_scripts_there_are_poses_and_nothing_that_does_nothing(opened: Open) -> None:
    page = opened("planar_arm")
    page.command("Emulation.setScriptExecutionDisabled", value=True)
    page.driver.refresh()
    assert page.one("#motion .poses").is_displayed()
    assert page.one("#motion > figure > .scene .rod").is_displayed()
    assert not page.one("#motion .controls").is_displayed()

"""Tables of a report on narrow screens: they fit, or an edge shows that there is more."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from srgc.cli import run
from tests.oracles.browsers import Opened
from tests.oracles.priced_slides import priced_slides

FOLDED = "#objectives table.folded, #margins table, #robot .parts"
SCALE = 2


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A design with objectives, margins and parts."""
    place = tmp_path_factory.mktemp("tables")
    text = priced_slides("minimize sum(price) then mass;")
    (place / "slides.srg").write_text(text, encoding="utf-8")
    assert run(["synth", str(place / "slides.srg"), "-o", str(place / "out"), "-q"]) == 0
    assert run(["report", str(place / "out"), "-q"]) == 0
    return place / "out" / "report.html"


Sized = Callable[..., Opened]


@pytest.fixture
def sized(driver: Any, page_file: Path) -> Iterator[Sized]:
    """Opens the page at a width, by day or in the dark."""
    opened = Opened(driver, page_file)

    def open_(width: int, scheme: str = "light") -> Opened:
        opened.media("screen", prefers_color_scheme=scheme)
        opened.command(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=740, deviceScaleFactor=SCALE, mobile=width < 500,
        )  # fmt: skip
        driver.get(page_file.as_uri())
        return opened

    yield open_
    opened.command("Emulation.clearDeviceMetricsOverride")


@pytest.mark.parametrize("width", [320, 480, 660, 768, 1280])
def test_the_main_tables_fit(sized: Sized, width: int) -> None:
    page = sized(width)
    tables = page.all(FOLDED)
    assert len(tables) == 3
    for table in tables:
        wide, room = page.run(
            "const e = arguments[0].closest('.scroll'); return [e.scrollWidth, e.clientWidth];",
            table,
        )
        assert wide <= room
    assert page.run("return document.documentElement.scrollWidth;") <= width


def test_every_cell_can_be_read_without_its_head(sized: Sized) -> None:
    """Where the heads of a table are not shown, its figures have theirs before them."""
    page = sized(1280)
    heads = page.run(
        "return Array.from(document.querySelectorAll('#objectives .folded th, #margins th'))"
        ".map((e) => e.textContent);"
    )
    page = sized(320)
    assert not any(
        each.is_displayed() for each in page.all("#objectives .folded thead, #margins thead")
    )
    said = page.run(
        "return Array.from(document.querySelectorAll('#objectives .folded td, #margins td'))"
        ".filter((e) => e.textContent).map((e) => getComputedStyle(e, '::before').content);"
    )
    shown = {each.strip('"').strip() for each in said} - {"none", "normal"}
    plain = {"objective", "what is claimed", "condition", "margin", "size"}
    assert shown == set(heads) - plain
    for figure in page.all("#objectives .folded td, #margins td"):
        if figure.text:
            assert figure.is_displayed()


def edges(page: Opened, box: Any) -> tuple[float, float]:
    """How much darker or lighter the left and the right edge are than the ground, up to 255."""
    picture = Image.open(BytesIO(box.screenshot_as_png)).convert("L")
    grey = np.asarray(picture, dtype=float)
    # The median over the height leaves out letters and lines.
    columns = np.median(grey, axis=0)
    ground = np.median(grey)
    near = slice(2 * SCALE, 5 * SCALE)
    return (
        float(np.abs(columns[near] - ground).max()),
        float(np.abs(columns[::-1][near] - ground).max()),
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("kind", ["table", "pre"])
def test_edges_show_where_there_is_more(sized: Sized, kind: str, scheme: str) -> None:
    page = sized(320, scheme)
    box = page.one("#check pre.commands" if kind == "pre" else "#check .scroll")
    page.run(
        "const e = arguments[0]; (e.querySelector('table') || e).style.minHeight = '12rem';"
        "if (arguments[1]) e.querySelector('table').style.minWidth = '40rem';"
        "e.dispatchEvent(new Event('resize', {bubbles: true}));",
        box, kind == "table",
    )  # fmt: skip
    assert page.run("const e = arguments[0]; return e.scrollWidth > e.clientWidth;", box)
    assert page.run("return arguments[0].tabIndex;", box) == 0
    seen = []
    for part in (0, 0.5, 1):
        page.run(
            "const e = arguments[0]; e.scrollLeft = arguments[1] * (e.scrollWidth - e.clientWidth);"
            "e.scrollIntoView({block: 'center'});",
            box, part,
        )  # fmt: skip
        left, right = edges(page, box)
        seen.append((left > 12, right > 12))
        assert left > 12 or left < 3
        assert right > 12 or right < 3
    assert seen == [(False, True), (True, True), (True, False)]


def test_what_fits_has_no_shadow(sized: Sized) -> None:
    page = sized(320)
    for table in page.all(FOLDED):
        page.run("arguments[0].scrollIntoView({block: 'center'});", table)
        assert max(edges(page, page.run("return arguments[0].closest('.scroll');", table))) < 3

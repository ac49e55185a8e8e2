"""``srgc view`` in a real browser: what its picture shows, against the tube of the certificate."""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
from PIL import Image
from selenium.webdriver.common.keys import Keys

from srgc.results.found_design import found_tube
from tests.oracles.browsers import SPACE, Opened, start
from tests.oracles.pictured_arm import START, pictured_arm, turn

pytest.importorskip("viser", reason="the extra view is not installed")

from srgc.view.page import EFFECTOR, ViewPage
from srgc.view.serving import page_address, viewer_server
from srgc.view.shown_designs import shown_designs

Result = Callable[[str], Path]
PATIENCE = 60.0
AROUND = 30
"""The pixels around a region in which nothing else is."""
WIDE, HIGH = 1000, 800
"""The window; its left part is free of controls."""
UP = {2: (0.0, 1.0, 0.0), 3: (0.0, 0.0, 1.0)}


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    driver = start(tmp_path_factory.mktemp("profile"), *SPACE, f"--window-size={WIDE},{HIGH}")
    yield driver
    driver.quit()


def until(condition: Callable[[], Any], what: str) -> Any:
    end = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < end, what
        time.sleep(0.05)
    return found


class Shown:
    """A page in a browser, with a camera that is known."""

    def __init__(self, browser: Any, page: ViewPage) -> None:
        self.page, self.opened = page, Opened(browser, Path())
        browser.get(page_address(page.server))
        self.client = next(iter(until(page.server.get_clients, "no client").values()))

    def aim(self, position: tuple[float, ...], look_at: tuple[float, ...], fov: float) -> None:
        camera, up = self.client.camera, UP[2 if self.page.flat else 3]
        self.eye, self.fov = np.array(position), fov
        forward = np.array(look_at) - self.eye
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, up)
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(forward, right), forward])
        camera.up_direction, camera.position, camera.look_at = up, position, look_at
        camera.fov = fov

    def pixel(self, point: np.ndarray) -> np.ndarray:
        """Where a pinhole camera sees a point, from the upper left corner."""
        width, height = self.opened.run(
            "const c = [...document.querySelectorAll('canvas')].pop();"
            "return [c.clientWidth, c.clientHeight];"
        )
        x, y, z = self.axes @ (point - self.eye)
        focal = height / 2 / np.tan(self.fov / 2)
        return np.array([width / 2 + focal * x / z, height / 2 + focal * y / z])

    def box(self, label: str) -> Any:
        xpath = f"//label[text()='{label}']"
        found = self.opened.driver.find_element("xpath", xpath).get_attribute("for")
        return self.opened.driver.find_element("id", found)

    def to(self, moment: float) -> None:
        """The number beside the slider is what its thumb sets, too."""
        field = self.opened.one(".mantine-NumberInput-input")
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(f"{moment:.3f}", Keys.ENTER)
        until(lambda: abs(self.page.time - moment) < 1e-9, f"not at {moment}")

    def dots(self) -> np.ndarray:
        """The pixels (m, 2) in the colour of effectors, when the picture has come to rest."""

        def seen() -> np.ndarray:
            png = self.opened.driver.get_screenshot_as_png()
            picture = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)
            rows, columns = np.nonzero(np.abs(picture - np.array(EFFECTOR)).max(axis=2) < 25)
            return np.stack([columns + 0.5, rows + 0.5], axis=1)

        before, end = seen(), time.monotonic() + PATIENCE
        while time.monotonic() < end:
            time.sleep(0.3)
            now = seen()
            if len(now) and np.array_equal(now, before):
                return now
            before = now
        raise AssertionError("no effector, or no rest")


@contextmanager
def viewed(browser: Any, *folders: Path, tubes: bool = True) -> Iterator[Shown]:
    page = ViewPage(server := viewer_server(None), shown_designs(folders, tubes=tubes).designs)
    try:
        yield Shown(browser, page)
    finally:
        server.stop()


def middle(folder: Path, moment: float) -> np.ndarray:
    """Where the certificate says that the first effector is, in space."""
    bounds = found_tube(folder).points_at(moment)[0]
    assert float(np.ptp(bounds, axis=1).max()) < 1e-6
    place = np.zeros(3)
    place[: len(bounds)] = bounds.mean(axis=1)
    return place


CAMERAS = {
    "planar_arm": ((2.7, 2.2, 9.0), (2.7, 2.2, 0.0), 0.8),
    "spatial": ((2.2, -1.6, 1.4), (0.5, 0.4, 0.2), 0.6),
}


@pytest.mark.parametrize(
    ("spec", "moments"),
    [("planar_arm", (0.0, 2.357, 6.0, 10.125)), ("spatial", (0.0, 0.333, 0.5, 0.78))],
)
def test_the_hand_is_where_the_certificate_says(
    browser: Any, made: Result, spec: str, moments: tuple[float, ...]
) -> None:
    folder = made(spec) / "out"
    with viewed(browser, folder) as shown:
        for label in ("Links", "Regions", "Tube", "Path"):
            shown.box(label).click()  # what may cover the dot
        shown.aim(*CAMERAS[spec])
        places = []
        for moment in moments:
            shown.to(moment)
            expected = shown.pixel(middle(folder, moment))
            found = shown.dots().mean(axis=0)
            assert np.linalg.norm(found - expected) < 1, (moment, found, expected)
            places.append(found)
        assert np.linalg.norm(places[-1] - places[0]) > 50


def test_designs_stand_side_by_side(browser: Any, made: Result) -> None:
    """The second is moved along y by what its label says nothing about: by the page's offset."""
    folders = [made(spec) / "out" for spec in ("turner", "slider")]
    with viewed(browser, *folders, tubes=False) as shown:
        for label in ("Links", "Regions", "Path", "Names"):
            shown.box(label).click()
        first, second = shown.page.designs
        assert second.bounds[0, 1] > first.bounds[1, 1]
        assert not first.offset.any()
        shown.aim((1.0, 1.5, 12.0), (1.0, 1.5, 0.0), 0.6)
        shown.to(1.234)
        pixels = shown.dots()
        expected = [
            shown.pixel(middle(folder, 1.234) + design.offset)
            for folder, design in zip(folders, (first, second), strict=True)
        ]
        near = np.linalg.norm(pixels[:, None] - np.stack(expected), axis=2)
        for number, place in enumerate(expected):
            own = pixels[near.argmin(axis=1) == number]
            assert np.linalg.norm(own.mean(axis=0) - place) < 1


def test_what_is_chosen_is_shown(browser: Any, made: Result) -> None:
    with viewed(browser, made("turner") / "out") as shown:
        shown.dots()

        def picture() -> np.ndarray:
            png = shown.opened.driver.get_screenshot_as_png()
            return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)[:, :600]

        for label in ("Links", "Regions", "Tube", "Path"):
            before = picture()
            shown.box(label).click()
            until(lambda old=before: np.abs(picture() - old).max() > 20, f"{label} stays")


def test_collision_bodies_are_seen_once_they_are_chosen(browser: Any, tmp_path: Path) -> None:
    """From above, the middle of a link's box, with nothing else there."""
    place = turn(START[0]) @ (0.2, 0.0, 0.0)
    with viewed(browser, pictured_arm(tmp_path / "out"), tubes=False) as shown:
        for label in ("Regions", "Path"):
            shown.box(label).click()
        shown.aim((0.2, 0.0, 4.0), (0.2, 0.0, 0.0), 0.5)
        shown.dots()
        x, y = shown.pixel(place).round().astype(int)

        def colour() -> np.ndarray:
            png = shown.opened.driver.get_screenshot_as_png()
            return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)[y, x]

        assert colour().min() > 240  # the picture of the link lies beside it
        shown.box("Links").click()
        shown.box("Collision bodies").click()
        until(lambda: colour()[1] < colour()[2] - 20, "no violet body")


def test_regions_are_where_the_spec_says(browser: Any, made: Result) -> None:
    """From above: the box about all coloured pixels there. A slow browser blurs thin lines."""
    boxes = {"obstacle": ((1.4, 1.4), (2.5, 2.5)), "target": ((-0.3, 1.2), (0.3, 1.9))}
    with viewed(browser, made("turner") / "out", tubes=False) as shown:
        for label in ("Links", "Path"):
            shown.box(label).click()
        shown.aim((2.0, 0.9, 12.0), (2.0, 0.9, 0.0), 0.5)
        shown.dots()

        def taken() -> np.ndarray:
            png = shown.opened.driver.get_screenshot_as_png()
            return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)

        def seen(kind: str, corners: np.ndarray) -> bool:
            """Whether a region is drawn; on a busy machine that comes after the effector."""
            (left, bottom), (right, top) = corners
            x, y = round(left) - AROUND, round(top) - AROUND
            picture = taken()[y : round(bottom) + AROUND, x : round(right) + AROUND]
            main = {"obstacle": 0, "target": 1}[kind]
            coloured = np.ptp(picture, axis=2) > 20
            rows, columns = np.nonzero(coloured & (picture.argmax(axis=2) == main))
            if not len(rows) or len(rows) < coloured.sum():
                return False
            across = np.array([columns.min(), columns.max() + 1]) + x - [left, right]
            down = np.array([rows.min(), rows.max() + 1]) + y - [top, bottom]
            return bool(max(np.abs(across).max(), np.abs(down).max()) <= 2)

        for kind, (low, high) in boxes.items():
            # Half of the thickness of 1 cm is 0.04 pixels from so far.
            corners = np.stack([shown.pixel(np.array([*each, -0.01])) for each in (low, high)])
            until(lambda kind=kind, corners=corners: seen(kind, corners), f"no {kind} there")
        x, y = shown.pixel(np.array([0.8, 0.8, 0.0])).round().astype(int)
        assert taken()[y, x].min() > 240  # nothing is there


def test_the_tube_is_where_the_certificate_says(browser: Any, made: Result) -> None:
    """Its pixels are within the bounds of all its boxes, and reach those of the boxes in sight.

    At the start, where the arm rests, boxes hardly cover a pixel: they need not be seen.
    """
    folder = made("planar_arm") / "out"
    with viewed(browser, folder) as shown:
        for label in ("Links", "Regions", "Path"):
            shown.box(label).click()
        shown.aim((3.6, 2.4, 12.0), (3.6, 2.4, 0.0), 0.6)
        shown.dots()
        png = shown.opened.driver.get_screenshot_as_png()
        picture = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)
        red, green, blue = np.moveaxis(picture, 2, 0)
        tubes = (red - blue > 20) & (green > 150)
        tubes[:200, :320] = False  # there the page says how slow a picture without a card is
        rows, columns = np.nonzero(tubes)
        found = np.array([[columns.min(), rows.min()], [columns.max() + 1, rows.max() + 1]])
        # The camera looks straight down: pixels are an affine function of positions.
        zero, one = shown.pixel(np.zeros(3)), shown.pixel(np.array([1.0, 1.0, 0.0]))
        corners = zero + (one - zero) * np.moveaxis(found_tube(folder).points[:, 0], 2, 1)
        low, high = corners.min(axis=1), corners.max(axis=1)
        in_sight = (high - low).min(axis=1) >= 2  # some pixel is all theirs
        seen_low, seen_high = low[in_sight].min(axis=0), high[in_sight].max(axis=0)
        assert (found[0] >= low.min(axis=0) - 2).all()
        assert (found[0] <= seen_low + 2).all()
        assert (found[1] <= high.max(axis=0) + 2).all()
        assert (found[1] >= seen_high - 2).all()
        assert (seen_high - seen_low).min() > 100


def test_a_page_plays_to_the_end_and_stops(browser: Any, made: Result) -> None:
    with viewed(browser, made("turner") / "out", tubes=False) as shown:
        stop = []

        def clock() -> None:
            while not stop:
                time.sleep(0.02)
                shown.page.tick(0.1)

        thread = Thread(target=clock)
        thread.start()
        try:
            button = shown.opened.driver.find_element("xpath", "//button[.//text()='Play']")
            button.click()
            until(lambda: shown.page.time > 0.5, "it does not play")
            until(lambda: shown.page.time == 2.0, "it does not end")
            until(lambda: "Play" in button.text, "it does not stop")
            field = shown.opened.one(".mantine-NumberInput-input")
            until(lambda: float(field.get_attribute("value")) == 2.0, "the slider stays behind")
        finally:
            stop.append(True)
            thread.join()


def test_a_page_asks_nobody_else(browser: Any, made: Result) -> None:
    browser.get("about:blank")
    page = Opened(browser, Path())
    page.requests()
    with viewed(browser, made("turner") / "out", tubes=False) as shown:
        shown.dots()
        address = page_address(shown.page.server)
        asked = [
            url for url in page.requests() if not url.startswith(("data:", "chrome:", "about:"))
        ]
    assert f"{address}/" in asked
    assert all(url.removeprefix("blob:").startswith(address) for url in asked), asked

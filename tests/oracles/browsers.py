"""A real browser without a window, and pages of files opened in it."""

from __future__ import annotations

import json
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
DRIVERS = ("chromedriver", "chromium.chromedriver")
QUIET = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--window-size=1100,900",
)  # fmt: skip
"""The browser itself stays silent, too."""
SPACE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""WebGL without a graphics card."""


def first_of(names: tuple[str, ...]) -> str | None:
    """The first program of these that is installed."""
    return next((path for name in names if (path := shutil.which(name)) is not None), None)


def start(profile: Path, *more: str) -> Any:
    """A driver of an installed browser; where there is none, a skip or a failure.

    ``SRGC_BROWSER=required`` makes it a failure.
    """
    browser, driver = first_of(BROWSERS), first_of(DRIVERS)
    if browser is None or driver is None:
        reason = "no Chromium with its ChromeDriver is installed"
        if os.environ.get("SRGC_BROWSER") == "required":
            pytest.fail(reason)
        pytest.skip(reason)
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for argument in (*QUIET, *more, f"--user-data-dir={profile}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(options=options, service=Service(driver))


@dataclass
class Opened:
    """A page in the browser."""

    driver: Any
    path: Path

    def run(self, script: str, *arguments: object) -> Any:
        """What a piece of script returns."""
        return self.driver.execute_script(script, *arguments)

    def all(self, selector: str) -> list[Any]:
        """The elements that a selector matches."""
        found: list[Any] = self.driver.find_elements("css selector", selector)
        return found

    def one(self, selector: str) -> Any:
        """The first element that a selector matches."""
        return self.driver.find_element("css selector", selector)

    def command(self, name: str, **values: object) -> None:
        """A command of the DevTools protocol."""
        self.driver.execute_cdp_cmd(name, values)

    def media(self, media: str = "", **features: str) -> None:
        """The page as on that medium, with those media features (hyphens for underscores)."""
        listed = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.command("Emulation.setEmulatedMedia", media=media, features=listed)

    def complaints(self) -> list[str]:
        """What the browser's console has said since it was last asked."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self) -> list[str]:
        """Addresses that were asked for since this was last asked."""
        events = [
            json.loads(each["message"])["message"] for each in self.driver.get_log("performance")
        ]
        return [
            event["params"]["request"]["url"]
            for event in events
            if event["method"] == "Network.requestWillBeSent"
        ]

    def on_screen(self, element: Any) -> tuple[float, float]:
        """Where the origin of an SVG element is on the page as it is shown, in pixels."""
        x, y = self.run(
            "const m = arguments[0].getScreenCTM(); return [m.e + scrollX, m.f + scrollY];", element
        )
        return float(x), float(y)

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from srgc.cli import run
from tests.oracles.browsers import Opened, start


@pytest.fixture(scope="session")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """One browser for all tests of a worker."""
    browser = start(tmp_path_factory.mktemp("profile"))
    yield browser
    browser.quit()


@pytest.fixture(scope="session")
def report_of(
    made: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """The report on the result of a spec."""
    folder = tmp_path_factory.mktemp("reports")

    def get(spec: str) -> Path:
        page = folder / f"{spec}.html"
        if not page.exists():
            assert run(["report", str(made(spec) / "out"), "-o", str(page)]) == 0
        return page

    return get


@pytest.fixture
def opened(driver: Any, report_of: Callable[[str], Path]) -> Iterator[Callable[[str], Opened]]:
    """Opens the report on a spec, as a screen of a computer shows it in daylight."""

    def open_(spec: str) -> Opened:
        page = Opened(driver, report_of(spec))
        page.command("Emulation.clearDeviceMetricsOverride")
        page.media("screen", prefers_color_scheme="light", prefers_reduced_motion="no-preference")
        driver.get("about:blank")
        page.complaints()
        page.requests()
        driver.get(page.path.as_uri())
        return page

    yield open_
    Opened(driver, Path()).command("Emulation.setScriptExecutionDisabled", value=False)

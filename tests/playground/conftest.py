"""The built page, served on this machine, and a browser that has it open."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from tests.oracles.browsers import Opened, start

ROOT = Path(__file__).parents[2]
PATIENCE = 240
"""Seconds for an answer; what it takes is measured elsewhere, in benchmarks/playground.py."""


class Files(SimpleHTTPRequestHandler):
    """The files of a folder, without a word about each of them."""

    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """Where the page is served that `make playground` has built."""
    built = ROOT / os.environ.get("SRGC_PLAYGROUND_BUILT", "out/playground")
    if not (built / "index.html").is_file():
        pytest.skip("the playground is not built: run `make playground`")
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Files, directory=built))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


class Playground(Opened):
    """The page in the browser."""

    def wait(self, script: str) -> Any:
        """What an expression becomes when it is true of something."""
        from selenium.webdriver.support.ui import WebDriverWait

        return WebDriverWait(self.driver, PATIENCE, 0.05).until(
            lambda _: self.run(f"return {script};")
        )

    def ask(self, **request: object) -> dict[str, Any]:
        """The answer to a request that the page may make."""
        script = "const done = arguments[1]; playground.ask(arguments[0]).then(done);"
        found: dict[str, Any] = self.driver.execute_async_script(script, request)
        return found

    def show(self, text: str) -> str:
        """Put a text into the editor; what the findings are then."""
        self.run(
            "performance.clearMeasures(); document.getElementById('tab-check').click();"
            "playground.text = arguments[0];",
            text,
        )
        self.wait("performance.getEntriesByName('srgc answer').length")
        return self.one("#findings").text

    def text(self, selector: str) -> str:
        """The text of an element, whether it is shown or not."""
        found: str = self.run("return document.querySelector(arguments[0]).textContent;", selector)
        return found


@pytest.fixture(scope="session")
def opened_page(address: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Playground]:
    """The page, opened once, where no other address leads anywhere."""
    nowhere = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
    driver = start(tmp_path_factory.mktemp("profile"), nowhere)
    driver.set_script_timeout(PATIENCE)
    driver.get(address)
    page = Playground(driver, Path())
    page.wait("performance.getEntriesByName('srgc answer').length")
    yield page
    driver.quit()


@pytest.fixture
def page(opened_page: Playground) -> Playground:
    """The page on a screen of a computer, in daylight."""
    opened_page.command("Emulation.clearDeviceMetricsOverride")
    opened_page.media("screen", prefers_color_scheme="light", prefers_reduced_motion="reduce")
    return opened_page


@pytest.fixture
def reopened(page: Playground, address: str) -> Callable[[str], Playground]:
    """Opens the page anew, with a fragment."""

    def open_(fragment: str) -> Playground:
        page.driver.get("about:blank")
        page.driver.get(f"{address}{fragment}")
        page.wait("performance.getEntriesByName('srgc answer').length")
        return page

    return open_

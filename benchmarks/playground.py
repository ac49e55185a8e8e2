"""How fast the playground is: from opening the page to its first findings, and from a key to them.

The page that `make playground` has built is served on this machine and opened in headless Chromium,
each time with an empty profile.  Keys are typed one after the other into the README's spec, and
into one of 300 lines and more; a key is answered when the findings of the text with it are shown.

    .venv/bin/python benchmarks/playground.py --runs 5 --keys 20 --json out/playground.json
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from statistics import median
from typing import Any

from large_spec import large_spec
from timing import ROOT, machine

sys.path.insert(0, str(ROOT))

from tests.oracles.browsers import start

FIRST, KEY = 5.0, 0.3
"""The required seconds."""
ANSWERS = (
    "return performance.getEntriesByName('srgc answer').map((e) => [e.startTime, e.duration]);"
)


@dataclass(frozen=True)
class Times:
    """Medians and the largest, in seconds."""

    what: str
    count: int
    median: float
    most: float
    required: float


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a folder."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/"
    finally:
        server.shutdown()
        server.server_close()


@contextmanager
def opened(address: str) -> Iterator[Any]:
    """A browser with an empty profile, at an address."""
    with tempfile.TemporaryDirectory() as profile:
        driver = start(Path(profile))
        try:
            driver.get(address)
            yield driver
        finally:
            driver.quit()


def answered(driver: Any, count: int) -> list[list[float]]:
    """The first answers, as start and duration in milliseconds since the page was asked for."""
    while len(found := driver.execute_script(ANSWERS)) < count:
        time.sleep(0.02)
    return found


def first(address: str, runs: int) -> Times:
    """From the start of navigation to the findings of the first spec."""
    taken = []
    for _ in range(runs):
        with opened(address) as driver:
            [begun, lasted] = answered(driver, 1)[0]
            taken.append((begun + lasted) / 1000)
    return Times("navigation to first findings", runs, median(taken), max(taken), FIRST)


def typed(address: str, name: str, text: str | None, keys: int) -> Times:
    """From a key to the findings of the text with it, the worker being warm."""
    from selenium.webdriver.common.keys import Keys

    with opened(address) as driver:
        answered(driver, 1)
        if text is not None:
            driver.execute_script("playground.text = arguments[0];", text)
            answered(driver, 2)
        driver.set_script_timeout(120)  # completion is loaded by then
        driver.execute_async_script("playground.ask({ask: 'fmt', text: ''}).then(arguments[0]);")
        editor = driver.find_element("css selector", ".cm-content")
        editor.click()
        editor.send_keys(Keys.CONTROL, Keys.END)
        editor.send_keys("//")
        time.sleep(2)
        taken = []
        for _ in range(keys):
            driver.execute_script("performance.clearMeasures();")
            editor.send_keys("x")
            taken.append(answered(driver, 1)[0][1] / 1000)
        lines = driver.execute_script("return playground.text.split('\\n').length;")
    return Times(f"a key in {name}, {lines} lines", keys, median(taken), max(taken), KEY)


def long_spec() -> str:
    """Cells of a plant until there are 300 lines."""
    text = ""
    while text.count("\n") < 300:
        text = large_spec(len(text) + 1)
    return text


def main(arguments: list[str] | None = None) -> None:
    """Measure and print; with ``--json`` also write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--page", type=Path, default=ROOT / "out" / "playground")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--keys", type=int, default=20)
    parser.add_argument("--json", type=Path, help="write the figures here")
    options = parser.parse_args(arguments)
    if not (options.page / "index.html").is_file():
        parser.error(f"{options.page} has no page: run `make playground`")
    print(machine())
    with served(options.page) as address:
        found = [
            first(address, options.runs),
            typed(address, "the README's spec", None, options.keys),
            typed(address, "a long spec", long_spec(), options.keys),
        ]
    print(f"{'':<42}{'runs':>5}{'median s':>10}{'most s':>8}{'required':>10}")
    for each in found:
        verdict = "met" if each.median <= each.required else "MISSED"
        print(
            f"{each.what:<42}{each.count:>5}{each.median:>10.3f}{each.most:>8.3f}"
            f"{each.required:>6.1f} {verdict}"
        )
    if options.json is not None:
        options.json.parent.mkdir(parents=True, exist_ok=True)
        content = {"machine": machine(), "times": [asdict(each) for each in found]}
        options.json.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

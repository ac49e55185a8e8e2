"""What axe-core, a checker of accessibility, finds wrong with a page that is open in a browser."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest

AXE = Path(__file__).parents[2] / "editors/playground/node_modules/axe-core/axe.min.js"
SEEN = [(320, "light"), (768, "dark"), (1280, "light"), (1280, "dark")]
"""Widths of screens in pixels, with the colours that the reader prefers."""
RUN = """
const done = arguments[0];
axe.run(document, { resultTypes: ["violations"] }).then((found) => done(
  found.violations
    .filter((rule) => ["serious", "critical"].includes(rule.impact))
    .flatMap((rule) => rule.nodes.map((node) => `${rule.id}: ${node.html.slice(0, 200)}`))));
"""


def source() -> str:
    """The script of axe-core that `make playground` installs; without it, a skip or a failure."""
    if not AXE.is_file():
        reason = "axe-core is not installed: run `make playground`"
        if os.environ.get("SRGC_BROWSER") == "required":
            pytest.fail(reason)
        pytest.skip(reason)
    return AXE.read_text(encoding="utf-8")


def show(driver: Any, width: int, colours: str) -> None:
    """Make the browser's screen that wide, for somebody who prefers those colours."""
    screen = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
    wished = {"prefers-color-scheme": colours, "prefers-reduced-motion": "reduce"}
    features = [{"name": name, "value": value} for name, value in wished.items()]
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "screen", "features": features})


def serious(driver: Any, axe: str) -> list[str]:
    """The serious and critical findings about the open page, each a rule and an element."""
    driver.execute_script(axe)
    found: list[str] = driver.execute_async_script(RUN)
    return found

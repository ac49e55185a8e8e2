"""Pages of which a part is made while the site is built.

Such a page has a line that is a comment; what is made takes its place. They are read again in every
build, since what they are made from is no page.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from _extensions.benchmark_tables import results
from _extensions.command_pages import reference
from _extensions.decision_index import index
from _extensions.gallery_page import MADE as RESULTS
from _extensions.gallery_page import copy_reports, with_reports

if TYPE_CHECKING:
    from collections.abc import Callable

    from sphinx.application import Sphinx

ROOT = Path(__file__).parents[2]
GALLERY = "gallery/index"
MADE: dict[str, tuple[str, Callable[[], str]]] = {
    "decisions/index": ("<!-- decisions -->", lambda: index(ROOT / "docs" / "decisions")),
    "reference/benchmarks": ("<!-- results -->", lambda: results(ROOT / "benchmarks" / "results")),
    "reference/commands": ("<!-- commands -->", reference),
}


def fill(_app: Sphinx, name: str, source: list[str]) -> None:
    """Put what is made in its place."""
    if name in MADE:
        place, make = MADE[name]
        source[0] = source[0].replace(place, make())
    if name == GALLERY:
        source[0] = with_reports(source[0], ROOT / RESULTS)


def outdated(*_arguments: object) -> list[str]:
    """All of these pages, always."""
    return [*MADE, GALLERY]


def finish(app: Sphinx, error: Exception | None) -> None:
    """Add the reports that the gallery links to."""
    if error is None:
        copy_reports(ROOT / RESULTS, Path(app.outdir))


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect to the reading of the pages."""
    app.connect("source-read", fill)
    app.connect("env-get-outdated", outdated)
    app.connect("build-finished", finish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

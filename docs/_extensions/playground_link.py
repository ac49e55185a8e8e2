"""The playground as a part of the site, with a link on every page, where it has been built."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx
    from sphinx.config import Config

BUILT = Path(__file__).parents[2] / "out" / "playground"
SIDEBAR = (
    "brand", "search", "scroll-start", "navigation", "playground", "scroll-end",
)  # fmt: skip
"""What Furo has there, and the link."""


def link(_app: Sphinx, config: Config) -> None:
    """Put the link below the table of contents."""
    config.html_sidebars = {"**": [f"sidebar/{name}.html" for name in SIDEBAR]}


def copy(app: Sphinx, error: Exception | None) -> None:
    """Put the page where the link leads."""
    if error is None and app.builder.format == "html":
        shutil.copytree(BUILT, Path(app.outdir) / "playground", dirs_exist_ok=True)


def setup(app: Sphinx) -> dict[str, Any]:
    """Connect, if `make playground` has been run."""
    if (BUILT / "index.html").is_file():
        app.connect("config-inited", link)
        app.connect("build-finished", copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}

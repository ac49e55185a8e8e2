"""How figures look, and a figure as SVG with the same bytes at every run."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from threading import RLock
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

COLOURS = {"obstacle": "#d1495b", "target": "#4c956c", "region": "#8d99ae"}
INK, PATH, ARM = "#1f2a44", "#2e6fba", "#6b7280"
SETTINGS: Any = {
    "svg.hashsalt": "srgc",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
}


_SETTINGS = RLock()
"""matplotlib's settings are those of the process."""


@contextmanager
def figure_settings() -> Iterator[None]:
    """In the block the settings are ours alone, whatever a notebook or another thread has set."""
    with _SETTINGS, mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        yield


def svg_text(figure: Figure) -> str:
    """The figure as SVG, without a date."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": "srgc"})
    return buffer.getvalue()

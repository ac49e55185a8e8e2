"""Regret over evaluations as a picture: medians with the middle half of the runs as a band."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from compiler.arrays import Array

COLUMNS = 3
LEAST = 1e-3
"""Regrets are drawn down to this part of what lies between a first point and the best known."""


def draw(regrets: Mapping[str, Mapping[str, Array]], path: Path) -> None:
    """A panel per function with a curve per method; ``regrets`` (runs, evaluations) by names."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    rows = -(-len(regrets) // COLUMNS)
    with mpl.rc_context({"svg.hashsalt": "srgc", "svg.fonttype": "none", "font.size": 8}):
        figure, axes = plt.subplots(rows, COLUMNS, figsize=(11, 3.2 * rows), squeeze=False)
        for panel in axes.flat[len(regrets) :]:
            panel.set_visible(False)
        for panel, (name, curves) in zip(axes.flat, regrets.items(), strict=False):
            for method, runs in curves.items():
                shown = np.maximum(runs, LEAST * np.max(runs[:, 0]))
                low, middle, high = np.percentile(shown, [25, 50, 75], axis=0)
                number = np.arange(1, len(middle) + 1)
                (line,) = panel.plot(number, middle, label=method, linewidth=1.2)
                panel.fill_between(number, low, high, color=line.get_color(), alpha=0.12)
            panel.set(title=name, xlabel="evaluations", ylabel="regret", yscale="log")
        axes.flat[0].legend(frameon=False)
        figure.tight_layout()
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, format="svg", metadata={"Date": None})
        plt.close(figure)

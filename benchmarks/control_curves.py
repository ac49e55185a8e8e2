"""Times that grow with a size: the exponent, and a picture with logarithmic axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Curve:
    """Seconds, and seconds an iteration, by sizes."""

    what: str
    sizes: tuple[int, ...]
    whole: tuple[float, ...]
    each: tuple[float, ...]


def exponent(sizes: Sequence[int], times: Sequence[float]) -> tuple[float, float]:
    """Slope and height of the straight line through the logarithms: time = height * size^slope."""
    slope, height = np.polyfit(np.log(sizes), np.log(times), 1)
    return float(slope), float(np.exp(height))


def draw(curves: Sequence[Curve], path: Path) -> None:
    """A panel per curve with the fitted lines, as SVG."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.ticker import NullFormatter

    with mpl.rc_context({"svg.hashsalt": "srgc", "svg.fonttype": "none", "font.size": 8}):
        figure, axes = plt.subplots(1, len(curves), figsize=(4.2 * len(curves), 3.4), squeeze=False)
        for panel, curve in zip(axes.flat, curves, strict=True):
            for name, times in (("evaluation", curve.whole), ("iteration", curve.each)):
                slope, height = exponent(curve.sizes, times)
                (dots,) = panel.plot(curve.sizes, times, "o", markersize=4)
                fitted = [height * size**slope for size in curve.sizes]
                panel.plot(
                    curve.sizes, fitted, color=dots.get_color(), linewidth=1,
                    label=f"{name}: exponent {slope:.2f}",
                )  # fmt: skip
            panel.set(xscale="log", yscale="log", xlabel=curve.what, ylabel="seconds")
            panel.set_xticks(curve.sizes, [str(size) for size in curve.sizes])
            panel.xaxis.set_minor_formatter(NullFormatter())
            panel.legend(frameon=False)
        figure.tight_layout()
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, format="svg", metadata={"Date": None})
        plt.close(figure)

"""A landscape as a picture, SVG: colours over two parameters, a curve over one (Figure 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from compiler.discretisation.float_reading import Array
from solvers.parameters.sample import Sample
from srgc.landscapes.landscape import Landscape
from srgc.landscapes.landscape_request import Axis
from srgc.render.svg import COLOURS, INK, PATH, figure_settings, svg_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INFEASIBLE = "#d9dce3"
LINES = 8
"""Lines of equal robustness."""
NOTHING = "no point of the grid is feasible"


def landscape_svg(content: Landscape, title: str) -> str:
    """The picture; ``title`` is above it."""
    with figure_settings():
        wide = len(content.axes) == 2
        figure = Figure(figsize=(6.8, 5.6) if wide else (6.8, 4.2), layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.add_subplot()
        (_draw_plane if wide else _draw_curve)(figure, axes, content)
        axes.set_title(title, fontsize=9, loc="left")
        axes.set_xlabel(_label(content.axes[0]))
        low, high = _edges(content.axes[0])[[0, -1]]
        axes.set_xlim(low, high)
        axes.legend(loc="upper left", bbox_to_anchor=(0, -0.14), fontsize=8, frameon=False, ncols=3)
        return svg_text(figure)


def _label(axis: Axis) -> str:
    unit = "" if axis.unit == "1" else f" ({axis.unit.replace('*', ' ')})"
    symbol, _, name = axis.name.partition(".")
    return f"{axis.module}.{name}, symbol {symbol}{unit}"


def _edges(axis: Axis) -> Array:
    """The borders between the values, and as far beyond the first and the last: (k + 1,)."""
    middle = (axis.values[1:] + axis.values[:-1]) / 2
    first = 2 * axis.values[0] - middle[0]
    last = 2 * axis.values[-1] - middle[-1]
    return np.asarray(np.concatenate([[first], middle, [last]]))


def _rho(content: Landscape) -> Array:
    """Rho over the grid, nan where infeasible; its shape is that of the axes."""
    values = [item.robustness if item.feasible else np.nan for item in content.grid]
    return np.array(values).reshape([len(axis.values) for axis in content.axes])


# --- two parameters ------------------------------------------------------------------------------


def _draw_plane(figure: Figure, axes: Axes, content: Landscape) -> None:
    first, second = content.axes
    rho = _rho(content).T
    axes.set_facecolor(INFEASIBLE)
    axes.set_ylabel(_label(second))
    low, high = _edges(second)[[0, -1]]
    axes.set_ylim(low, high)
    if np.all(np.isnan(rho)):
        axes.text(0.5, 0.5, NOTHING, transform=axes.transAxes, ha="center", color=INK)
    else:
        shown = np.ma.masked_invalid(rho)
        colours = axes.pcolormesh(_edges(first), _edges(second), shown, cmap="viridis", zorder=1)
        figure.colorbar(colours, ax=axes, label="robustness ρ", pad=0.02)
        if not (first.discrete or second.discrete) and np.ptp(shown.compressed()) > 0:
            axes.contour(first.values, second.values, shown, levels=LINES, colors="white",
                         linewidths=0.6, alpha=0.7, zorder=2)  # fmt: skip
    axes.fill([], [], color=INFEASIBLE, label="infeasible")
    _draw_samples(axes, content, [content.at(sample) for sample in content.samples])
    axes.plot(*content.at(content.design), "*", color="white", mec=INK, ms=14, mew=1.0,
              ls="none", label=f"design, ρ {content.design.robustness:.4g}", zorder=6)  # fmt: skip
    _draw_marks(axes, content, [mark.values for mark in content.marks])


def _draw_samples(axes: Axes, content: Landscape, places: list[tuple[float, ...]]) -> None:
    """The samples of the search: dots where feasible, crosses elsewhere."""
    for feasible, marker, text in ((True, "o", "feasible"), (False, "x", "infeasible")):
        chosen = [
            place
            for place, sample in zip(places, content.samples, strict=True)
            if sample.feasible is feasible
        ]
        if chosen:
            face = "white" if feasible else INK
            axes.plot(*np.array(chosen).T, marker, color=face, mec=INK, mew=0.9, ms=4.5,
                      ls="none", label=f"search, {text}", zorder=4, clip_on=True)  # fmt: skip


def _draw_marks(axes: Axes, content: Landscape, places: list[tuple[float, ...]]) -> None:
    for number, (mark, sample, place) in enumerate(
        zip(content.marks, content.marked, places, strict=True)
    ):
        colour = COLOURS["obstacle"]
        value = f"ρ {sample.robustness:.4g}" if sample.feasible else "infeasible"
        axes.plot(*place, "DsPv^"[number % 5], color=colour, mec="white", mew=0.9, ms=8, ls="none",
                  label=f"{mark.label}, {value}", zorder=5)  # fmt: skip


# --- one parameter -------------------------------------------------------------------------------


def _draw_curve(_figure: Figure, axes: Axes, content: Landscape) -> None:
    (axis,) = content.axes
    rho, edges = _rho(content), _edges(axis)
    for number in np.flatnonzero(np.isnan(rho)):
        axes.axvspan(edges[number], edges[number + 1], color=INFEASIBLE, lw=0, zorder=0)
    if np.isnan(rho).any():
        axes.fill([], [], color=INFEASIBLE, label="infeasible")
    axes.plot(axis.values, rho, "o" if axis.discrete else ".-", color=PATH, lw=1.6, label="grid")
    axes.set_ylabel("robustness ρ")
    known = [item for item in (*content.grid, content.design) if item.feasible]
    floor = min(item.robustness for item in known)
    _draw_samples(axes, content, [_on_curve(content, item, floor) for item in content.samples])
    axes.plot(*_on_curve(content, content.design, floor), "*", color="white", mec=INK, ms=14,
              mew=1.0, ls="none", label="design", zorder=6)  # fmt: skip
    _draw_marks(axes, content, [_on_curve(content, item, floor) for item in content.marked])


def _on_curve(content: Landscape, sample: Sample, floor: float) -> tuple[float, float]:
    """Where a sample is drawn: what is infeasible at the bottom."""
    return content.at(sample)[0], sample.robustness if sample.feasible else floor

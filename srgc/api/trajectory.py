"""The motion of a result, as arrays and as matplotlib charts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault
from srgc.report import tables
from srgc.results.found_design import FoundDesign

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from srgc.render.charts import Curve
    from srgc.report.charts import CurveGroup

SIZE = (7.0, 2.4)
"""The size of one chart in inches."""


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory(tables.Trajectory):
    """A motion of k steps at its k + 1 samples, in SI units.

    Shapes: times ``t`` (k + 1,), coordinates ``q`` and rates ``qd`` (k + 1, n), module states ``s``
    (k + 1, states), inputs ``u`` (k, inputs), and positions of the e effectors ``effectors``
    (k + 1, e, d).  Row i of ``u`` holds from ``t[i]`` to ``t[i + 1]``.

    Attributes:
        found: the robot and its task; not a stable interface.
    """

    found: FoundDesign = field(repr=False)

    @spoken
    def plot(self, axes: Axes | Sequence[Axes] | None = None) -> tuple[Axes, ...]:
        """Draw coordinates, rates, module states and inputs over time (s).

        There is a chart for each of these and each of their units (rad, m, N*m, ...).  Dashed lines
        are bounds.  This method needs matplotlib, which is not installed with srgc.

        Args:
            axes: the axes to draw on, one for each chart, as ``matplotlib.pyplot.subplots``
                returns them; by default those of a new figure.

        Returns:
            The axes of the charts, from top to bottom.

        Raises:
            SrgcError: matplotlib is missing, or the number of axes is not that of the charts.
        """
        charts = tuple(_charts(self))
        if not charts:
            raise UsageFault("the robot has neither coordinates nor inputs: there is no chart")
        places = _places(len(charts)) if axes is None else tuple(np.ravel(np.asarray(axes)))
        if len(places) != len(charts):
            names = ", ".join(label for label, _ in charts)
            raise UsageFault(
                f"`axes` are {len(charts)}, one for each chart ({names}), not {len(places)}"
            )
        for place, (label, curves) in zip(places, charts, strict=True):
            _draw(place, label, curves)
        places[-1].set_xlabel("time (s)")
        return places


def trajectory_of(found: FoundDesign) -> Trajectory:
    """The motion of a design at its samples.

    Raises:
        UsageFault: the inputs are not those of the task, or the motion has no values in doubles.
    """
    moved = tables.planned_trajectory(found)
    return Trajectory(moved.t, moved.q, moved.qd, moved.s, moved.u, moved.effectors, found)


def _charts(motion: Trajectory) -> Iterator[tuple[str, list[Curve]]]:
    """For each chart, the label of its axis and its curves: those of one kind and unit."""
    from srgc.report.charts import planned_curves

    groups: tuple[CurveGroup, ...] = planned_curves(motion.found, motion)
    for group in groups:
        for unit in dict.fromkeys(curve.unit for curve in group.curves):
            label = group.title if unit == "1" else f"{group.title} ({unit})"
            yield label, [curve for curve in group.curves if curve.unit == unit]


def _places(count: int) -> tuple[Any, ...]:
    try:
        from matplotlib import pyplot
    except ImportError:
        hint = "pip install matplotlib"
        raise UsageFault("`plot` needs matplotlib, which is not installed", hint=hint) from None
    width, height = SIZE
    size = (width, height * count)
    _, axes = pyplot.subplots(
        count, 1, sharex=True, squeeze=False, figsize=size, layout="constrained"
    )
    return tuple(axes[:, 0])


def _draw(axes: Axes, label: str, curves: Sequence[Curve]) -> None:
    for curve in curves:
        values = [*curve.values, curve.values[-1]] if curve.held else curve.values
        style = "steps-post" if curve.held else "default"
        (line,) = axes.plot(curve.times, values, drawstyle=style, label=curve.title)
        for bound in curve.bounds:
            if bound is not None:
                axes.axhline(bound, color=line.get_color(), linestyle="--", linewidth=0.8)
    axes.set_ylabel(label)
    axes.legend(loc="best", fontsize="small")

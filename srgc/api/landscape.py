"""The robustness over one or two parameters of a design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from srgc.faults import UsageFault

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from compiler.arrays import Array
    from srgc.landscapes.landscape import Landscape as Evaluated
    from srgc.landscapes.landscape_request import Mark
    from srgc.results.found_design import FoundDesign


LEAST_POINTS, MOST_POINTS = 2, 1000
"""The least and the largest number of values per parameter, as for the command."""
MISFIT = "`ranges` has two numbers for a name, `marks` a number for each parameter"


@dataclass(frozen=True, slots=True, eq=False)
class Landscape:
    """The robustness rho on a grid over one or two parameters, as in the paper's Figure 4.

    A notebook displays its picture.

    Attributes:
        found: the design; not a stable interface.
        content: the evaluations; not a stable interface.
    """

    found: FoundDesign
    content: Evaluated

    @property
    def axes(self) -> dict[str, Array]:
        """The values on the grid, shape (n,), by the name of the parameter, in SI units."""
        return {axis.name: axis.values for axis in self.content.axes}

    @property
    def robustness(self) -> Array:
        """Rho on the grid, shape (n1,) or (n1, n2), with one axis for each parameter.

        It is negative where no motion was found.
        """
        import numpy as np

        values = [sample.robustness for sample in self.content.grid]
        return np.array(values).reshape([len(axis.values) for axis in self.content.axes])

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Where a motion was found on the grid; the shape is that of ``robustness``."""
        import numpy as np

        values = [sample.feasible for sample in self.content.grid]
        return np.array(values).reshape([len(axis.values) for axis in self.content.axes])

    @property
    def svg(self) -> str:
        """The picture as SVG."""
        from srgc.landscapes.landscape import title
        from srgc.landscapes.landscape_picture import landscape_svg

        return landscape_svg(self.content, title(self.found, self.content))

    def __repr__(self) -> str:
        return f"<Landscape over {', '.join(self.axes)}: {self.robustness.size} points>"

    def __str__(self) -> str:
        from srgc.landscapes.landscape import landscape_text

        return landscape_text(self.found, self.content)

    def _repr_html_(self) -> str:
        from srgc.render.html_text import figure_html

        return figure_html(self.svg, f"robustness over {' and '.join(self.axes)}")


def landscape_of(
    folder: Path,
    over: str | Sequence[str] | None,
    ranges: Mapping[str, tuple[float, float]],
    points: int | None,
    marks: Mapping[str, Sequence[float]],
    jobs: int,
) -> Landscape:
    """Evaluate the robustness on the grid; arguments as for ``Result.landscape``.

    Raises:
        UsageFault: an argument does not fit the robot.
    """
    from srgc.landscapes.landscape import landscape
    from srgc.landscapes.landscape_request import LandscapeRequest, axes_of, refuse_marks
    from srgc.results.found_design import found_design, found_record
    from srgc.search_options import workers_for

    found = found_design(folder)
    record = found_record(folder, found)
    if points is not None and not LEAST_POINTS <= points <= MOST_POINTS:
        raise UsageFault(f"`points` is a number from {LEAST_POINTS} to {MOST_POINTS}")
    if jobs < 1:
        raise UsageFault("`jobs` counts from 1")
    names = None if over is None else (over,) if isinstance(over, str) else tuple(over)
    request = LandscapeRequest(names, _ranges(ranges), points, _marks(marks))
    axes = axes_of(found.model, request)
    refuse_marks(axes, request.marks)
    with workers_for(jobs) as workers:
        return Landscape(
            found,
            landscape(found, record, folder, axes, request.marks, workers, lambda *_: None),
        )


def _ranges(given: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    try:
        return {name: (_number(low), _number(high)) for name, (low, high) in given.items()}
    except (TypeError, ValueError):
        raise UsageFault(MISFIT) from None


def _marks(given: Mapping[str, Sequence[float]]) -> tuple[Mark, ...]:
    from srgc.landscapes.landscape_request import Mark

    try:
        return tuple(Mark(tuple(map(_number, mark)), label) for label, mark in given.items())
    except (TypeError, ValueError):
        raise UsageFault(MISFIT) from None


def _number(value: float) -> float:
    number = float(value)
    if not isfinite(number):
        raise UsageFault(f"`{number}` is not a number")
    return number

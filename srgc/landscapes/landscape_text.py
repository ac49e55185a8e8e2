"""A landscape in a few lines."""

from __future__ import annotations

from srgc.landscapes.landscape import Landscape
from srgc.landscapes.landscape_request import Axis
from srgc.results.found_design import FoundDesign


def title(found: FoundDesign, content: Landscape) -> str:
    """What the picture is of."""
    held = len(found.model.parameters) - len(content.axes)
    others = f", {held} more as designed" if held else ""
    names = " and ".join(axis.name for axis in content.axes)
    return f"{found.task.name}: {' '.join(found.claim.word)}\nrobustness over {names}{others}"


def landscape_text(found: FoundDesign, content: Landscape) -> str:
    """What was evaluated, the best of it, the design and the marks."""
    feasible = sum(1 for sample in content.grid if sample.feasible)
    lines = [f"robot:   {' '.join(found.claim.word)}"]
    lines += [f"over:    {_described(axis)}" for axis in content.axes]
    lines.append(f"grid:    {len(content.grid)} points, {feasible} feasible")
    if feasible:
        best = content.best
        lines.append(f"best:    {_at(content.at(best))}: rho {best.robustness:.4g}")
    design = content.design
    lines.append(f"design:  {_at(content.at(design))}: rho {design.robustness:.4g}")
    for mark, sample in zip(content.marks, content.marked, strict=True):
        value = f"rho {sample.robustness:.4g}" if sample.feasible else "infeasible"
        lines.append(f"mark:    {mark.label} {_at(mark.values)}: {value}")
    lines.append(f"samples: {len(content.samples)} of the search")
    return "\n".join(lines)


def _described(axis: Axis) -> str:
    """An axis with its values; of a finite set these are all there are."""
    unit = "" if axis.unit == "1" else f" {axis.unit}"
    if axis.discrete:
        values = ", ".join(f"{value:g}" for value in axis.values)
        return f"{axis.name} in {{{values}}}{unit}, all its values"
    return f"{axis.name} in [{axis.values[0]:g}, {axis.values[-1]:g}]{unit}"


def _at(values: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"

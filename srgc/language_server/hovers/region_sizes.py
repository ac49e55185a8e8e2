"""The box, the area or volume and the corners of a region."""

from __future__ import annotations

from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text
from srgc.language_server.hovers.quantity_text import rounded

_MOST_ROWS = 60
"""Regions with more rows or points are not measured while an editor waits."""


def region_text(region: ir.Region, dimension: int) -> str:
    """What a region is like, as Markdown."""
    shape = region.shape
    size = len(shape.rows if isinstance(shape, ir.Inequalities) else shape.points)
    kind = f"A{'n' if region.kind == 'obstacle' else ''} {region.kind}"
    if size > _MOST_ROWS:
        return f"{kind} of {size} rows."
    from compiler.workspaces.polytope import polytope_of

    polytope = polytope_of(shape, dimension)
    if polytope.is_empty:
        return f"{kind} that is empty."
    if not polytope.is_bounded:
        return f"{kind} without bounds."
    corners = polytope.vertices
    sides = [(min(each), max(each)) for each in zip(*corners, strict=True)]
    box = " x ".join(f"[{number_text(low)}, {number_text(high)}]" for low, high in sides)
    volume = polytope.volume
    unit, name = ("m^2", "area") if dimension == 2 else ("m^3", "volume")
    exact, near = number_text(volume), rounded(float(volume))
    shown = exact if exact == near else f"{exact} ≈ {near}"
    where = "plane" if dimension == 2 else "space"
    measures = f"- bounding box: {box} m\n- {name}: {shown} {unit}"
    return f"{kind} in the {where} with {len(corners)} corners.\n\n{measures}"

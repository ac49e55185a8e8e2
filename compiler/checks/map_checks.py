"""Findings about maps of obstacles: what each is made of, or why it cannot be used."""

from __future__ import annotations

from fractions import Fraction

from compiler.tasks.obstacle_pieces import pieces_of, polytopes_within
from compiler.workspaces.map_fault import MapFault
from compiler.workspaces.pieces import Pieces, cross, sides
from compiler.workspaces.polytope import Polytope
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.diagnostics.wording import counted
from grammar_lang.ir import ObstacleMap, Workspace


def map_shapes(
    workspace: Workspace, bounds: Polytope, sink: Sink
) -> dict[str, tuple[Polytope, ...]]:
    """The pieces of every map within the bounds, by name, and a note about each.

    A map that cannot be used is an error and has no pieces; one without obstacles within the
    bounds is warned of.
    """
    shapes: dict[str, tuple[Polytope, ...]] = {}
    for found in workspace.maps:
        try:
            every, inside = pieces_of(found), polytopes_within(found, workspace.bounds)
        except MapFault as fault:
            fault.report(found, sink)
            continue
        shapes[found.name] = inside
        if every.polygons and not inside:
            sink.warning(
                Code.REGION_OUTSIDE_BOUNDS,
                f"obstacle `{found.name}` lies outside the bounds and has no effect",
                found.span,
                hint="move it, or widen the bounds",
                notes=((workspace.bounds.span, "the bounds"),),
            )
        else:
            _note(found, every, len(inside), bounds, sink)
    return shapes


def _note(found: ObstacleMap, every: Pieces, inside: int, bounds: Polytope, sink: Sink) -> None:
    """What a map is made of, how far it was rounded, and whether the bounds go on beyond it."""
    parts = [f"{counted(inside, 'convex piece')} from {every.origin}"]
    if every.inflation:
        parts.append(f"rounded outwards by at most {_above(every.inflation)} m")
    outside = len(every.polygons) - inside
    if outside:
        parts.append(f"{counted(outside, 'more piece')} outside the bounds left out")
    hint = None
    if every.extent is not None and not _holds(every.extent, bounds):
        hint = "the bounds go on beyond the image, where there is no obstacle"
    sink.note(Code.MAP_PIECES, f"obstacle `{found.name}`: {', '.join(parts)}", found.span, hint)


def _above(value: Fraction) -> str:
    """A decimal of two digits that is not below a positive value."""
    exponent = 0
    while value * 10**exponent < 10:
        exponent += 1
    digits = -(-value.numerator * 10**exponent // value.denominator)
    return f"{float(Fraction(digits, 10**exponent)):.2g}"


def _holds(extent: tuple[tuple[Fraction, Fraction], ...], bounds: Polytope) -> bool:
    """Whether the bounds lie within a convex polygon."""
    return all(cross(a, b, (x, y)) >= 0 for a, b in sides(extent) for x, y in bounds.vertices)

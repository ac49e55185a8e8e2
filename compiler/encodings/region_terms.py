r"""Points and segments against convex regions, as formulas about their coordinates.

Touching counts as inside a region and as clear of an obstacle, so that each formula is necessary
for what has to hold strictly.  A segment and a convex polygon have disjoint interiors iff the line
of one of the polygon's edges separates them, or the segment's own line does (the separating axis
theorem for their Minkowski difference, whose edges are edges of either).

Source: de Berg, Cheong, van Kreveld & Overmars, *Computational Geometry*, section 13.3.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.encodings.real_terms import (
    Formula,
    Quantity,
    add,
    all_of,
    any_of,
    at_most,
    constant,
    multiply,
)
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir

FAR = Fraction(10**6)
"""Metres at which an obstacle without end is cut: what is farther away is left out."""


@dataclass(frozen=True, slots=True)
class PolygonTerms:
    """A convex polygon by the rows of its edges and its vertices, exact."""

    rows: tuple[ir.HalfSpace, ...]
    vertices: tuple[tuple[Fraction, ...], ...]


def polygon_terms(polygon: Polytope) -> PolygonTerms | None:
    """The polygon without rows that no edge lies on; None if it is empty."""
    if polygon.is_empty:
        return None
    if not polygon.is_bounded:
        ends = ((1, 0), (-1, 0), (0, 1), (0, -1))
        box = tuple(ir.HalfSpace((Fraction(x), Fraction(y)), FAR) for x, y in ends)
        polygon = polygon.intersection(Polytope(box))
        if polygon.is_empty:
            return None
    rows = tuple(row for row in polygon.rows if any(row.normal))
    if polygon.has_interior:
        rows = tuple(polygon.rows[i] for i in polygon.facets)
    return PolygonTerms(rows, polygon.vertices)


def inside(row: ir.HalfSpace, position: Sequence[Quantity]) -> Formula:
    """A point satisfies a half-space, written without negative factors."""
    terms = [(a, multiply(constant(abs(a)), x)) for a, x in zip(row.normal, position, strict=True)]
    left = [term for a, term in terms if a > 0]
    right = [term for a, term in terms if a < 0]
    (right if left else left).append(constant(row.offset if left else -row.offset))
    return at_most(add(*left), add(*right))


def beyond(row: ir.HalfSpace, position: Sequence[Quantity]) -> Formula:
    """A point is on the boundary of a half-space or outside."""
    return inside(ir.HalfSpace(tuple(-a for a in row.normal), -row.offset), position)


def point_clear(polygon: PolygonTerms, point: Sequence[Quantity]) -> Formula:
    """A point is not in the interior of a polygon."""
    return any_of([beyond(row, point) for row in polygon.rows])


def segment_clear(
    polygon: PolygonTerms, ends: Sequence[Sequence[Quantity]], line: Sequence[Quantity]
) -> Formula:
    """A segment has no point in the interior of a polygon.

    ``line`` is (u_x, u_y, m): a direction of the segment, and m = u_x a_y - u_y a_x of a point a on
    its line, so that u_x v_y - u_y v_x - m tells on which side of it a vertex v lies.
    """
    edges = [all_of([beyond(row, end) for end in ends]) for row in polygon.rows]
    x, y, moment = line
    sides = []
    for sign in (1, -1):
        parts = []
        for vertex in polygon.vertices:
            ahead, across = (multiply(constant(sign * value), q)
                             for value, q in zip(vertex[::-1], (x, y), strict=True))  # fmt: skip
            opposite = multiply(constant(sign), moment)
            parts.append(at_most(add(opposite, across), ahead))
        sides.append(all_of(parts))
    return any_of([*edges, *sides])

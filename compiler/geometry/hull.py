"""Facets of the convex hull of points, exactly, by polarity.

Source: Ziegler, *Lectures on Polytopes*, Theorem 2.11: for c in the interior of the hull of the
points p_i, the facets are ``y . (x - c) <= 1`` for the vertices y of the polar polytope
``{y : (p_i - c) . y <= 1}``.  A flat hull is described in its affine hull, the equations of which
are added as pairs of inequalities.  Polygons go round their corners instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from compiler.geometry.double_description import Point, describe, integer_row
from compiler.geometry.volume import counter_clockwise
from grammar_lang.ir import HalfSpace


def hull_rows(points: Sequence[Point]) -> tuple[HalfSpace, ...]:
    """Half-spaces whose intersection is the convex hull of the points (n >= 1, all of one length).

    Irredundant where the hull has an interior; the order depends on the set of points only.
    """
    if not points:
        raise ValueError("the hull of no points has no facets")
    distinct = sorted(set(points))
    origin, dimension = distinct[0], len(distinct[0])
    basis, pivots = _echelon([_minus(point, origin) for point in distinct[1:]], dimension)
    rows = _affine_hull(origin, basis, pivots)
    if pivots:
        flat = [tuple(point[axis] for axis in pivots) for point in distinct]
        for normal, offset in _full_dimensional(flat):
            lifted = [Fraction(0)] * dimension
            for axis, entry in zip(pivots, normal, strict=True):
                lifted[axis] = entry
            rows.append(HalfSpace(tuple(lifted), offset))
    return tuple(rows)


def _minus(left: Point, right: Point) -> list[Fraction]:
    return [a - b for a, b in zip(left, right, strict=True)]


def _echelon(rows: list[list[Fraction]], columns: int) -> tuple[list[list[Fraction]], list[int]]:
    """The reduced row echelon form without its zero rows, and its pivot columns."""
    pending, basis, pivots = [row[:] for row in rows], list[list[Fraction]](), list[int]()
    for column in range(columns):
        found = next((i for i, row in enumerate(pending) if row[column]), None)
        if found is None:
            continue
        chosen = pending.pop(found)
        pivot = [entry / chosen[column] for entry in chosen]
        for row in (*basis, *pending):
            factor = row[column]
            row[:] = [a - factor * b for a, b in zip(row, pivot, strict=True)]
        basis.append(pivot)
        pivots.append(column)
    return basis, pivots


def _affine_hull(origin: Point, basis: list[list[Fraction]], pivots: list[int]) -> list[HalfSpace]:
    """Each coordinate that is no pivot is an affine function of the pivots: two rows each."""
    rows: list[HalfSpace] = []
    for axis in range(len(origin)):
        if axis in pivots:
            continue
        normal = [Fraction(0)] * len(origin)
        normal[axis] = Fraction(1)
        for direction, pivot in zip(basis, pivots, strict=True):
            normal[pivot] = -direction[axis]
        offset = sum((a * x for a, x in zip(normal, origin, strict=True)), Fraction(0))
        rows.append(HalfSpace(tuple(normal), offset))
        rows.append(HalfSpace(tuple(-a for a in normal), -offset))
    return rows


def _full_dimensional(points: Sequence[Point]) -> list[tuple[Point, Fraction]]:
    """Facets of a hull with interior, sorted."""
    return _edges(points) if len(points[0]) == 2 else _polar_facets(points)


def _edges(points: Sequence[Point]) -> list[tuple[Point, Fraction]]:
    """The edges of a polygon, in time linear in the points but for sorting (Andrew 1979)."""
    corners = counter_clockwise(points)
    return sorted(
        _facet((y - b, a - x), (y - b) * a + (a - x) * b)
        for (a, b), (x, y) in pairwise((*corners, corners[0]))
    )


def _facet(normal: Sequence[Fraction], offset: Fraction) -> tuple[Point, Fraction]:
    """A half-space in primitive integers."""
    row = integer_row(normal, offset)
    return tuple(Fraction(entry) for entry in row[:-1]), Fraction(-row[-1])


def _polar_facets(points: Sequence[Point]) -> list[tuple[Point, Fraction]]:
    """The facets by polarity."""
    centre = tuple(sum(column, Fraction(0)) / len(points) for column in zip(*points, strict=True))
    polar = [integer_row(_minus(point, centre), Fraction(1)) for point in points]
    vertices, _ = describe(polar, len(centre))
    facets = []
    for vertex in vertices:
        normal = vertex.point()
        offset = 1 + sum((y * c for y, c in zip(normal, centre, strict=True)), Fraction(0))
        facets.append(_facet(normal, offset))
    return sorted(facets)

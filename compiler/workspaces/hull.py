"""Convex polytopes from half-spaces or points: vertices, facets, area and volume, all exact."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise, product
from math import factorial, gcd, lcm
from operator import mul
from typing import NamedTuple, TypeAlias, TypeVar

from grammar_lang.ir import HalfSpace

# --- Vertices of a polyhedron by the double description method, in integers -----------------------
#
# Source: Fukuda & Prodon, *Double description method revisited* (1996).  A point of dimension d is
# a *ray* ``(X_1, ..., X_d, W)`` of integers with ``W > 0`` that stands for ``X / W``.  A half-space
# ``a . p <= b`` is a row ``(a_1, ..., a_d, -b)`` of integers, so that it holds iff ``row . ray`` is
# at most zero.  Every vertex carries the set of rows that are tight there, as the bits of an
# integer.  Two vertices are joined by an edge iff no third vertex is tight wherever both are
# (Proposition 7).


IntRow: TypeAlias = tuple[int, ...]
Point: TypeAlias = tuple[Fraction, ...]


class Vertex(NamedTuple):
    """A vertex as a primitive ray, and the bits of the rows that are tight there."""

    ray: tuple[int, ...]
    tight: int

    def point(self) -> Point:
        """The Cartesian coordinates."""
        *coordinates, weight = self.ray
        return tuple(Fraction(x, weight) for x in coordinates)


def primitive(entries: Sequence[int]) -> tuple[int, ...]:
    """The entries divided by their greatest common divisor (a positive scaling)."""
    divisor = gcd(*entries)
    return tuple(entries) if divisor <= 1 else tuple(entry // divisor for entry in entries)


def integer_row(normal: Sequence[Fraction], offset: Fraction) -> IntRow:
    """The primitive integer row of ``normal . p <= offset``; equal sets have equal rows."""
    scale = lcm(offset.denominator, *(a.denominator for a in normal))
    entries = [a.numerator * (scale // a.denominator) for a in normal]
    return primitive([*entries, -offset.numerator * (scale // offset.denominator)])


def value(row: IntRow, ray: tuple[int, ...]) -> int:
    """``row . ray``: negative inside, zero on the boundary, positive outside."""
    return sum(map(mul, row, ray))


def clip(vertices: Sequence[Vertex], row: IntRow, bit: int) -> list[Vertex]:
    """The vertices of the polytope intersected with ``row``, which becomes row number ``bit``.

    Args:
        vertices: all vertices of a bounded polytope (of any affine dimension), with complete tight
            sets.
        row: the half-space, shape (d + 1,).
        bit: the number of the row, unused so far.
    """
    mark = 1 << bit
    kept: list[Vertex] = []
    above: list[tuple[Vertex, int]] = []
    below: list[tuple[Vertex, int]] = []
    for vertex in vertices:
        height = value(row, vertex.ray)
        if height > 0:
            above.append((vertex, height))
        elif height < 0:
            below.append((vertex, height))
            kept.append(vertex)
        else:
            kept.append(Vertex(vertex.ray, vertex.tight | mark))
    for upper, high in above:
        for lower, low in below:
            common = upper.tight & lower.tight
            if _adjacent(upper, lower, common, vertices):
                crossing = [high * b - low * a for a, b in zip(upper.ray, lower.ray, strict=True)]
                kept.append(Vertex(primitive(crossing), common | mark))
    return kept


def _adjacent(first: Vertex, second: Vertex, common: int, vertices: Sequence[Vertex]) -> bool:
    """Whether no third vertex is tight at all rows of ``common`` (then the two span an edge)."""
    if common.bit_count() < len(first.ray) - 2:
        return False
    return not any(
        vertex.tight & common == common and vertex is not first and vertex is not second
        for vertex in vertices
    )


def describe(rows: Sequence[IntRow], dimension: int) -> tuple[list[Vertex], bool]:
    """Vertices of ``rows`` within a box so large that nothing is lost, and whether it is bounded.

    By Cramer's rule, every minimal face of the polyhedron has a point with coordinates of at most
    ``d! M^d``, where M is the largest entry, so a box larger by one meets every face.  The
    polyhedron is empty or flat iff its part in the box is, and unbounded iff a vertex of that part
    is on the box.  Row i is bit i; the sides of the box are the bits from ``len(rows)`` on.
    """
    largest = max((abs(entry) for row in rows for entry in row), default=0)
    radius = factorial(dimension) * largest**dimension + 1
    vertices = list(_box(radius, dimension, len(rows)))
    for bit, row in enumerate(rows):
        vertices = clip(vertices, row, bit)
    return vertices, all(vertex.tight >> len(rows) == 0 for vertex in vertices)


def _box(radius: int, dimension: int, first_bit: int) -> Iterator[Vertex]:
    for signs in product((0, 1), repeat=dimension):
        ray = (*(radius if sign else -radius for sign in signs), 1)
        yield Vertex(ray, sum(1 << first_bit + 2 * axis + sign for axis, sign in enumerate(signs)))


# --- Exact area and volume of convex polytopes given by vertices and facets -----------------------
#
# Source: Bueler, Enge & Fukuda, *Exact volume computation for polytopes* (2000), section 3:
# triangulation by boundary facets, as pyramids from one vertex.


Lattice: TypeAlias = tuple[int, ...]
Coordinate = TypeVar("Coordinate", int, float, Fraction)


def on_lattice(points: Sequence[Point]) -> tuple[list[Lattice], int]:
    """The points times their least common denominator, and that denominator.

    Integers are compared and multiplied several times as fast as fractions.
    """
    scale = lcm(*(x.denominator for point in points for x in point))
    return [tuple(x.numerator * (scale // x.denominator) for x in p) for p in points], scale


def turn(a: Sequence[Coordinate], b: Sequence[Coordinate], c: Sequence[Coordinate]) -> Coordinate:
    """Twice the signed area of the triangle a, b, c in the plane: positive for a left turn."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def counter_clockwise(points: Iterable[Point]) -> tuple[Point, ...]:
    """The corners of the hull of points in the plane, from the lexicographically least one on."""
    given = tuple(points)
    lattice, _ = on_lattice(given)
    original = dict(zip(lattice, given, strict=True))
    return tuple(original[point] for point in _hull(lattice))


def _hull(points: Iterable[Lattice]) -> list[Lattice]:
    ordered = sorted(points)
    if len(ordered) < 3:
        return ordered
    return [*_chain(ordered)[:-1], *_chain(ordered[::-1])[:-1]]


def _chain(points: Sequence[Lattice]) -> list[Lattice]:
    """One half of Andrew's monotone chain."""
    chain: list[Lattice] = []
    for point in points:
        while len(chain) >= 2 and turn(chain[-2], chain[-1], point) <= 0:
            chain.pop()
        chain.append(point)
    return chain


def around(corners: Sequence[Point]) -> tuple[Point, ...]:
    """The corners of a facet in order: the ends of a segment, or around a polygon in space.

    Raises:
        ValueError: the points in space are not the corners of a convex polygon.
    """
    if len(corners[0]) == 2:
        return tuple(corners)
    for drop in range(3):
        flat = {(*point[:drop], *point[drop + 1 :]): point for point in corners}
        ring = counter_clockwise(flat)
        if len(ring) == len(corners):
            return tuple(flat[corner] for corner in ring)
    raise ValueError("the corners of a facet are those of a convex polygon")


def polygon_area(corners: Sequence[Point]) -> Fraction:
    """The area (m^2) of a convex polygon in the plane, with its corners in counter-clockwise order.

    Zero for fewer than three corners.
    """
    if len(corners) < 3:
        return Fraction(0)
    lattice, scale = on_lattice(corners)
    fan = sum(turn(lattice[0], b, c) for b, c in pairwise(lattice[1:]))
    return Fraction(fan, 2 * scale * scale)


def polyhedron_volume(facets: Sequence[tuple[Point, Sequence[Point]]]) -> Fraction:
    """The volume (m^3) of a convex polyhedron in space.

    Args:
        facets: each facet once, as its normal (3,) and its corners in any order.
    """
    lattice, scale = on_lattice([point for _, corners in facets for point in corners])
    taken = iter(lattice)
    faces = [(normal, [next(taken) for _ in corners]) for normal, corners in facets]
    apex = min(lattice)
    total = 0
    for normal, corners in faces:
        if apex in corners:
            continue
        drop = next(axis for axis, entry in enumerate(normal) if entry)
        flat = {(*point[:drop], *point[drop + 1 :]): point for point in corners}
        ring = [flat[corner] for corner in _hull(flat)]
        for b, c in pairwise(ring[1:]):
            total += abs(_determinant(apex, ring[0], b, c))
    return Fraction(total, 6 * scale**3)


def _determinant(o: Lattice, a: Lattice, b: Lattice, c: Lattice) -> int:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        tuple(p - q for p, q in zip(point, o, strict=True)) for point in (a, b, c)
    )
    return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)


# --- Facets of the convex hull of points, exactly, by polarity ------------------------------------
#
# Source: Ziegler, *Lectures on Polytopes*, Theorem 2.11: for c in the interior of the hull of the
# points p_i, the facets are ``y . (x - c) <= 1`` for the vertices y of the polar polytope
# ``{y : (p_i - c) . y <= 1}``.  A flat hull is described in its affine hull, whose equations are
# added as pairs of inequalities.  For polygons, the facets are found from their corners instead.


def hull_rows(points: Sequence[Point]) -> tuple[HalfSpace, ...]:
    """Half-spaces whose intersection is the convex hull of the points (n >= 1, all of one length).

    Irredundant if the hull has an interior; the order depends only on the set of points.

    Raises:
        ValueError: there is no point.
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
    """Two rows for each non-pivot coordinate, which is an affine function of the pivots."""
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
    """The facets of a hull with interior, sorted."""
    return _edges(points) if len(points[0]) == 2 else _polar_facets(points)


def _edges(points: Sequence[Point]) -> list[tuple[Point, Fraction]]:
    """The edges of a polygon, in linear time apart from sorting (Andrew 1979)."""
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
    """The facets, by polarity."""
    centre = tuple(sum(column, Fraction(0)) / len(points) for column in zip(*points, strict=True))
    polar = [integer_row(_minus(point, centre), Fraction(1)) for point in points]
    vertices, _ = describe(polar, len(centre))
    facets = []
    for vertex in vertices:
        normal = vertex.point()
        offset = 1 + sum((y * c for y, c in zip(normal, centre, strict=True)), Fraction(0))
        facets.append(_facet(normal, offset))
    return sorted(facets)

"""Vertices of a polyhedron by the double description method, in integers.

Source: Fukuda & Prodon, *Double description method revisited* (1996).  A point of dimension d is a
*ray* ``(X_1, ..., X_d, W)`` of integers with ``W > 0`` that stands for ``X / W``; a half-space
``a . p <= b`` is a row ``(a_1, ..., a_d, -b)`` of integers, so that it holds where ``row . ray`` is
at most zero.  Every vertex carries the set of rows that are tight there, as the bits of an integer;
two vertices are joined by an edge iff no third one is tight wherever both are (Proposition 7).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from math import factorial, gcd, lcm
from operator import mul
from typing import NamedTuple, TypeAlias

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
        vertices: all vertices of a bounded polytope (of any affine dimension), tight sets complete.
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

    By Cramer's rule every minimal face of the polyhedron has a point with coordinates of at most
    ``d! M^d``, M the largest entry, so the box of one more meets every face of it: the polyhedron
    is empty or flat iff its part in the box is, and unbounded iff a vertex of that part is on
    the box.  Row i is bit i; the sides of the box are the bits from ``len(rows)`` on.
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

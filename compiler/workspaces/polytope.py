"""Convex polytopes in the plane and in space, exact.

Source: Ziegler, *Lectures on Polytopes*, chapters 1 and 2.  A polytope is an intersection of closed
half-spaces ``normal . p <= offset`` over the rationals; every predicate here is decided without
rounding.  Only ``A``, ``b`` and ``box`` return floats and load numpy.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Literal

from compiler.workspaces.hull import (
    IntRow,
    Point,
    Vertex,
    clip,
    counter_clockwise,
    describe,
    hull_rows,
    integer_row,
    polygon_area,
    polyhedron_volume,
    value,
)
from grammar_lang.ir import HalfSpace, Hull, Inequalities, RegionShape, Round

if TYPE_CHECKING:
    from compiler.arrays import Array


AXES = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class Description:
    """Vertices with tight rows (bit i: row i); of an unbounded set, those in a large box."""

    vertices: tuple[Vertex, ...]
    bounded: bool


@dataclass(frozen=True)
class Polytope:
    """``{p : normal_i . p <= offset_i for all i}``, closed; it may be empty, flat or unbounded.

    ``known`` is the vertex description, if it is already known; it must be right.
    """

    rows: tuple[HalfSpace, ...]
    known: Description | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not self.rows:
            raise ValueError("a polytope needs at least one row, to know its dimension")
        if len({len(row.normal) for row in self.rows}) != 1:
            raise ValueError("the rows of a polytope are of one dimension")

    # --- exact data ---

    @property
    def dimension(self) -> int:
        """The dimension of the surrounding space."""
        return len(self.rows[0].normal)

    @cached_property
    def integer_rows(self) -> tuple[IntRow, ...]:
        """For each row, the primitive integers ``(normal, -offset)``."""
        return tuple(integer_row(row.normal, row.offset) for row in self.rows)

    @cached_property
    def description(self) -> Description:
        """The vertex description, computed when first needed."""
        if self.known is not None:
            return self.known
        vertices, bounded = describe(self.integer_rows, self.dimension)
        return Description(tuple(vertices), bounded)

    @property
    def is_empty(self) -> bool:
        """Whether it has no point."""
        return not self.description.vertices

    @property
    def is_bounded(self) -> bool:
        """Whether its recession cone is trivial (the empty set is bounded)."""
        return self.description.bounded

    def extends(self, axis: int, sign: Literal[-1, 1]) -> bool:
        """Whether it is unbounded along ``sign`` times an axis; an unbounded set is so along some.

        If a set is unbounded in several directions, one of them may hide another.
        """
        side = len(self.rows) + 2 * axis + (sign > 0)
        return not self.is_bounded and any(
            vertex.tight >> side & 1 for vertex in self.description.vertices
        )

    @cached_property
    def affine_dimension(self) -> int:
        """The dimension of its affine hull, -1 if empty."""
        return rank([vertex.ray for vertex in self.description.vertices]) - 1

    @property
    def has_interior(self) -> bool:
        """Whether it is full-dimensional."""
        return self.affine_dimension == self.dimension

    @cached_property
    def vertices(self) -> tuple[Point, ...]:
        """All vertices: counter-clockwise in the plane, in lexicographic order in space.

        Raises:
            ValueError: it is unbounded.
        """
        self._require_bounded()
        points = (vertex.point() for vertex in self.description.vertices)
        return counter_clockwise(points) if self.dimension == 2 else tuple(sorted(points))

    @cached_property
    def centre(self) -> Point:
        """The mean of the vertices, a point of the relative interior; ValueError if empty."""
        if self.is_empty:
            raise ValueError("an empty polytope has no centre")
        count = len(self.vertices)
        return tuple(
            sum(column, Fraction(0)) / count for column in zip(*self.vertices, strict=True)
        )

    @cached_property
    def volume(self) -> Fraction:
        """The area (m^2) in the plane, the volume (m^3) in space; zero without interior.

        Raises:
            ValueError: it is unbounded, or has an interior of another dimension.
        """
        self._require_bounded()
        if self.dimension == 2:
            return polygon_area(self.vertices)
        if not self.has_interior:
            return Fraction(0)
        if self.dimension == 3:
            return polyhedron_volume(
                [
                    (self.rows[i].normal, [vertex.point() for vertex in self.face(i)])
                    for i in self.facets
                ]
            )
        raise ValueError("volumes are computed in the plane and in space")

    def face(self, row: int) -> tuple[Vertex, ...]:
        """The vertices on the boundary of a row's half-space."""
        return tuple(v for v in self.description.vertices if v.tight >> row & 1)

    @cached_property
    def facets(self) -> tuple[int, ...]:
        """The first row of every facet, in order of the rows (dimension 2 or 3, with interior).

        A face with at least d vertices is a facet: no three vertices are collinear.
        """
        found: dict[frozenset[tuple[int, ...]], int] = {}
        for i, row in enumerate(self.rows):
            face = self.face(i)
            if any(row.normal) and len(face) >= self.dimension:
                found.setdefault(frozenset(vertex.ray for vertex in face), i)
        return tuple(sorted(found.values()))

    # --- predicates ---

    def contains_point(self, point: Sequence[Fraction]) -> bool:
        """Whether a rational point is in the (closed) set."""
        return all(
            sum((a * x for a, x in zip(row.normal, point, strict=True)), Fraction(0)) <= row.offset
            for row in self.rows
        )

    def contains(self, other: Polytope) -> bool:
        """Whether a bounded polytope is a subset; ValueError if the other is unbounded."""
        other._require_bounded()
        return all(
            value(row, vertex.ray) <= 0
            for row in self.integer_rows
            for vertex in other.description.vertices
        )

    def separated_interiors(self, other: Polytope) -> bool:
        """Whether the interiors have no common point (touching is allowed)."""
        return not self.intersection(other).has_interior

    def meets(self, other: Polytope) -> bool:
        """Whether the closed sets have a common point."""
        return not self.intersection(other).is_empty

    # --- constructions ---

    def clipped(self, row: HalfSpace) -> Polytope:
        """The intersection with one half-space, the row appended."""
        return self.intersection(Polytope((row,)))

    def intersection(self, other: Polytope) -> Polytope:
        """The intersection, with the rows of both."""
        if not self.is_bounded:
            if not other.is_bounded:
                return Polytope((*self.rows, *other.rows))
            return other.intersection(self)
        vertices: Sequence[Vertex] = self.description.vertices
        for bit, row in enumerate(other.integer_rows, start=len(self.rows)):
            vertices = clip(vertices, row, bit)
        known = Description(tuple(vertices), bounded=True)
        return Polytope((*self.rows, *other.rows), known)

    def halves(self, row: HalfSpace) -> tuple[Polytope | None, Polytope | None]:
        """The parts inside and outside a half-space; None for a part without interior.

        The polytope must be bounded, full-dimensional and irredundant; so are the parts, and the
        last row of both is the cut.
        """
        cut = integer_row(row.normal, row.offset)
        heights = [value(cut, vertex.ray) for vertex in self.description.vertices]
        if max(heights) <= 0:
            return self, None
        if min(heights) >= 0:
            return None, self
        bit = len(self.rows)
        below = clip(self.description.vertices, cut, bit)
        fresh = [vertex for vertex in below if vertex.tight >> bit & 1]
        above = [
            vertex
            for vertex, height in zip(self.description.vertices, heights, strict=True)
            if height > 0
        ]
        return (
            self._part(below, row),
            self._part([*above, *fresh], half_space_complement(row)),
        )

    def _part(self, vertices: Sequence[Vertex], row: HalfSpace) -> Polytope:
        """The polytope of these vertices, with the rows that are still facets, and the new row."""
        bits = [
            bit
            for bit in range(len(self.rows))
            if sum(vertex.tight >> bit & 1 for vertex in vertices) >= self.dimension
        ]
        bits.append(len(self.rows))
        renumbered = tuple(
            Vertex(v.ray, sum(1 << new for new, old in enumerate(bits) if v.tight >> old & 1))
            for v in vertices
        )
        rows = (*(self.rows[bit] for bit in bits[:-1]), row)
        return Polytope(rows, Description(renumbered, bounded=True))

    def irredundant(self) -> Polytope:
        """The same set without redundant rows, in the order of the rows.

        Raises:
            ValueError: it has no interior, so its facets do not determine it.
        """
        if not self.has_interior:
            raise ValueError("only a polytope with interior is given by its facets")
        if len(self.facets) == len(self.rows) or not self.facets:
            return self
        rows = tuple(self.rows[i] for i in self.facets)
        if not self.is_bounded:
            return Polytope(rows)
        vertices = tuple(
            Vertex(
                v.ray, sum(1 << new for new, old in enumerate(self.facets) if v.tight >> old & 1)
            )
            for v in self.description.vertices
        )
        return Polytope(rows, Description(vertices, bounded=True))

    # --- views ---

    @cached_property
    def A(self) -> Array:  # noqa: N802
        """Unit outward normals, shape (m, d), so that ``A p - b`` is in metres."""
        return self._floats[0]

    @cached_property
    def b(self) -> Array:
        """Offsets of the unit normals, shape (m,), in metres."""
        return self._floats[1]

    @cached_property
    def _floats(self) -> tuple[Array, Array]:
        import numpy as np

        rows = [row for row in self.rows if any(row.normal)]
        normals = np.array([[float(a) for a in row.normal] for row in rows]).reshape(
            len(rows), self.dimension
        )
        lengths = np.linalg.norm(normals, axis=1)
        offsets = np.array([float(row.offset) for row in rows])
        return normals / lengths[:, None], offsets / lengths

    @cached_property
    def box(self) -> Array:
        """A bounding box, shape (2, d), in metres, rounded outwards; ValueError if empty."""
        if self.is_empty:
            raise ValueError("an empty polytope has no bounding box")
        import numpy as np

        points = np.array([[float(x) for x in vertex] for vertex in self.vertices])
        return np.stack(
            [
                np.nextafter(points.min(axis=0), -np.inf),
                np.nextafter(points.max(axis=0), np.inf),
            ]
        )

    def inequalities(self) -> list[str]:
        """The rows as text, with normals scaled to primitive integers: ``-x <= -17/10``."""
        return [_inequality(row) for row in self.rows]

    def _require_bounded(self) -> None:
        if not self.is_bounded:
            raise ValueError("the polytope is unbounded")


def polytope_of(shape: RegionShape, dimension: int) -> Polytope:
    """The polytope of a shape of the workspace; no rows at all mean the whole space.

    For a round set it is the one used for motions: motions that respect it respect the set.
    """
    match shape:
        case Inequalities(rows=rows):
            zero = HalfSpace((Fraction(0),) * dimension, Fraction(0))
            return Polytope(rows or (zero,))
        case Hull(points=points):
            return Polytope(hull_rows(points))
        case Round():
            from compiler.workspaces.round_set import round_rows

            return Polytope(round_rows(shape))


def refuting_polytope(shape: RegionShape, dimension: int) -> Polytope:
    """The polytope of a shape for use in refutations: for a round set, on its other side."""
    if isinstance(shape, Round):
        shape = replace(shape, outward=not shape.outward)
    return polytope_of(shape, dimension)


def half_space_complement(row: HalfSpace) -> HalfSpace:
    """The closed half-space on the other side of the same boundary."""
    return HalfSpace(tuple(-a for a in row.normal), -row.offset, row.span)


def rank(rays: Iterable[tuple[int, ...]]) -> int:
    """The rank of integer vectors, by elimination without fractions."""
    basis: list[tuple[int, tuple[int, ...]]] = []
    for ray in rays:
        rest = ray
        for column, pivot in basis:
            head, lead = rest[column], pivot[column]
            if head:
                rest = tuple(lead * a - head * b for a, b in zip(rest, pivot, strict=True))
        column = next((i for i, entry in enumerate(rest) if entry), -1)
        if column >= 0:
            basis.append((column, rest))
            if len(basis) == len(ray):
                break
    return len(basis)


def _inequality(row: HalfSpace) -> str:
    primitive_normal = integer_row(row.normal, Fraction(0))[:-1]
    scale = next(
        (Fraction(p) / a for p, a in zip(primitive_normal, row.normal, strict=True) if a),
        Fraction(1),
    )
    terms: list[str] = []
    for entry, axis in zip(primitive_normal, AXES, strict=False):
        if entry:
            sign = "-" if entry < 0 else "+" if terms else ""
            factor = "" if abs(entry) == 1 else f"{abs(entry)}*"
            terms.append(f"{sign} {factor}{axis}" if terms else f"{sign}{factor}{axis}")
    return f"{' '.join(terms) or '0'} <= {row.offset * scale}"

"""Shapes to test with, and slow independent answers about the plane (orientation tests only)."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, pairwise

from hypothesis import strategies as st

from compiler.workspaces.polytope import Polytope
from grammar_lang.ir import NOWHERE, HalfSpace, Hull, Inequalities, Region, Workspace


def row(*entries, span=NOWHERE):
    """The half-space ``entries[:-1] . p <= entries[-1]``."""
    *normal, offset = (Fraction(entry) for entry in entries)
    return HalfSpace(tuple(normal), offset, span)


def box_rows(*sides):
    rows = []
    for axis, (lower, upper) in enumerate(sides):
        unit = [0] * len(sides)
        unit[axis] = 1
        rows += [row(*unit, upper), row(*(-u for u in unit), -Fraction(lower))]
    return Inequalities(tuple(rows))


def box(name, kind, *sides, span=NOWHERE):
    return Region(name, kind, box_rows(*sides), span)


def hull(name, kind, *points, span=NOWHERE):
    return Region(name, kind, Hull(tuple(tuple(Fraction(x) for x in p) for p in points)), span)


def bench(*, s_name="S"):
    """The workspace of the running example."""
    return Workspace(
        "Bench",
        2,
        box("bounds", "bounds", (0, 5), (0, 5)),
        (
            box(s_name, "region", ("0.8", "1.2"), ("1.0", "1.4")),
            Region(
                "O",
                "obstacle",
                Inequalities((row(-1, 0, "-1.7"), row(1, 0, 3), row(0, -1, -2), row(0, 1, 3))),
            ),
            box("T", "target", ("3.5", "4.2"), ("3.8", "4.5")),
        ),
    )


def cuts_of_the_bench():
    """Segments from the obstacle of the running example down and up to the bounds."""
    return [Polytope(box_rows(("2.35", "2.35"), side).rows) for side in ((0, 2), (3, 5))]


def turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def in_hull(points, p):
    """Caratheodory: a point of the hull with interior is in a triangle of its points."""
    for a, b, c in combinations(points, 3):
        if turn(a, b, c) == 0:
            continue
        turns = [turn(a, b, p), turn(b, c, p), turn(c, a, p)]
        if all(t >= 0 for t in turns) or all(t <= 0 for t in turns):
            return True
    return False


def in_shape(shape, p):
    if isinstance(shape, Hull):
        return in_hull(shape.points, p)
    return all(sum(a * x for a, x in zip(r.normal, p, strict=True)) <= r.offset for r in shape.rows)


def edges(corners):
    return list(pairwise((*corners, corners[0])))


def share_edge(first, second):
    """Whether two polygons (corners in order) have collinear edges with a common stretch."""
    for a, b in edges(first):
        for c, d in edges(second):
            if turn(a, b, c) == 0 and turn(a, b, d) == 0:
                axis = 0 if a[0] != b[0] else 1
                low = max(min(a[axis], b[axis]), min(c[axis], d[axis]))
                high = min(max(a[axis], b[axis]), max(c[axis], d[axis]))
                if low < high:
                    return True
    return False


def strictly_inside(corners, p):
    return all(turn(a, b, p) > 0 for a, b in edges(corners))


# --- strategies ---

coordinates = st.integers(-2, 14).map(lambda n: Fraction(n, 2))
points = st.tuples(coordinates, coordinates)


@st.composite
def polygons(draw):
    """Three to five points, not all on a line."""
    corners = draw(
        st.lists(points, min_size=3, max_size=5, unique=True).filter(
            lambda ps: any(turn(*t) for t in combinations(ps, 3))
        )
    )
    return Hull(tuple(corners))


@st.composite
def boxes(draw):
    (a, b), (c, d) = (
        sorted(draw(st.lists(coordinates, min_size=2, max_size=2, unique=True))) for _ in range(2)
    )
    return box_rows((a, b), (c, d))


@st.composite
def workspaces(draw, max_regions=4):
    """Bounds [0, 6] x [0, 5] with tilted polygons and boxes that overlap, touch and stick out."""
    shapes = draw(st.lists(polygons() | boxes(), max_size=max_regions))
    kinds = st.sampled_from(["obstacle", "target", "region"])
    regions = tuple(Region(f"R{i}", draw(kinds), shape) for i, shape in enumerate(shapes))
    return Workspace("W", 2, box("bounds", "bounds", (0, 6), (0, 5)), regions)

"""The directed boundary of a union of polygons, and polygons traced from directed edges; exact.

Source: de Berg, Cheong, van Kreveld & Overmars, *Computational Geometry* (2008), section 2.2
(half-edges; the next one is found by rotating around the end).  Points are homogeneous integers
``(X, Y, W)``, W > 0; an edge has the inside on its left.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cmp_to_key
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.hull import IntRow, Vertex, primitive
from compiler.workspaces.polytope import Description, Polytope
from grammar_lang.ir import HalfSpace

Ray: TypeAlias = tuple[int, ...]
Edge: TypeAlias = tuple[Ray, Ray]
Direction: TypeAlias = tuple[int, int]
NEARLY = 1e-7
"""Relative to the size of a picture: a point farther from a line than this is not on it."""


def direction(start: Ray, end: Ray) -> Direction:
    """A positive multiple of the vector between two points."""
    return (end[0] * start[2] - start[0] * end[2], end[1] * start[2] - start[1] * end[2])


def cross(a: Direction, b: Direction) -> int:
    """Positive iff b is to the left of a (by less than half a turn)."""
    return a[0] * b[1] - a[1] * b[0]


def orientation(a: Ray, b: Ray, c: Ray) -> int:
    """Positive iff a, b, c turn left, zero iff they are collinear."""
    return (
        a[0] * (b[1] * c[2] - b[2] * c[1])
        - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


def line(a: Ray, b: Ray) -> Ray:
    """The line through two points, or the point on two lines: the vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def places(points: Sequence[Ray]) -> Array:
    """The points in floats, shape (n, 2)."""
    return np.array([[x / w, y / w] for x, y, w in points]).reshape(-1, 2)


def boundary(pieces: Iterable[Polytope]) -> list[Edge]:
    """The edges between a union of interior-disjoint polygons and its outside.

    No edge has an end of another in its interior.  One edge continues another along a line only at
    an end of a third.
    """
    sides: dict[IntRow, list[tuple[Ray, int]]] = {}
    for piece in pieces:
        for number, row in enumerate(piece.integer_rows):
            ends = [vertex.ray for vertex in piece.face(number)]
            forward = max(row[:-1], (0, 0)) == row[:-1]
            plane = row if forward else tuple(-entry for entry in row)
            first, last = sorted(ends, key=lambda ray: Fraction(_along(plane, ray), ray[2]))
            # the inside is on the left: along the rotated normal of the canonical row, or against
            # it
            step = 1 if forward else -1
            sides.setdefault(plane, []).extend(((first, step), (last, -step)))
    whole: list[Edge] = []
    for plane in sorted(sides):
        whole.extend(_uncovered(plane, sides[plane]))
    points = list(dict.fromkeys(point for edge in whole for point in edge))
    stops = _points_on(whole, points)
    return [part for edge, on in zip(whole, stops, strict=True) for part in divided(edge, on)]


def _along(plane: IntRow, ray: Ray) -> int:
    """W times the coordinate of a point along a line, in the direction of its rotated normal."""
    return plane[0] * ray[1] - plane[1] * ray[0]


def _uncovered(plane: IntRow, ends: Sequence[tuple[Ray, int]]) -> list[Edge]:
    """The maximal stretches of a line with pieces on one side only, directed."""
    steps: dict[Ray, int] = {}
    for ray, step in ends:
        steps[ray] = steps.get(ray, 0) + step
    found: list[Edge] = []
    state, since = 0, ends[0][0]
    for ray in sorted(steps, key=lambda ray: Fraction(_along(plane, ray), ray[2])):
        if not steps[ray]:
            continue
        if state:
            found.append((since, ray) if state > 0 else (ray, since))
        state += steps[ray]
        since = ray
    return found


def _points_on(edges: Sequence[Edge], points: Sequence[Ray]) -> list[list[Ray]]:
    """For each edge, the points in its relative interior."""
    place = places(points)
    starts, ends = (places([edge[i] for edge in edges]) for i in (0, 1))
    tolerance = NEARLY * (1 + float(np.abs(place).max(initial=0.0)))
    found: list[list[Ray]] = []
    for edge, start, end in zip(edges, starts, ends, strict=True):
        near = (place >= np.minimum(start, end) - tolerance).all(axis=1)
        near &= (place <= np.maximum(start, end) + tolerance).all(axis=1)
        (dx, dy), gap = end - start, place[near] - start
        close = np.abs(dx * gap[:, 1] - dy * gap[:, 0]) <= tolerance * (abs(dx) + abs(dy))
        candidates = np.flatnonzero(near)[close]
        found.append([p for p in (points[k] for k in candidates) if _inside(edge, p)])
    return found


def _inside(edge: Edge, point: Ray) -> bool:
    start, end = edge
    if point in edge or orientation(start, end, point):
        return False
    (ax, ay), (bx, by) = direction(point, start), direction(point, end)
    return ax * bx + ay * by < 0


def divided(edge: Edge, points: Iterable[Ray]) -> list[Edge]:
    """The parts of an edge between points in its interior."""
    start, end = edge
    dx, dy = direction(start, end)
    inner = sorted(set(points), key=lambda p: Fraction(dx * p[0] + dy * p[1], p[2]))
    return list(pairwise((start, *inner, end)))


def outgoing(edges: Iterable[Edge]) -> dict[Ray, list[Edge]]:
    """For each point, the edges that begin there, in counter-clockwise order."""
    found: dict[Ray, list[Edge]] = {}
    for edge in edges:
        found.setdefault(edge[0], []).append(edge)
    for around in found.values():
        if len(around) > 1:
            around.sort(key=cmp_to_key(_order))
    return found


def _order(a: Edge, b: Edge) -> int:
    return _turned(direction(a[0], a[1]), direction(b[0], b[1]))


def _turned(a: Direction, b: Direction) -> int:
    """Compare two directions counter-clockwise, starting from the positive x axis."""
    return _lower(a) - _lower(b) or -cross(a, b)


def _lower(a: Direction) -> bool:
    """Whether a direction points down, or to the left."""
    return a[1] < 0 or (a[1] == 0 and a[0] < 0)


def following(edge: Edge, around: Mapping[Ray, Sequence[Edge]]) -> Edge:
    """The next edge around what is on the left: the first one clockwise from the way back."""
    start, end = edge
    leaving = around[end]
    if len(leaving) == 1:
        return leaving[0]
    back = direction(end, start)
    before = [other for other in leaving if _turned(direction(*other), back) < 0]
    return before[-1] if before else leaving[-1]


def traced(edges: Sequence[Edge]) -> list[tuple[Ray, ...]]:
    """The cycles of the edges, each with the corners at which it turns."""
    around = outgoing(edges)
    left = set(edges)
    cycles: list[tuple[Ray, ...]] = []
    for first in edges:
        if first not in left:
            continue
        edge = first
        cycle: list[Edge] = []
        while edge in left:
            left.remove(edge)
            cycle.append(edge)
            edge = following(edge, around)
        if edge != first:
            raise AssertionError("the edges round a polygon come back to the first")
        turning = zip((cycle[-1], *cycle), cycle, strict=False)
        cycles.append(tuple(b[0] for a, b in turning if cross(direction(*a), direction(*b))))
    return cycles


def polygon(corners: Sequence[Ray]) -> Polytope | None:
    """The polygon of corners in counter-clockwise order, by its edges; None if not convex."""
    count = len(corners)
    turns = [orientation(corners[i - 2], corners[i - 1], corners[i]) for i in range(count)]
    if count < 3 or min(turns) <= 0:
        return None
    first = min(range(count), key=lambda i: tuple(Fraction(x, corners[i][2]) for x in corners[i]))
    ring = [*corners[first:], *corners[:first]]
    rows = []
    for start, end in pairwise((*ring, ring[0])):
        *normal, last = primitive([-entry for entry in line(start, end)])
        rows.append(HalfSpace(tuple(map(Fraction, normal)), Fraction(-last)))
    vertices = tuple(Vertex(ray, 1 << i | 1 << (i - 1) % count) for i, ray in enumerate(ring))
    return Polytope(tuple(rows), Description(vertices, bounded=True))

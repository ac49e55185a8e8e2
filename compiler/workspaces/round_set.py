"""Balls, capsules and cylinders approximated by polytopes from outside or inside, all exact.

Normals are rational points of the unit circle or sphere, computed from the slopes of a
stereographic projection, so the planes of a polytope around a ball touch it.  Its vertices are
farther from the centre by at most a known factor; scaled down by that factor, it is inside the
ball.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import lru_cache
from itertools import product
from math import cos, hypot, isqrt, pi, sin
from typing import TypeAlias

from compiler.workspaces.hull import describe, hull_rows, integer_row
from grammar_lang.ir import HalfSpace, Round

SIDES = 16
"""The sides of the polygon around a circle: its corners are 2 % farther out (13 % for a sphere)."""
SLOPES = 100
"""The largest denominator of a slope."""
DIGITS = 10**12
"""Roots are rounded by at most 1 / ``DIGITS``."""

Point: TypeAlias = tuple[Fraction, ...]


@lru_cache(maxsize=256)
def round_rows(shape: Round) -> tuple[HalfSpace, ...]:
    """The half-spaces of a polytope that contains a round set (``outward``) or lies in it."""
    dimension = len(shape.points[0])
    grown = shape.radius * (1 if shape.outward else _shrinking(dimension))
    if shape.kind == "ball":
        (centre,) = shape.points
        return tuple(
            HalfSpace(normal, _dot(normal, centre) + grown) for normal in unit_normals(dimension)
        )
    if shape.kind == "capsule":
        about = [_scaled(corner, grown) for corner in _corners(dimension)]
    else:
        about = list(_disc(shape))
    return hull_rows([_plus(end, corner) for end in shape.points for corner in about])


def _disc(shape: Round) -> Iterator[Point]:
    """The corners, about its middle, of a disc across a cylinder's axis; in the plane, its ends."""
    one, other = shape.points
    axis = tuple(b - a for a, b in zip(one, other, strict=True))
    if len(axis) == 2:
        across: list[Point] = [(-axis[1], axis[0])]
        corners: tuple[Point, ...] = ((Fraction(1),), (Fraction(-1),))
        part = Fraction(1)
    else:
        least = min(range(3), key=lambda i: abs(axis[i]))
        first = _cross(axis, tuple(Fraction(int(i == least)) for i in range(3)))
        across = [first, _cross(axis, first)]
        corners, part = _corners(2), Fraction(1) if shape.outward else _shrinking(2)
    lengths = [_root(_dot(each, each), up=not shape.outward) for each in across]
    for corner in corners:
        found: Point = (Fraction(0),) * len(axis)
        for weight, each, length in zip(corner, across, lengths, strict=True):
            found = _plus(found, _scaled(each, weight * part * shape.radius / length))
        yield found


# --- A ball of radius 1 ---------------------------------------------------------------------------


@lru_cache(maxsize=2)
def unit_normals(dimension: int) -> tuple[Point, ...]:
    """Rational unit vectors: every 22.5 degrees, or to the 26 neighbours of a cube's middle."""
    if dimension == 2:
        angles = [2 * pi * number / SIDES for number in range(SIDES)]
        return tuple(_unit((cos(angle), sin(angle))) for angle in angles)
    places = [place for place in product((-1, 0, 1), repeat=3) if any(place)]
    return tuple(_unit(tuple(x / hypot(*place) for x in place)) for place in places)


def _unit(near: tuple[float, ...]) -> Point:
    """A rational unit vector near a given one, by stereographic projection from the far pole."""
    sign = 1 if near[-1] >= 0 else -1
    slopes = [Fraction(x / (1 + abs(near[-1]))).limit_denominator(SLOPES) for x in near[:-1]]
    square = sum((x * x for x in slopes), Fraction(0))
    return (*(2 * x / (1 + square) for x in slopes), sign * (1 - square) / (1 + square))


@lru_cache(maxsize=2)
def _corners(dimension: int) -> tuple[Point, ...]:
    """The corners of the polytope whose planes touch the unit ball."""
    rows = [integer_row(normal, Fraction(1)) for normal in unit_normals(dimension)]
    return tuple(sorted(vertex.point() for vertex in describe(rows, dimension)[0]))


@lru_cache(maxsize=2)
def _shrinking(dimension: int) -> Fraction:
    """The factor that scales this polytope down to lie inside the ball."""
    farthest = max(_dot(corner, corner) for corner in _corners(dimension))
    return 1 / _root(farthest, up=True)


# --- Exact vectors --------------------------------------------------------------------------------


def _dot(one: Point, other: Point) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))


def _plus(one: Point, other: Point) -> Point:
    return tuple(a + b for a, b in zip(one, other, strict=True))


def _scaled(one: Point, factor: Fraction) -> Point:
    return tuple(factor * a for a in one)


def _cross(one: Point, other: Point) -> Point:
    a, b, c = one
    x, y, z = other
    return (b * z - c * y, c * x - a * z, a * y - b * x)


def _root(square: Fraction, *, up: bool) -> Fraction:
    """The square root of a positive number, rounded up or down."""
    p, q = square.numerator, square.denominator
    whole = isqrt(p * q * DIGITS**2)
    exact = whole**2 == p * q * DIGITS**2
    return Fraction(whole + int(up and not exact), q * DIGITS)

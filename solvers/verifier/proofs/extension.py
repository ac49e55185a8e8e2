"""Extensions of points by shapes: boxes, the discs of cylinders, and hulls.

In a direction n a box extends from its middle by the sum of |n . x_i| times half its edges, and a
disc by its radius times the norm of (n . x_b, n . x_c), where x are the axes of its frame. The
lowest corner is known as soon as the signs of n . x_i are. Each corner of a hull is such a sum with
weights of its own (``hull_extension.py``).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import cos, hypot, pi, sin
from typing import TypeAlias

from flint import arb

from solvers.verifier.proofs.point_map import Slice, Terms

Corner: TypeAlias = tuple[int, Terms]
"""A point, and directions with the weights that lead from it to a corner."""

SIDES = 8
"""The number of rim points of a disc that always count as corners."""
LEVEL = 1e-6
"""A disc whose slope is less than this counts as level: it has no lowest point."""


Rim: TypeAlias = tuple[float, float]
"""A direction in the plane of a disc, of any length, in the axes of its columns."""
Forms: TypeAlias = Sequence[tuple[arb, arb]]
"""n . x for the columns x: over a slice, and at its middle."""


@dataclass(frozen=True, slots=True)
class Extension(ABC):
    """Weighted sums of directions, given by the numbers of their ``columns``."""

    columns: tuple[int, ...]

    def opposite(self) -> Extension:
        """The mirror image, with all weights negated; the same unless a subclass differs."""
        return self

    @property
    @abstractmethod
    def farthest(self) -> tuple[arb, ...]:
        """The largest weights; their norm bounds how far the extension reaches."""

    @abstractmethod
    def corners(self, rims: Sequence[Rim]) -> list[Terms]:
        """Weights of the corners; for a disc, with the rim points in the directions ``rims``."""

    @abstractmethod
    def lowest(self, forms: Forms) -> tuple[list[Terms], arb, arb]:
        """The weights that may be lowest, and bounds to add to their heights, as in ``forms``."""

    def lowest_on_rim(self, normal: Sequence[float], over: Slice) -> Rim | None:
        """The direction of a disc's lowest point at the middle of a slice; None for others."""
        del normal, over
        return None


@dataclass(frozen=True, slots=True)
class BoxExtension(Extension):
    """Each weight is at most half an edge."""

    halves: tuple[arb, ...]

    @property
    def farthest(self) -> tuple[arb, ...]:
        """Half the edges."""
        return self.halves

    def corners(self, rims: Sequence[Rim]) -> list[Terms]:
        """All corners."""
        del rims
        ways = product(*((-half, half) for half in self.halves))
        return [tuple(zip(self.columns, way, strict=True)) for way in ways]

    def lowest(self, forms: Forms) -> tuple[list[Terms], arb, arb]:
        """One corner, more where the sign of a slope is not certain."""
        ways = list[list[tuple[int, arb]]]()
        for column, half, (slope, _) in zip(self.columns, self.halves, forms, strict=True):
            signs = [-1] if slope > 0 else [1] if slope < 0 else [-1, 1]
            ways.append([(column, sign * half) for sign in signs])
        return list(product(*ways)), arb(0), arb(0)


@dataclass(frozen=True, slots=True)
class DiscExtension(Extension):
    """The norm of the two weights is at most the radius."""

    radius: arb

    @property
    def farthest(self) -> tuple[arb, ...]:
        """The radius, which is the norm of both weights."""
        return (self.radius,)

    def corners(self, rims: Sequence[Rim]) -> list[Terms]:
        """The rim points in the given directions, and some all around."""
        around = [2 * pi * i / SIDES for i in range(SIDES)]
        return [self._on_rim(way) for way in (*((cos(a), sin(a)) for a in around), *rims)]

    def _on_rim(self, way: Rim) -> Terms:
        long = (arb(way[0]) ** 2 + arb(way[1]) ** 2).sqrt()
        weights = (self.radius * arb(each) / long for each in way)
        return tuple(zip(self.columns, weights, strict=True))

    def lowest_on_rim(self, normal: Sequence[float], over: Slice) -> Rim | None:
        """The direction of the lowest point, unless the disc is level."""
        x, y = (_dot(normal, over.middle(column)) for column in self.columns)
        return None if hypot(x, y) < LEVEL else (-x, -y)

    def lowest(self, forms: Forms) -> tuple[list[Terms], arb, arb]:
        """The point that is lowest at the middle; others are lower by a second-order amount."""
        (a, a0), (b, b0) = forms
        x, y = float(a0.mid()), float(b0.mid())
        norms = _norm(a, b), _norm(a0, b0)
        choices: list[Terms] = [()]
        level = choices, -self.radius * norms[0], -self.radius * norms[1]
        if hypot(x, y) < LEVEL:
            return level
        long = (arb(x) ** 2 + arb(y) ** 2).sqrt()
        along, at = (arb(x) * a + arb(y) * b) / long, (arb(x) * a0 + arb(y) * b0) / long
        if not along > 0:
            return level
        across = (arb(x) * b - arb(y) * a) / long
        # The norm is at most c + d^2 / (2 c), where c and d are its parts along and across a
        # direction.
        over = arb(0).union(-self.radius * across * across / (2 * along))
        return [self._on_rim((-x, -y))], over, -self.radius * (norms[1] - at)


def lowest(
    over: Slice, normal: Sequence[arb], points: Sequence[int], extensions: Sequence[Extension]
) -> Iterator[tuple[arb, arb]]:
    """Enclosures of ``normal . p`` over a slice and at its middle.

    They are for ``points``, extended in all ways by ``extensions`` that may be lowest.
    """
    if not extensions:
        yield from (over.form(normal, point) for point in points)
        return
    choices, left = list[Terms]([()]), (arb(0), arb(0))
    for extension in extensions:
        forms = [over.form(normal, column) for column in extension.columns]
        more, *lost = extension.lowest(forms)
        choices = [(*choice, *terms) for choice in choices for terms in more]
        left = left[0] + lost[0], left[1] + lost[1]
    for point, terms in product(points, choices):
        value, at = over.form(normal, point, terms)
        yield value + left[0], at + left[1]


def corners(
    points: Sequence[int],
    extensions: Sequence[Extension],
    rims: Sequence[Sequence[Rim]] = (),
) -> list[Corner]:
    """The corners of all points; ``rims`` gives further directions for each of the extensions."""
    rims = rims or [()] * len(extensions)
    each = [item.corners(more) for item, more in zip(extensions, rims, strict=True)]
    return [
        (point, tuple(term for terms in ways for term in terms))
        for point in points
        for ways in product(*each)
    ]


def corner_at(over: Slice, corner: Corner) -> list[arb]:
    """The position of a corner at the middle of a slice."""
    point, terms = corner
    place = [axis[0] for axis in over.points[point]]
    for column, weight in terms:
        place = [x + weight * y[0] for x, y in zip(place, over.points[column], strict=True)]
    return place


def _norm(x: arb, y: arb) -> arb:
    """The Euclidean norm, valid even if it may be zero."""
    square = x * x + y * y
    if square > 0:
        return square.sqrt()
    far = abs(x).upper() ** 2 + abs(y).upper() ** 2
    return arb(0).union(far.sqrt())


def _dot(left: Sequence[float], right: Sequence[float]) -> float:
    return sum(a * b for a, b in zip(left, right, strict=True))

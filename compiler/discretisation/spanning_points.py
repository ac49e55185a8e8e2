"""The corners of what collides, from the points and directions of a robot's graph, in doubles.

Bodies and shapes become hulls of points.  Those of boxes are exact; a cylinder is the prism around
it, so that a search keeps farther away than it has to, and proofs read cylinders as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise, product

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.robots.robot import Collider, Shape

Indices = NDArray[np.int64]

SIDES = 8
"""Of the prism about a cylinder: its edges are 8 % farther away from the axis than the radius."""


@dataclass(frozen=True, slots=True)
class Points:
    """Positions of m points at K samples, in metres, and their derivatives.

    Shapes: value (K, m, d), by_q (K, m, d, n), by_theta (K, m, d, p).
    """

    value: Array
    by_q: Array
    by_theta: Array


@dataclass(frozen=True, slots=True)
class _Sum:
    """A point: a base and directions, by number, times parts of sizes, (column, size, part)."""

    base: int
    terms: tuple[tuple[int, int, float], ...]


class SpanningPoints:
    """The effectors, the corners of all colliders, and the differences of those of pairs.

    ``hulls`` are the numbers of the corners of each collider, ``gaps`` those of the differences of
    each pair ``apart``, from the first point behind the effectors.
    """

    def __init__(self, graph: RobotGraph) -> None:
        self._graph = graph
        first, colliders = len(graph.model.effectors), graph.model.colliders
        starts = [0, *accumulate(len(_sizes(each)) for each in colliders)]
        offsets = [
            _offsets(each, start, graph.model.dimension)
            for each, start in zip(colliders, starts[:-1], strict=True)
        ]
        groups = [
            [_Sum(base, _along(extent.columns, offset)) for base in extent.bases for offset in own]
            for extent, own in zip(graph.extents, offsets, strict=True)
        ]
        for (one, two), gap in zip(graph.model.apart, graph.gaps, strict=True):
            both = product(offsets[one], offsets[two])
            sums = [_along(gap.columns[0], a) + _along(gap.columns[1], b, -1.0) for a, b in both]
            groups.append([_Sum(base, terms) for base in gap.bases for terms in sums])
        ends = [0, *accumulate(len(group) for group in groups)]
        numbers = [tuple(range(start, end)) for start, end in pairwise(ends)]
        self.hulls = tuple(numbers[: len(colliders)])
        self.gaps = tuple(numbers[len(colliders) :])
        self.plain = not any(isinstance(each, Shape) and each.across(3) for each in colliders)
        """Whether they are the points of the graph as they are."""
        every = [_Sum(e - first, ()) for e in range(first)] + [s for g in groups for s in g]
        self._bases: Indices = np.array([first + each.base for each in every], dtype=np.int64)
        shape = len(every), max((len(each.terms) for each in every), default=0)
        self._columns, self._which = np.zeros(shape, np.int64), np.zeros(shape, np.int64)
        self._parts = np.zeros(shape)
        for row, each in enumerate(every):
            for place, (column, size, part) in enumerate(each.terms):
                self._columns[row, place] = first + column
                self._which[row, place], self._parts[row, place] = size, part

    @cached_property
    def _sizes(self) -> ca.Function:
        """The sizes of all shapes in m, (s,), and their Jacobian in theta (s, p)."""
        function = self._graph.sizes
        theta, k = (ca.SX.sym(f"i{i}", function.size1_in(i)) for i in range(2))
        value = function(theta, k)
        outputs = [ca.densify(value), ca.densify(ca.jacobian(value, theta))]
        return ca.Function("sizes", [theta, k], outputs)

    def positions(self, points: Array, theta: Array, constants: Array) -> Array:
        """Where the corners are, (K, m, d) in m, from the points of the graph, (K, t, d)."""
        if self.plain:
            return points
        return self._spanned(points, self._weights(theta, constants)[0])

    def of(self, points: Points, theta: Array, constants: Array) -> Points:
        """The same with derivatives; ``theta`` is (p,) or, for each sample, (K, p)."""
        if self.plain:
            return points
        weights, slopes = self._weights(theta, constants)
        by_theta = self._spanned(points.by_theta, weights)
        for place in range(self._columns.shape[1]):
            along = points.value[:, self._columns[:, place]]
            by_theta += along[..., None] * slopes[:, :, place, None, :]
        return Points(
            self._spanned(points.value, weights), self._spanned(points.by_q, weights), by_theta
        )

    def _weights(self, theta: Array, constants: Array) -> tuple[Array, Array]:
        """What directions count in the corners, (1 or K, m, c), and by theta (1 or K, m, c, p)."""
        designs = np.atleast_2d(theta)
        values, slopes = self._sizes.map(len(designs))(
            designs.T, np.repeat(constants[:, None], len(designs), axis=1)
        )
        count, p = len(designs), designs.shape[1]
        sizes = np.array(values).T
        by_theta = np.array(slopes).reshape(sizes.shape[1], count, p).transpose(1, 0, 2)
        return sizes[:, self._which] * self._parts, by_theta[:, self._which] * self._parts[
            ..., None
        ]

    def _spanned(self, given: Array, weights: Array) -> Array:
        """Sums (K, m, …) of bases and directions (K, t, …) with their weights."""
        found = given[:, self._bases]
        rest = (1,) * (given.ndim - 2)
        for place in range(self._columns.shape[1]):
            weight = weights[:, :, place].reshape(*weights.shape[:2], *rest)
            found += weight * given[:, self._columns[:, place]]
        return found


def _sizes(collider: Collider) -> tuple[int, ...]:
    return collider.sizes if isinstance(collider, Shape) else ()


def _offsets(collider: Collider, first: int, dimension: int) -> list[tuple[tuple[int, float], ...]]:
    """The corners about a base: per axis across the number of a size, and the part of it."""
    if not isinstance(collider, Shape) or not collider.across(dimension):
        return [()]
    count = len(collider.across(dimension))
    if collider.kind == "box":
        sizes = [first + i for i in range(count)]
        signs = product((-0.5, 0.5), repeat=count)
        return [tuple(zip(sizes, each, strict=True)) for each in signs]
    radius = first + 1
    if count == 1:
        return [((radius, -1.0),), ((radius, 1.0),)]
    angles = (np.arange(SIDES) + 0.5) * 2 * np.pi / SIDES
    wider = 1 / np.cos(np.pi / SIDES)
    corners = wider * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return [((radius, x), (radius, y)) for x, y in corners.tolist()]


def _along(
    columns: tuple[int, ...], offset: tuple[tuple[int, float], ...], sign: float = 1.0
) -> tuple[tuple[int, int, float], ...]:
    return tuple(
        (column, size, sign * part) for column, (size, part) in zip(columns, offset, strict=True)
    )

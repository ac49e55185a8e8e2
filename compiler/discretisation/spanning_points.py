"""The corners of what collides, from the points and directions of a robot's graph, in doubles.

Bodies and shapes become hulls of points.  Those of boxes are exact; a cylinder becomes a prism
whose edges are as far outside as its faces are inside.  Proofs read cylinders as they are, and ask
for more room where a face was too near.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise, product
from math import cos, pi, prod

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.robots.robot import Collider, Shape

Indices = NDArray[np.int64]

SIDES = 8
"""Of the prism for a cylinder."""
OFF = (1 - cos(pi / SIDES)) / (1 + cos(pi / SIDES))
"""The part of the radius, 4 %, by which edges are outside of the cylinder, and faces inside."""


@dataclass(frozen=True, slots=True)
class Points:
    """Positions of m points at K samples, in metres, and their derivatives.

    Shapes: value (K, m, d), by_q (K, m, d, n), by_theta (K, m, d, p).
    """

    value: Array
    by_q: Array
    by_theta: Array


@dataclass(frozen=True, slots=True)
class _Offsets:
    """What leads from a base of a collider to its w corners: sums of c directions with weights.

    ``columns`` (c,) are directions by number; weights are ``parts`` (w, c) of the ``sizes`` (w, c),
    by number.
    """

    columns: Indices
    sizes: Indices
    parts: Array

    def seen_along(self, columns: Indices) -> _Offsets:
        """The same along other directions."""
        return replace(self, columns=columns)

    def of(self, given: Array, sizes: Array) -> Array:
        """The offsets (K, w, …) from points (K, t, …) and sizes (1 or K, s)."""
        return _product(sizes[:, self.sizes] * self.parts, given[:, self.columns])

    def by_theta(self, given: Points, sizes: Array, slopes: Array) -> Array:
        """Their derivatives (K, w, d, p); those of the sizes are ``slopes`` (1 or K, s, p)."""
        whole = self.of(given.by_theta, sizes)
        weights = slopes[:, self.sizes] * self.parts[..., None]
        for place, column in enumerate(self.columns):
            whole += given.value[:, None, column, :, None] * weights[:, :, place, None, :]
        return whole


def _product(weights: Array, directions: Array) -> Array:
    """Sums (K, w, …) of directions (K, c, …) with weights (1 or K, w, c)."""
    count, columns, *rest = directions.shape
    flat = directions.reshape(count, columns, prod(rest))
    found: Array = np.matmul(weights, flat)
    return found.reshape(count, weights.shape[1], *rest)


@dataclass(frozen=True, slots=True)
class _Group:
    """Bases, by number, with the offsets of a collider, or those of one less those of another."""

    bases: Indices
    offsets: tuple[_Offsets, ...]

    @property
    def count(self) -> int:
        """How many points it has."""
        return len(self.bases) * prod(len(each.parts) for each in self.offsets)

    def points(self, given: Array, offsets: Sequence[Array]) -> Array:
        """Its points (K, count, …), the offsets being (K, w, …) each."""
        base = given[:, self.bases]
        found = base[:, :, None, None]
        if offsets:
            found = found + offsets[0][:, None, :, None]
        if len(offsets) > 1:
            found = found - offsets[1][:, None, None]
        return found.reshape(len(given), self.count, *given.shape[2:])


class SpanningPoints:
    """Effectors, the corners of all colliders, the differences of those of pairs, and axes.

    ``hulls`` are the numbers of the corners of each collider, ``gaps`` those of the differences of
    each pair ``apart``, ``axes`` those of the axes of each effector's frame, from the first point
    behind the effectors.
    """

    def __init__(self, graph: RobotGraph) -> None:
        self._graph = graph
        first, colliders = len(graph.model.effectors), graph.model.colliders
        starts = accumulate((len(_sizes(each)) for each in colliders), initial=0)
        offsets = [
            _offsets(each, start, graph.model.dimension)
            for each, start in zip(colliders, starts, strict=False)
        ]

        def behind(numbers: Sequence[int]) -> Indices:
            return np.array([first + number for number in numbers], dtype=np.int64)

        groups = [
            _Group(behind(extent.bases), (own.seen_along(behind(extent.columns)),))
            for extent, own in zip(graph.numbering.extents, offsets, strict=True)
        ]
        for pair, gap in zip(graph.model.apart, graph.numbering.gaps, strict=True):
            both = zip(pair, gap.columns, strict=True)
            seen = tuple(offsets[each].seen_along(behind(columns)) for each, columns in both)
            groups.append(_Group(behind(gap.bases), seen))
        groups += [_Group(behind(axes), ()) for axes in graph.numbering.axes]
        ends = accumulate((group.count for group in groups), initial=0)
        numbers = [tuple(range(start, end)) for start, end in pairwise(ends)]
        self.hulls = tuple(numbers[: len(colliders)])
        last = len(colliders) + len(graph.model.apart)
        self.gaps = tuple(numbers[len(colliders) : last])
        self.axes = tuple(numbers[last:])
        self.plain = not any(own.parts.size for own in offsets)
        """Whether they are the points of the graph as they are."""
        self._groups = [_Group(np.arange(first), ()), *groups]

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
        sizes, _ = self._sizes_at(theta, constants)
        return self._spanned(points, lambda offsets: offsets.of(points, sizes))

    def of(self, points: Points, theta: Array, constants: Array) -> Points:
        """The same with derivatives; ``theta`` is (p,) or, for each sample, (K, p)."""
        if self.plain:
            return points
        sizes, slopes = self._sizes_at(theta, constants)
        value, by_q, by_theta = points.value, points.by_q, points.by_theta
        return Points(
            self._spanned(value, lambda offsets: offsets.of(value, sizes)),
            self._spanned(by_q, lambda offsets: offsets.of(by_q, sizes)),
            self._spanned(by_theta, lambda offsets: offsets.by_theta(points, sizes, slopes)),
        )

    def _sizes_at(self, theta: Array, constants: Array) -> tuple[Array, Array]:
        """The sizes (1 or K, s) in m, and their derivatives (1 or K, s, p)."""
        designs = np.atleast_2d(theta)
        count, p = designs.shape
        values, slopes = self._sizes.map(count)(
            designs.T, np.repeat(constants[:, None], count, axis=1)
        )
        sizes = np.array(values).T
        return sizes, np.array(slopes).reshape(sizes.shape[1], count, p).transpose(1, 0, 2)

    def _spanned(self, given: Array, offsets: Callable[[_Offsets], Array]) -> Array:
        """All points (K, m, …)."""
        parts = [
            group.points(given, [offsets(each) for each in group.offsets]) for group in self._groups
        ]
        return np.concatenate(parts, axis=1)


def _sizes(collider: Collider) -> tuple[int, ...]:
    return collider.sizes if isinstance(collider, Shape) else ()


def _offsets(collider: Collider, first: int, dimension: int) -> _Offsets:
    """The corners about a base; the sizes of a shape are numbered from ``first`` on."""
    parts, sizes = np.zeros((1, 0)), np.zeros((1, 0), dtype=np.int64)
    across = collider.across(dimension) if isinstance(collider, Shape) else ()
    if across and isinstance(collider, Shape):
        if collider.kind == "box":
            parts = np.array(list(product((-0.5, 0.5), repeat=len(across))))
            sizes = np.tile(first + np.arange(len(across)), (len(parts), 1))
        else:
            parts = np.array([[-1.0], [1.0]]) if len(across) == 1 else _around()
            sizes = np.full(parts.shape, first + 1)
    return _Offsets(np.zeros(0, dtype=np.int64), sizes, parts)


def _around() -> Array:
    """The corners of a polygon along the unit circle, (w, 2)."""
    angles = (np.arange(SIDES) + 0.5) * 2 * np.pi / SIDES
    corners: Array = (1 + OFF) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return corners

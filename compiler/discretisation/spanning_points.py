"""The corners of colliders, from the points and directions of a robot's graph, in doubles.

Bodies and shapes become hulls of points. Those of boxes and hulls are exact; a cylinder becomes a
prism whose edges are as far outside as its faces are inside. Proofs use exact cylinders, and demand
a larger distance if a face was too near. For pairs with very many differences, those where the
bodies are nearest are chosen in each pose.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise, product
from math import cos, pi, prod
from typing import TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.near_differences import KEPT, near_differences_of_pairs
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.robots.hull_corners import corners_from_middle
from compiler.robots.robot import Collider, RobotModel, Shape
from compiler.time_limits.time_limit import check_time

Indices = NDArray[np.int64]
Choice: TypeAlias = tuple[Indices, Indices]

SIDES = 8
"""The number of sides of the prism for a cylinder."""
OFF = (1 - cos(pi / SIDES)) / (1 + cos(pi / SIDES))
"""The fraction of the radius, 4 %, by which edges are outside the cylinder, and faces inside."""

MOST_DIFFERENCES = 256
"""For a pair with more differences a few are chosen, separately in each pose."""
MOST_AT_ONCE = 1 << 13
"""If pairs times poses exceed this number, the pairs are split into blocks."""


@dataclass(frozen=True, slots=True)
class Points:
    """Positions of m points at K samples, in metres, and their derivatives.

    Shapes: value (K, m, d), by_q (K, m, d, n), by_theta (K, m, d, p). ``changing`` holds the points
    chosen separately in each sample, if there are any.
    """

    value: Array
    by_q: Array
    by_theta: Array
    changing: ChangingPoints | None = None


@dataclass(frozen=True, slots=True)
class ChangingPoints:
    """The points chosen of pairs at K samples, to follow them from one sample to the next.

    ``by_q`` (K, t, d, n) are derivatives of the points of the graph, ``sizes`` (1 or K, s).
    """

    groups: tuple[tuple[_NearGroup, int, Choice], ...]
    by_q: Array
    sizes: Array

    def bends(self, rates: Array, dt: float) -> Iterator[tuple[slice, Array]]:
        """Their numbers, and the distance of each from its chord halfway through a step (k, …, d).

        The points of a step are those chosen at its beginning; ``rates`` are (k + 1, n).
        """
        velocities = np.einsum("ktdn,kn->ktd", self.by_q, rates)
        given = dt / 8 * (velocities[:-1] - velocities[1:])
        for group, start, (one, two) in self.groups:
            offsets = [each.of(given, self.sizes[: len(given)]) for each in group.offsets]
            yield slice(start, start + group.count), group.of(given, offsets, (one[:-1], two[:-1]))


@dataclass(frozen=True, slots=True)
class _Offsets:
    """The vectors from a base of a collider to its w corners: weighted sums of c directions.

    ``columns`` (c,) are the numbers of the directions; weights are ``parts`` (w, c) of the sizes
    with the numbers ``sizes`` (w, c); after the last size there is one more, which is 1.
    """

    columns: Indices
    sizes: Indices
    parts: Array

    def seen_along(self, columns: Indices) -> _Offsets:
        """The offsets along other directions."""
        return replace(self, columns=columns)

    def of(self, given: Array, sizes: Array) -> Array:
        """The offsets (K, w, …) from points (K, t, …) and sizes (1 or K, s)."""
        return _product(sizes[:, self.sizes] * self.parts, given[:, self.columns])

    def by_theta(self, given: Points, sizes: Array, slopes: Array) -> Array:
        """The derivatives (K, w, d, p); those of the sizes are ``slopes`` (1 or K, s, p)."""
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
    """Bases, by number, with a collider's offsets, or with those of one minus those of another."""

    bases: Indices
    offsets: tuple[_Offsets, ...]

    @property
    def count(self) -> int:
        """The number of its points."""
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


@dataclass(frozen=True, slots=True)
class _NearGroup(_Group):
    """A pair with very many differences, of which few are chosen in every pose."""

    @property
    def count(self) -> int:
        """The number of its points in a pose."""
        return KEPT

    def of(self, given: Array, offsets: Sequence[Array], choice: Choice) -> Array:
        """The chosen points, or their derivatives, (K, count, …)."""
        one, two = self.bodies(given, offsets)
        row = np.arange(len(given))[:, None]
        found: Array = one[row, choice[0]] - two[row, choice[1]]
        return found

    def bodies(self, given: Array, offsets: Sequence[Array]) -> tuple[Array, Array]:
        """The points of both bodies, relative to the second one."""
        first = given[:, self.bases][:, :, None] + offsets[0][:, None]
        count = first.shape[1] * first.shape[2]
        return first.reshape(len(given), count, *given.shape[2:]), offsets[1]


class SpanningPoints:
    """Effectors, the corners of all colliders, their differences for pairs, and axes.

    ``hulls`` are the numbers of the corners of each collider, ``gaps`` those of the differences of
    each pair ``apart``, ``axes`` those of the axes of each effector's frame, counted from the first
    point after the effectors. ``lasting`` are the numbers of the points that are the same in every
    pose, including effectors.
    """

    def __init__(self, graph: RobotGraph) -> None:
        self._graph = graph
        first, colliders = len(graph.model.effectors), graph.model.colliders
        *starts, one = accumulate((len(_sizes(each)) for each in colliders), initial=0)
        offsets = [
            _hull_offsets(each, one, graph.model)
            if isinstance(each, Shape) and each.corners
            else _offsets(each, start, graph.model.dimension)
            for each, start in zip(colliders, starts, strict=True)
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
            group = _Group(behind(gap.bases), seen)
            many = group.count > MOST_DIFFERENCES
            groups.append(_NearGroup(group.bases, seen) if many else group)
        groups += [_Group(behind(axes), ()) for axes in graph.numbering.axes]
        ends = accumulate((group.count for group in groups), initial=0)
        numbers = [tuple(range(start, end)) for start, end in pairwise(ends)]
        self.hulls = tuple(numbers[: len(colliders)])
        last = len(colliders) + len(graph.model.apart)
        self.gaps = tuple(numbers[len(colliders) : last])
        self.axes = tuple(numbers[last:])
        self.plain = not any(own.parts.size for own in offsets)
        """Whether the points are those of the graph, unchanged."""
        self._groups = [_Group(np.arange(first), ()), *groups]
        self.lasting: Indices = np.concatenate(
            [np.arange(first)]
            + [
                first + np.array(each, dtype=np.int64)
                for group, each in zip(groups, numbers, strict=True)
                if not isinstance(group, _NearGroup)
            ]
        )
        self._near = [
            (group, first + each[0])
            for group, each in zip(groups, numbers, strict=True)
            if isinstance(group, _NearGroup)
        ]

    @property
    def changing(self) -> bool:
        """Whether some points are chosen separately in each pose."""
        return bool(self._near)

    @cached_property
    def _sizes(self) -> ca.Function:
        """The sizes of all shapes in m, (s,), and their Jacobian in theta (s, p)."""
        function = self._graph.sizes
        theta, k = (ca.SX.sym(f"i{i}", function.size1_in(i)) for i in range(2))
        value = function(theta, k)
        outputs = [ca.densify(value), ca.densify(ca.jacobian(value, theta))]
        return ca.Function("sizes", [theta, k], outputs)

    def positions(self, points: Array, theta: Array, constants: Array) -> Array:
        """The positions of the corners, (K, m, d) in m, from the points of the graph, (K, t, d)."""
        if self.plain:
            return points
        sizes, _ = self._sizes_at(theta, constants)
        choices = self._choices(points, sizes)
        return self._spanned(points, lambda offsets: offsets.of(points, sizes), choices)

    def of(self, points: Points, theta: Array, constants: Array) -> Points:
        """The corners with derivatives; ``theta`` is (p,) or, for each sample, (K, p)."""
        if self.plain:
            return points
        sizes, slopes = self._sizes_at(theta, constants)
        value, by_q, by_theta = points.value, points.by_q, points.by_theta
        choices = self._choices(value, sizes)
        changing = tuple(
            (group, start, choice)
            for (group, start), choice in zip(self._near, choices, strict=True)
        )
        return Points(
            self._spanned(value, lambda offsets: offsets.of(value, sizes), choices),
            self._spanned(by_q, lambda offsets: offsets.of(by_q, sizes), choices),
            self._spanned(
                by_theta, lambda offsets: offsets.by_theta(points, sizes, slopes), choices
            ),
            ChangingPoints(changing, by_q, sizes) if changing else None,
        )

    def _choices(self, given: Array, sizes: Array) -> list[Choice]:
        """The choices for each pair with very many differences."""
        found, most = list[Choice](), max(1, MOST_AT_ONCE // len(given))
        for start in range(0, len(self._near), most):
            check_time()
            pairs = [
                group.bodies(given, [each.of(given, sizes) for each in group.offsets])
                for group, _ in self._near[start : start + most]
            ]
            found += near_differences_of_pairs(pairs)
        return found

    def _sizes_at(self, theta: Array, constants: Array) -> tuple[Array, Array]:
        """The sizes (1 or K, s) in m with a 1 after them, and their derivatives (1 or K, s, p)."""
        designs = np.atleast_2d(theta)
        count, p = designs.shape
        values, slopes = self._sizes.map(count)(
            designs.T, np.repeat(constants[:, None], count, axis=1)
        )
        sizes = np.array(values).T
        by_theta = np.array(slopes).reshape(sizes.shape[1], count, p).transpose(1, 0, 2)
        one = np.concatenate([sizes, np.ones((count, 1))], axis=1)
        return one, np.concatenate([by_theta, np.zeros((count, 1, p))], axis=1)

    def _spanned(
        self, given: Array, offsets: Callable[[_Offsets], Array], choices: Sequence[Choice]
    ) -> Array:
        """All points (K, m, …)."""
        parts, left = [], iter(choices)
        for group in self._groups:
            check_time()
            own = [offsets(each) for each in group.offsets]
            if isinstance(group, _NearGroup):
                parts.append(group.of(given, own, next(left)))
            else:
                parts.append(group.points(given, own))
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


def _hull_offsets(hull: Shape, one: int, model: RobotModel) -> _Offsets:
    """The corners of a hull about its middle; ``one`` is the number of the size that is 1."""
    corners = corners_from_middle(hull, model.scalars)
    parts = np.array([[float(x) for x in corner[: model.dimension]] for corner in corners])
    return _Offsets(np.zeros(0, dtype=np.int64), np.full(parts.shape, one), parts)


def _around() -> Array:
    """The corners of a polygon along the unit circle, (w, 2)."""
    angles = (np.arange(SIDES) + 0.5) * 2 * np.pi / SIDES
    corners: Array = (1 + OFF) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return corners

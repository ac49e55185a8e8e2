"""How far the effectors and bodies of a robot in some poses are from what they have to avoid."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.robot import Body, RodBody
from compiler.time_limits.time_limit import check_time
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from solvers.parameters.parameter_search import parameter_space
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.subproblem import Indices

ENOUGH = 0.5
"""Metres: clearances are told apart up to this."""


@dataclass(frozen=True, slots=True)
class BodyClearance:
    """The demands that hold at any instant, to be measured on many poses at once."""

    separations: tuple[Separation, ...]
    dwells: tuple[Dwell, ...]

    def of(self, positions: Array, enough: float = ENOUGH) -> Array:
        """The least clearance (K,) of positions (K, m, d), in metres, at most ``enough``.

        Negative where a demand is broken: by how much, along the best separating direction.
        """
        found = np.full(len(positions), enough)
        for dwell in self.dwells:
            values = positions[:, dwell.point] @ dwell.region.normals.T
            found = np.minimum(found, np.min(dwell.region.offsets - values, axis=1))
        for separation in self.separations:
            check_time()
            moving = positions[:, list(separation.points)]
            near = np.flatnonzero(_box_gap(moving, separation) < found)
            near = near[_facet_gap(moving[near], separation) < found[near]]
            if len(near):
                gap = _gap(moving[near], separation)
                found[near] = np.minimum(found[near], gap)
        return found


def body_clearance(avoidances: Avoidances) -> BodyClearance:
    """The demands of a task, those of its bounds included."""
    bounds = avoidances.bounds
    effectors = range(len(avoidances.numeric.graph.model.effectors))
    dwells = [Dwell(effector, 0, 0, bounds) for effector in effectors]
    dwells += avoidances.bodies_within_bounds(0)
    return BodyClearance(tuple(avoidances.separations()), tuple(dwells))


def _box_gap(moving: Array, separation: Separation) -> Array:
    """A lower bound (K,) of the gaps, by the boxes about both."""
    lower, upper = separation.obstacle.box
    apart = np.maximum(lower - moving.max(axis=1), moving.min(axis=1) - upper)
    return np.asarray(np.max(apart, axis=1) - separation.distance)


def _facet_gap(moving: Array, separation: Separation) -> Array:
    """A lower bound (K,) of the gaps, by the facets of the obstacle."""
    obstacle = separation.obstacle
    ahead = np.min(moving @ obstacle.normals.T, axis=1) - obstacle.offsets
    return np.asarray(np.max(ahead, axis=1) - separation.distance)


def _gap(moving: Array, separation: Separation) -> Array:
    normal, support = separating_planes(moving, separation.obstacle)
    nearest = np.min(np.einsum("kd,kwd->kw", normal, moving), axis=1)
    return np.asarray(nearest - support - separation.distance)


# --------------------------------------------------------------------------------------------------
# What a task keeps effectors and bodies away from, and where it keeps them, at every instant.


FAR = Fraction(1000)


@dataclass(frozen=True, slots=True)
class Avoidances:
    """The demands of a task on a robot that bind all the time; points count effectors first."""

    numeric: NumericRobot
    workspace: ir.Workspace
    task: ir.Task

    def region(self, name: str) -> ConvexSet:
        """A region of the workspace."""
        return convex_set(polytope_of(self.workspace.region(name).shape, self.workspace.dimension))

    @property
    def bounds(self) -> ConvexSet:
        """The bounds of the workspace."""
        return convex_set(polytope_of(self.workspace.bounds.shape, self.workspace.dimension))

    def separations(self) -> Iterator[Separation]:
        """What every ``avoid`` keeps apart."""
        graph = self.numeric.graph
        count = len(graph.model.effectors)
        for avoid in self.task.avoid:
            for name in avoid.regions:
                obstacle = self.region(name)
                distance = float(avoid.margin)
                if avoid.subject == "effector":
                    yield from (Separation((e,), obstacle, distance) for e in range(count))
                    continue
                for body, hull in zip(graph.model.bodies, graph.hulls, strict=True):
                    reach = distance + self._thickness(body)
                    yield Separation(tuple(count + i for i in hull), obstacle, reach)

    def bodies_within_bounds(self, last: int) -> Iterator[Dwell]:
        """Where ``bounds with body`` keeps bodies, from sample 0 to the ``last``."""
        if not self.task.bounds_body:
            return
        graph, bounds = self.numeric.graph, self.bounds
        for body, hull in zip(graph.model.bodies, graph.hulls, strict=True):
            within = replace(bounds, offsets=bounds.offsets - self._thickness(body))
            for i in hull:
                yield Dwell(len(graph.model.effectors) + i, 0, last, within)

    def _thickness(self, body: Body) -> float:
        """A bound on the radius of a body: search only, the proof reads each one exactly."""
        if not isinstance(body, RodBody) or body.radius is None:
            return 0.0
        model = self.numeric.graph.model
        values = scalar_floats(model.scalars, parameter_space(model).upper)
        radii = [b.radius for b in model.bodies if isinstance(b, RodBody)]
        return max(abs(values[r]) for r in radii if r is not None)


def convex_set(polytope: Polytope) -> ConvexSet:
    """A polytope in floats; an unbounded one is cut far away."""
    if not polytope.is_bounded:
        d = polytope.dimension
        rows = [
            ir.HalfSpace(tuple(Fraction(sign * (i == j)) for j in range(d)), FAR)
            for i in range(d)
            for sign in (-1, 1)
        ]
        polytope = polytope.intersection(Polytope(tuple(rows)))
    vertices = np.array([[float(x) for x in vertex] for vertex in polytope.vertices])
    return ConvexSet(polytope.A, polytope.b, vertices)


# --------------------------------------------------------------------------------------------------
# The half-planes that keep a trajectory on its path: cells at samples, separation in between.
#
# An effector that has to follow a cell path is held in one convex cell per sample.  Between two
# samples every avoided set is kept on the far side of one half-plane that holds for the points of
# both samples, so that the chord cannot cut a corner; it is chosen afresh about each reference.


ON_FACET = 1e-9
"""Metres up to which a vertex lies on a facet."""
PARALLEL = 1e-9
MANY = 16
"""With more separations than this, those far away at a step are left out there."""
NEARBY = 0.3
"""What is farther away than this part of the extent of the motion counts as far."""
ASTRAY = 0.02
"""Distance in metres from which a reference counts as having left its cell."""


@dataclass(frozen=True)
class ConvexSet:
    """A polytope in floats: unit normals (m, d); offsets (m,) and vertices (w, d), in metres."""

    normals: Array
    offsets: Array
    vertices: Array

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """The least and the greatest coordinates of the vertices, (d,) each."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @cached_property
    def edge_directions(self) -> Array:
        """Unit directions (e, 3) of the edges in space, parallel ones once.

        Two vertices on two common facets span an edge; more than the edges do no harm.
        """
        on = np.abs(self.vertices @ self.normals.T - self.offsets) <= ON_FACET
        found: list[Array] = []
        for i, j in combinations(range(len(self.vertices)), 2):
            direction = self.vertices[j] - self.vertices[i]
            length = float(np.linalg.norm(direction))
            if np.count_nonzero(on[i] & on[j]) < 2 or length <= ON_FACET:
                continue
            direction = direction / length
            if all(np.linalg.norm(np.cross(direction, other)) > PARALLEL for other in found):
                found.append(direction)
        return np.array(found).reshape(-1, 3)


@dataclass(frozen=True, slots=True)
class Dwell:
    """A point stays in a convex set at the samples ``first`` to ``last`` (included).

    ``shares`` (m,) says what part of the margin is kept from each facet; None: all of it.
    ``spreads`` (m,) says the same of the spread of disturbed motions.
    """

    point: int
    first: int
    last: int
    region: ConvexSet
    shares: Array | None = None
    spreads: Array | None = None


@dataclass(frozen=True, slots=True)
class Separation:
    """The hull of some points stays ``distance`` metres from a convex set, also between samples.

    From sample ``first`` to sample ``last`` (None: to the end).
    """

    points: tuple[int, ...]
    obstacle: ConvexSet
    distance: float
    first: int = 0
    last: int | None = None

    def spans(self, count: int) -> tuple[Indices, Indices]:
        """The first and the last sample, (steps,) each, of every step it binds, of ``count`` steps.

        A single sample is bound alone: both are that sample.
        """
        last = count if self.last is None else self.last
        if self.first == last:
            return np.array([last]), np.array([last])
        first = np.arange(self.first, last)
        return first, first + 1


@dataclass(frozen=True)
class PositionPlan:
    """All that binds positions; ``margin`` (m) shrinks dwells and widens separations.

    ``anchors`` (k + 1, d) are positions of point ``anchored`` inside its dwells.  Half-planes are
    chosen about them wherever the reference has left its dwell, so that a bad reference cannot
    ask for a side that the path excludes.  ``spread`` (k + 1, m), in metres, tightens the
    constraints beyond the margin, for disturbed motions.
    """

    steps: int
    dwells: tuple[Dwell, ...]
    separations: tuple[Separation, ...]
    margin: float
    anchored: int | None = None
    anchors: Array | None = None
    spread: Array | None = None

    def rows(self, positions: Array) -> PositionRows:
        """The half-planes about reference positions of shape (k + 1, m, d)."""
        parts = list(self._dwell_rows)
        about = self._anchored(positions)
        near = self._near(about)
        parts += [self._separate(separation, about, *spans) for separation, spans in near]
        d = positions.shape[2]
        none = np.zeros(0, dtype=np.int64)
        parts.append((none, none, np.zeros((0, d)), np.zeros(0)))
        sample, point, normal, offset = (
            np.concatenate([part[i] for part in parts]) for i in range(4)
        )
        return PositionRows(sample, point, normal, offset)

    @cached_property
    def _dwell_rows(self) -> tuple[tuple[Indices, Indices, Array, Array], ...]:
        """The half-planes of the dwells, which are those of the sets wherever the reference is."""
        return tuple(self._dwell(dwell) for dwell in self.dwells)

    def _anchored(self, positions: Array) -> Array:
        """The reference with the anchored point brought back where it has left its dwells."""
        if self.anchored is None or self.anchors is None:
            return positions
        about = positions.copy()
        for dwell in self.dwells:
            if dwell.point == self.anchored:
                span = slice(dwell.first, dwell.last + 1)
                values = positions[span, dwell.point] @ dwell.region.normals.T
                lost = np.max(values - dwell.region.offsets, axis=1) > ASTRAY
                kept = about[span, dwell.point]
                about[span, dwell.point] = np.where(lost[:, None], self.anchors[span], kept)
        return about

    def _dwell(self, dwell: Dwell) -> tuple[Indices, Indices, Array, Array]:
        region = dwell.region
        samples, facets = dwell.last - dwell.first + 1, len(region.offsets)
        sample = np.repeat(np.arange(dwell.first, dwell.last + 1), facets)
        point = np.full(samples * facets, dwell.point)
        normal = np.tile(region.normals, (samples, 1))
        margins = self.margin if dwell.shares is None else self.margin * dwell.shares
        offset = np.tile(region.offsets - margins, samples)
        if self.spread is not None:
            kept = np.ones(facets) if dwell.spreads is None else dwell.spreads
            offset -= self.spread[sample, point] * np.tile(kept, samples)
        return sample, point, normal, offset

    def _near(self, positions: Array) -> list[tuple[Separation, tuple[Indices, Indices]]]:
        """The separations with the spans of samples that they bind.

        Of a great many, those whose boxes are far from what moves in a step are left out there.
        """
        count = len(positions) - 1
        wanted = [(separation, separation.spans(count)) for separation in self.separations]
        if len(wanted) <= MANY:
            return wanted
        spread = np.ptp(positions.reshape(-1, positions.shape[2]), axis=0)
        reach = NEARBY * float(np.linalg.norm(spread))
        kept = []
        for separation, (first, last) in wanted:
            moving = positions[:, list(separation.points)]
            low, high = moving.min(axis=1), moving.max(axis=1)
            low, high = np.minimum(low[first], low[last]), np.maximum(high[first], high[last])
            lower, upper = separation.obstacle.box
            gap = np.max(np.maximum(lower - high, low - upper), axis=1)
            close = gap <= reach + separation.distance
            if close.any():
                kept.append((separation, (first[close], last[close])))
        return kept

    def _separate(
        self, wanted: Separation, positions: Array, first: Indices, last: Indices
    ) -> tuple[Indices, Indices, Array, Array]:
        check_time()
        group = np.array(wanted.points)
        moving = positions[:, group]
        swept = np.concatenate([moving[first], moving[last]], axis=1)
        normal, support = separating_planes(swept, wanted.obstacle)
        k, width, d = swept.shape
        sample = np.repeat(np.stack([first, last], axis=1), len(group), axis=1)
        point = np.broadcast_to(np.tile(group, 2)[None, :], (k, width))
        normals = np.broadcast_to(-normal[:, None, :], (k, width, d)).reshape(-1, d)
        offset = np.repeat(-(support + wanted.distance + self.margin), width)
        if self.spread is not None:
            offset -= self.spread[sample.ravel(), point.ravel()]
        return sample.ravel(), point.ravel(), normals, offset


def separating_planes(swept: Array, obstacle: ConvexSet) -> tuple[Array, Array]:
    """The best half-plane between each point set (k, w, d) and a convex obstacle.

    Candidates are the obstacle's facets; in the plane also the lines through two of the points, in
    space the planes through three of them and those along one edge of either.  The sets are
    disjoint iff one of these separates them (separating axis theorem); the lines from corners to
    points make the best gap the distance where two corners are nearest.  Returns unit normals
    (k, d) pointing away from the obstacle and the obstacle's support (k,) in those directions.
    """
    k, width, d = swept.shape
    facets = np.broadcast_to(obstacle.normals, (k, *obstacle.normals.shape))
    pairs = list(combinations(range(width), 2))
    edge = swept[:, [j for _, j in pairs]] - swept[:, [i for i, _ in pairs]]
    across = _planar(edge) if d == 2 else _spatial(edge, swept, obstacle)
    length = np.linalg.norm(across, axis=2, keepdims=True)
    across = np.where(length > 1e-9, across / np.maximum(length, 1e-12), obstacle.normals[0])
    away = (swept[:, :, None, :] - obstacle.vertices[None, None]).reshape(k, -1, d)
    reach = np.linalg.norm(away, axis=2, keepdims=True)
    away = np.where(reach > 1e-9, away / np.maximum(reach, 1e-12), obstacle.normals[0])
    normals = np.concatenate([facets, across, -across, away], axis=1)
    support = np.max(normals @ obstacle.vertices.T, axis=2)
    nearest = np.min(np.einsum("kcd,kwd->kcw", normals, swept), axis=2)
    best = np.argmax(nearest - support, axis=1)
    row = np.arange(k)
    return normals[row, best], support[row, best]


def _planar(edge: Array) -> Array:
    """Normals (k, c, 2) of the lines through two of the points."""
    return np.stack([-edge[..., 1], edge[..., 0]], axis=2)


def _spatial(edge: Array, swept: Array, obstacle: ConvexSet) -> Array:
    """Normals (k, c, 3): edge times edge, and the planes through three of the points."""
    k, width, _ = swept.shape
    crossed = np.cross(edge[:, :, None, :], obstacle.edge_directions[None, None])
    parts = [crossed.reshape(k, -1, 3)]
    for i, j, m in combinations(range(width), 3):
        parts.append(np.cross(swept[:, j] - swept[:, i], swept[:, m] - swept[:, i])[:, None, :])
    return np.concatenate(parts, axis=1)

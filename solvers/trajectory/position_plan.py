"""The half-planes that keep a trajectory on its path: cells at samples, separation in between.

An effector that has to follow a cell path is kept in one convex cell per sample.  Between two
samples every avoided set is kept on the far side of one half-plane that holds for the points of
both samples, so that the chord cannot cut a corner.  The half-plane is chosen anew about each
reference.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.time_limits.time_limit import check_time
from solvers.trajectory.convex_set import ConvexSet
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.separating_planes import Obstacles, facet_planes, separating_planes
from solvers.trajectory.subproblem import Indices

MANY = 16
"""With more separations than this, those far away at a step are omitted there."""
MOST_CORNERS = 8
"""Of larger hulls, only this many points nearest to the half-plane are constrained."""
NEARBY = 0.3
"""Separations are far if farther away than this share of the extent of the motion."""
ASTRAY = 0.02
"""Distance, in units of length, beyond which a reference counts as outside its cell."""

Rows: TypeAlias = tuple[Indices, Indices, Array, Array]
"""Samples, points, normals and offsets, as in ``PositionRows``."""


@dataclass(frozen=True, slots=True)
class Dwell:
    """A point stays in a convex set at the samples ``first`` to ``last`` (included).

    ``shares`` (m,) is the share of the margin kept from each facet; None means all of it.
    ``spreads`` (m,) is the same for the spread of disturbed motions and for the deviation of a
    motion between samples.
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

    It binds from sample ``first`` to sample ``last`` (None: to the end).
    """

    points: tuple[int, ...]
    obstacle: ConvexSet
    distance: float
    first: int = 0
    last: int | None = None

    def spans(self, count: int) -> tuple[Indices, Indices]:
        """The first and last samples, (steps,) each, of every step it binds, of ``count`` steps.

        If it binds a single sample, both are that sample.
        """
        last = count if self.last is None else self.last
        if self.first == last:
            return np.array([last]), np.array([last])
        first = np.arange(self.first, last)
        return first, first + 1


@dataclass(frozen=True)
class _Alike:
    """Separations with the same number of points and kind of obstacle, by their indices (s,).

    ``points`` are (s, p), ``distances`` (s,) in metres.
    """

    separations: tuple[Separation, ...]
    numbers: Indices
    points: Indices
    distances: Array
    obstacles: Obstacles

    @staticmethod
    def of(numbered: list[tuple[int, Separation]]) -> _Alike:
        """Group separations given with their indices."""
        separations = tuple(separation for _, separation in numbered)
        return _Alike(
            separations,
            np.array([number for number, _ in numbered]),
            np.array([separation.points for separation in separations]),
            np.array([separation.distance for separation in separations]),
            Obstacles(tuple(separation.obstacle for separation in separations)),
        )

    def steps(self, count: int) -> tuple[Indices, Indices, Indices]:
        """The separation, and the first and the last sample, of all steps that are bound."""
        spans = [separation.spans(count) for separation in self.separations]
        which = np.repeat(np.arange(len(spans)), [len(first) for first, _ in spans])
        first, last = (np.concatenate(ends) for ends in zip(*spans, strict=True))
        return which, first, last

    def close(
        self, positions: Array, far: float, steps: tuple[Indices, Indices, Indices]
    ) -> tuple[Indices, Indices, Indices]:
        """The steps in which the box of the moving points is not ``far`` from the obstacle's."""
        which, first, last = steps
        moving = positions[:, self.points]
        low, high = moving.min(axis=2), moving.max(axis=2)
        low = np.minimum(low[first, which], low[last, which])
        high = np.maximum(high[first, which], high[last, which])
        lower, upper = (each[which] for each in self._boxes)
        gap = np.max(np.maximum(lower - high, low - upper), axis=1)
        kept = gap <= far + self.distances[which]
        return which[kept], first[kept], last[kept]

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """The least and greatest coordinates of the obstacles, (s, d) each."""
        lower, upper = zip(*(each.box for each in self.obstacles.sets), strict=True)
        return np.array(lower), np.array(upper)

    def planes(self, swept: Array, which: Indices, far: float) -> tuple[Array, Array]:
        """The best half-planes (k, d) and (k,); for distant obstacles, those of facets."""
        normal, support, gap = facet_planes(swept, self.obstacles, which)
        near = np.flatnonzero(gap <= far + self.distances[which])
        if len(near):
            normal[near], support[near] = separating_planes(
                swept[near], self.obstacles, which[near]
            )
        return normal, support


@dataclass(frozen=True)
class PositionPlan:
    """All constraints on positions; ``margin`` (m) shrinks dwells and widens separations.

    ``anchors`` (k + 1, d) are positions of point ``anchored`` inside its dwells.  Half-planes are
    chosen about them wherever the reference has left its dwell by ``astray`` (m), so that a bad
    reference cannot impose a side that the path excludes.  ``spread`` (k + 1, m), in metres,
    tightens the constraints beyond the margin, for disturbed motions.
    """

    steps: int
    dwells: tuple[Dwell, ...]
    separations: tuple[Separation, ...]
    margin: float
    anchored: int | None = None
    anchors: Array | None = None
    spread: Array | None = None
    astray: float = ASTRAY

    def rows(self, positions: Array, bends: Array | None = None) -> PositionRows:
        """The half-planes about reference positions of shape (k + 1, m, d).

        With the ``bends`` (k, m, d) of the reference, they also hold halfway through the steps, as
        far as other motions bend as the reference does.
        """
        parts = [*self._dwelling(bends), *self._separated(self._anchored(positions), bends)]
        d = positions.shape[2]
        none = np.zeros(0, dtype=np.int64)
        parts.append((none, none, np.zeros((0, d)), np.zeros(0)))
        sample, point, normal, offset = (
            np.concatenate([part[i] for part in parts]) for i in range(4)
        )
        return PositionRows(sample, point, normal, offset)

    @cached_property
    def _dwell_rows(self) -> tuple[Rows, ...]:
        """The half-planes of the dwells, which do not depend on the reference."""
        return tuple(self._dwell(dwell) for dwell in self.dwells)

    def _dwelling(self, bends: Array | None) -> tuple[Rows, ...]:
        """The half-planes of the dwells, also for the middle of the steps between their samples."""
        if bends is None:
            return self._dwell_rows
        return tuple(
            _within(dwell, rows, bends)
            for dwell, rows in zip(self.dwells, self._dwell_rows, strict=True)
        )

    def _anchored(self, positions: Array) -> Array:
        """The reference with the anchored point moved back where it has left its dwells."""
        if self.anchored is None or self.anchors is None:
            return positions
        about = positions.copy()
        for dwell in self.dwells:
            if dwell.point == self.anchored:
                span = slice(dwell.first, dwell.last + 1)
                values = positions[span, dwell.point] @ dwell.region.normals.T
                lost = np.max(values - dwell.region.offsets, axis=1) > self.astray
                kept = about[span, dwell.point]
                about[span, dwell.point] = np.where(lost[:, None], self.anchors[span], kept)
        return about

    def _dwell(self, dwell: Dwell) -> Rows:
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

    @cached_property
    def _alike(self) -> tuple[_Alike, ...]:
        """The separations grouped by kind."""
        kinds: dict[tuple[int, ...], list[tuple[int, Separation]]] = {}
        for number, separation in enumerate(self.separations):
            kind = len(separation.points), *Obstacles.kind(separation.obstacle)
            kinds.setdefault(kind, []).append((number, separation))
        return tuple(_Alike.of(numbered) for numbered in kinds.values())

    def _separated(self, positions: Array, bends: Array | None) -> list[Rows]:
        """The half-planes of the separations, in order.

        If there are many, those whose boxes are far from the moving points in a step are omitted
        there.
        """
        far = NEARBY * float(
            np.linalg.norm(np.ptp(positions.reshape(-1, positions.shape[2]), axis=0))
        )
        number, parts = list[Indices](), list[Rows]()
        for alike in self._alike:
            check_time()
            steps = alike.steps(len(positions) - 1)
            if len(self.separations) > MANY:
                steps = alike.close(positions, far, steps)
            part = self._halves(alike, positions, bends, far, steps)
            number.append(np.repeat(alike.numbers[steps[0]], len(part[0]) // max(1, len(steps[0]))))
            parts.append(part)
        if len(parts) < 2:
            return parts
        order = np.argsort(np.concatenate(number), kind="stable")
        sample, point, normal, offset = (
            np.concatenate(each)[order] for each in zip(*parts, strict=True)
        )
        return [(sample, point, normal, offset)]

    def _halves(
        self,
        alike: _Alike,
        positions: Array,
        bends: Array | None,
        far: float,
        steps: tuple[Indices, Indices, Indices],
    ) -> Rows:
        """The half-planes of some steps."""
        which, first, last = steps
        group = alike.points[which]
        point = np.concatenate([group, group], axis=1)
        sample = np.repeat(np.stack([first, last], axis=1), group.shape[1], axis=1)
        swept = positions[sample, point]
        normal, support = alike.planes(swept, which, far)
        k, width, d = swept.shape
        if width > 2 * MOST_CORNERS:
            width = 2 * MOST_CORNERS
            heights = np.einsum("kwd,kd->kw", swept, normal)
            kept = np.sort(np.argpartition(heights, width - 1, axis=1)[:, :width], axis=1)
            sample, point = (np.take_along_axis(each, kept, axis=1) for each in (sample, point))
        normals = np.broadcast_to(-normal[:, None, :], (k, width, d)).reshape(-1, d)
        offset = np.repeat(-(support + alike.distances[which] + self.margin), width)
        if self.spread is not None:
            offset -= self.spread[sample.ravel(), point.ravel()]
        if bends is not None:
            # Chords keep extra distance, so that the curves keep enough.
            moving = (first < last)[:, None]
            bent = bends[np.minimum(first, len(bends) - 1)[:, None], point]
            toward = np.where(moving, -np.einsum("kpd,kd->kp", bent, normal), 0.0)
            offset -= np.maximum(0.0, toward).ravel()
        return sample.ravel(), point.ravel(), normals, offset


def _within(dwell: Dwell, rows: Rows, bends: Array) -> Rows:
    """The rows of a dwell, with room for the bends in the steps next to each sample."""
    if dwell.first == dwell.last:
        return rows
    sample, point, normal, offset = rows
    kept = np.ones(len(dwell.region.offsets)) if dwell.spreads is None else dwell.spreads
    taken = np.zeros(len(offset))
    for step, bound in ((sample - 1, sample > dwell.first), (sample, sample < dwell.last)):
        bent = bends[np.clip(step, 0, len(bends) - 1), point]
        taken = np.maximum(taken, np.where(bound, np.einsum("rd,rd->r", normal, bent), 0.0))
    return sample, point, normal, offset - taken * np.tile(kept, dwell.last - dwell.first + 1)

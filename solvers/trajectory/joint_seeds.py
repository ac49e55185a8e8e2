"""Initial motions in joint space: poses where a task constrains points, and clear ways in between.

The path of the effector between these places is left open; the cells are read off the resulting
motion.  Poses are found by inverse kinematics from many starts, and chosen so that the ways between
them are short.  Ways around obstacles are found by two trees (``joint_ways.py``).  All this only
provides seeds.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.time_limits.time_limit import check_time
from solvers.trajectory.convex_set import ConvexSet
from solvers.trajectory.inverse_kinematics import Pool, apart, solve_positions
from solvers.trajectory.joint_ways import ClearSpace, joint_way, positions_of
from solvers.trajectory.monotone_cubic import monotone_cubic
from solvers.trajectory.position_plan import Dwell

POSES = 16
"""Poses kept at each place; ``LOOKED`` times as many are tried."""
LOOKED = 6
REACHED = 1e-5
"""A point within this share of the extent counts as having reached its target."""
NEARER = 8
"""If no point reaches its target, how often targets are moved to nearest places in its set."""
INNER = 0.9
"""The share of a set, about its middle, that contains these targets."""
PROJECTIONS = 20
SEARCHES = 12
"""The number of chains of poses whose ways are checked."""


@dataclass(frozen=True, slots=True)
class Stop:
    """A sample at which some points are each in a convex set."""

    sample: int
    aims: tuple[tuple[int, ConvexSet], ...]


def stops_of(dwells: Sequence[Dwell], steps: int) -> tuple[Stop, ...]:
    """The samples at which dwells begin and end, in order; dwells over all samples are ignored.

    The first and the last sample are always included.
    """
    own = [each for each in dwells if (each.first, each.last) != (0, steps)]
    samples = sorted({0, steps, *(end for each in own for end in (each.first, each.last))})
    return tuple(
        Stop(k, tuple((each.point, each.region) for each in own if each.first <= k <= each.last))
        for k in samples
    )


def joint_seeds(
    space: ClearSpace,
    stops: Sequence[Stop],
    drawn: Pool,
    first: Array | None,
    count: int,
    seed: int,
    *,
    straight: bool = False,
    to_edges: bool = False,
) -> list[Array]:
    """Motions (k + 1, n) through all stops, at most ``count``, the shortest first.

    ``drawn`` are random poses; ``first`` (n,) is the only start pose, or None for any.  With
    ``straight``, ways between stops are not led around obstacles.  With ``to_edges``, sets whose
    middle is out of reach are tried again near their edges.
    """
    rng = np.random.default_rng(seed)
    known: dict[tuple[tuple[int, int], ...], Array] = {}
    poses = []
    for stop in stops:
        check_time()
        key = tuple((point, id(region)) for point, region in stop.aims)
        if key not in known:
            known[key] = _poses(space, stop, drawn, rng, NEARER if to_edges else 0)
        poses.append(known[key])
    if first is not None:
        poses[0] = first[None]
    if not all(map(len, poses)):
        return []
    chains = _Chains(space, tuple(stops), tuple(poses), seed, straight)
    return chains.motions(count)


def _poses(
    space: ClearSpace, stop: Stop, drawn: Pool, rng: np.random.Generator, nearer: int
) -> Array:
    """Clear poses (K, n) with the points of a stop in their sets, far from each other.

    If no point reaches its target, new targets are chosen up to ``nearer`` times, or ``NEARER``
    times if the robot has too few coordinates to reach most targets.
    """
    if not stop.aims:
        q = drawn.q[: POSES * LOOKED]
    else:
        gaps = [
            np.max(drawn.positions[:, point] @ region.normals.T - region.offsets, axis=1)
            for point, region in stop.aims
        ]
        order = np.argsort(np.sum(np.maximum(gaps, 0.0), axis=0), kind="stable")
        starts = drawn.q[order[: POSES * LOOKED]]
        targets = np.concatenate(
            [_places(region, len(starts), rng) for _, region in stop.aims], axis=1
        )
        points = [point for point, _ in stop.aims]
        q, left = solve_positions(space.numeric, starts, space.theta, points, targets, space.box)
        reached = left < REACHED * space.extent
        # With fewer coordinates than the targets have, hardly any of these can be reached exactly.
        rounds = NEARER if space.numeric.n < targets.shape[1] else nearer
        for _ in range(0 if reached.any() else rounds):
            places = positions_of(space.numeric, q, space.theta)
            targets = np.concatenate(
                [_nearest(region, places[:, point]) for point, region in stop.aims], axis=1
            )
            q, left = solve_positions(space.numeric, q, space.theta, points, targets, space.box)
            reached = left < REACHED * space.extent
        q = q[reached]
    if not len(q):
        return q
    clearances = space.clearances(q)
    q = q[clearances >= space.clear]
    chosen: list[Array] = []
    for each in q:
        if len(chosen) == POSES:
            break
        if all(apart(space.numeric, each, other) for other in chosen):
            chosen.append(each)
    return np.array(chosen).reshape(-1, space.numeric.n)


def _places(region: ConvexSet, count: int, rng: np.random.Generator) -> Array:
    """Places (count, d) in a set, denser near its middle."""
    weights = rng.exponential(size=(count, len(region.vertices)))
    inside = weights @ region.vertices / weights.sum(axis=1, keepdims=True)
    found: Array = (inside + region.vertices.mean(axis=0)) / 2
    return found


def _nearest(region: ConvexSet, points: Array) -> Array:
    """The places in the inner part of a set nearest to points (K, d).

    They are found by alternating projections (Boyle & Dykstra, *A method for finding projections
    onto the intersection of convex sets in Hilbert spaces*, 1986).
    """
    middle = region.vertices.mean(axis=0)
    offsets = INNER * region.offsets + (1 - INNER) * (region.normals @ middle)
    back = np.zeros((len(offsets), *points.shape))
    for _ in range(PROJECTIONS):
        for normal, offset, own in zip(region.normals, offsets, back, strict=True):
            before = points + own
            points = before - np.maximum(before @ normal - offset, 0.0)[:, None] * normal
            own[:] = before - points
    return points


@dataclass(slots=True)
class _Chains:
    """Poses (c, n) at each stop, and the ways between them as far as they are known."""

    space: ClearSpace
    stops: tuple[Stop, ...]
    poses: tuple[Array, ...]
    seed: int
    straight: bool

    def motions(self, count: int) -> list[Array]:
        """The motions of the best chains; they end in different poses."""
        costs = [self._costs(number) for number in range(len(self.stops) - 1)]
        ways: dict[tuple[int, int, int], Array | None] = {}
        found: list[Array] = []
        for _ in range(SEARCHES):
            chain = _best(costs)
            if chain is None or len(found) == count:
                break
            good = True
            for number, (i, j) in enumerate(itertools.pairwise(chain)):
                if (number, i, j) not in ways:
                    start, end = self.poses[number][i], self.poses[number + 1][j]
                    ways[number, i, j] = self._way(start, end)
                if ways[number, i, j] is None:
                    costs[number][i, j] = np.inf
                    good = False
                    break
            if good:
                pairs = enumerate(itertools.pairwise(chain))
                own = [ways[number, i, j] for number, (i, j) in pairs]
                found.append(self._timed([way for way in own if way is not None]))
                costs[-1][:, chain[-1]] = np.inf
        return found

    def _way(self, start: Array, end: Array) -> Array | None:
        """Poses (w, n) on a clear way, or None if none is found."""
        if not self.straight:
            return joint_way(self.space, start, end, self.seed)
        clear = bool(self.space.passable(start[None], end[None])[0])
        return np.array([start, end]) if clear else None

    def _costs(self, number: int) -> Array:
        """The squared lengths divided by times, from each pose of a stop to each of the next."""
        before, after = self.poses[number], self.poses[number + 1]
        time = self.stops[number + 1].sample - self.stops[number].sample
        return self.space.lengths(after[None] - before[:, None]) ** 2 / time

    def _timed(self, ways: Sequence[Array]) -> Array:
        """Coordinates (k + 1, n) along ways, at each stop in time, from rest to rest."""
        steps = self.stops[-1].sample
        poses, times, along = [ways[0][0]], [0.0], [0.0]
        for way in ways:
            lengths = self.space.lengths(np.diff(way, axis=0))
            poses += list(way[1:])
            along += (along[-1] + np.cumsum(lengths)).tolist()
            times.append(along[-1])
        places = np.array(along)
        gates, samples = np.array(times), np.array([float(stop.sample) for stop in self.stops])
        curve = monotone_cubic(samples, gates, np.arange(steps + 1.0))
        at = np.clip(curve, 0.0, places[-1])
        kept = np.concatenate([[True], np.diff(places) > 0])
        columns = [np.interp(at, places[kept], column[kept]) for column in np.array(poses).T]
        return np.stack(columns, axis=1)


def _best(costs: Sequence[Array]) -> list[int] | None:
    """The cheapest chain as indices of poses; None if every chain is impossible."""
    total, choices = np.zeros(len(costs[0])), list[Array]()
    for cost in costs:
        sums = total[:, None] + cost
        choices.append(np.argmin(sums, axis=0))
        total = np.min(sums, axis=0)
    if not np.isfinite(total).any():
        return None
    chain = [int(np.argmin(total))]
    for choice in reversed(choices):
        chain.append(int(choice[chain[-1]]))
    return chain[::-1]

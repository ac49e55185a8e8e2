"""Grow a covering of the coordinates for one box of parameters where the task may be possible.

Each round asks why it may be. If no pose at the goal (or at the start) is known, all leaves that
may contain one are halved. Otherwise the leaves on short ways from start to goal are halved. A way
that appears to be clear ends the search; so does a pose that only smaller boxes of parameters
exclude.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from compiler.unreachability.box_tree import CoordinateTree
from solvers.impossibility.box_conditions import BoxConditions, Judged
from solvers.impossibility.coordinate_cover import CoordinateCover, Flags, Numbers, Side

AT_ONCE = 64
"""The leaves on ways that are halved in a round."""
WAYS = 4
"""The ways that are looked for in a round."""
SAMPLES = 5
"""The poses that are checked on each piece of a way."""
UNSEEN, UNCERTAIN, CLEAR = 2.0, 0.5, 0.05
"""Coordinates are halved while they move points by more than this multiple of what parameters do:
in leaves without a known valid pose, in leaves with a pose that some parameters exclude, and in
leaves with a pose that no parameters exclude."""


@dataclass(frozen=True, slots=True)
class Divide:
    """A parameter has to be divided first."""

    parameter: int


@dataclass(frozen=True, slots=True)
class Hopeless:
    """There is a way from start to goal, as far as floats can tell."""


@dataclass(frozen=True, slots=True)
class Exhausted:
    """The limit of leaves or rounds was reached."""


@dataclass(frozen=True, slots=True)
class Covered:
    """No way leads from start to goal."""

    tree: CoordinateTree


Grown = Covered | Divide | Hopeless | Exhausted


@dataclass(slots=True)
class BoxGrowth:
    """One box of parameters from ``low`` to ``high`` (p,); ``divisible`` says which can be divided.

    In a ``coarse`` box parameters are divided until poses are known, and then ways are blocked; in
    others ways are blocked at once, since there may be poses for single parameters only. For each
    kept leaf, ``whole`` judges it with all parameters, ``middle`` a pose in it with all parameters,
    and ``sample`` that pose with the middle parameters.
    """

    demands: BoxConditions
    side: Side
    low: Array
    high: Array
    divisible: Flags
    coarse: bool
    leaves: int
    rounds: int
    cover: CoordinateCover = field(init=False)
    whole: Judged = field(init=False)
    middle: Judged = field(init=False)
    sample: Judged = field(init=False)

    def grown(self) -> Grown:
        """Cover the coordinates, or say why not."""
        self.cover = CoordinateCover(self.side)
        self._judge(None)
        while self.rounds > 0:
            self.rounds -= 1
            passage = self._open_passage()
            if passage is None:
                return Covered(self.cover.tree())
            chosen = self._chosen(passage)
            if not isinstance(chosen, np.ndarray):
                return chosen
            if self.cover.leaves + len(chosen) > self.leaves:
                break
            halved = self.cover.halve(chosen, self._variables(chosen))
            self._judge(halved)
        return Exhausted()

    # --- judging --------------------------------------------------------------------------------

    def _judge(self, fresh: Numbers | None) -> None:
        """Judge new leaves (None: all of them), and keep those that are open."""
        low, high = self.cover.boxes()
        if fresh is not None:
            low, high = low[fresh], high[fresh]
        whole = self._judged(low, high, self.low, self.high)
        still = whole.open
        at = self._poses(low[still], high[still])
        centre = (self.low + self.high) / 2
        middle = sample = self._judged(at, at, centre, centre)
        if np.any(self.high > self.low):
            middle = self._judged(at, at, self.low, self.high)
        if fresh is None:
            self.cover.keep(still)
            self.whole, self.middle, self.sample = whole.at(still), middle, sample
            return
        count = len(self.cover.node)
        kept = np.ones(count, dtype=bool)
        kept[fresh[~still]] = False
        known = np.arange(count)
        known[fresh] = -1
        order = known[kept]
        place = np.full(count, -1)
        place[fresh[still]] = np.arange(int(still.sum()))
        new = place[kept]
        self.cover.keep(kept)
        self.whole = _merged(self.whole, whole.at(still), order, new)
        self.middle = _merged(self.middle, middle, order, new)
        self.sample = _merged(self.sample, sample, order, new)

    def _judged(self, low: Array, high: Array, first: Array, last: Array) -> Judged:
        """Judge boxes of coordinates (K, n), all with the same parameters."""
        shape = (len(low), len(first))
        return self.demands.judged(
            np.concatenate([low, np.broadcast_to(first, shape)], axis=1),
            np.concatenate([high, np.broadcast_to(last, shape)], axis=1),
        )

    def _poses(self, low: Array, high: Array) -> Array:
        """A pose (n,) in each box: the given start if the box contains it, otherwise the middle."""
        middle = (low + high) / 2
        given = self.demands.given
        if given is not None:
            inside = ((low <= given) & (given <= high)).all(axis=1)
            middle[inside] = given
        return np.asarray(middle)

    def _open_passage(self) -> int | None:
        """The first passage for which a chain of leaves may be a way."""
        everywhere = np.ones(len(self.cover.node), dtype=bool)
        for passage in range(self.whole.start.shape[1]):
            start, goal = self.whole.start[:, passage], self.whole.goal[:, passage]
            if not (start.any() and goal.any()):
                continue
            if np.any(self.cover.distances(start, everywhere)[goal] >= 0):
                return passage
        return None

    # --- choosing -------------------------------------------------------------------------------

    def _chosen(self, passage: int) -> Numbers | Divide | Hopeless:
        """The leaves to halve."""
        poses = []
        for name in ("goal", "start"):
            maybe = np.asarray(getattr(self.whole, name)[:, passage])
            certain = np.asarray(self.middle.open & getattr(self.middle, name)[:, passage])
            seen = np.asarray(self.sample.open & getattr(self.sample, name)[:, passage])
            poses.append((maybe, certain & maybe, seen & maybe))
        poses.sort(key=lambda item: int(item[0].sum()))
        for maybe, certain, _ in poses:
            if not certain.any():
                return self._halved(np.flatnonzero(maybe))
        for _, certain, seen in poses:
            if self.coarse and not seen.any():
                return self._finer(np.flatnonzero(certain), UNSEEN)
        return self._on_ways(passage)

    def _on_ways(self, passage: int) -> Numbers | Divide | Hopeless:
        """Leaves on short ways, to be halved so that each way becomes impossible."""
        allowed = np.ones(len(self.cover.node), dtype=bool)
        found: list[Numbers] = []
        for number, way in enumerate(self._ways(passage, allowed)):
            if number == 0 and self._is_clear(way, passage):
                return Hopeless()
            worth = self._worth(way, passage)
            if not len(worth):
                return Hopeless()
            decided = worth[~self._certain(worth, way, passage)]
            if not len(decided):
                finer = self._finer(worth, UNCERTAIN)
                if not isinstance(finer, np.ndarray):
                    return finer
                decided = finer
            found.append(decided)
            allowed[found[-1]] = False
            if sum(len(part) for part in found) >= AT_ONCE:
                break
        return self._halved(np.concatenate(found))

    def _ways(self, passage: int, allowed: Flags) -> Iterator[Numbers]:
        """Short ways from goal to start through leaves that are allowed at the time."""
        start, goal = self.whole.start[:, passage], self.whole.goal[:, passage]
        for _ in range(WAYS):
            way = self.cover.way(self.cover.distances(start, allowed), goal & allowed)
            if not len(way):
                return
            yield way

    def _worth(self, way: Numbers, passage: int) -> Numbers:
        """The leaves of a way with some pose that may not be on a valid way."""
        worth = ~self.whole.free[way]
        worth[0] |= not self.middle.goal[way[0], passage]
        worth[-1] |= not self.middle.start[way[-1], passage]
        return np.asarray(way[worth])

    def _certain(self, leaves: Numbers, way: Numbers, passage: int) -> Flags:
        """Whether the pose in each leaf may be valid, for any smaller boxes of coordinates."""
        certain = self.middle.open[leaves].copy()
        certain[leaves == way[0]] &= self.middle.goal[way[0], passage]
        certain[leaves == way[-1]] &= self.middle.start[way[-1], passage]
        return np.asarray(certain)

    def _is_clear(self, way: Numbers, passage: int) -> bool:
        """Whether all checked poses on a way are clear, for the middle parameters."""
        ends = self.sample.goal[way[0], passage] and self.sample.start[way[-1], passage]
        if not ends or not self.sample.open[way].all():
            return False
        poses = self._polyline(way)
        centre = (self.low + self.high) / 2
        return bool(self._judged(poses, poses, centre, centre).open.all())

    def _polyline(self, way: Numbers) -> Array:
        """Poses from leaf to touching leaf, through the middle of their common boundary."""
        low, high = (ends[way] for ends in self.cover.boxes())
        at = self._poses(low, high)
        first, last = np.maximum(low[:-1], low[1:]), np.minimum(high[:-1], high[1:])
        shared = (first + last) / 2
        wrapped = first > last + 1e-12  # they touch across the ends of a turn
        upward = low[:-1] > low[1:]
        leave = np.where(wrapped, np.where(upward, high[:-1], low[:-1]), shared)
        enter = np.where(wrapped, np.where(upward, low[1:], high[1:]), shared)
        t = np.linspace(0.0, 1.0, SAMPLES)[:, None, None]
        pieces = [at[None], at[:-1] + t * (leave - at[:-1]), enter + t * (at[1:] - enter)]
        return np.concatenate([piece.reshape(-1, at.shape[1]) for piece in pieces])

    # --- dividing -------------------------------------------------------------------------------

    def _halved(self, leaves: Numbers) -> Numbers | Hopeless:
        """The leaves with a side that can be halved and has an effect."""
        count = self.demands.n
        useful = self.whole.effects[leaves, :count] > 0
        can = (useful & self.cover.divisible()[leaves]).any(axis=1)
        return np.asarray(leaves[can]) if can.any() else Hopeless()

    def _variables(self, leaves: Numbers) -> Numbers:
        """The coordinate with the largest effect in each leaf."""
        effects = self.whole.effects[leaves, : self.demands.n]
        able = np.where(self.cover.divisible()[leaves], effects, -1.0)
        return np.asarray(np.argmax(able, axis=1), dtype=np.int64)

    def _finer(self, leaves: Numbers, part: float) -> Numbers | Divide | Hopeless:
        """The leaves whose coordinates matter compared with the parameters; else a parameter."""
        count = self.demands.n
        effects = self.whole.effects[leaves]
        most = effects[:, :count].max(axis=1, initial=0.0)
        others = np.where(self.divisible, effects[:, count:], 0.0)
        if not np.any(others > 0):
            return self._halved(leaves)
        free = self.middle.free[leaves] & (part < UNSEEN)
        least = np.where(free, CLEAR, part)
        coarse = leaves[most > least * others.max(axis=1)]
        if len(coarse):
            return self._halved(coarse)
        return Divide(int(np.argmax(others.sum(axis=0))))


def _merged(old: Judged, new: Judged, order: Numbers, place: Numbers) -> Judged:
    """Rows of ``old`` at ``order``, or of ``new`` at ``place`` where that is not negative."""
    fresh = place >= 0

    def rows(before: Array | Flags, after: Array | Flags) -> np.ndarray:
        result = np.empty((len(order), *before.shape[1:]), dtype=before.dtype)
        result[~fresh] = before[order[~fresh]]
        result[fresh] = after[place[fresh]]
        return result

    return Judged(
        rows(old.open, new.open), rows(old.free, new.free), rows(old.start, new.start),
        rows(old.goal, new.goal), rows(old.effects, new.effects),
    )  # fmt: skip

"""A covering of the coordinates for one box of parameters that is halved everywhere alike."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from compiler.unreachability.box_tree import CoordinateTree
from solvers.refutation.box_demands import BoxDemands, Judged
from solvers.refutation.box_growth import Divide
from solvers.refutation.coordinate_cover import CoordinateCover, Flags, Side


@dataclass(slots=True)
class EvenGrowth:
    """One box of parameters from ``low`` to ``high`` (p,); ``divisible`` says which of them are."""

    demands: BoxDemands
    side: Side
    low: Array
    high: Array
    divisible: Flags
    cover: CoordinateCover = field(init=False)
    judged: Judged = field(init=False)

    def __post_init__(self) -> None:
        self.cover = CoordinateCover(self.side)
        self._judge()

    def refined(self, size: int) -> CoordinateTree:
        """A tree with at most so many leaves that are kept, and less than twice as many in all."""
        while 0 < 2 * len(self.cover.node) <= size and 2 * self.cover.leaves <= 4 * size:
            effects = self.judged.effects[:, : self.demands.n]
            able = np.where(self.cover.divisible(), effects, -1.0)
            where = np.flatnonzero(able.max(axis=1, initial=0.0) > 0)
            if not len(where):
                break
            self.cover.halve(where, np.asarray(np.argmax(able[where], axis=1), dtype=np.int64))
            self._judge()
        return self.cover.tree()

    def parameter(self) -> Divide | None:
        """The parameter of most effect, if one can be divided."""
        effects = self.judged.effects[:, self.demands.n :].sum(axis=0)
        effects = np.where(self.divisible, effects, 0.0)
        return Divide(int(np.argmax(effects))) if np.any(effects > 0) else None

    def _judge(self) -> None:
        """Judge all kept leaves, and keep those that are open."""
        low, high = self.cover.boxes()
        shape = (len(low), len(self.low))
        judged = self.demands.judged(
            np.concatenate([low, np.broadcast_to(self.low, shape)], axis=1),
            np.concatenate([high, np.broadcast_to(self.high, shape)], axis=1),
        )
        self.cover.keep(judged.open)
        self.judged = judged.at(judged.open)

"""Search for a covering that shows that a robot cannot do a task with any parameters.

The search is depth first over boxes of parameters, with a covering of the coordinates grown for
each. The result is a proof only once the verifier has replayed it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.intervals import around
from compiler.objectives.cheaper_robots import CheaperRobots
from compiler.unreachability.box_tree import (
    LEAF,
    MOST_VARIABLES,
    ChoiceSide,
    CoordinateTree,
    ParameterLeaf,
    ParameterTree,
    Part,
    Parts,
    coordinate_sides,
    enclosures,
    parameter_sides,
)
from compiler.unreachability.motion_conditions import MotionConditions, Passage
from solvers.impossibility.box_conditions import NEAR, BoxConditions, Judged
from solvers.impossibility.box_growth import BoxGrowth, Covered, Divide, Hopeless
from solvers.impossibility.coordinate_cover import CoordinateCover, Flags, Side

MOST_HALVINGS = 24
"""The most halvings of a parameter."""
COARSE = 3
"""Boxes of parameters with fewer halvings per parameter, on average, are coarse."""


@dataclass(frozen=True, slots=True)
class CoveringBudget:
    """Limits: leaves in total and for one box of parameters, and rounds in total."""

    leaves: int
    leaves_at_once: int
    rounds: int


FOR_A_WAY = CoveringBudget(800, 800, 40)
"""For a way at given parameters, which usually exists."""
STRAIGHT = 41
"""The number of poses that are checked on a line."""


@dataclass(frozen=True, slots=True)
class Covering:
    """A covering, and the number of the question that it refutes."""

    tree: ParameterTree
    question: int


def find_covering(
    demands: MotionConditions,
    graph: RobotGraph,
    budget: CoveringBudget,
    cheaper: CheaperRobots | None = None,
) -> Covering | None:
    """A covering of the boxes of a robot's parameters and coordinates; None if none was found.

    ``graph`` is in the joints' own coordinates. Only parameters of ``cheaper`` robots have to be
    covered; None: all parameters. The search is deterministic.
    """
    most = max(len(demands.model.dofs), len(demands.model.parameters))
    if coordinate_sides(demands.model) is None or most > MOST_VARIABLES:
        return None
    for question, passages in enumerate(demands.passages):
        if not passages:
            return Covering((ParameterLeaf("|", (LEAF,)),), question)
    for question, passages in enumerate(demands.passages):
        try:
            search = Search(demands, passages, graph)
        except ValueError:  # rules, or their derivatives, without an exact value
            return None
        found = search.tree(budget, cheaper)
        if found is not None:
            return Covering(found, question)
    return None


class Search:
    """The search for one question, which has ``passages``.

    Raises:
        ValueError: the robot's rules have no value over boxes, or its range is unlimited.
    """

    def __init__(
        self, demands: MotionConditions, passages: tuple[Passage, ...], graph: RobotGraph
    ) -> None:
        sides = coordinate_sides(demands.model)
        if sides is None:
            raise ValueError("a prismatic joint has no range")
        self._side = Side(
            np.array([float(side.low.mid()) for side in sides]),
            np.array([float(side.high.mid()) for side in sides]),
            np.array([side.circle for side in sides], dtype=bool),
        )
        self._demands = BoxConditions(demands, passages, graph, self._side.circle)
        self._parameters = parameter_sides(demands.model)

    def straight(self, start: Array | None, target: Array, theta: Array) -> bool:
        """Whether poses on the straight line to a goal are clear, at parameters (p,).

        The poses are coordinates (n,) in rad or m; ``start`` None is the start given by the task.
        """
        start = self._demands.given if start is None else start
        if start is None:
            return False
        poses = start + np.linspace(0.0, 1.0, STRAIGHT)[:, None] * (target - start)
        at = np.concatenate([poses, np.broadcast_to(theta, (STRAIGHT, len(theta)))], axis=1)
        judged = self._demands.judged(at, at)
        return bool(judged.open.all() and judged.goal[-1].any())

    def start_excluded(self) -> bool:
        """Whether the given start is out of range, or violates a demand for all parameters."""
        given = self._demands.given
        if given is None:
            return False
        if np.any((given < self._side.low - NEAR) | (given > self._side.high + NEAR)):
            return True
        ends = enclosures(self._parameters, (Part(),) * len(self._parameters))
        low = np.array([*given, *(float(side.low) for side in ends)])
        high = np.array([*given, *(float(side.high) for side in ends)])
        return not self._demands.judged(low[None], high[None]).open[0]

    def way_at(self, theta: Array) -> bool:
        """Whether there appears to be a way at parameters (p,)."""
        fixed = np.zeros(len(theta), dtype=bool)
        at = FOR_A_WAY
        growth = BoxGrowth(
            self._demands, self._side, theta, theta, fixed,
            coarse=False, leaves=at.leaves, rounds=at.rounds,
        )  # fmt: skip
        return isinstance(growth.grown(), Hopeless)

    def tree(
        self, budget: CoveringBudget, cheaper: CheaperRobots | None = None
    ) -> ParameterTree | None:
        """A covering without a way, for all parameters or those of ``cheaper`` robots.

        None if none was found.
        """
        nodes: list[int | ParameterLeaf] = []
        waiting: list[Parts] = [(Part(),) * len(self._parameters)]
        leaves, rounds = budget.leaves, budget.rounds
        while waiting:
            box = waiting.pop()
            if cheaper is not None and cheaper.none_in(enclosures(self._parameters, box)):
                nodes.append(ParameterLeaf("$", ()))
                continue
            growth = self._growth(box, min(leaves, budget.leaves_at_once), rounds, cheaper)
            grown = growth.grown()
            leaves, rounds = leaves - growth.cover.leaves, growth.rounds
            if cheaper is not None and rounds > 0 and not isinstance(grown, Covered | Divide):
                grown = self._divided(box, cheaper) or grown
            match grown:
                case Covered(tree):
                    nodes.append(ParameterLeaf("|", tree))
                case Divide(parameter):
                    nodes.append(parameter)
                    waiting += [
                        (*box[:parameter], half, *box[parameter + 1 :])
                        for half in reversed(box[parameter].halves())
                    ]
                case _:
                    return None
        return tuple(nodes)

    def _divided(self, box: Parts, cheaper: CheaperRobots) -> Divide | None:
        """The parameter to divide if no way is known at the middle of a box; None if one is.

        A middle without cheaper robots counts as one without a way.
        """
        low, high, able = self._ends(box, cheaper)
        middle = (low + high) / 2
        if not np.any(able):
            return None
        if cheaper.none_in([around(arb(value)) for value in middle.tolist()]):
            gains = [self._gain(box, i, cheaper) if able[i] else 0.0 for i in range(len(box))]
            if any(gains):
                return Divide(int(np.argmax(gains)))
        elif self.way_at(middle):
            return None
        return Divide(min(np.flatnonzero(able).tolist(), key=lambda i: box[i].halvings))

    def _gain(self, box: Parts, place: int, cheaper: CheaperRobots) -> float:
        """How much the least values of the halves of a parameter differ, over all objectives."""
        halves = [
            enclosures(self._parameters, (*box[:place], half, *box[place + 1 :]))
            for half in box[place].halves()
        ]
        least = [[cheaper.least(less.amount, half) for less in cheaper.less] for half in halves]
        return float(sum(abs(a - b) for a, b in zip(*least, strict=True)))

    def even(self, box: Parts, shape: Sequence[int]) -> EvenGrowth:
        """A covering with evenly halved leaves, for a box of parameters.

        The coordinates ``shape``, on which M depends, are halved more often than others.
        """
        weights = np.ones(self._demands.n)
        weights[list(shape)] = SHAPE
        return EvenGrowth(self._demands, self._side, *self._ends(box), weights)

    def _growth(
        self, box: Parts, leaves: int, rounds: int, cheaper: CheaperRobots | None
    ) -> BoxGrowth:
        coarse = sum(part.halvings for part in box) < COARSE * len(box)
        ends = self._ends(box, cheaper)
        return BoxGrowth(self._demands, self._side, *ends, coarse, leaves, rounds)

    def _ends(self, box: Parts, cheaper: CheaperRobots | None = None) -> tuple[Array, Array, Flags]:
        """The ends of a box of parameters, and which of them can be divided."""
        ends = enclosures(self._parameters, box)
        if cheaper is not None:
            ends = cheaper.narrowed(ends)
        low = np.array([float(side.low) for side in ends])
        high = np.array([float(side.high) for side in ends])
        return low, high, self._divisible(box, low, high)

    def _divisible(self, box: Parts, low: Array, high: Array) -> Flags:
        """Which parameters of a box can be divided."""
        found = []
        for i, (side, part) in enumerate(zip(self._parameters, box, strict=True)):
            if isinstance(side, ChoiceSide):
                first, last = side.chosen(part)
                found.append(last - first > 1)
            else:
                found.append(part.halvings < MOST_HALVINGS and bool(high[i] > low[i]))
        return np.array(found, dtype=bool)


# --- An evenly halved covering of the coordinates for one box of parameters -----------------------


SHAPE = 8.0
"""The effect of coordinates on which M depends counts so often."""


@dataclass(slots=True)
class EvenGrowth:
    """One box of parameters from ``low`` to ``high`` (p,); ``divisible`` ones can be divided.

    The coordinate is halved that moves points most, times its entry of ``weights`` (n,).
    """

    demands: BoxConditions
    side: Side
    low: Array
    high: Array
    divisible: Flags
    weights: Array
    cover: CoordinateCover = field(init=False)
    judged: Judged = field(init=False)

    def __post_init__(self) -> None:
        self.cover = CoordinateCover(self.side)
        self._judge()

    def refined(self, size: int, *, goals: bool = False) -> CoordinateTree:
        """A tree with at most ``size`` kept leaves, and at most 2.5 times as many in total.

        With ``goals``, only leaves that may have a goal pose are halved, however often.
        """
        while True:
            chosen: Flags = self.judged.open
            if goals:
                chosen = np.logical_or.reduce(self.judged.goal, axis=1)
            new = int(chosen.sum())
            if not 0 < len(chosen) + new <= size or self.cover.leaves + new > 4 * size:
                break
            effects = self.judged.effects[:, : self.demands.n]
            effects = effects if goals else effects * self.weights
            able = np.where(self.cover.divisible() & chosen[:, None], effects, -1.0)
            where = np.flatnonzero(able.max(axis=1, initial=0.0) > 0)
            if not len(where):
                break
            self.cover.halve(where, np.asarray(np.argmax(able[where], axis=1), dtype=np.int64))
            self._judge()
        return self.cover.tree()

    def parameter(self) -> Divide | None:
        """The parameter with the largest effect, if one can be divided."""
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

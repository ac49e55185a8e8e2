"""The cheapest chains of robots through the tasks of a mission: a shortest path through layers.

Every layer has the robots that remain for a task; a step from one robot to a robot of the next
layer costs what rebuilding it costs. Costs of words are computed for all pairs at once; a pair of
robots whose parameters are both known is computed separately.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from math import lcm
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from compiler.missions.robot_changes import Built, Free, cost_of_changes
from grammar_lang import ir

Ints: TypeAlias = npt.NDArray[Any]
"""Integers of 64 bits, or objects if these are too small."""
NONE = 2**61
"""The cost of an impossible step, if costs have 64 bits."""


Words: TypeAlias = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Link:
    """A robot of a layer; ``narrow``: its parameters are known more closely than their domains.

    ``rank`` orders chains of equal cost, smaller ones first.
    """

    robot: Built
    rank: int = 0
    narrow: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its modules."""
        return tuple(module.name for module in self.robot)


@dataclass(slots=True)
class ChainCosts:
    """The costs of steps; ``existing`` is the robot that exists before the first task, if any."""

    prices: ir.Prices
    free: Free
    existing: Link | None = None
    scale: int = field(init=False)
    _words: dict[tuple[bool, Words, Words], Ints] = field(
        default_factory=dict[tuple[bool, Words, Words], Ints]
    )
    _pairs: dict[tuple[int, int], tuple[Link, Link, int]] = field(
        default_factory=dict[tuple[int, int], tuple[Link, Link, int]]
    )

    def __post_init__(self) -> None:
        prices = self.prices
        self.scale = lcm(*(p.denominator for p in (prices.add, prices.remove, prices.change)))

    def whole(self, cost: Fraction) -> int:
        """A cost as an integer."""
        return int(cost * self.scale)

    def most(self, layers: Sequence[Sequence[Link]]) -> int:
        """An upper bound of the cost of any chain, as an integer."""
        given = 0 if self.existing is None else len(self.existing.robot)
        longest = [max(len(link.robot) for link in layer) for layer in layers]
        prices = self.prices
        each = self.whole(max(prices.add, prices.remove, prices.change))
        return 2 * (given + 2 * sum(longest)) * each

    def steps(self, before: Sequence[Link], after: Sequence[Link], *, wide: bool = False) -> Ints:
        """The costs (len(before), len(after)) of all steps from one layer to the next.

        ``wide``: they may have more than 64 bits.
        """
        add, remove = self.whole(self.prices.add), self.whole(self.prices.remove)
        first = list(dict.fromkeys(link.names for link in before))
        second = list(dict.fromkeys(link.names for link in after))
        key = wide, tuple(first), tuple(second)
        if key not in self._words:
            self._words[key] = word_costs(first, second, add, remove, wide=wide)
        at_first = {names: i for i, names in enumerate(first)}
        at_second = {names: j for j, names in enumerate(second)}
        rows = np.array([at_first[link.names] for link in before], dtype=np.int64)
        columns = np.array([at_second[link.names] for link in after], dtype=np.int64)
        costs: Ints = self._words[key][np.ix_(rows, columns)]
        narrow = [j for j, link in enumerate(after) if link.narrow]
        for i, link in enumerate(before):
            for j in narrow if link.narrow else ():
                costs[i, j] = self._pair(link, after[j])
        return costs

    def _pair(self, before: Link, after: Link) -> int:
        key = id(before), id(after)
        if key not in self._pairs:
            cost = cost_of_changes(before.robot, after.robot, self.prices, self.free)
            self._pairs[key] = before, after, self.whole(cost)
        return self._pairs[key][2]


def word_costs(
    old: Sequence[tuple[str, ...]],
    new: Sequence[tuple[str, ...]],
    add: int,
    remove: int,
    *,
    wide: bool = False,
) -> Ints:
    """The costs of turning words into words by their modules alone, (len(old), len(new)).

    ``wide``: costs may have more than 64 bits.

    All pairs are computed at once, one cell of the table of Wagner & Fischer after another.
    """
    names: dict[str, int] = {}
    for word in (*old, *new):
        for name in word:
            names.setdefault(name, len(names))
    n, m = (max(map(len, words), default=0) for words in (old, new))
    left, right = _padded(old, names, n), _padded(new, names, m)
    lengths = np.array([len(word) for word in old]), np.array([len(word) for word in new])
    kind = object if wide else np.int64
    costs: Ints = np.zeros((len(old), len(new)), dtype=kind)
    rows: list[Ints] = [np.full(costs.shape, j * add, dtype=kind) for j in range(m + 1)]
    for i in range(n + 1):
        if i:
            above, rows = rows, [np.full(costs.shape, i * remove, dtype=kind)]
            for j in range(1, m + 1):
                cell = np.minimum(above[j] + remove, rows[j - 1] + add)
                same = left[:, i - 1, None] == right[None, :, j - 1]
                rows.append(np.where(same, np.minimum(cell, above[j - 1]), cell))
        for j in range(m + 1):
            here = (lengths[0] == i)[:, None] & (lengths[1] == j)[None, :]
            costs[here] = rows[j][here]
    return costs


def _padded(
    words: Sequence[tuple[str, ...]], names: dict[str, int], length: int
) -> npt.NDArray[np.int64]:
    table = np.full((len(words), length), -1, dtype=np.int64)
    for i, word in enumerate(words):
        table[i, : len(word)] = [names[name] for name in word]
    return table


@dataclass(frozen=True, slots=True)
class Chain:
    """The number of a robot in every layer, and the cost of all steps."""

    robots: tuple[int, ...]
    cost: Fraction


def cheapest_chain(
    costs: ChainCosts,
    layers: Sequence[Sequence[Link]],
    blocked: Sequence[tuple[int, int, int]] = (),
) -> Chain | None:
    """The cheapest chain, of equal ones that with the least sum of ranks; None if there is none.

    Args:
        costs: the costs of steps.
        layers: the robots that remain for each task.
        blocked: steps that are not allowed: the number of the layer that they start from, and the
            numbers of the two robots.
    """
    if not all(layers):
        return None
    unit = sum(max(link.rank for link in layer) for layer in layers) + 1
    most = (costs.most(layers) + 1) * unit
    wide = most >= NONE
    none = max(most, NONE)
    kind = object if wide else np.int64
    ranks: list[Ints] = [np.array([link.rank for link in layer], dtype=kind) for layer in layers]
    best = ranks[0].copy()
    if costs.existing is not None:
        best += costs.steps([costs.existing], layers[0], wide=wide)[0] * unit
    behind: list[Ints] = []
    for number, (before, after) in enumerate(pairwise(layers)):
        steps = costs.steps(before, after, wide=wide) * unit
        for layer, i, j in blocked:
            if layer == number:
                steps[i, j] = none
        total = best[:, None] + steps
        behind.append(total.argmin(axis=0))
        best = np.minimum(total.min(axis=0), none) + ranks[number + 1]
    last = int(best.argmin())
    if best[last] >= none:
        return None
    found = [last]
    for choice in reversed(behind):
        found.append(int(choice[found[-1]]))
    return Chain(tuple(reversed(found)), Fraction(int(best[last]) // unit, costs.scale))

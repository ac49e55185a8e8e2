"""Missions of arms on one joint whose links have lengths from intervals: linear programs decide.

An arm does a task if the sum of its lengths is within two bounds.  All chains of words, all ways to
keep modules and all choices of what is changed are asked about, the cheapest first.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product

import numpy as np
from scipy.optimize import linprog

from tests.oracles.mission_arms import CLEAR, Unclear
from tests.oracles.mission_robots import Prices, Robot, keeping

Word = tuple[str, ...]
Place = tuple[int, int]
"""The number of a robot in a chain, and that of a module in it."""
Same = tuple[tuple[Place, Place], ...]
"""Places whose lengths are equal."""
MOST_QUESTIONS = 4000


@dataclass(frozen=True)
class Step:
    """A way to make a word of another one: its cost, and the modules whose lengths are kept."""

    cost: Fraction
    same: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Continuous:
    """Words for each task, its bounds on the length of an arm, and the lengths of links.

    ``chosen`` are the links whose lengths are parameters.
    """

    layers: tuple[tuple[Word, ...], ...]
    needed: tuple[tuple[float, float], ...]
    spans: dict[str, tuple[float, float]]
    chosen: frozenset[str]
    prices: Prices
    existing: Robot | None = None

    def alone(self) -> bool:
        """Whether every task has a word."""
        return all(
            any(self._does(word, [k]) for word in layer) for k, layer in enumerate(self.layers)
        )

    def _does(self, word: Word, tasks: Sequence[int]) -> bool:
        """Whether an arm of a word does some tasks with one value of each length."""
        low = sum(self.spans[name][0] for name in word if name in self.spans)
        high = sum(self.spans[name][1] for name in word if name in self.spans)
        first = max(self.needed[k][0] for k in tasks)
        last = min(self.needed[k][1] for k in tasks)
        gap = min(high, last) - max(low, first)
        if abs(gap) < CLEAR and not (low == high and gap == 0):
            raise Unclear
        if low == high and min(abs(low - first), abs(last - low)) < CLEAR:
            raise Unclear
        return gap > 0 or (gap == 0 and first < low < last)

    def shared(self) -> set[Word]:
        """The words of arms that do all tasks with one value of each length."""
        every = range(len(self.layers))
        words = set(self.layers[0]).intersection(*self.layers[1:])
        return {word for word in words if self._does(word, every)}

    def each(self) -> set[Word]:
        """The words of arms that do each task with lengths of their own."""
        words = set(self.layers[0]).intersection(*self.layers[1:])
        return {w for w in words if all(self._does(w, [k]) for k in range(len(self.layers)))}

    def blind(self) -> tuple[Fraction] | None:
        """The least cost as if lengths did not matter."""
        return self._least(blind=True)

    def least(self) -> tuple[Fraction] | None:
        """The least cost of a chain."""
        return self._least(blind=False)

    # --- chains ----------------------------------------------------------------------------------

    def _least(self, *, blind: bool) -> tuple[Fraction] | None:
        able = [
            [word for word in layer if self._does(word, [k])] for k, layer in enumerate(self.layers)
        ]
        ways = sorted(self._ways(able), key=lambda way: way[0])
        for count, (cost, words, same) in enumerate(ways):
            if count > MOST_QUESTIONS:
                raise Unclear
            if blind or self._agree(words, same):
                return (cost,)
        return None

    def _ways(self, able: list[list[Word]]) -> Iterator[tuple[Fraction, tuple[Word, ...], Same]]:
        old = None if self.existing is None else tuple(name for name, _ in self.existing)
        cache = {
            (a, b): list(self._steps(a, b))
            for before, after in pairwise(able)
            for a, b in product(before, after)
        }
        count = 1
        for before, after in pairwise(able):
            count *= max((len(cache[a, b]) for a, b in product(before, after)), default=0)
        if count * len(able[0]) > 50_000:
            raise Unclear
        for words in product(*able):
            first = Fraction(0)
            if old is not None:
                first = min(step.cost for step in self._steps(old, words[0]))
            for steps in product(*(cache[pair] for pair in pairwise(words))):
                same = tuple(
                    ((k, i), (k + 1, j)) for k, step in enumerate(steps) for i, j in step.same
                )
                yield first + sum((step.cost for step in steps), Fraction(0)), words, same

    def _steps(self, old: Word, new: Word) -> Iterator[Step]:
        prices = self.prices
        for pairs in keeping(old, new):
            cost = prices.remove * (len(old) - len(pairs)) + prices.add * (len(new) - len(pairs))
            shared = [(i, j) for i, j in pairs if old[i] in self.chosen]
            may = [(i, j) for i, j in shared if old[i] in prices.free]
            for which in product([False, True], repeat=len(may)):
                changed = {pair for pair, yes in zip(may, which, strict=True) if yes}
                same = tuple(pair for pair in shared if pair not in changed)
                yield Step(cost + prices.change * len(changed), same)

    def _agree(self, words: tuple[Word, ...], same: Same) -> bool:
        """Whether there are lengths, with room to spare; else there are none by as much."""
        if self._program(words, same, CLEAR):
            return True
        if self._program(words, same, -CLEAR):
            raise Unclear
        return False

    def _program(self, words: tuple[Word, ...], same: Same, room: float) -> bool:
        places = {
            (k, i): n
            for n, (k, i) in enumerate(
                (k, i)
                for k, word in enumerate(words)
                for i, m in enumerate(word)
                if m in self.spans
            )
        }
        bounds = [(0.0, 0.0)] * len(places)
        for (k, i), n in places.items():
            low, high = self.spans[words[k][i]]
            inner = min(room, (high - low) / 4) if high > low else 0.0
            bounds[n] = (low + inner, high - inner) if high > low else (low, high)
        rows, limits = list[np.ndarray](), list[float]()
        for k, (low, high) in enumerate(self.needed):
            row = np.array([float(place[0] == k) for place in places])
            rows += [row, -row]
            limits += [high - room, -low - room]
        equal = np.zeros((len(same), len(places)))
        for n, (one, other) in enumerate(same):
            equal[n, places[one]], equal[n, places[other]] = 1.0, -1.0
        found = linprog(
            np.zeros(len(places)), np.array(rows), limits,
            equal if same else None, np.zeros(len(same)) if same else None, bounds,
        )  # fmt: skip
        return found.status == 0

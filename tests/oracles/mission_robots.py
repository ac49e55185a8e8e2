"""What missions cost, by brute force: robots, ways to rebuild them, and chains of them.

Nothing here is of the project.  A robot is a tuple of modules, a module a name and the value of its
length, None where it has none or where nobody says what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations

Module = tuple[str, Fraction | None]
Robot = tuple[Module, ...]
Pairs = tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Prices:
    """What changes cost; kept modules may change the length of those that are ``free``."""

    add: Fraction
    remove: Fraction
    change: Fraction = Fraction(0)
    free: frozenset[str] = frozenset()


def keeping(old: Sequence[str], new: Sequence[str]) -> Iterator[Pairs]:
    """All ways to keep modules of one name, in their order."""
    for size in range(min(len(old), len(new)) + 1):
        for some in combinations(range(len(old)), size):
            for others in combinations(range(len(new)), size):
                pairs = tuple(zip(some, others, strict=True))
                if all(old[i] == new[j] for i, j in pairs):
                    yield pairs


def rebuilding(old: Robot, new: Robot, prices: Prices) -> Fraction:
    """What the cheapest way from one robot to another costs."""

    @cache
    def rest(i: int, j: int) -> Fraction:
        ways = list[Fraction]()
        if i < len(old):
            ways.append(prices.remove + rest(i + 1, j))
        if j < len(new):
            ways.append(prices.add + rest(i, j + 1))
        if i < len(old) and j < len(new):
            change = changing(old[i], new[j], prices)
            ways += [] if change is None else [change + rest(i + 1, j + 1)]
        return min(ways, default=Fraction(0))

    return rest(0, 0)


def changing(old: Module, new: Module, prices: Prices) -> Fraction | None:
    """What it costs to keep a module as another one; None: it cannot be kept."""
    if old[0] != new[0]:
        return None
    if None in (old[1], new[1]) or old[1] == new[1]:
        return Fraction(0)
    return prices.change if old[0] in prices.free else None


def cheapest(
    layers: Sequence[Collection[Robot]],
    cost: Callable[[Robot, Robot], Fraction],
    existing: Robot | None = None,
) -> Fraction | None:
    """What the cheapest chain of robots costs, one of every layer; None: there is none."""
    best: dict[Robot, Fraction] = {}
    for number, layer in enumerate(layers):
        if number == 0:
            best = {
                robot: Fraction(0) if existing is None else cost(existing, robot) for robot in layer
            }
            continue
        best = {
            robot: min(spent + cost(before, robot) for before, spent in best.items())
            for robot in layer
            if best
        }
    return min(best.values(), default=None)

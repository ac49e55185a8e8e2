"""The changes that turn one robot into another: modules removed, added, kept and changed.

A module can be kept only as a module of the same name with the same parameter values, except for
those that may change. The cheapest way of keeping modules in their order is chosen (Wagner &
Fischer 1974, with deletions and insertions). If no parameters are known, the cost is that of the
words, as in :mod:`compiler.robots.alignment`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.missions.parameter_ranges import Ranges, meet, single
from compiler.robots.parameter_values import ParameterValue
from grammar_lang import ir

Free: TypeAlias = Collection[tuple[str, str]]


@dataclass(frozen=True, slots=True)
class BuiltModule:
    """A module of a robot; ``values`` gives the ranges of those parameters that are known."""

    name: str
    values: Mapping[str, Ranges]


Built: TypeAlias = tuple[BuiltModule, ...]
"""A robot as its modules in word order."""


@dataclass(frozen=True, slots=True)
class Changes:
    """The cheapest way from one robot to another.

    ``kept`` holds pairs of numbers of modules, in the old robot and in the new one; ``changed``
    holds such pairs with the name of a parameter that must get another value.
    """

    cost: Fraction
    kept: tuple[tuple[int, int], ...]
    removed: tuple[int, ...]
    added: tuple[int, ...]
    changed: tuple[tuple[int, int, str], ...]


def built(
    word: Sequence[str], modules: Collection[str], values: Mapping[tuple[int, str], Ranges]
) -> Built:
    """The robot of a word.

    Args:
        word: its symbols.
        modules: which of them are modules.
        values: the ranges of parameters, by the index in the word and the name.
    """
    known: dict[int, dict[str, Ranges]] = {}
    for (symbol, name), ranges in values.items():
        known.setdefault(symbol, {})[name] = ranges
    return tuple(
        BuiltModule(symbol, known.get(index, {}))
        for index, symbol in enumerate(word)
        if symbol in modules
    )


def built_of(
    word: Sequence[str], modules: Collection[str], parameters: Sequence[ParameterValue]
) -> Built:
    """A robot with one value for each of its parameters."""
    values = {(p.parameter.symbol, p.parameter.name): single(p.stated) for p in parameters}
    return built(word, modules, values)


def changes(old: Built, new: Built, prices: ir.Prices, free: Free) -> Changes:
    """The cheapest way from one robot to another.

    Of several it is the one that keeps most modules, and of these the one that keeps what comes
    first.

    Args:
        old: the existing robot.
        new: the robot to be built.
        prices: the prices of changes.
        free: the parameters, by module name and parameter name, that kept modules may change.
    """
    rest = _costs(old, new, prices, free)
    kept, removed, added = [], [], []
    altered: list[tuple[int, int, str]] = []
    i = j = 0
    while i < len(old) or j < len(new):
        if i < len(old) and j < len(new):
            names = _to_change(old[i], new[j], free)
            if names is not None and rest[i][j] == _plus(
                rest[i + 1][j + 1], prices.change * len(names), 0
            ):
                kept.append((i, j))
                altered += [(i, j, name) for name in names]
                i, j = i + 1, j + 1
                continue
        if i < len(old) and rest[i][j] == _plus(rest[i + 1][j], prices.remove, 1):
            removed.append(i)
            i += 1
        else:
            added.append(j)
            j += 1
    return Changes(rest[0][0][0], tuple(kept), tuple(removed), tuple(added), tuple(altered))


def cost_of_changes(old: Built, new: Built, prices: ir.Prices, free: Free) -> Fraction:
    """The cost of the cheapest way from one robot to another."""
    return _costs(old, new, prices, free)[0][0][0]


Cost: TypeAlias = tuple[Fraction, int]
"""The cost of changes, and the number of modules that are not kept."""


def _plus(cost: Cost, price: Fraction, modules: int) -> Cost:
    return cost[0] + price, cost[1] + modules


def _costs(old: Built, new: Built, prices: ir.Prices, free: Free) -> list[list[Cost]]:
    """The least costs of turning ``old[i:]`` into ``new[j:]``."""
    n, m = len(old), len(new)
    rest: list[list[Cost]] = [[(Fraction(0), 0)] * (m + 1) for _ in range(n + 1)]
    for i in range(n, -1, -1):
        for j in range(m, -1, -1):
            found: list[Cost] = []
            if i < n:
                found.append(_plus(rest[i + 1][j], prices.remove, 1))
            if j < m:
                found.append(_plus(rest[i][j + 1], prices.add, 1))
            if i < n and j < m:
                names = _to_change(old[i], new[j], free)
                if names is not None:
                    found.append(_plus(rest[i + 1][j + 1], prices.change * len(names), 0))
            rest[i][j] = min(found, default=(Fraction(0), 0))
    return rest


def _to_change(old: BuiltModule, new: BuiltModule, free: Free) -> list[str] | None:
    """The parameters whose values must change for a module to be kept; None if it cannot be."""
    if old.name != new.name:
        return None
    found: list[str] = []
    for name, ranges in old.values.items():
        if name in new.values and not meet(ranges, new.values[name]):
            if (old.name, name) not in free:
                return None
            found.append(name)
    return found

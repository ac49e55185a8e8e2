"""The parameters that robots of a chain share, because modules that are kept keep their values."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.missions.robot_changes import Built, changes
from grammar_lang import ir
from solvers.missions.shared_values import Group, Place


@dataclass(frozen=True, slots=True)
class LinkedRobot:
    """A robot of a chain.

    ``symbols`` are the places of its modules in its word; ``parameters`` have the place of their
    module and their name.
    """

    robot: Built
    symbols: tuple[int, ...]
    parameters: tuple[tuple[int, str], ...]

    def parameter(self, module: int, name: str) -> int:
        """The index of a parameter of a module."""
        return self.parameters.index((self.symbols[module], name))


@dataclass(frozen=True, slots=True)
class KeptParameters:
    """What modules keep when a robot is rebuilt at some prices; ``free`` parameters may change."""

    prices: ir.Prices
    free: frozenset[tuple[str, str]]

    def values(self, old: Built, new: LinkedRobot) -> dict[int, Fraction]:
        """The values that a robot keeps of one whose values are known, by parameter."""
        return {
            new.parameter(module, name): value
            for _, module, name, value in self._common(old, new.robot)
            if value is not None
        }

    def groups(
        self, before: Built | None, chain: Sequence[LinkedRobot]
    ) -> tuple[list[Group], dict[Group, Fraction]]:
        """The parameters that must be equal along a chain, and the groups whose value is given.

        Args:
            before: the robot before the first task; None if there is none.
            chain: the robots of all tasks.
        """
        joined = _Joined()
        given: dict[Place, Fraction] = {}
        for k, linked in enumerate(chain):
            old = before if not k else chain[k - 1].robot
            if old is None:
                continue
            for i, j, name, value in self._common(old, linked.robot):
                place = k, linked.parameter(j, name)
                if k:
                    joined.join((k - 1, chain[k - 1].parameter(i, name)), place)
                elif value is not None:
                    joined.join(place, place)
                    given[place] = value
        groups = joined.groups()
        fixed = {group: given[place] for group in groups for place in group if place in given}
        return groups, fixed

    def _common(self, old: Built, new: Built) -> Iterator[tuple[int, int, str, Fraction | None]]:
        """The parameters that kept modules retain: indices of modules, the name, the old value."""
        way = changes(old, new, self.prices, self.free)
        for i, j in way.kept:
            for name, ranges in old[i].values.items():
                free = (old[i].name, name) in self.free and not self.prices.change
                if name not in new[j].values or free or (i, j, name) in way.changed:
                    continue
                value = (
                    ranges[0].low if len(ranges) == 1 and ranges[0].low == ranges[0].high else None
                )
                yield i, j, name, value


class _Joined:
    """Disjoint sets of places, joined pair by pair."""

    def __init__(self) -> None:
        self._of: dict[Place, set[Place]] = {}

    def join(self, one: Place, other: Place) -> None:
        """Join the sets of two places."""
        both = self._of.get(one, {one}) | self._of.get(other, {other})
        for place in both:
            self._of[place] = both

    def groups(self) -> list[Group]:
        """The sets, in order of their places."""
        return sorted({tuple(sorted(each)) for each in self._of.values()})

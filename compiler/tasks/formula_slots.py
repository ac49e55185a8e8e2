"""Necessary conditions of temporal formulas in continuous time, as clauses.

The time [0, T] is cut at the multiples of a step g that divides T and every time in the formulas.
For every subformula the clauses say in which slots (:mod:`compiler.tasks.region_slots`) it holds.
They hold for every motion, so unsatisfiable clauses refute a task. They are not sufficient
conditions, as the order of events inside an interval is lost. Compare the sampling of Fainekos &
Pappas, *Robustness of temporal logic specifications for continuous-time signals* (2009).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import reduce
from math import gcd, lcm

from compiler.tasks.region_slots import TRUE, Node, RegionSlots, Row


def common_step(times: Iterable[Fraction]) -> Fraction:
    """The greatest number of which all the (positive) times are multiples."""

    def divisor(a: Fraction, b: Fraction) -> Fraction:
        scale = lcm(a.denominator, b.denominator)
        return Fraction(gcd(int(a * scale), int(b * scale)), scale)

    return reduce(divisor, times)


class Slots(RegionSlots):
    """Formulas about where effectors are; see :class:`RegionSlots` for the arguments."""

    def __init__(
        self, count: int, signatures: Sequence[int], effectors: Sequence[int], *, beyond: int = 0
    ) -> None:
        self._alternatives: dict[Node, frozenset[Node]] = {}
        self._unions: dict[tuple[Node, int, int], int] = {}
        super().__init__(count, signatures, effectors, beyond=beyond)

    # --- Boolean connectives -------------------------------------------------------------------

    def disjunction(self, nodes: Iterable[Node]) -> Node:
        """At least one holds."""
        masks: dict[int, int] = {}
        others: set[Node] = set()
        for node in self._flat(nodes):
            if node in self._masks:
                effector, mask = self._masks[node]
                masks[effector] = masks.get(effector, 0) | mask
            else:
                others.add(node)
        others |= {self._masked(effector, mask) for effector, mask in masks.items()}
        others.discard(-self.true)
        if self.true in others or any(-node in others for node in others):
            return self.true
        if len(others) < 2:
            return next(iter(others), -self.true)
        key = ("or", frozenset(others))
        if key not in self._known:
            node = self._node(key, self._or_row([self.row(node) for node in sorted(others)]))
            self._alternatives[node] = frozenset(others)
        return self._known[key]

    def _flat(self, nodes: Iterable[Node]) -> Iterator[Node]:
        for node in nodes:
            yield from self._alternatives.get(node, (node,))

    def conjunction(self, nodes: Iterable[Node]) -> Node:
        """All hold."""
        return -self.disjunction(-node for node in nodes)

    def _or_row(self, rows: Sequence[Row]) -> Row:
        some: list[int] = []
        every: list[int] = []
        for slot in range(self.last + 1):
            somewhere = self.variable()
            self._iff_any(somewhere, [row.some[slot] for row in rows])
            throughout = somewhere
            if self._is_interval(slot):
                throughout = self.variable()
                self._somewhere_each(throughout, rows, slot)
                self.clauses.append((-throughout, somewhere))
            some.append(somewhere)
            every.append(throughout)
        return Row(tuple(some), tuple(every))

    def _somewhere_each(self, throughout: int, rows: Sequence[Row], slot: int) -> None:
        """One part that holds throughout suffices; it is needed if all others hold nowhere."""
        rest_before: list[int] = [-TRUE]
        for row in rows[:-1]:
            rest_before.append(self._either(rest_before[-1], row.some[slot]))
        rest_after = -TRUE
        for row, before in zip(reversed(rows), reversed(rest_before), strict=True):
            self.clauses.append((-row.every[slot], throughout))
            self.clauses.append((-throughout, row.every[slot], before, rest_after))
            rest_after = self._either(rest_after, row.some[slot])

    def _either(self, a: int, b: int) -> int:
        if TRUE in (a, b) or a == -b:
            return TRUE
        if a == b or b == -TRUE:
            return a
        if a == -TRUE:
            return b
        variable = self.variable()
        self._iff_any(variable, (a, b))
        return variable

    # --- temporal operators --------------------------------------------------------------------

    def eventually(self, node: Node, lower: int, upper: int) -> Node:
        """Somewhere from ``lower`` to ``upper`` intervals later; there is nothing beyond the end.

        An ``upper`` of N or more means the end.
        """
        upper = min(upper, self.count)
        key = ("eventually", node, lower, upper)
        if lower > upper:
            return -self.true
        if key not in self._known:
            make = self._shifted if lower == upper else self._window
            return self._node(key, make(node, lower, upper))
        return self._known[key]

    def always(self, node: Node, lower: int, upper: int) -> Node:
        """Throughout a window."""
        return -self.eventually(-node, lower, upper)

    def _shifted(self, node: Node, lower: int, _upper: int) -> Row:
        row, none = self.row(node), (-TRUE,) * min(2 * lower, self.last + 1)
        return Row(row.some[2 * lower :] + none, row.every[2 * lower :] + none)

    def _window(self, node: Node, lower: int, upper: int) -> Row:
        row = self.row(node)
        some: list[int] = []
        every: list[int] = []
        for slot in range(self.last + 1):
            first, final = slot + 2 * lower, min(slot + 2 * upper, self.last)
            some.append(self._any(node, first, final))
            if slot % 2 == 0:
                every.append(some[-1])
                continue
            # Only what lies between its two ends is in the windows of all instants of a slot.
            throughout = self.variable()
            enough = [self._any(node, first + 1, min(slot + 2 * upper - 1, self.last))]
            enough += [row.every[end] for end in (first, slot + 2 * upper) if end < self.last]
            self.clauses += [(-literal, throughout) for literal in enough]
            self.clauses.append((-throughout, some[-1]))
            every.append(throughout)
        return Row(tuple(some), tuple(every))

    def _any(self, node: Node, first: int, final: int) -> int:
        """A literal that says that the node holds somewhere in the slots ``first`` to ``final``."""
        size = final - first + 1
        if size <= 0:
            return -TRUE
        level = size.bit_length() - 1
        return self._either(
            self._span(node, level, first), self._span(node, level, final - (1 << level) + 1)
        )

    def _span(self, node: Node, level: int, first: int) -> int:
        """As ``_any`` for ``2**level`` slots."""
        if level == 0:
            return self.row(node).some[first]
        key = (node, level, first)
        if key not in self._unions:
            half = 1 << (level - 1)
            low = self._span(node, level - 1, first)
            self._unions[key] = self._either(low, self._span(node, level - 1, first + half))
        return self._unions[key]

    def last_part(self, node: Node, duration: int) -> Node:
        """Throughout the last ``duration`` intervals, whatever the present instant."""
        key = ("last", node, duration)
        if key not in self._known:
            first = max(0, self.last - 2 * duration)
            literals = (-self._any(-node, first, self.last),) * (self.last + 1)
            return self._node(key, Row(literals, literals))
        return self._known[key]

    def until(self, left: Node, right: Node) -> Node:
        """``right`` at some instant from now on, and ``left`` at all instants before it."""
        if left not in self._masks or not self._is_closed(self._masks[left][1]):
            return self._until(left, right)
        # A motion does not leave a closed set before it meets something else: both hold then.
        both = self.conjunction((left, right))
        return self.disjunction((right, self._until(left, both)))

    def _until(self, left: Node, right: Node) -> Node:
        key = ("until", left, right)
        if key not in self._known:
            return self._node(key, self._until_row(self.row(left), self.row(right)))
        return self._known[key]

    def _until_row(self, left: Row, right: Row) -> Row:
        some = [0] * (self.last + 1)
        every = [0] * (self.last + 1)
        self._until_end(left, right, some, every)
        for slot in range(2 * self.count - 1, 0, -2):
            after = some[slot + 1]
            here, there = (left.some[slot], left.every[slot]), (right.some[slot], right.every[slot])
            goes_on = self._goes_on(here, there, after)
            some[slot], every[slot] = self._until_inside(here, there, after, goes_on)
            now = self._both(left.some[slot - 1], goes_on)
            some[slot - 1] = every[slot - 1] = self._either(right.some[slot - 1], now)
        return Row(tuple(some), tuple(every))

    def _until_end(self, left: Row, right: Row, some: list[int], every: list[int]) -> None:
        """Fill in the instant N g, and the slots after it."""
        some[self.last] = every[self.last] = right.some[self.last]

    def _both(self, a: int, b: int) -> int:
        return -self._either(-a, -b)

    def _goes_on(self, left: tuple[int, int], right: tuple[int, int], after: int) -> int:
        """From the start of an interval ``left`` holds until ``right``, inside it or after it."""
        variable = self.variable()
        self.clauses += [
            (-variable, left[0]),
            (-variable, right[0], left[1]),
            (-variable, right[0], after),
            (variable, -left[1], -right[0]),
            (variable, -left[1], -after),
        ]
        return variable

    def _until_inside(
        self, left: tuple[int, int], right: tuple[int, int], after: int, goes_on: int
    ) -> tuple[int, int]:
        """The literals for an until somewhere in an interval, and throughout it."""
        somewhere, throughout = self.variable(), self.variable()
        self.clauses += [
            (-somewhere, right[0], left[0]),
            (-somewhere, right[0], after),
            (somewhere, -right[0]),
            (somewhere, -goes_on),
            (-throughout, somewhere),
            (-throughout, right[0], left[1]),
            (-throughout, right[0], after),
            (-throughout, left[0], right[1]),
            (throughout, -right[1]),
            (throughout, -left[1], -after),
        ]
        return somewhere, throughout

"""Necessary conditions of temporal formulas in continuous time, as clauses.

The time [0, T] is cut at the multiples of a step g that divides T and every time in the formulas,
into instants and open intervals between them: the *slots*. For every subformula and slot two
variables say whether it holds *somewhere* in the slot and *throughout* it. The clauses hold for
every motion, so unsatisfiable clauses refute a task. They are not sufficient conditions, as the
order of events inside an interval is lost. Compare the sampling of Fainekos & Pappas, *Robustness
of temporal logic specifications for continuous-time signals* (2009).

For each effector and slot, certain signatures (:mod:`compiler.tasks.necessary_conditions`) occur in
a motion; regions are closed and motions continuous.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import gcd, lcm
from typing import TypeAlias

Clause: TypeAlias = tuple[int, ...]
Node: TypeAlias = int
"""A subformula, numbered from 1; a negative number is its negation."""

TRUE = 1
CLAUSE_LIMIT = 300_000


class TooManySlotsError(ValueError):
    """The formulas need more than ``CLAUSE_LIMIT`` clauses."""


def common_step(times: Iterable[Fraction]) -> Fraction:
    """The greatest number of which all the (positive) times are multiples."""

    def divisor(a: Fraction, b: Fraction) -> Fraction:
        scale = lcm(a.denominator, b.denominator)
        return Fraction(gcd(int(a * scale), int(b * scale)), scale)

    return reduce(divisor, times)


@dataclass(frozen=True, slots=True)
class Row:
    """For each slot the literals that a subformula holds somewhere, and throughout.

    Slot 2k is the instant ``k g``, where both are equal; slot 2k + 1 is the interval after it.
    """

    some: tuple[int, ...]
    every: tuple[int, ...]

    def negated(self) -> Row:
        """The row of the negation."""
        return Row(tuple(-x for x in self.every), tuple(-x for x in self.some))


class Slots:
    """Clauses over the variables 1, 2, …; variable 1 is true.

    Args:
        count: the number N of intervals.
        signatures: bit sets over the regions.
        effectors: the effectors that move, by any numbers.
        beyond: the number of slots after the instant N g; each is like an interval.
    """

    def __init__(
        self, count: int, signatures: Sequence[int], effectors: Sequence[int], *, beyond: int = 0
    ) -> None:
        self.count = count
        self.last = 2 * count + beyond
        self.clauses: list[Clause] = [(TRUE,)]
        self._variables = TRUE
        self._signatures = tuple(signatures)
        self._full = (1 << len(self._signatures)) - 1
        self._rows: dict[Node, Row] = {}
        self._alternatives: dict[Node, frozenset[Node]] = {}
        self._masks: dict[Node, tuple[int, int]] = {}
        self._known: dict[object, Node] = {}
        self._unions: dict[tuple[Node, int, int], int] = {}
        if len(effectors) * self.last * len(self._signatures) > CLAUSE_LIMIT:
            raise TooManySlotsError
        self._occurs = {effector: self._motion() for effector in effectors}
        same = (TRUE,) * (self.last + 1)
        self.true = self._node("true", Row(same, same))

    # --- variables and rows --------------------------------------------------------------------

    def variable(self) -> int:
        """A new variable."""
        self._variables += 1
        return self._variables

    def row(self, node: Node) -> Row:
        """The literals of a subformula."""
        return self._rows[node]

    def _is_interval(self, slot: int) -> bool:
        return slot % 2 == 1 or slot > 2 * self.count

    def _node(self, key: object, row: Row) -> Node:
        if len(self.clauses) > CLAUSE_LIMIT:
            raise TooManySlotsError
        node = len(self._rows) // 2 + 1
        self._rows[node], self._rows[-node] = row, row.negated()
        self._known[key] = node
        return node

    def _iff_any(self, variable: int, literals: Sequence[int]) -> None:
        self.clauses.append((-variable, *literals))
        self.clauses += [(variable, -literal) for literal in literals]

    def _motion(self) -> list[list[int]]:
        """For each slot and signature a variable that says that the signature occurs there."""
        occurs = [[self.variable() for _ in self._signatures] for _ in range(self.last + 1)]
        self.clauses += [tuple(there) for there in occurs]
        for slot in range(0, 2 * self.count + 1, 2):
            self._at_most_one(occurs[slot])
        return occurs

    def _at_most_one(self, literals: Sequence[int]) -> None:
        """At most one literal is true, by a sequential counter (Sinz 2005)."""
        before = literals[0]
        for literal in literals[1:]:
            self.clauses.append((-before, -literal))
            after = self.variable()
            self.clauses += [(-before, after), (-literal, after)]
            before = after

    # --- regions and subformulas made of them --------------------------------------------------

    def region(self, effector: int, number: int) -> Node:
        """An effector is in a region, given by its bit."""
        bits = enumerate(self._signatures)
        return self._masked(effector, sum(1 << k for k, bits in bits if bits >> number & 1))

    def _masked(self, effector: int, mask: int) -> Node:
        """An effector is at a point with one of some signatures (bit k stands for the k-th)."""
        if mask in (0, self._full):
            return self.true if mask else -self.true
        if mask & 1:
            return -self._masked(effector, self._full ^ mask)
        key = ("mask", effector, mask)
        if key not in self._known:
            node = self._node(key, self._mask_row(effector, mask))
            self._masks[node] = (effector, mask)
            self._masks[-node] = (effector, self._full ^ mask)
            for closed in (node, -node):
                if self._is_closed(self._masks[closed][1]):
                    self._close(self.row(closed))
        return self._known[key]

    def _mask_row(self, effector: int, mask: int) -> Row:
        some: list[int] = []
        every: list[int] = []
        for slot, occurs in enumerate(self._occurs[effector]):
            within = [x for k, x in enumerate(occurs) if mask >> k & 1]
            somewhere = self.variable()
            self._iff_any(somewhere, within)
            throughout = somewhere
            if self._is_interval(slot):
                throughout = self.variable()
                without = [x for k, x in enumerate(occurs) if not mask >> k & 1]
                self._iff_any(-throughout, without)
            some.append(somewhere)
            every.append(throughout)
        return Row(tuple(some), tuple(every))

    def _is_closed(self, mask: int) -> bool:
        """Whether the points with these signatures are a union of intersections of regions."""
        chosen = [bits for k, bits in enumerate(self._signatures) if mask >> k & 1]
        others = [bits for k, bits in enumerate(self._signatures) if not mask >> k & 1]
        return not any(one & other == one for one in chosen for other in others)

    def _close(self, row: Row) -> None:
        """A closed subformula that holds throughout an interval holds at its ends."""
        for slot in range(1, 2 * self.count, 2):
            for end in (slot - 1, slot + 1):
                self.clauses.append((-row.every[slot], row.some[end]))

    def free(self, key: object) -> Node:
        """A subformula about which nothing is known, the same for the same key."""
        if ("free", key) not in self._known:
            slots = range(self.last + 1)
            some = tuple(self.variable() for _ in slots)
            every = tuple(self.variable() if self._is_interval(k) else some[k] for k in slots)
            self.clauses += [(-every[k], some[k]) for k in slots if self._is_interval(k)]
            self._node(("free", key), Row(some, every))
        return self._known["free", key]

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

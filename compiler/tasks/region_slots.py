"""Where effectors are in the slots of a motion, as clauses.

The time of a motion is cut into instants and open intervals between them: the *slots*. For each
effector and slot, certain signatures (:mod:`compiler.tasks.region_signatures`) occur in a motion;
regions are closed and motions continuous. For a subformula and a slot two variables say whether it
holds *somewhere* in the slot and *throughout* it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from compiler.tasks.region_signatures import adjacency, components

Clause: TypeAlias = tuple[int, ...]
Node: TypeAlias = int
"""A subformula, numbered from 1; a negative number is its negation."""

TRUE = 1
CLAUSE_LIMIT = 300_000


class TooManySlotsError(ValueError):
    """The formulas need more than ``CLAUSE_LIMIT`` clauses."""


@dataclass(frozen=True, slots=True)
class Row:
    """For each slot the literals that a subformula holds somewhere, and throughout.

    Slot 2k is the k-th instant, where both are equal; slot 2k + 1 is the interval after it.
    """

    some: tuple[int, ...]
    every: tuple[int, ...]

    def negated(self) -> Row:
        """The row of the negation."""
        return Row(tuple(-x for x in self.every), tuple(-x for x in self.some))


class RegionSlots:
    """Clauses over the variables 1, 2, …; variable 1 is true.

    Args:
        count: the number N of intervals.
        signatures: bit sets over the regions.
        effectors: the effectors that move, by any numbers.
        beyond: the number of slots after the N-th instant; each is like an interval.
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
        self._near = adjacency(self._signatures)
        self._rows: dict[Node, Row] = {}
        self._masks: dict[Node, tuple[int, int]] = {}
        self._connected: set[Node] = set()
        self._known: dict[object, Node] = {}
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
        node = self._points(effector, mask)
        if node in self._masks and abs(node) not in self._connected:
            self._connected.add(abs(node))
            for each in (node, -node):
                self._connect(each)
        return node

    def _points(self, effector: int, mask: int) -> Node:
        """The same, without what follows where these points are not connected."""
        if mask in (0, self._full):
            return self.true if mask else -self.true
        if mask & 1:
            return -self._points(effector, self._full ^ mask)
        key = ("mask", effector, mask)
        if key not in self._known:
            node = self._node(key, self._mask_row(effector, mask))
            self._masks[node] = (effector, mask)
            self._masks[-node] = (effector, self._full ^ mask)
            for closed in (node, -node):
                if self._is_closed(self._masks[closed][1]):
                    self._close(self.row(closed))
        return self._known[key]

    def _connect(self, node: Node) -> None:
        """During an interval a motion that stays within some points stays in a component."""
        effector, mask = self._masks[node]
        parts = components(mask, self._near)
        if len(parts) == 1:
            return
        within = self.row(node).every
        for part in parts:
            row = self.row(self._points(effector, part))
            for slot in range(self.last + 1):
                if self._is_interval(slot):
                    self.clauses.append((-within[slot], -row.some[slot], row.every[slot]))

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

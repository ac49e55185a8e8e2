"""Necessary conditions of temporal formulas on motions that go on for ever, as clauses.

The time [0, N g] is cut into slots as in :mod:`compiler.tasks.formula_slots`. Two more slots
follow. In both, as in an interval, a subformula may hold somewhere or throughout:

- the *tail*, all instants after N g;
- *late*: a subformula holds somewhere in it if it holds at arbitrarily late instants
  (``always eventually``), and throughout it if it holds from some instant on
  (``eventually always``).

The clauses hold for every continuous motion on [0, oo), whatever repeats in it and when. These
include motions that are a prefix and a loop, and motions whose rounds differ.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.tasks.formula_slots import Slots
from compiler.tasks.region_slots import TRUE, Node, Row

COMPARED = 4
"""Each window is compared with at most this many other, latest windows of the same subformula."""


class EndlessSlots(Slots):
    """Clauses about motions on [0, oo); the last two slots are the tail and late.

    Args:
        count: the number N of intervals before the tail, more than any finite time of a window has.
        signatures: bit sets over the regions.
        effectors: the effectors that move, by any numbers.
    """

    def __init__(self, count: int, signatures: Sequence[int], effectors: Sequence[int]) -> None:
        self._windows: dict[Node, list[tuple[int, int, Node]]] = {}
        super().__init__(count, signatures, effectors, beyond=2)

    @property
    def _end(self) -> int:
        """The slot of the instant N g, after which the tail begins."""
        return 2 * self.count

    @property
    def _tail(self) -> int:
        return self._end + 1

    @property
    def _late(self) -> int:
        return self._end + 2

    def _motion(self) -> list[list[int]]:
        occurs = super()._motion()
        # Anything that occurs again and again occurs in the tail.
        pairs = zip(occurs[self._late], occurs[self._tail], strict=True)
        self.clauses += [(-late, tail) for late, tail in pairs]
        return occurs

    def _node(self, key: object, row: Row) -> Node:
        for each in (row, row.negated()):
            self.clauses.append((-each.every[self._tail], each.every[self._late]))
        return super()._node(key, row)

    def _close(self, row: Row) -> None:
        super()._close(row)
        self.clauses.append((-row.every[self._tail], row.some[self._end]))

    # --- windows -------------------------------------------------------------------------------

    def eventually(self, node: Node, lower: int, upper: int) -> Node:
        """Somewhere from ``lower`` to ``upper`` intervals later; more than N means at any time."""
        if lower > upper:
            return -self.true
        if lower == upper == 0:
            return node
        upper = min(upper, self.count + 1)
        key = ("eventually", node, lower, upper)
        if key not in self._known:
            if lower == upper:
                self._node(key, self._shifted(node, lower, upper))
            elif upper > self.count:
                self._node(key, self._at_any_time(node, lower))
            else:
                self._node(key, self._window(node, lower, upper))
            self._compare(node, lower, upper)
        return self._known[key]

    def last_part(self, node: Node, duration: int) -> Node:
        """There is no last part.

        Raises:
            ValueError: always.
        """
        raise ValueError("a motion that goes on for ever has no last part")

    def _compare(self, node: Node, lower: int, upper: int) -> None:
        """What holds within a window holds within any window that contains it, also beyond N g."""
        new = lower, upper, self._known["eventually", node, lower, upper]
        known = self._windows.setdefault(node, [])
        for other in known[-COMPARED:]:
            for inner, outer in ((new, other), (other, new)):
                if outer[0] <= inner[0] and inner[1] <= outer[1]:
                    one, two = self.row(inner[2]), self.row(outer[2])
                    for slot in range(max(0, self._tail - 2 * outer[1]), self.last + 1):
                        self.clauses.append((-one.some[slot], two.some[slot]))
                        self.clauses.append((-one.every[slot], two.every[slot]))
        known.append(new)

    def _shifted(self, node: Node, lower: int, upper: int) -> Row:
        row, kept = self.row(node), self._end + 1 - 2 * lower
        some, every = (
            list(row.some[2 * lower : self._tail]),
            list(row.every[2 * lower : self._tail]),
        )
        for slot in range(kept, self._tail):
            somewhere, throughout = self._part_of_tail(row, instant=slot % 2 == 0)
            some.append(somewhere)
            every.append(throughout)
        somewhere, throughout = self._part_of_tail(row, instant=False)
        some += [somewhere, row.some[self._late]]
        every += [throughout, row.every[self._late]]
        return Row(tuple(some), tuple(every))

    def _part_of_tail(self, row: Row, *, instant: bool) -> tuple[int, int]:
        """The literals that something holds somewhere, and throughout, a part of the tail."""
        somewhere = self.variable()
        throughout = somewhere if instant else self.variable()
        self.clauses += [
            (-somewhere, row.some[self._tail]),
            (-row.every[self._tail], throughout),
            (-throughout, somewhere),
        ]
        return somewhere, throughout

    def _window(self, node: Node, lower: int, upper: int) -> Row:
        row = self.row(node)
        some: list[int] = []
        every: list[int] = []
        for slot in range(self._tail):
            first, final = slot + 2 * lower, slot + 2 * upper
            inside = final <= self._end
            met = self._any(node, first, min(final, self._end))
            somewhere = met
            if not inside:
                somewhere = self.variable()
                self.clauses += [
                    (-somewhere, met, row.some[self._tail]),
                    (-met, somewhere),
                    (-row.every[self._tail], somewhere),
                ]
            some.append(somewhere)
            if slot % 2 == 0:
                every.append(somewhere)
                continue
            # Only what lies between its two ends is in the windows of all instants of a slot.
            enough = [self._any(node, first + 1, min(final - 1, self._end))]
            enough += [row.every[end] for end in (first, final) if end < self._end]
            enough += [] if inside else [row.every[self._tail]]
            every.append(self._throughout(somewhere, enough))
        tail, late = row.some[self._tail], row.some[self._late]
        if lower:
            tail = self.variable()
            self.clauses.append((-tail, row.some[self._tail]))
        some += [tail, late]
        every.append(self._throughout(tail, [row.every[self._tail]]))
        every.append(self._throughout(late, [row.every[self._late]]))
        return Row(tuple(some), tuple(every))

    def _throughout(self, somewhere: int, enough: Sequence[int]) -> int:
        """A variable for holding throughout a slot; each literal of ``enough`` suffices for it."""
        throughout = self.variable()
        self.clauses += [(-literal, throughout) for literal in enough]
        self.clauses.append((-throughout, somewhere))
        return throughout

    def _at_any_time(self, node: Node, lower: int) -> Row:
        """Somewhere ``lower`` intervals later, or after that."""
        row = self.row(node)
        again, ahead = row.some[self._late], row.some[self._tail]
        some: list[int] = []
        every: list[int] = []
        for slot in range(self._tail):
            first = slot + 2 * lower
            somewhere = self._either(self._any(node, first, self._end), ahead)
            if first > self._end:
                somewhere = self.variable()
                self.clauses += [
                    (-somewhere, ahead),
                    (-again, somewhere),
                    (-row.every[self._tail], somewhere),
                ]
            some.append(somewhere)
            if slot % 2 == 0:
                every.append(somewhere)
                continue
            enough = [again, row.every[self._tail]]
            if first < self._end:
                enough += [self._any(node, first + 1, self._end), row.every[first], ahead]
            every.append(self._throughout(somewhere, enough))
        if lower:
            ahead = self.variable()
            self.clauses += [(-ahead, row.some[self._tail]), (-again, ahead)]
        return Row((*some, ahead, again), (*every, again, again))

    # --- until ---------------------------------------------------------------------------------

    def _until_end(self, left: Row, right: Row, some: list[int], every: list[int]) -> None:
        for slot in (self._late, self._tail):
            some[slot] = right.some[slot]
            throughout = self._throughout(some[slot], [right.every[slot]])
            again = right.some[self._late]
            self.clauses += [
                (-throughout, again),
                (-throughout, left.some[slot], right.every[slot]),
                (-left.every[slot], -again, throughout),
            ]
            every[slot] = throughout
        here = left.some[self._tail], left.every[self._tail]
        there = right.some[self._tail], right.every[self._tail]
        now = self._both(left.some[self._end], self._goes_on(here, there, -TRUE))
        some[self._end] = every[self._end] = self._either(right.some[self._end], now)

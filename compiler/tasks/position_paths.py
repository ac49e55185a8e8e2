"""Paths of one effector as clauses, one Boolean per (cell, position); a position is a change.

Source: Biere, Cimatti, Clarke & Zhu, *Symbolic model checking without BDDs* (1999), unrolled to m
changes. A cell can be at position j only if it is within j changes of the start and within m - j of
an end. So its positions range from its distance to m minus its distance to an end, and each bound m
adds one position per cell. Whatever a clause leaves out because of the present bound is represented
by the literal ``more``: assumed false under that bound, and true ever after.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.formula_clauses import TRUE, Clauses, Ints
from compiler.tasks.places import NOWHERE, UNREACHABLE, Edges, Places


class PositionPaths:
    """Paths c_0 .. c_m, for one bound m after another.

    Args:
        clauses: the clauses to which new ones are added.
        edges: the graph.
        from_start: distances from the start, shape (n,), ``UNREACHABLE`` if there is no path.
        to_end: distances to the end, in the same form; 0 where a path may end.
        who: the name of the effector.
        cell_name: gives the name of a cell.
        simple: whether no cell may occur twice.
    """

    def __init__(
        self,
        clauses: Clauses,
        edges: Edges,
        from_start: Ints,
        to_end: Ints,
        *,
        who: str,
        cell_name: Callable[[int], str],
        simple: bool,
    ) -> None:
        through = from_start + to_end
        self._clauses = clauses
        self._edges = edges
        self._from_start = from_start
        self._to_end = to_end
        self._who = who
        self._cell_name = cell_name
        self._through = through
        order = np.argsort(through, kind="stable")
        self._order = order[through[order] < UNREACHABLE]
        self._rank = np.empty(len(through), dtype=np.int64)
        self._rank[order] = np.arange(len(through))
        self.shortest = int(through[self._order[0]]) if len(self._order) else None
        self._bases: list[int] = []
        self._in_layer = Ladders(clauses, "the cells at position")
        self._of_cell = Ladders(clauses, "the positions of cell") if simple else None
        self._exists: dict[int, int] = {}
        self.places = NOWHERE
        self.more = TRUE
        near = from_start < UNREACHABLE
        usable = near[edges.tails] & near[edges.heads]
        self._farthest = np.full(edges.count, -1, dtype=np.int64)
        np.maximum.at(self._farthest, edges.tails[usable], to_end[edges.heads[usable]])

    @property
    def bound(self) -> int:
        """The number of changes laid out; at first, one less than the shortest path has."""
        return -1 if self.shortest is None else self.shortest + len(self._bases) - 1

    def exists(self, position: int) -> int:
        """The literal that the path has a position."""
        if self.shortest is None or position <= self.shortest:
            return TRUE
        for missing in range(self.shortest + len(self._exists) + 1, position + 1):
            literal = self._clauses.one(f"{self._who} has a position {missing}")
            self._exists[missing] = literal
            self._clauses.clause([-literal, self._exists.get(missing - 1, TRUE)])
        return self._exists[position]

    def variable(self, cell: int, position: int) -> int:
        """The variable of a cell at a position, 0 if the cell cannot be there yet."""
        return int(self.variables_at(np.array([cell]), np.array([position]))[0])

    def variables_at(self, cells: Ints, positions: Ints) -> Ints:
        """As ``variable``, for arrays of one shape (n,)."""
        if self.shortest is None:
            return np.zeros(len(cells), dtype=np.int64)
        made = positions + np.minimum(self._to_end[cells], UNREACHABLE) - self.shortest
        there = (made >= 0) & (made < len(self._bases))
        there &= self._through[cells] <= made + self.shortest
        bases = np.array([*self._bases, 0], dtype=np.int64)[np.where(there, made, -1)]
        return np.where(there, bases + self._rank[cells], 0)

    def beginning(self, cells: Sequence[int]) -> Ints:
        """The variables (n,) of a path that begins with n cells, 0 where there is none yet."""
        return self.variables_at(np.array(cells), np.arange(len(cells)))

    def extend(self) -> Places:
        """Lay out one more change; return the new variables.

        Raises:
            ValueError: there is no path of any length.
        """
        clauses = self._clauses
        if self.shortest is None:
            raise ValueError("there is no path of any length")
        clauses.clause([self.more])
        bound = self.bound + 1
        self.more = clauses.one(f"{self._who} has more than {bound} changes")
        count = int(np.searchsorted(self._through[self._order], bound, side="right"))
        cells = self._order[:count]
        positions = bound - self._to_end[cells]
        variables = clauses.fresh(count, lambda i: self._name(cells[i], positions[i]))
        self._bases.append(int(variables[0]))
        new = Places(cells, positions, variables)
        self._in_layer.extend(positions, variables)
        if self._of_cell is not None:
            self._of_cell.extend(cells, variables)
        self._begin()
        for age in range(3):
            self._go_on(bound, age)
        self._come_from(new)
        self.places = self.places.with_more(new)
        return new

    def decode(self, true: NDArray[np.bool_]) -> tuple[int, ...]:
        """The path of a model: whether variable v holds, ``true[v]``, shape (variables + 1,)."""
        at = self.places
        last = max((p for p, v in self._exists.items() if true[v]), default=self.shortest or 0)
        chosen = true[at.variables] & (at.layers <= last)
        order = np.argsort(at.layers[chosen])
        return tuple(at.cells[chosen][order].tolist())

    def ends(self, places: Places) -> None:
        """Let paths be no longer than their positions, and end only where they may."""
        if self.shortest is None:
            return
        at = places.layers
        for chosen, further in ((at > self.shortest, 0), (self._goes_on(places), 1)):
            literals = [self.exists(position + further) for position in at[chosen].tolist()]
            own = -places.variables[chosen]
            self._clauses.add(np.column_stack([own, np.array(literals, dtype=np.int64)]))

    def _goes_on(self, places: Places) -> NDArray[np.bool_]:
        """The places, from where on paths may end, that are not an end."""
        return (self._to_end[places.cells] > 0) & (places.layers >= (self.shortest or 0))

    def _name(self, cell: int, position: int) -> str:
        return f"{self._who} in {self._cell_name(int(cell))} at position {position}"

    def _begin(self) -> None:
        """The path begins in a cell of the start."""
        starts = np.flatnonzero((self._from_start == 0) & (self._through < UNREACHABLE))
        literals = self.variables_at(starts, np.zeros(len(starts), dtype=np.int64))
        if not (literals == 0).any() and self._to_end[starts].max() != self.bound:
            return
        known = literals[literals > 0].tolist()
        self._clauses.clause([*known, *([self.more] if len(known) < len(starts) else [])])

    def _go_on(self, bound: int, age: int) -> None:
        """If a variable made ``age`` bounds ago holds, a neighbour holds at the next position.

        The neighbours present are those whose distance to the end is below the cell's own plus
        ``age``. The clause of an age replaces the previous one, if that was incomplete.
        """
        if age >= len(self._bases):
            return
        then = bound - age
        count = int(np.searchsorted(self._through[self._order], then, side="right"))
        cells = self._order[:count]
        beyond = self._farthest[cells] - self._to_end[cells]
        positions = then - self._to_end[cells]
        # At age 0 a cell of the end is at the last position, and nothing follows.
        due = (beyond >= age - 1) if age else (positions < bound)
        if age == 1:
            due |= positions == then
        cells, positions, beyond = cells[due], positions[due], beyond[due]
        owners, heads = self._edges.of(cells)
        following = self.variables_at(heads, positions[owners] + 1)
        kept = following > 0
        start = [-self.variables_at(cells, positions), *self._guards(positions + 1, beyond >= age)]
        self._emit(start, owners[kept], following[kept])

    def _guards(self, positions: Ints, incomplete: NDArray[np.bool_]) -> list[Ints]:
        """The literals that excuse from going on: no such position, or not laid out yet."""
        numbers, which = np.unique(positions, return_inverse=True)
        literals = np.array([-self.exists(n) for n in numbers.tolist()], dtype=np.int64)
        return [literals[which], np.where(incomplete, self.more, -TRUE)]

    def _emit(self, heads: list[Ints], owners: Ints, bodies: Ints) -> None:
        """Add clauses of a variable, its excuses and bodies; false excuses are left out."""
        own, ending, more = heads
        ends, mores = ending != -TRUE, more != -TRUE
        for has_end in (False, True):
            for has_more in (False, True):
                rows = np.flatnonzero((ends == has_end) & (mores == has_more))
                if not len(rows):
                    continue
                columns = [own[rows]]
                columns += [ending[rows]] if has_end else []
                columns += [more[rows]] if has_more else []
                place = np.full(len(own), -1, dtype=np.int64)
                place[rows] = np.arange(len(rows))
                mine = place[owners] >= 0
                self._clauses.implications(
                    np.column_stack(columns), place[owners[mine]], bodies[mine]
                )

    def _come_from(self, new: Places) -> None:
        """A cell after the first position has a neighbour at the position before."""
        later = new.layers > 0
        cells, positions = new.cells[later], new.layers[later]
        owners, heads = self._edges.of(cells)
        before = self.variables_at(heads, positions[owners] - 1)
        kept = before > 0
        head = -new.variables[later][:, None]
        self._clauses.implications(head, owners[kept], before[kept])


# --- At most one literal of each group, where groups grow -----------------------------------------
#
# Source: the ladder encoding (Gent & Nightingale, *A new encoding of alldifferent into SAT*, 2004):
# for each member a literal says that it or one before it holds.


class Ladders:
    """Groups 0, 1, ... of literals, empty at first."""

    def __init__(self, clauses: Clauses, what: str) -> None:
        self._clauses = clauses
        self._what = what
        self._top = np.zeros(0, dtype=np.int64)

    def extend(self, groups: Ints, literals: Ints) -> None:
        """Add literals to their groups, both of shape (n,)."""
        if not len(groups):
            return
        order = np.argsort(groups, kind="stable")
        groups, literals = groups[order], literals[order]
        missing = int(groups[-1]) + 1 - len(self._top)
        self._top = np.pad(self._top, (0, max(0, missing)))
        first = np.ones(len(groups), dtype=bool)
        first[1:] = groups[1:] != groups[:-1]
        before = self._top[groups]
        # For the first member of a group the literal itself is the first rung.
        rungs = literals.copy()
        further = ~(first & (before == 0))
        names = groups[further]
        rungs[further] = self._clauses.fresh(
            len(names), lambda i: f"one of {self._what} {names[i]} so far"
        )
        before = np.where(first, before, np.roll(rungs, 1))
        own, rung, lower = literals[further], rungs[further], before[further]
        self._clauses.add(np.column_stack([-own, rung]))
        self._clauses.add(np.column_stack([-lower, rung]))
        self._clauses.add(np.column_stack([-own, -lower]))
        last = np.roll(first, -1)
        self._top[groups[last]] = rungs[last]

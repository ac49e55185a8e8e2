"""A planning problem as clauses, untimed and timed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.cell_sequences import CellSequences
from compiler.tasks.effector_distances import EffectorDistances
from compiler.tasks.formula_clauses import TRUE, Clauses, FormulaClauses, Ints, Layers
from compiler.tasks.places import UNREACHABLE, Places, RegionLinks, Word
from compiler.tasks.position_paths import PositionPaths
from compiler.tasks.sampled_formula import Literal
from compiler.tasks.specification import PlanningProblem

# --- When the positions of a path are entered: an order encoding ----------------------------------
#
# Source: Tamura, Taga, Kitagawa & Banbara, *Compiling finite linear CSP into SAT* (2009), which
# represents an integer by comparisons with it.


class EntrySamples:
    """Position p is entered at a sample up to ``latest``, after position p - 1; position 0 at 0."""

    def __init__(
        self,
        clauses: Clauses,
        paths: PositionPaths,
        steps: int,
        who: str,
        latest: int | None = None,
    ) -> None:
        self._clauses = clauses
        self._paths = paths
        self._steps = steps
        self._who = who
        self._latest = steps if latest is None else latest
        self._rows = [np.full(steps + 1, TRUE, dtype=np.int64)]

    def row(self, position: int) -> Ints:
        """For each sample the literal that the position is entered by then; shape (steps + 1,)."""
        while len(self._rows) <= position:
            self._add_row(len(self._rows))
        return self._rows[position]

    def entries(self, count: int, true: NDArray[np.bool_]) -> tuple[int, ...]:
        """The samples at which a model enters the first ``count`` positions.

        ``true`` is the model, shape (variables + 1,): whether variable v holds, at index v.
        """
        return tuple(int(np.argmax((row > 0) & true[np.abs(row)])) for row in self._rows[:count])

    def literals(self, entries: Sequence[int]) -> list[int]:
        """Literals that are all true only if the positions are entered at exactly these samples."""
        found = []
        for position, sample in enumerate(entries):
            row = self.row(position)
            found.append(int(row[sample]))
            found += [-int(row[sample - 1])] if sample else []
        return found

    def _add_row(self, position: int) -> None:
        """Add a row: ``row[j]`` implies ``row[j + 1]``, and ``row[j - 1]`` of the previous one."""
        first, exists = min(position, self._steps + 1), self._paths.exists(position)
        row = np.full(self._steps + 1, -TRUE, dtype=np.int64)
        row[first:] = self._clauses.fresh(
            self._steps + 1 - first,
            lambda i: f"{self._who} is at position {position} by sample {first + i}",
        )
        own = row[first:]
        self._clauses.add(np.column_stack([-own[:-1], own[1:]]))
        if position > 1:
            before = self._rows[-1][first - 1 : self._steps]
            self._clauses.add(np.column_stack([-own, before]))
        literal = int(row[self._latest])
        self._clauses.clause([-exists, literal])
        self._clauses.clause([exists, -int(row[-1])])
        self._rows.append(row)


# --- Literals of a formula at samples, by the position that an effector is at ---------------------


class TimedRegions:
    """Variables that imply literals at samples.

    Args:
        clauses: the clauses to which new ones are added.
        propositions: the regions that each cell lies in.
        entries: for each effector (from 1) when it enters its positions.
        steps: the last sample, and the last position.
    """

    def __init__(
        self,
        clauses: Clauses,
        propositions: Sequence[frozenset[str]],
        entries: Mapping[int, EntrySamples],
        steps: int,
    ) -> None:
        self._clauses = clauses
        self._entries = entries
        self._steps = steps
        self._links = RegionLinks(clauses, propositions, steps)
        self._asked: dict[Literal, Ints] = {}
        self._positions = dict.fromkeys(entries, -1)

    def ask(self, literal: Literal, layer: int, variable: int) -> None:
        """Make the variable imply the literal at that sample; call before linking any place."""
        if literal not in self._asked:
            self._asked[literal] = np.zeros(self._steps + 1, dtype=np.int64)
        self._asked[literal][layer] = variable

    def link(self, effector: int, new: Places, last: int) -> None:
        """Link new places of an effector (from 1), whose positions are laid out up to ``last``."""
        for position in range(self._positions[effector] + 1, min(last, self._steps) + 1):
            self._positions[effector] = position
            for literal, variables in self._asked.items():
                if literal.effector == effector:
                    self._at_position(literal, variables, position)
        self._links.link(effector, new)

    def _at_position(self, literal: Literal, variables: Ints, position: int) -> None:
        """At each sample asked for: if the effector is at the position, the literal holds there."""
        sign = "" if literal.positive else "not "
        there = self._clauses.one(
            f"{sign}{literal.region} by effector {literal.effector} at position {position}"
        )
        self._links.ask(literal, position, there)
        entered = self._entries[literal.effector].row(position)
        left = self._entries[literal.effector].row(position + 1)
        due = (variables > 0) & (entered != -TRUE)
        for own, here, gone in zip(variables[due], entered[due], left[due], strict=True):
            self._clauses.clause([-int(own), -int(here), int(gone), there])


# --- The sum of the changes of several paths, counted in unary ------------------------------------
#
# Source: the totalizer (Bailleux & Boufkhad, *Efficient CNF encoding of Boolean cardinality
# constraints*, 2003); the numbers are already unary.


class TotalChanges:
    """Bounds a sum: if ``above(b)`` is assumed false, the paths have at most b changes together."""

    def __init__(self, clauses: Clauses, paths: Sequence[PositionPaths]) -> None:
        self._clauses = clauses
        self._paths = paths
        self._known: dict[tuple[int, int], int] = {}

    def above(self, bound: int) -> int:
        """A literal that holds if the paths have more than ``bound`` changes."""
        return self._at_least(len(self._paths), bound + 1)

    def _at_least(self, count: int, number: int) -> int:
        """A literal that holds if the first paths together have that many changes."""
        if number <= 0:
            return TRUE
        if count == 1:
            return self._paths[0].exists(number)
        key = (count, number)
        if key not in self._known:
            literal = self._clauses.one(f"{number} changes of {count} effectors")
            self._known[key] = literal
            for own in range(number + 1):
                others = self._at_least(count - 1, number - own)
                mine = self._paths[count - 1].exists(own)
                self._clauses.clause([-others, -mine, literal])
        return self._known[key]


# --- An untimed problem with one effector as clauses, extended by one change of cell at a time ----


class PositionEncoding:
    """Paths c_0 .. c_m of one effector; without a formula no cell occurs twice.

    Attributes:
        clauses: the clauses to solve, under ``assumptions``.
        least: a lower bound on the changes of a plan; None if there is no plan at all.
        limit: the largest number of changes.
        complete: whether the limit excludes no plan.
    """

    def __init__(self, problem: PlanningProblem) -> None:
        (planned,) = problem.effectors
        self.clauses = Clauses()
        distance = EffectorDistances(problem, planned)
        simple = problem.formula is None
        self._paths = PositionPaths(
            self.clauses,
            distance.edges,
            distance.from_start,
            distance.to_end,
            who=f"effector {planned.effector + 1}",
            cell_name=problem.name,
            simple=simple,
        )
        self.shortest = (distance.shortest,)
        self.least = distance.least
        usable = int((distance.from_start + distance.to_end < UNREACHABLE).sum())
        self.complete = simple and usable - 1 <= problem.changes
        self.limit = min(problem.changes, usable - 1) if simple else problem.changes
        self._effector = planned.effector
        self._formula: FormulaClauses | None = None
        if problem.formula is not None and self.least is not None:
            layers = Layers(self.limit, self._paths.exists, open_end=True)
            self._regions = RegionLinks(self.clauses, problem.propositions, self.limit)
            self._formula = FormulaClauses(self.clauses, problem.formula, layers, self._regions)
        self._forbidden = CellSequences(self.clauses, f"effector {planned.effector + 1}")

    def extend(self, bound: int) -> None:
        """Lay out paths of ``bound`` changes; those with fewer are no longer searched."""
        self._lay_out(bound)
        self.clauses.clause([self._paths.exists(bound)])

    def _lay_out(self, bound: int) -> None:
        while self._paths.bound < bound:
            new = self._paths.extend()
            self._forbidden.extend(new)
            if self._formula is not None:
                self._formula.lay_out(self._paths.bound)
                self._regions.link(self._effector + 1, new)

    def assumptions(self, bound: int, *, distinct: bool) -> list[int]:
        """The literals of a bound that is laid out; they exclude everything beyond it."""
        return [-self._paths.more, -self._paths.exists(bound + 1)]

    def decode(self, true: NDArray[np.bool_]) -> tuple[Word, ...]:
        """The path of a model, given as ``true[v]`` for each variable v, shape (variables + 1,)."""
        return (Word(self._effector, self._paths.decode(true), None),)

    def exclude(self, words: Sequence[Word]) -> None:
        """Exclude this path; longer paths may begin with it."""
        (word,) = words
        own = self._paths.beginning(word.cells)
        self.clauses.clause([*(-own).tolist(), self._paths.exists(len(own))])

    def block(self, effector: int, cells: Sequence[int], *, ordered: bool) -> None:
        """Exclude paths that visit these cells; ``ordered``: that visit them in order."""
        self._forbidden.forbid(cells, self._paths.places, ordered=ordered)

    def close(self) -> None:
        """Make the clauses those of all plans within the limit, without assumptions."""
        if self.least is None or self.least > self.limit:
            self.clauses.clause([])
            return
        self._lay_out(self.limit)
        self._paths.ends(self._paths.places)
        for literal in self.assumptions(self.limit, distinct=False):
            self.clauses.clause([literal])


# --------------------------------------------------------------------------------------------------
# A timed problem, or one with several effectors, as clauses: paths, and when they are entered.
#
# With one layer of cells per sample, changes would need a counter that knows nothing of distances.
# Here, as in untimed problems, cells are indexed by position, and samples are entry times.


class SampleEncoding:
    """Cell traces of all planned effectors; the sum of their changes is bounded.

    Attributes:
        clauses: the clauses to solve, under ``assumptions``.
        shortest: for each effector the fewest changes from its start to its end, None if no path.
        least: a lower bound on the changes of a plan; None if there is no plan at all.
        limit: the largest number of changes.
        complete: whether the limit excludes no plan.
    """

    def __init__(self, problem: PlanningProblem) -> None:
        self.clauses = Clauses()
        steps = problem.steps
        self._steps = steps
        found = [EffectorDistances(problem, planned) for planned in problem.effectors]
        self.shortest = tuple(distance.shortest for distance in found)
        leasts = [one.least for one in found if one.least is not None and one.least <= steps]
        self.least = sum(leasts) if len(leasts) == len(found) else None
        self._leasts = leasts
        most = steps * len(found)
        self.limit = min(problem.changes, most)
        self.complete = problem.changes >= most
        self._numbers = [planned.effector for planned in problem.effectors]
        self._paths = [
            PositionPaths(
                self.clauses,
                distance.edges,
                distance.from_start,
                distance.to_end,
                who=f"effector {planned.effector + 1}",
                cell_name=problem.name,
                simple=False,
            )
            for planned, distance in zip(problem.effectors, found, strict=True)
        ]
        self._entries = [
            EntrySamples(self.clauses, paths, steps, f"effector {number + 1}", problem.settled)
            for paths, number in zip(self._paths, self._numbers, strict=True)
        ]
        self._total = TotalChanges(self.clauses, self._paths)
        self._distinct = self.clauses.one("no sequence of cells comes again")
        by_number = {
            n + 1: entries for n, entries in zip(self._numbers, self._entries, strict=True)
        }
        self._regions = TimedRegions(self.clauses, problem.propositions, by_number, steps)
        if problem.formula is not None and self.least is not None:
            layers = Layers(steps, lambda _: TRUE, open_end=False)
            FormulaClauses(self.clauses, problem.formula, layers, self._regions).lay_out(steps)
        self._forbidden = [
            CellSequences(self.clauses, f"effector {number + 1}") for number in self._numbers
        ]

    def extend(self, bound: int) -> None:
        """Lay out paths of up to ``bound`` changes in total."""
        for index, paths in enumerate(self._paths):
            while paths.bound < self._own(index, bound):
                new = paths.extend()
                paths.ends(new)
                self._entries[index].row(paths.bound + 1)
                self._regions.link(self._numbers[index] + 1, new, paths.bound)
                self._forbidden[index].extend(new)

    def _own(self, index: int, bound: int) -> int:
        """The most changes of one path, given the least changes of the others."""
        return min(bound - sum(self._leasts) + self._leasts[index], self._steps)

    def assumptions(self, bound: int, *, distinct: bool) -> list[int]:
        """The literals of a bound that is laid out; negative ones exclude anything beyond it."""
        found = [-paths.more for paths in self._paths]
        found += [
            -paths.exists(self._own(index, bound) + 1) for index, paths in enumerate(self._paths)
        ]
        if len(self._paths) > 1:
            found.append(-self._total.above(bound))
        else:
            found.append(self._paths[0].exists(bound))
        return [*found, self._distinct] if distinct else found

    def decode(self, true: NDArray[np.bool_]) -> tuple[Word, ...]:
        """The words of a model, given as ``true[v]`` for each variable, shape (variables + 1,)."""
        found = []
        for number, paths, entries in zip(self._numbers, self._paths, self._entries, strict=True):
            cells = paths.decode(true)
            found.append(Word(number, cells, entries.entries(len(cells), true)))
        return tuple(found)

    def exclude(self, words: Sequence[Word]) -> None:
        """Exclude these words and, while sequences must be distinct, these sequences of cells."""
        others: list[int] = []
        exact: list[int] = []
        for word, paths, entries in zip(words, self._paths, self._entries, strict=True):
            others += (-paths.beginning(word.cells)).tolist()
            others.append(paths.exists(len(word.cells)))
            exact += [-literal for literal in entries.literals(word.entries or ())]
        self.clauses.clause([*others, -self._distinct])
        self.clauses.clause([*others, *exact])

    def block(self, effector: int, cells: Sequence[int], *, ordered: bool) -> None:
        """Exclude words in which that effector visits these cells; ``ordered``: in order."""
        index = self._numbers.index(effector)
        self._forbidden[index].forbid(cells, self._paths[index].places, ordered=ordered)

    def close(self) -> None:
        """Make the clauses those of all plans within the limit, without assumptions."""
        if self.least is None or self.least > self.limit:
            self.clauses.clause([])
            return
        self.extend(self.limit)
        for literal in self.assumptions(self.limit, distinct=False):
            self.clauses.clause([literal] if literal < 0 else [TRUE])


# --- A planning problem as clauses ----------------------------------------------------------------


PlanEncoding: TypeAlias = PositionEncoding | SampleEncoding


def plan_encoding(problem: PlanningProblem) -> PlanEncoding:
    """The encoding by changes of cell if one effector's path is untimed, else by samples."""
    return SampleEncoding(problem) if problem.by_samples else PositionEncoding(problem)

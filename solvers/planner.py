"""P.Planning: paths through the cells, found by SAT in ascending order of changes of cell.

Source: Algorithm 1 and Section 4.2 (Problem 3).  A path is a sequence of cells, each adjacent to
the next; without a formula no cell occurs twice.  If a task is not timed, the control synthesis
decides when each cell is entered.  Paths that visit the cells of a counterexample are excluded.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from compiler.tasks.plan_encoding import plan_encoding
from compiler.tasks.specification import PlanningProblem
from compiler.time_limits.time_limit import check_time
from solvers.backends.cadical import SatSolver
from solvers.verdict import Answer, Fails, Holds, Unknown

CONFLICTS = 200_000
SOLVED = "a SAT problem was solved"


@dataclass(frozen=True, slots=True)
class EffectorPath:
    """The cells of one effector (numbered from 0), in the order in which they are entered.

    Consecutive cells differ and are adjacent.  ``entries`` are the samples at which they are
    entered, the first 0; None if the task does not depend on them.
    """

    effector: int
    cells: tuple[int, ...]
    entries: tuple[int, ...] | None


@dataclass(frozen=True, slots=True)
class Plan:
    """The paths of the planned effectors, in ascending order of effector number."""

    paths: tuple[EffectorPath, ...]

    @property
    def changes(self) -> int:
        """The number of changes of cell, summed over all effectors."""
        return sum(len(path.cells) - 1 for path in self.paths)


@dataclass(frozen=True, slots=True)
class CounterExample:
    """No motion was found for a plan in which ``effector`` (from 0) visits ``cells`` in this order.

    Other cells may lie in between; an empty tuple stands for every plan.  If not ``ordered``, no
    motion was found that visits the cells in any order.  ``reason`` says why, and ``robot`` is the
    key of the robot for which this is known.
    """

    effector: int
    cells: tuple[int, ...]
    reason: str
    robot: str = ""
    ordered: bool = True

    def meets(self, effector: int, path: Sequence[int]) -> bool:
        """Whether the path of this effector visits the cells of the counterexample."""
        if effector != self.effector:
            return False
        if not self.ordered:
            return set(self.cells) <= set(path)
        rest = iter(path)
        return all(cell in rest for cell in self.cells)


class Exhaustion(Enum):
    """Why no plan is left."""

    APART = "no sequence of neighbouring cells leads from the start to the target"
    TOO_FAR = "every path has more changes of cell than there are samples for"
    FORMULA = "no path within the bound satisfies the formula"
    SPENT = "all plans were given out or are blocked"


@dataclass(frozen=True, slots=True)
class Exhausted:
    """Proof, by graph distance and by the SAT solver, that no plan is left.

    ``changes`` is the bound on changes of cell up to which this holds.  ``complete`` says that
    there is no plan with more changes either (with one entry per sample, if the task is timed).
    ``plans`` counts the plans returned; the claim rests on these and on the counterexamples.
    """

    changes: int
    complete: bool
    plans: int
    blocked: tuple[CounterExample, ...]
    why: Exhaustion


PlanAnswer: TypeAlias = Answer[Plan, Exhausted]


class Planner:
    """Enumerates plans in ascending order of changes of cell, without repetition.

    Plans that differ only in the samples at which cells are entered count as one until no other
    plan is left.  Then the remaining ones follow, again in ascending order of changes.
    """

    def __init__(self, problem: PlanningProblem, *, conflicts: int = CONFLICTS) -> None:
        """Compute the distances; nothing is solved yet.

        Args:
            problem: the planning problem.
            conflicts: the conflict budget of each call of the SAT solver.

        Raises:
            ValueError: if the bound on changes is negative.
        """
        if problem.changes < 0:
            raise ValueError("the number of changes is at least 0")
        self.problem = problem
        self._encoding = plan_encoding(problem)
        self._conflicts = conflicts
        self._solver = SatSolver()
        self._bound = self._encoding.least
        self._distinct = True
        self._unbounded = False
        self._plans = 0
        self._blocked: list[CounterExample] = []

    @property
    def blocked(self) -> tuple[CounterExample, ...]:
        """The counterexamples, in the order in which they were given."""
        return tuple(self._blocked)

    @property
    def complete(self) -> bool:
        """Whether the bound on changes is known to exclude no plan."""
        return self._encoding.complete or self._encoding.least is None or self._unbounded

    def next_plan(self) -> PlanAnswer:
        """The next plan, or a proof that none is left.

        ``Unknown`` leaves the state unchanged: the next call continues with the same bound.
        """
        while self._bound is not None and self._bound <= self._encoding.limit:
            self._encoding.extend(self._bound)
            assumed = self._encoding.assumptions(self._bound, distinct=self._distinct)
            self._hand_over()
            check_time()
            answer = self._solver.solve(assumed, conflicts=self._conflicts)
            check_time(SOLVED)
            match answer:
                case Holds(witness=model):
                    words = self._encoding.decode(model.true)
                    self._encoding.exclude(words)
                    self._plans += 1
                    return Holds(
                        Plan(tuple(EffectorPath(w.effector, w.cells, w.entries) for w in words))
                    )
                case Fails(counterexample=core):
                    self._advance(bounded=any(literal < 0 for literal in core.assumptions))
                case Unknown() as unknown:
                    return unknown
        return Fails(
            Exhausted(
                self.problem.changes, self.complete, self._plans, self.blocked, self._reason()
            )
        )

    def block(self, counterexample: CounterExample) -> None:
        """Exclude every plan in which the effector visits the cells of a counterexample.

        A counterexample about an effector that is not planned excludes nothing and is not stored.

        Raises:
            ValueError: if an index is not that of a cell.
        """
        cells, count = counterexample.cells, len(self.problem.neighbours)
        if not all(0 <= cell < count for cell in cells):
            raise ValueError(f"no cells: {cells}")
        if all(p.effector != counterexample.effector for p in self.problem.effectors):
            return
        self._blocked.append(counterexample)
        self._encoding.block(counterexample.effector, cells, ordered=counterexample.ordered)

    def _hand_over(self) -> None:
        for clauses in self._encoding.clauses.taken():
            self._solver.add(clauses)

    def _advance(self, *, bounded: bool) -> None:
        """Go on to the next bound, or stop if the clauses rule out every bound."""
        if self._bound is None:
            return
        if bounded:
            self._bound += 1
        else:
            self._unbounded = True
            self._bound = None
        ended = self._bound is None or self._bound > self._encoding.limit
        if ended and self._distinct and self._plans and self.problem.by_samples:
            self._distinct = False
            self._bound = self._encoding.least

    def _reason(self) -> Exhaustion:
        shortest = self._encoding.shortest
        known = [one for one in shortest if one is not None]
        if len(known) < len(shortest):
            return Exhaustion.APART
        if sum(known) > self._encoding.limit or max(known) > self.problem.steps:
            return Exhaustion.TOO_FAR
        return Exhaustion.SPENT if self._plans or self._blocked else Exhaustion.FORMULA

"""P.Planning: paths through the cells by SAT, fewest changes of cell first.

Source: Algorithm 1 and Section 4.2 (Problem 3).  A path is a sequence of cells, each adjacent to
the next; without a formula no cell comes twice.  Where a task is not timed, the control synthesis
decides when each cell is entered.  Paths that visit the cells of a counterexample are left out.
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
    """The cells of one effector (from 0), in the order they are entered.

    Consecutive ones differ and are adjacent.  ``entries`` are the samples at which they are
    entered, the first 0; None where the task does not care when.
    """

    effector: int
    cells: tuple[int, ...]
    entries: tuple[int, ...] | None


@dataclass(frozen=True, slots=True)
class Plan:
    """The paths of the planned effectors, by ascending number."""

    paths: tuple[EffectorPath, ...]

    @property
    def changes(self) -> int:
        """The number of changes of cell, of all effectors together."""
        return sum(len(path.cells) - 1 for path in self.paths)


@dataclass(frozen=True, slots=True)
class CounterExample:
    """No motion was found for a plan in which that effector (from 0) visits these cells in turn.

    Other cells may lie between; no cell at all stands for every plan.  Where they are not
    ``ordered``, none was found that visits them in another order either.  ``reason`` and ``robot``
    (its key) say why, and of which robot this is known.
    """

    effector: int
    cells: tuple[int, ...]
    reason: str
    robot: str = ""
    ordered: bool = True

    def meets(self, effector: int, path: Sequence[int]) -> bool:
        """Whether that effector visits these cells on a path."""
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
    """Proved, by graph distance and by the SAT solver: no plan is left.

    ``changes`` is the bound up to which this is so; ``complete`` tells that it was no restriction:
    there is none with more changes either (with an entry per sample, where the task is timed).
    ``plans`` counts those given out; they and the counterexamples are what the claim rests on.
    """

    changes: int
    complete: bool
    plans: int
    blocked: tuple[CounterExample, ...]
    why: Exhaustion


PlanAnswer: TypeAlias = Answer[Plan, Exhausted]


class Planner:
    """Enumerates plans in order of their changes of cell, none twice.

    Plans that differ only in the samples at which cells are entered count as one, until nothing
    else is left: then the others follow, fewest changes first again.
    """

    def __init__(self, problem: PlanningProblem, *, conflicts: int = CONFLICTS) -> None:
        """Measure distances; nothing is solved yet.

        Args:
            problem: what is asked.
            conflicts: the budget of each call of the SAT solver.

        Raises:
            ValueError: the bound on changes is negative.
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
        """The counterexamples, in the order they were given."""
        return tuple(self._blocked)

    @property
    def complete(self) -> bool:
        """Whether the bound on changes is known to exclude no plan."""
        return self._encoding.complete or self._encoding.least is None or self._unbounded

    def next_plan(self) -> PlanAnswer:
        """The next plan, never one given before; or the proof that none is left.

        ``Unknown`` leaves everything as it was: another call goes on with the same bound.
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
        """Leave out every plan in which that effector visits the cells of a counterexample.

        One about an effector that is not planned leaves out nothing, and is not kept.

        Raises:
            ValueError: an index that is no cell's.
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
        """Go on to the next bound, unless the clauses say that none will do."""
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

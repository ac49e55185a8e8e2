"""P.Planning and P.Synthesis for one structure: plans, motions along them, counterexamples, cuts.

Plans come from the SAT solver, fewest changes of cell first, and one of each homotopy kind before a
second of any.  A plan whose beginning cannot be followed is excluded with all that begin so; where
that leaves none, a cell at which it happened is cut in two and the planning goes on, with the
counterexamples that say nothing of that cell.  After a proof, the other ways round are tried for a
more robust design.

A search is a generator of states: whoever asks for the next one pays for one attempt, and may stop
at any time.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.specification import PlanningProblem, planning_problem
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.bisection import halving
from grammar_lang import ir
from solvers.planner import CounterExample, Plan, Planner
from solvers.run_context import RunContext
from solvers.search.motion_proof import MotionProof
from solvers.search.path_search import PathSearch
from solvers.search.path_task import Design, PathTask, exhausted_text
from solvers.search.plan_kinds import obstacle_points, other_kinds
from solvers.search.round_task import RoundTask, closing, round_tasks
from solvers.search.sampled_cells import (
    clear_of_bodies,
    standing_configurations,
    start_cells,
    within_reach,
)
from solvers.search.search_state import PathAttempt, StructureState
from solvers.trajectory.corridor import polyline
from solvers.verdict import Holds, Unknown

OTHER_WAYS = 2
"""So many other kinds of paths are tried for a more robust design than a proved one."""
NUMERIC_FAULTS = (OverflowError, ZeroDivisionError, FloatingPointError, MemoryError)
TOO_LARGE = "the numbers of the task are too large or too small for the search"
NO_EFFECTOR = "it has no effector that the task asks for"

Attempts: TypeAlias = Generator[PathAttempt, None, str]
"""Attempts one after another, and why they end."""
Part: TypeAlias = Generator[PathAttempt, None, tuple[str, bool]]
"""The same of a part of them, and whether one had a design."""


@dataclass(frozen=True, slots=True)
class StructureSearch:
    """What is searched; ``number`` is the place of the structure among all, ``robot`` its key.

    ``keep`` is given each design as it is proved, ``seen`` the robustness of what waits for it.
    """

    program: ir.Program
    task: ir.Task
    context: RunContext
    cells: Abstraction
    derivation: Derivation
    numeric: NumericRobot
    number: int
    robot: str
    keep: Callable[[Design], None]
    seen: Callable[[float], None]

    def states(self, effectors: Sequence[int]) -> Iterator[StructureState]:
        """What is known after each attempt; the last one says why no more are made.

        ``effectors`` (from 0) are those that may start and reach, the most hopeful first.
        """
        state, attempts = StructureState(), self._attempts(effectors)
        while not state.is_over:
            try:
                state = replace(state, attempts=(*state.attempts, next(attempts)))
            except StopIteration as ended:
                state = replace(state, reason=str(ended.value))
            except NUMERIC_FAULTS as fault:
                state = replace(state, reason=f"{TOO_LARGE} ({type(fault).__name__}: {fault})")
            yield state

    def _attempts(self, effectors: Sequence[int]) -> Attempts:
        reason = NO_EFFECTOR
        for effector in effectors:
            for shape in round_tasks(self.task, effector):
                reason, found = yield from _RoundSearch(self, shape, effector).attempts()
                if found:
                    return reason
        return reason


@dataclass(frozen=True, slots=True)
class _RoundSearch:
    """The search of one shape of a motion, in which one effector reaches.

    Where motions go on for ever, what is searched and what is proved of it differ.
    """

    search: StructureSearch
    shape: RoundTask
    recorded: int

    @property
    def task(self) -> ir.Task:
        """What is searched."""
        return self.shape.task

    @property
    def paths(self) -> PathSearch:
        """The search of single paths."""
        search, context = self.search, self.search.context
        place = PathTask(
            search.program, self.task, search.numeric, self.shape.formula, context.seed,
            context.solver, self.shape.loop,
        )  # fmt: skip
        proof = MotionProof(search.program, search.task, search.derivation, context)
        return PathSearch(
            place, proof, context, self.recorded, search.number, search.robot, search.keep,
            search.seen,
        )  # fmt: skip

    def attempts(self) -> Part:
        """Attempts until one has a design, and those that make it more robust."""
        if not self.search.numeric.graph.model.dofs:
            return (yield from self.standing())
        paths = self.search.context.paths
        cells, known = self.search.cells, list[CounterExample]()
        reason, found = "", False
        for budget in (paths, (paths + 1) // 2):
            reason, found = yield from self.planned(cells, known, budget)
            finer = None if found else self.cut(cells, known)
            if finer is None:
                break
            cells, known = finer
        return reason, found

    def standing(self) -> Part:
        """A robot that cannot move does the task where it stands, or not at all."""
        search = self.search
        workspace = search.program.workspaces[self.task.workspace]
        found = standing_configurations(
            search.numeric, workspace, self.task, search.cells, self.recorded, search.context.seed
        )
        for cell, configuration in found:
            attempt = self.paths.standing(search.cells, cell, configuration)
            yield attempt
            if attempt.design is not None:
                return "proved", True
        return "the robot cannot move, and no place to stand was found for it", False

    def planned(self, cells: Abstraction, known: list[CounterExample], budget: int) -> Part:
        """Attempts at plans until one leads to a design, none is left or the budget is used up.

        Where no plan goes through cells alone for which poses are found, others are tried, too.
        What is learned is added to ``known``.
        """
        search, reason = self.search, "the task leaves no cell to start in"
        starts = start_cells(cells, self.task, search.numeric)
        problem = planning_problem(cells, self.task, self.recorded, starts)
        problem = clear_of_bodies(problem, search.numeric, cells, self.task)
        for closed in closing(problem, self.shape):
            reachable = within_reach(closed, search.numeric, cells, search.context.seed)
            plans = _Plans(self, reachable, cells, known, budget)
            reason, found = yield from plans.attempts()
            if not plans.count and reachable != closed:
                plans = _Plans(self, closed, cells, known, budget)
                reason, found = yield from plans.attempts()
            if found:
                return reason, True
        return reason, False

    def cut(
        self, cells: Abstraction, known: Sequence[CounterExample]
    ) -> tuple[Abstraction, list[CounterExample]] | None:
        """The cells with that one cut at which the shortest excluded plan fails; None without one.

        With them come the counterexamples that say nothing of that cell: the others need not hold
        of its halves.
        """
        if not known:
            return None
        failed = min(known, key=lambda item: len(item.prefix))
        direction = None
        if len(failed.prefix) > 1:
            line = polyline(cells, failed.prefix).points
            direction = (line[-1] - line[-2]).tolist()
        finer, children = cells.refined([halving(cells, failed.prefix[-1], direction)])
        whole = {cell: parts[0] for cell, parts in enumerate(children) if len(parts) == 1}
        kept = [
            replace(item, prefix=tuple(whole[cell] for cell in item.prefix))
            for item in known
            if all(cell in whole for cell in item.prefix)
        ]
        name = cells.cells[failed.prefix[-1]].name
        self.search.context.reporter.note(f"no plan is left: `{name}` is cut")
        return finer, kept


class _Plans:
    """The plans of one planning problem, one of each kind first, and the attempts at them.

    ``count`` is the number of those that were tried.
    """

    def __init__(
        self,
        round_search: _RoundSearch,
        problem: PlanningProblem,
        cells: Abstraction,
        known: list[CounterExample],
        budget: int,
    ) -> None:
        self.count = 0
        self._round = round_search
        self._problem = problem
        self._cells = cells
        self._known = known
        self._budget = budget

    def attempts(self) -> Part:
        """Attempts until one has a design; then those that may make it more robust."""
        context, paths, best = self._round.search.context, self._round.paths, -np.inf
        planner, others = Planner(self._problem), list[Plan]()
        tried = set[Plan]()
        for counterexample in self._known:
            planner.block(counterexample)
        while self.count < self._budget:
            if others:
                plan = others.pop(0)
            else:
                match planner.next_plan():
                    case Holds(witness=plan):
                        pass
                    case Unknown(reason=limit):
                        return f"planning: {limit.value}", False
                    case ended:
                        text = exhausted_text(ended.counterexample, best, self._round.task)
                        return text, False
            if plan in tried or self._is_blocked(plan):
                continue
            tried.add(plan)
            context.check_time()
            self.count += 1
            attempt = paths.attempt(self._cells, plan)
            yield attempt
            if attempt.design is not None:
                yield from self._improvements(plan, attempt.design, tried)
                return "proved", True
            best = max(best, attempt.robustness)
            if attempt.excluded is not None:
                self._known.append(attempt.excluded)
                planner.block(attempt.excluded)
            if self.count == 1 < self._budget:
                others = self._other_kinds(plan)
        return f"{self.count} paths tried, best robustness {best:.4g}", False

    def _is_blocked(self, plan: Plan) -> bool:
        """Whether a counterexample excludes a plan."""
        return any(
            path.effector == item.effector and path.cells[: len(item.prefix)] == item.prefix
            for path in plan.paths
            for item in self._known
        )

    def _other_kinds(self, plan: Plan) -> list[Plan]:
        """Plans that go round the obstacles on other sides than a plan."""
        round_search = self._round
        workspace = round_search.search.program.workspaces[round_search.task.workspace]
        points = obstacle_points(workspace, round_search.task)
        return other_kinds(self._problem, plan, self._cells, points, self._known)

    def _improvements(
        self, plan: Plan, design: Design, tried: Collection[Plan]
    ) -> Iterator[PathAttempt]:
        """Attempts at more robust designs along other kinds of paths, but those tried before.

        Where disturbances are named or motions go on for ever, a proof takes too long for that.
        """
        task = self._round.search.task
        if task.repeat or task.robust is not None:
            return
        kinds = [other for other in self._other_kinds(plan) if other not in tried]
        for other in kinds[:OTHER_WAYS]:
            self._round.search.context.check_time()
            attempt = self._round.paths.improved(self._cells, other, design)
            yield attempt
            if attempt.design is not None and attempt.design.robustness > design.robustness:
                design = attempt.design

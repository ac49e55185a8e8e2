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

from collections.abc import Collection, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from compiler.tasks.specification import PlanningProblem, planning_problem
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.bisection import halving
from grammar_lang import ir
from solvers.planner import CounterExample, EffectorPath, Plan, Planner
from solvers.search.path_search import PathSearch, StructureTask
from solvers.search.path_task import Design, exhausted_text
from solvers.search.plan_kinds import obstacle_points, other_kinds
from solvers.search.round_task import closing, round_tasks
from solvers.search.sampled_cells import (
    clear_of_bodies,
    standing_configurations,
    start_cells,
    within_reach,
)
from solvers.search.search_state import PathAttempt, StructureState
from solvers.trajectory.path_timing import polyline
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
Taught: TypeAlias = "Generator[PathAttempt, None, tuple[str, bool, Lessons]]"
"""The same with what is known afterwards."""


@dataclass(frozen=True, slots=True)
class StructureSearch:
    """The search of a structure in a workspace that is divided into ``cells``."""

    given: StructureTask
    cells: Abstraction

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
            for shape in round_tasks(self.given.task, effector):
                paths = PathSearch(self.given, shape, effector)
                reason, found = yield from _RoundSearch(paths, self.cells).attempts()
                if found:
                    return reason
        return reason


@dataclass(frozen=True, slots=True)
class Lessons:
    """What is known of the cells of a workspace: counterexamples, and paths with a motion.

    Both name effectors from 0.  No path along which a motion was found is ever excluded.
    """

    blocked: tuple[CounterExample, ...] = ()
    followed: tuple[tuple[int, tuple[int, ...]], ...] = ()

    def excludes(self, plan: Plan) -> bool:
        """Whether a counterexample excludes a plan."""
        return any(
            path.effector == item.effector and path.cells[: len(item.prefix)] == item.prefix
            for path in plan.paths
            for item in self.blocked
        )

    def after(self, attempt: PathAttempt, path: EffectorPath) -> Lessons:
        """What is known after an attempt at a path of its leader."""
        if attempt.excluded is not None:
            spared = self._sparing(attempt.excluded, path.cells)
            return self if spared is None else replace(self, blocked=(*self.blocked, spared))
        if attempt.nearest is not None:
            return replace(self, followed=(*self.followed, (path.effector, path.cells)))
        return self

    def _sparing(self, excluded: CounterExample, cells: tuple[int, ...]) -> CounterExample | None:
        """A counterexample with so much more of the cells of its path that it spares all others.

        None where another path with a motion begins with all of them.
        """
        others = [path for effector, path in self.followed if effector == excluded.effector]
        for size in range(len(excluded.prefix), len(cells) + 1):
            if all(path[:size] != cells[:size] for path in others):
                return replace(excluded, prefix=cells[:size])
        return None

    def in_finer_cells(self, whole: Mapping[int, int]) -> Lessons:
        """The same of finer cells, about those that are ``whole`` there; the rest is forgotten.

        A counterexample need not hold of the halves of a cell.
        """
        return Lessons(
            tuple(
                replace(item, prefix=tuple(whole[cell] for cell in item.prefix))
                for item in self.blocked
                if whole.keys() >= set(item.prefix)
            ),
            tuple(
                (effector, tuple(whole[cell] for cell in path))
                for effector, path in self.followed
                if whole.keys() >= set(path)
            ),
        )


@dataclass(frozen=True, slots=True)
class _RoundSearch:
    """The search of one shape of a motion, in which one effector reaches, along ``paths``."""

    paths: PathSearch
    cells: Abstraction

    @property
    def given(self) -> StructureTask:
        """The structure."""
        return self.paths.structure

    @property
    def task(self) -> ir.Task:
        """What is searched."""
        return self.paths.shape.task

    def attempts(self) -> Part:
        """Attempts until one has a design, and those that make it more robust."""
        if not self.given.numeric.graph.model.dofs:
            return (yield from self.standing())
        budget = self.given.context.paths
        cells, lessons = self.cells, Lessons()
        reason, found = "", False
        for most in (budget, (budget + 1) // 2):
            reason, found, lessons = yield from self.planned(cells, lessons, most)
            finer = None if found else self.cut(cells, lessons)
            if finer is None:
                break
            cells, lessons = finer
        return reason, found

    def standing(self) -> Part:
        """A robot that cannot move does the task where it stands, or not at all."""
        given = self.given
        workspace = given.program.workspaces[self.task.workspace]
        found = standing_configurations(
            given.numeric, workspace, self.task, self.cells, self.paths.recorded,
            given.context.seed,
        )  # fmt: skip
        for cell, configuration in found:
            attempt = self.paths.standing(self.cells, cell, configuration)
            yield attempt
            if attempt.design is not None:
                return "proved", True
        return "the robot cannot move, and no place to stand was found for it", False

    def planned(self, cells: Abstraction, lessons: Lessons, budget: int) -> Taught:
        """Attempts at plans until one leads to a design, none is left or the budget is used up.

        Where no plan goes through cells alone for which poses are found, others are tried, too.
        """
        given, reason, found = self.given, "the task leaves no cell to start in", False
        starts = start_cells(cells, self.task, given.numeric)
        problem = planning_problem(cells, self.task, self.paths.recorded, starts)
        problem = clear_of_bodies(problem, given.numeric, cells, self.task)
        for closed in closing(problem, self.paths.shape):
            reachable = within_reach(closed, given.numeric, cells, given.context.seed)
            plans = _Plans(self.paths, reachable, cells, lessons, budget)
            reason, found = yield from plans.attempts()
            if not plans.count and reachable != closed:
                plans = _Plans(self.paths, closed, cells, lessons, budget)
                reason, found = yield from plans.attempts()
            lessons = plans.lessons
            if found:
                break
        return reason, found, lessons

    def cut(self, cells: Abstraction, lessons: Lessons) -> tuple[Abstraction, Lessons] | None:
        """The cells with that one cut at which the shortest excluded plan fails; None without one.

        With them comes what is known of all other cells.
        """
        if not lessons.blocked:
            return None
        failed = min(lessons.blocked, key=lambda item: len(item.prefix))
        direction = None
        if len(failed.prefix) > 1:
            line = polyline(cells, failed.prefix).points
            direction = (line[-1] - line[-2]).tolist()
        finer, children = cells.refined([halving(cells, failed.prefix[-1], direction)])
        whole = {cell: parts[0] for cell, parts in enumerate(children) if len(parts) == 1}
        name = cells.cells[failed.prefix[-1]].name
        self.given.context.reporter.note(f"no plan is left: `{name}` is cut")
        return finer, lessons.in_finer_cells(whole)


class _Plans:
    """The plans of one planning problem, one of each kind first, and the attempts at them.

    ``count`` is the number of those that were tried, ``lessons`` what is known after them.
    """

    def __init__(
        self,
        paths: PathSearch,
        problem: PlanningProblem,
        cells: Abstraction,
        lessons: Lessons,
        budget: int,
    ) -> None:
        self.count = 0
        self.lessons = lessons
        self._paths = paths
        self._problem = problem
        self._cells = cells
        self._budget = budget

    def attempts(self) -> Part:
        """Attempts until one has a design; then those that may make it more robust."""
        context = self._paths.structure.context
        planner, others, tried = Planner(self._problem), list[Plan](), set[Plan]()
        for counterexample in self.lessons.blocked:
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
                        return exhausted_text(ended.counterexample, self._paths.shape.task), False
            if plan in tried or self.lessons.excludes(plan):
                continue
            tried.add(plan)
            context.check_time()
            self.count += 1
            attempt = self._paths.attempt(self._cells, plan)
            yield attempt
            if attempt.design is not None:
                yield from self._improvements(plan, attempt.design, tried)
                return "proved", True
            before = self.lessons.blocked
            self.lessons = self.lessons.after(attempt, self._paths.leader(plan))
            for counterexample in self.lessons.blocked[len(before) :]:
                planner.block(counterexample)
            if self.count == 1 < self._budget:
                others = self._other_kinds(plan)
        return "the budget of paths is used up", False

    def _other_kinds(self, plan: Plan) -> list[Plan]:
        """Plans that go round the obstacles on other sides than a plan."""
        task, program = self._paths.shape.task, self._paths.structure.program
        points = obstacle_points(program.workspaces[task.workspace], task)
        return other_kinds(self._problem, plan, self._cells, points, self.lessons.blocked)

    def _improvements(
        self, plan: Plan, design: Design, tried: Collection[Plan]
    ) -> Iterator[PathAttempt]:
        """Attempts at more robust designs along other kinds of paths, but those tried before.

        Where disturbances are named or motions go on for ever, a proof takes too long for that.
        """
        given = self._paths.structure
        if given.task.repeat or given.task.robust is not None:
            return
        kinds = [other for other in self._other_kinds(plan) if other not in tried]
        for other in kinds[:OTHER_WAYS]:
            given.context.check_time()
            attempt = self._paths.improved(self._cells, other, design)
            yield attempt
            if attempt.design is not None and attempt.design.robustness > design.robustness:
                design = attempt.design

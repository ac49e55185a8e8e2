"""P.Planning and P.Synthesis for one structure: plans, motions, counterexamples, splits.

Plans come from the SAT solver, fewest changes of cell first, and one of each homotopy kind before a
second of any.  If no motion was found along a plan, all plans that visit the same few cells are
deferred.  If that leaves no plan, one of these cells is split in two, and planning continues with
the counterexamples that do not involve it.  Deferred plans come last.  After a proof, ways of other
kinds are tried for a more robust design.

A search is a generator of states: each request for the next state makes one attempt, and the caller
may stop at any time.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from compiler.tasks.path_count import MOST, count_paths
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
    together,
    within_reach,
)
from solvers.search.search_state import PathAttempt, StructureState
from solvers.trajectory.path_timing import polyline
from solvers.verdict import Holds, Unknown

OTHER_WAYS = 2
"""The number of other kinds of paths tried for a more robust design."""
LONGER = 2
"""Deferred paths are counted up to this many changes of cell more than in the path."""
NUMERIC_FAULTS = (OverflowError, ZeroDivisionError, FloatingPointError, MemoryError)
TOO_LARGE = "the numbers of the task are too large or too small for the search"
NO_EFFECTOR = "it has no effector that the task asks for"

Attempts: TypeAlias = Generator[PathAttempt, None, str]
"""Yields attempts; returns why they end."""
Part: TypeAlias = Generator[PathAttempt, None, tuple[str, bool]]
"""Yields some of the attempts; returns why they end, and whether one had a design."""
Counted: TypeAlias = "Generator[PathAttempt, None, Planned]"
"""Yields some of the attempts; returns what is known afterwards."""


@dataclass(frozen=True, slots=True)
class StructureSearch:
    """The search of a structure in a workspace divided into ``cells``."""

    given: StructureTask
    cells: Abstraction

    def states(self, effectors: Sequence[int]) -> Iterator[StructureState]:
        """Yield the state after each attempt; the last one says why no more are made.

        ``effectors`` (from 0) are those that may start and reach, the most promising first.
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
    """The lessons about the cells of a workspace: counterexamples, and paths with a motion.

    Both number effectors from 0.  A path along which a motion was found is never excluded.
    """

    blocked: tuple[CounterExample, ...] = ()
    followed: tuple[tuple[int, tuple[int, ...]], ...] = ()

    def excludes(self, plan: Plan) -> bool:
        """Whether a counterexample excludes a plan."""
        return any(
            item.meets(path.effector, path.cells) for path in plan.paths for item in self.blocked
        )

    def after(self, attempt: PathAttempt, path: EffectorPath) -> Lessons:
        """The lessons after an attempt at a path of its leader."""
        if attempt.excluded is not None:
            spared = self._sparing(attempt.excluded, path.cells)
            return self if spared is None else replace(self, blocked=(*self.blocked, spared))
        if attempt.nearest is not None:
            return replace(self, followed=(*self.followed, (path.effector, path.cells)))
        return self

    def _sparing(self, excluded: CounterExample, cells: tuple[int, ...]) -> CounterExample | None:
        """The counterexample, extended by cells of its path until it spares all followed paths.

        None if a followed path visits all cells of the path in order.
        """
        own = set(excluded.cells)
        for size in range(len(cells) + 1):
            more = tuple(cell for place, cell in enumerate(cells) if place < size or cell in own)
            grown = excluded if set(more) == own else replace(excluded, cells=more, ordered=True)
            if not any(grown.meets(*path) for path in self.followed):
                return grown
        return None

    def in_finer_cells(self, whole: Mapping[int, int]) -> Lessons:
        """These lessons about finer cells, as far as they concern only cells in ``whole``.

        A counterexample need not hold for the halves of a cell.
        """
        return Lessons(
            tuple(
                replace(item, cells=tuple(whole[cell] for cell in item.cells))
                for item in self.blocked
                if whole.keys() >= set(item.cells)
            ),
            tuple(
                (effector, tuple(whole[cell] for cell in path))
                for effector, path in self.followed
                if whole.keys() >= set(path)
            ),
        )


@dataclass(frozen=True, slots=True)
class Planned:
    """Why attempts at plans ended, whether one had a design, the lessons, and their number."""

    reason: str
    found: bool
    lessons: Lessons
    count: int

    @property
    def deferred(self) -> bool:
        """Whether plans may have been deferred because of others."""
        return bool(self.lessons.blocked)


@dataclass(frozen=True, slots=True)
class _RoundSearch:
    """The search of one shape of motion, in which one effector reaches, along ``paths``."""

    paths: PathSearch
    cells: Abstraction

    @property
    def given(self) -> StructureTask:
        """The structure."""
        return self.paths.structure

    @property
    def task(self) -> ir.Task:
        """The task that is searched."""
        return self.paths.shape.task

    def attempts(self) -> Part:
        """Attempts until one has a design, and those that make it more robust."""
        if not self.given.numeric.graph.model.dofs:
            return (yield from self.standing())
        budget = self.given.context.paths
        stages = (budget, (budget + 1) // 2)
        cells, lessons, count, first = self.cells, Lessons(), 0, set[Plan]()
        ended = Planned("", found=False, lessons=lessons, count=0)
        for most in stages:
            tried = first if cells is self.cells else set[Plan]()
            ended = yield from self.planned(cells, lessons, most, tried)
            count += ended.count
            finer = None if ended.found else self.cut(cells, ended.lessons)
            if finer is None:
                break
            cells, lessons = finer
        left = min(sum(stages) - count, stages[-1])
        if ended.found or not left or not ended.deferred:
            return ended.reason, ended.found
        self.given.context.reporter.note("paths that were deferred are tried")
        last = yield from self.planned(self.cells, Lessons(), left, first, learning=False)
        return (last.reason if last.count else ended.reason), last.found

    def standing(self) -> Part:
        """Attempts at a robot that cannot move: it does the task where it stands, or not at all."""
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

    def planned(
        self,
        cells: Abstraction,
        lessons: Lessons,
        budget: int,
        tried: set[Plan],
        *,
        learning: bool = True,
    ) -> Counted:
        """Attempts at plans until one gives a design, none is left or the budget is used up.

        Plans through cells for which poses are found come first; if there are none, others are
        tried.  Plans in ``tried`` are skipped; without ``learning`` no plan is deferred.
        """
        given, reason, found, count = self.given, "the task leaves no cell to start in", False, 0
        starts = start_cells(cells, self.task, given.numeric)
        problem = planning_problem(cells, self.task, self.paths.recorded, starts)
        problem = clear_of_bodies(problem, given.numeric, cells, self.task)
        for closed in closing(problem, self.paths.shape):
            robot = given.numeric, cells, given.context.seed
            reachable = within_reach(closed, *robot)
            problems = together(reachable, *robot), reachable, closed
            for place, posed in enumerate(problems):
                if posed in problems[:place]:
                    continue
                plans = _Plans(
                    self.paths, posed, cells, lessons, budget - count, tried, learning=learning
                )
                reason, found = yield from plans.attempts()
                count, lessons = count + plans.count, plans.lessons
                if plans.count:
                    break
            if found:
                break
        return Planned(reason, found, lessons, count)

    def cut(self, cells: Abstraction, lessons: Lessons) -> tuple[Abstraction, Lessons] | None:
        """The cells with the last cell of the smallest counterexample split; None without one.

        Lessons about all other cells are returned with them.
        """
        known = [item for item in lessons.blocked if item.cells]
        if not known:
            return None
        failed = min(known, key=lambda item: len(item.cells)).cells
        direction = None
        if len(failed) > 1 and failed[-1] in cells.neighbours[failed[-2]]:
            line = polyline(cells, failed[-2:]).points
            direction = (line[-1] - line[-2]).tolist()
        finer, children = cells.refined([halving(cells, failed[-1], direction)])
        whole = {cell: parts[0] for cell, parts in enumerate(children) if len(parts) == 1}
        name = cells.cells[failed[-1]].name
        self.given.context.reporter.note(f"no plan is left: `{name}` is cut")
        return finer, lessons.in_finer_cells(whole)


class _Plans:
    """The plans of one planning problem, one of each kind first, and the attempts at them.

    Plans in ``tried`` are skipped.  ``count`` is the number of attempts made, ``lessons`` what is
    known after them; without ``learning`` it stays unchanged.
    """

    def __init__(
        self,
        paths: PathSearch,
        problem: PlanningProblem,
        cells: Abstraction,
        lessons: Lessons,
        budget: int,
        tried: set[Plan],
        *,
        learning: bool,
    ) -> None:
        self.count = 0
        self.lessons = lessons
        self._paths = paths
        self._problem = problem
        self._cells = cells
        self._budget = budget
        self._tried = tried
        self._learning = learning
        self._planner = Planner(problem)

    def attempts(self) -> Part:
        """Attempts until one has a design; then those that may make it more robust."""
        context, planner, others = self._paths.structure.context, self._planner, list[Plan]()
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
            if plan in self._tried or self.lessons.excludes(plan):
                continue
            self._tried.add(plan)
            context.check_time()
            self.count += 1
            attempt = self._paths.attempt(self._cells, plan, explaining=self._learning)
            attempt = self._learnt(plan, attempt)
            yield attempt
            if attempt.design is not None:
                yield from self._improvements(plan, attempt.design)
                return "proved", True
            if self.count == 1 < self._budget:
                others = self._other_kinds(plan)
        return "the budget of paths is used up", False

    def _learnt(self, plan: Plan, attempt: PathAttempt) -> PathAttempt:
        """The attempt at a plan with its counterexample, and the number of paths that it defers."""
        if attempt.design is not None or not self._learning:
            return replace(attempt, excluded=None)
        before, leader = len(self.lessons.blocked), self._paths.leader(plan)
        self.lessons = self.lessons.after(attempt, leader)
        if len(self.lessons.blocked) == before:
            return replace(attempt, excluded=None)
        known = self.lessons.blocked[-1]
        changes = len(leader.cells) - 1 + LONGER
        deferred = count_paths(
            self._problem, known.effector, known.cells, changes, ordered=known.ordered
        )
        self._planner.block(known)
        text = deferred_text(self._cells, known, len(leader.cells), deferred)
        self._paths.structure.context.reporter.note(text)
        return replace(attempt, excluded=known, deferred=deferred)

    def _other_kinds(self, plan: Plan) -> list[Plan]:
        """Plans that pass the obstacles on other sides than ``plan``."""
        task, program = self._paths.shape.task, self._paths.structure.program
        points = obstacle_points(program.workspaces[task.workspace], task)
        return other_kinds(self._problem, plan, self._cells, points, self.lessons.blocked)

    def _improvements(self, plan: Plan, design: Design) -> Iterator[PathAttempt]:
        """Attempts at more robust designs along other kinds of paths that were not tried before.

        There are none if disturbances are named or motions go on for ever: proofs would take too
        long.
        """
        given = self._paths.structure
        if given.task.repeat or given.task.robust is not None:
            return
        kinds = [other for other in self._other_kinds(plan) if other not in self._tried]
        for other in kinds[:OTHER_WAYS]:
            given.context.check_time()
            attempt = self._paths.improved(self._cells, other, design)
            yield attempt
            if attempt.design is not None and attempt.design.robustness > design.robustness:
                design = attempt.design


def deferred_text(cells: Abstraction, known: CounterExample, length: int, count: int) -> str:
    """A description of what a counterexample defers, with the number of paths.

    ``length`` is the number of cells of the path that it comes from.
    """
    names = [f"`{cells.cells[cell].name}`" for cell in known.cells]
    if not names:
        return "all paths are deferred: no motion was found even without cells and obstacles"
    joint = " and then " if known.ordered else " and "
    what = joint.join(names) if len(names) < length else "all cells of the path"
    more, changes = " or more" if count == MOST else "", length - 1 + LONGER
    paths = "1 path" if count == 1 else f"{count} paths"
    return f"deferred: {what}, {paths}{more} of at most {changes} changes of cell"

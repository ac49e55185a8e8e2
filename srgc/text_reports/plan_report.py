"""``srgc plan``: the first plan of a task, or the problem for another solver."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain
from typing import TypeAlias

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from compiler.tasks.obstacle_pieces import expanded
from compiler.tasks.plan_script import dimacs, smt2
from compiler.tasks.specification import PlanningProblem, planning_problem, recorded_effector
from compiler.tasks.word_formula import holds
from compiler.words.budget import WordsTooLongError
from compiler.words.finite_automaton import AutomatonTooLargeError
from compiler.words.structures import InfiniteAmbiguityError
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.bisection import bisections
from grammar_lang import ir
from grammar_lang.diagnostics.wording import counted
from solvers.conclusion import module_bound
from solvers.planner import EffectorPath, Exhausted, Exhaustion, Plan, Planner
from solvers.search.round_task import (
    closing,
    round_tasks,
    tasks_by_length,
    tasks_of_other_lengths,
)
from solvers.trajectory.path_timing import Entries, gentle_entries, polyline, word_of
from solvers.verdict import Holds, Unknown, Verdict
from srgc.faults import UsageFault
from srgc.text_reports.next_step import next_command

Timed: TypeAlias = tuple[int, tuple[int, ...], Entries]
"""An effector, its cells, and the samples at which it enters them."""


@dataclass(frozen=True, slots=True)
class PlanReport:
    """The answer to a planning problem in words, and its plan if there is one."""

    verdict: Verdict
    text: str
    workspace: ir.Workspace
    cells: Abstraction
    plan: Plan | None = None

    def picture(self, title: str) -> str:
        """The cells, their labels and adjacency, and the plan if there is one, as SVG."""
        from srgc.render.workspace_picture import workspace_svg

        paths = () if self.plan is None else tuple(path.cells for path in self.plan.paths)
        return workspace_svg(self.cells, self.workspace, paths, title)


def plan_report(program: ir.Program, task: ir.Task, least_cells: int | None = None) -> PlanReport:
    """The plan with the fewest changes of cell, one cell per line; or why there is none.

    If the times matter, lines give the samples at which cells are entered; paths of several
    effectors have headings.  If possible, a plan keeps effectors that are on a body out of the
    cells that bodies have to avoid.
    """
    program, task = expanded(program, task)
    workspace, cells = program.workspaces[task.workspace], _cells(program, task, least_cells)
    found = PlanReport("unknown", "unknown: there is no cell to start in", workspace, cells)
    for problem in chain(_clear_problems(program, task, cells), _problems(cells, task)):
        match Planner(problem).next_plan():
            case Holds(witness=plan):
                gentle = _gentle(plan, problem, cells)
                text = "\n".join([*_length(problem, task), *_lines(gentle, cells, task)])
                return PlanReport("found", text, workspace, cells, gentle)
            case Unknown(reason=reason):
                found = PlanReport("unknown", f"unknown: {reason.value}", workspace, cells)
            case ended:
                text = f"no path: {_why(ended.counterexample, problem.steps, task)}"
                # For motions that repeat, only some shapes are searched; for those that may end at
                # several times, only some of the ends.
                some = task.repeat or (task.at_most and task.demanded)
                verdict: Verdict = "unknown" if some else "impossible"
                found = PlanReport(verdict, text, workspace, cells)
    return found


def _gentle(plan: Plan, problem: PlanningProblem, cells: Abstraction) -> Plan:
    """The plan with its samples moved to reduce haste; the solver's samples are arbitrary."""
    formula, paths = problem.formula, list(plan.paths)
    if formula is None:
        return plan
    for number, path in enumerate(paths):
        if path.entries is None:
            continue
        others = [(p.effector, p.cells, p.entries or (0,)) for p in paths if p is not path]

        def allowed(
            entries: Entries, path: EffectorPath = path, others: Sequence[Timed] = tuple(others)
        ) -> bool:
            timed = [*others, (path.effector, path.cells, entries)]
            if problem.settled is not None and entries[-1] > problem.settled:
                return False
            return holds(formula, word_of(cells, timed, problem.steps))

        line = polyline(cells, path.cells)
        entries = gentle_entries(line, path.entries, problem.steps, allowed)
        paths[number] = replace(path, entries=entries)
    return Plan(tuple(paths))


def dump_text(program: ir.Program, task: ir.Task, form: str, least_cells: int | None = None) -> str:
    """The whole problem as ``dimacs`` or ``smt2``, satisfiable iff there is a plan.

    Raises:
        UsageFault: the task repeats its motion for ever, or it has formulas and its motions may end
            at several times; both give several problems.
    """
    program, task = expanded(program, task)
    if task.repeat:
        raise UsageFault(f"the plans of task `{task.name}`, which repeats, are no single problem")
    if task.at_most and task.demanded:
        message = f"the plans of task `{task.name}`, which ends at several times, are no single"
        raise UsageFault(f"{message} problem")
    (problem,) = _problems(_cells(program, task, least_cells), task)
    lines = dimacs(problem) if form == "dimacs" else smt2(problem)
    return "\n".join(lines) + "\n"


def _cells(program: ir.Program, task: ir.Task, least: int | None) -> Abstraction:
    cells = abstract(program.workspaces[task.workspace])
    return cells if least is None else cells.cut(bisections(cells, least))


def _problems(cells: Abstraction, task: ir.Task) -> Iterator[PlanningProblem]:
    """The problem of a task; if it repeats, the problems of all shapes that a search considers.

    Without formulas, the largest number of steps is enough, since more steps allow more plans; with
    formulas, several numbers of steps are considered.
    """
    recorded = recorded_effector(task) or 0
    lengths = *tasks_by_length(task), *tasks_of_other_lengths(task)
    for each in lengths if task.demanded else lengths[:1]:
        for part in round_tasks(each, recorded):
            yield from closing(planning_problem(cells, part.task, recorded), part)


def _clear_problems(
    program: ir.Program, task: ir.Task, cells: Abstraction
) -> Iterator[PlanningProblem]:
    """The problems without the cells that bodies avoid, for effectors that are on a body.

    These cells are those for the smallest robot that can move.
    """
    if all(avoid.subject != "body" for avoid in task.avoid):
        return
    # This loads scipy, which other plans do not need.
    from solvers.search.sampled_cells import clear_of_bodies

    family = family_of(program, task)
    model = None
    with suppress(InfiniteAmbiguityError, AutomatonTooLargeError, WordsTooLongError):
        robots = candidates(family, module_bound(family, task), task.origin)
        models = (each.model for each in robots if each.model is not None)
        model = next((each for each in models if each.dofs), None)
    if model is not None:
        numeric = NumericRobot(robot_graph(model, task.gravity))
        for problem in _problems(cells, task):
            yield clear_of_bodies(problem, numeric, cells, task)


def _length(problem: PlanningProblem, task: ir.Task) -> Iterator[str]:
    """The number of steps of a plan, if it is a choice and formulas depend on times."""
    if task.at_most and task.demanded:
        yield f"{counted(problem.steps, 'step')}:"


def _lines(plan: Plan, cells: Abstraction, task: ir.Task) -> Iterator[str]:
    for path in plan.paths:
        if len(plan.paths) > 1:
            yield f"effector {path.effector + 1}:"
        yield from _path_lines(path, cells, task)


def _path_lines(path: EffectorPath, cells: Abstraction, task: ir.Task) -> Iterator[str]:
    names = [cells.cells[cell].name for cell in path.cells]
    if path.entries is None:
        yield from names
        return
    for name, sample in zip(names, path.entries, strict=True):
        yield f"{name}\tat sample {sample} ({float(sample * task.step):g} s)"


def _why(ended: Exhausted, steps: int, task: ir.Task) -> str:
    if ended.why is Exhaustion.TOO_FAR:
        return f"every path has more changes of cell than the {steps + 1} samples allow"
    if ended.why is Exhaustion.FORMULA and not ended.complete:
        return f"no path with at most {ended.changes} changes of cell satisfies the formula"
    if ended.why is Exhaustion.FORMULA:
        if task.at_most:
            return "no path satisfies the formula, of any number of steps that was looked at"
        return f"no path within the {steps + 1} samples satisfies the formula"
    return str(ended.why.value)


def after_plan(verdict: Verdict, file: str) -> str:
    """The line about the next step."""
    if verdict == "found":
        return next_command("srgc synth", file, "finds out whether a robot can follow it")
    return next_command("srgc plan -o plan.svg", file, "draws the cells")

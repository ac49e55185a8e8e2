"""Synthesise a robot, plan a path of cells, explain why a task has no robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

from srgc.api.mission_result import MissionResult, mission_in
from srgc.api.program import Program, Specification, program_of
from srgc.api.result import Result, opened
from srgc.api.search_arguments import is_quiet, place_of, refuse_numbers
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault
from srgc.session import chosen, refuse_cycles
from srgc.time_limit import TimeLimit

if TYPE_CHECKING:
    from solvers.explanation.explanation import Explanation as Found
    from srgc.text_reports.plan_report import PlanReport


# --- The search for a robot and its proof ---------------------------------------------------------


@overload
def synthesize(
    program: Specification,
    task: str | None = None,
    folder: str | PathLike[str] | None = None,
    *,
    mission: None = None,
    seed: int = 0,
    jobs: int = 1,
    time_limit: float | None = None,
    cells: int | None = None,
    every: bool = False,
    pareto: bool = False,
    gap: float | str | None = None,
    solver: str | None = None,
    search: str | None = None,
    smt: str | None = None,
    lemmas: bool = True,
    force: bool = False,
    progress: bool | None = None,
) -> Result: ...
@overload
def synthesize(
    program: Specification,
    task: None = None,
    folder: str | PathLike[str] | None = None,
    *,
    mission: str,
    seed: int = 0,
    jobs: int = 1,
    time_limit: float | None = None,
    solver: str | None = None,
    search: str | None = None,
    smt: str | None = None,
    lemmas: bool = True,
    force: bool = False,
    progress: bool | None = None,
) -> MissionResult: ...
@spoken
def synthesize(
    program: Specification,
    task: str | None = None,
    folder: str | PathLike[str] | None = None,
    *,
    mission: str | None = None,
    seed: int = 0,
    jobs: int = 1,
    time_limit: float | None = None,
    cells: int | None = None,
    every: bool = False,
    pareto: bool = False,
    gap: float | str | None = None,
    solver: str | None = None,
    search: str | None = None,
    smt: str | None = None,
    lemmas: bool = True,
    force: bool = False,
    progress: bool | None = None,
) -> Result | MissionResult:
    """Search for a robot that is proved to do a task, or for a proof that there is none.

    Args:
        program: the specification, or the path of its file.
        task: the task; may be omitted if there is only one.
        mission: a mission whose tasks are solved together, instead of one ``task``.
        folder: the folder for the results, as for ``srgc synth -o``; an interrupted search
            continues from it.  By default a temporary folder that exists as long as the result;
            ``Result.save`` copies it.
        seed: the seed of all random numbers; the same seed gives the same result.
        jobs: the number of processes; it does not change the result.
        time_limit: a limit in seconds.  If no robot is proved by then, the verdict is unknown.
        cells: the least number of cells to begin with.
        every: whether to continue after the first robot and compare all designs.
        pareto: the same, but only non-dominated designs are kept.
        gap: continue until no robot can be more robust than the best one by more than this
            percentage, such as 5 or "5 %".  It excludes ``every``, ``pareto`` and tasks with
            ``minimize``.
        solver: the solver of convex programs: by default our own, or one of cvxpy's.
        search: the search for parameters, by default gp-acb.
        smt: the SMT solvers that decide scripts, such as "cvc5" or "z3,cvc5"; several have to
            agree.  By default z3 as a library.
        lemmas: whether one refutation may cover many structures.
        force: whether to replace the results of another synthesis in the folder.
        progress: whether to show the progress of the search; by default only in notebooks.

    Returns:
        The result.  It is not verified yet; call its ``verify``.

    Raises:
        SrgcError: there is no such task or mission, it has a clause that is not supported, or the
            folder has other contents.
    """
    limit, program = TimeLimit(time_limit), program_of(program)
    if mission is not None:
        refused = {
            "task": task, "cells": cells, "every": every or None, "pareto": pareto or None,
            "gap": gap,
        }  # fmt: skip
        _refuse_of_tasks(refused)
        refuse_numbers(seed, jobs, time_limit)
        return _mission(
            program, mission, folder, limit, seed=seed, jobs=jobs, solver=solver, search=search,
            smt=smt, lemmas=lemmas, force=force, quiet=is_quiet(progress),
        )  # fmt: skip
    chosen_task = chosen(program.ir.tasks, task, "task")
    refuse_cycles(program.ir, program.ir.grammars[chosen_task.grammar])
    refuse_numbers(seed, jobs, time_limit, cells=cells)
    from srgc.results.synthesis_run import SynthesisOptions, run_synthesis
    from srgc.search_options import asked_gap, named_search, named_smt_solvers, named_solver

    named_smt_solvers(smt)
    if gap is not None and (every or pareto):
        option = "pareto" if pareto else "every"
        raise UsageFault(
            f"`{option}` does not go with `gap`, which keeps the most robust robot alone"
        )

    place, keeper = place_of(folder)
    options = SynthesisOptions(
        place, seed, jobs, limit, force, quiet=is_quiet(progress), cells=cells,
        every=every or pareto, front=pareto, solver=named_solver(solver),
        search=named_search(search), lemmas=lemmas, smt=smt, gap=asked_gap(gap, chosen_task),
    )  # fmt: skip
    run_synthesis(Path(program.name), program.ir, chosen_task, options)
    return opened(place, keeper)


def _refuse_of_tasks(given: Mapping[str, object]) -> None:
    """Refuse arguments that apply to a single task only."""
    for name, value in given.items():
        if value is not None:
            raise UsageFault(f"`{name}` is about one task, and `mission` about all of a mission")


def _mission(
    program: Program,
    name: str,
    folder: str | PathLike[str] | None,
    limit: TimeLimit,
    *,
    seed: int,
    jobs: int,
    solver: str | None,
    search: str | None,
    smt: str | None,
    lemmas: bool,
    force: bool,
    quiet: bool,
) -> MissionResult:
    """Search for the robots of a mission."""
    from srgc.results.mission_run import run_mission
    from srgc.results.synthesis_run import SynthesisOptions
    from srgc.search_options import named_search, named_smt_solvers, named_solver

    mission = chosen(program.ir.missions, name, "mission")
    refuse_cycles(program.ir, program.ir.grammars[program.ir.tasks[mission.tasks[0]].grammar])
    named_smt_solvers(smt)
    place, keeper = place_of(folder)
    options = SynthesisOptions(
        place, seed, jobs, limit, force, quiet, solver=named_solver(solver),
        search=named_search(search), lemmas=lemmas, smt=smt,
    )  # fmt: skip
    run_mission(Path(program.name), program.ir, mission, options)
    return mission_in(place, keeper)


# --- The path of a task through the cells of its workspace ----------------------------------------


@dataclass(frozen=True, slots=True)
class Plan:
    """The path of each effector through cells, or the reason why there is none.

    A notebook displays its picture.

    Attributes:
        report: the answer with its cells; not a stable interface.
        title: the title above the picture.
    """

    report: PlanReport
    title: str

    @property
    def verdict(self) -> Literal["found", "impossible", "unknown"]:
        """``"found"``, ``"impossible"``, or ``"unknown"`` if neither is proved."""
        return self.report.verdict

    @property
    def cells(self) -> tuple[str, ...]:
        """The names of all cells of the workspace."""
        return tuple(cell.name for cell in self.report.cells.cells)

    @property
    def paths(self) -> dict[int, tuple[str, ...]]:
        """The cells that each effector passes, in order, by its number from 1."""
        plan, cells = self.report.plan, self.report.cells.cells
        paths = () if plan is None else plan.paths
        return {p.effector + 1: tuple(cells[cell].name for cell in p.cells) for p in paths}

    @property
    def svg(self) -> str:
        """A picture of the cells, their labels and adjacency, and the path if there is one."""
        return self.report.picture(self.title)

    def __repr__(self) -> str:
        ways = "; ".join(" > ".join(path) for path in self.paths.values())
        return f"<Plan: {ways or self.report.text}>"

    def __str__(self) -> str:
        return self.report.text

    def _repr_html_(self) -> str:
        from srgc.api.displays import plan_html

        return plan_html(self.report, self.title)


@spoken
def plan(program: Specification, task: str | None = None, *, cells: int | None = None) -> Plan:
    """Plan a path for the effectors of a task, with the fewest changes of cell.

    A plan ignores the robot; ``synthesize`` searches for a robot that can follow one.

    Args:
        program: the specification, or the path of its file.
        task: the task; may be omitted if there is only one.
        cells: the least number of cells to begin with.

    Raises:
        SrgcError: there is no such task, or it has a clause that is not supported.
    """
    from srgc.text_reports.plan_report import plan_report

    if cells is not None and cells < 1:
        raise UsageFault("`cells` counts from 1")
    program = program_of(program)
    chosen_task = chosen(program.ir.tasks, task, "task")
    report = plan_report(program.ir, chosen_task, cells)
    return Plan(report, f"{program.name}, task {chosen_task.name}")


# --- Why no robot was found -----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Explanation:
    """The lines of a specification that conflict, and changes that make its task possible.

    Attributes:
        found: the whole explanation; not a stable interface.
    """

    found: Found

    @property
    def conflicts(self) -> list[list[str]]:
        """For each conflict, the lines that together rule out robots, in words."""
        return [[line.says for line in one.lines] for one in self.found.conflicts.found]

    @property
    def suggestions(self) -> list[str]:
        """Changes of a single line, in words; with each, a run found and proved a robot."""
        return [one.change.says for one in self.found.suggestions]

    def __repr__(self) -> str:
        conflicts, changes = len(self.conflicts), len(self.suggestions)
        return f"<Explanation: {conflicts} conflicts, {changes} suggestions>"

    def __str__(self) -> str:
        from srgc.text_reports.why_report import why_text

        return why_text(self.found).rstrip()

    def _repr_html_(self) -> str:
        from srgc.api.displays import explanation_html

        return explanation_html(self.found)


@spoken
def why(
    result: str | PathLike[str], *, runs: bool = True, time_limit: float | None = None
) -> Explanation:
    """Find the lines of a specification that conflict, and changes that make its task possible.

    Args:
        result: a result with the verdict impossible or unknown, or its folder.
        runs: whether to search for changes that help; a run confirms each of them.
        time_limit: a limit in seconds; the explanation contains what is known by then.

    Raises:
        SrgcError: there are no results, a robot was found, or the result is that of a mission; use
            ``MissionResult.why`` for a mission.
    """
    from solvers.explanation.explanation import Asked, explain
    from solvers.explanation.run import MOST_RUNS
    from srgc.results.mission_refusal import is_mission_folder
    from srgc.results.why_folder import tried_folder

    limit = TimeLimit(time_limit)
    if is_mission_folder(Path(result)):
        raise UsageFault(
            f"{Path(result)} holds the results of a mission: `open_result(…).why()` explains it"
        )
    tried = tried_folder(Path(result))
    if tried.tried is None:
        raise UsageFault("a robot was found: there is nothing to explain, `verify` checks it")
    context = tried.context(limit.reached)
    # Places are told as in the specification itself, not in the copy, which may be anywhere.
    program = tried.posed.program
    sources = tuple(replace(source, name=source.path) for source in program.sources)
    posed = replace(tried.posed, program=replace(program, sources=sources))
    with limit.holds():
        found = explain(posed, tried.tried, Asked(context, MOST_RUNS if runs else 0))
    return Explanation(found)

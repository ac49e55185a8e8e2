"""Questions to a program: synthesise, plan, why."""

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
    """Search a task for a robot that is proved to do it, or for a proof that there is none.

    Args:
        program: the specification, or the path of its file.
        task: which one; may be left out where there is one.
        mission: solve all tasks of this mission together, instead of one.
        folder: where the results are written, as by ``srgc synth -o``; a search that was
            interrupted goes on from there.  By default a temporary folder, which lasts as long as
            the result; ``Result.save`` keeps it.
        seed: of everything that is drawn; the same seed gives the same result.
        jobs: how many processes search; the result is the same.
        time_limit: seconds, after which the verdict is unknown unless a robot was proved by then.
        cells: begin with at least so many cells.
        every: go on after the first robot, and compare all of them.
        pareto: the same, and keep those alone that no other one dominates.
        gap: go on until no robot is proved to be more robust by more than that part of the best
            one, in percent, as 5 or "5 %"; not with ``every``, ``pareto`` or a task that says
            itself what is to be least.
        solver: of convex programs; our own by default, or one of cvxpy's.
        search: of parameters; gp-acb by default.
        smt: the SMT solvers that scripts are given to, as "cvc5" or "z3,cvc5", which must agree; z3
            as a library by default.
        lemmas: let one refutation be about many structures, where it can be.
        force: replace the results of another synthesis in the folder.
        progress: say how far the search is; by default in notebooks alone.

    Returns:
        The result, not verified yet: its ``verify`` does that.

    Raises:
        SrgcError: there is no such task or mission, it has a clause that is not supported, or the
            folder holds something else.
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
    """Refuse arguments that are about one task."""
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


# --- The way of a task through the cells of its workspace -----------------------------------------


@dataclass(frozen=True, slots=True)
class Plan:
    """The cells that effectors go through, or why there is no such way; it draws itself.

    Attributes:
        report: the answer with its cells; not a stable interface.
        title: what stands above the picture.
    """

    report: PlanReport
    title: str

    @property
    def verdict(self) -> Literal["found", "impossible", "unknown"]:
        """Whether there is a plan."""
        return self.report.verdict

    @property
    def cells(self) -> tuple[str, ...]:
        """The names of all cells of the workspace."""
        return tuple(cell.name for cell in self.report.cells.cells)

    @property
    def paths(self) -> dict[int, tuple[str, ...]]:
        """By the number of the effector, from 1, the cells that it goes through, in order."""
        plan, cells = self.report.plan, self.report.cells.cells
        paths = () if plan is None else plan.paths
        return {p.effector + 1: tuple(cells[cell].name for cell in p.cells) for p in paths}

    @property
    def svg(self) -> str:
        """The cells, their labels and adjacency, and the path if there is one."""
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
    """Plan the cells that a task's effectors go through, with the fewest changes.

    A plan is not about robots: ``synthesize`` finds one that follows it.

    Args:
        program: the specification, or the path of its file.
        task: which one; may be left out where there is one.
        cells: begin with at least so many cells.

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


# --- Why a task was not met -----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Explanation:
    """Which lines of a specification conflict, and what would make its task possible.

    Attributes:
        found: all that is known; not a stable interface.
    """

    found: Found

    @property
    def conflicts(self) -> list[list[str]]:
        """The lines that together rule robots out, by conflict, in words."""
        return [[line.says for line in one.lines] for one in self.found.conflicts.found]

    @property
    def suggestions(self) -> list[str]:
        """Changes of one line with which a run has found and proved a robot, in words."""
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
    """Say which lines of a specification conflict, and what would make its task possible.

    Args:
        result: one with the verdict impossible or unknown, or its folder.
        runs: whether to look for changes that help, each confirmed by a run of its own.
        time_limit: seconds; what is known by then is given.

    Raises:
        SrgcError: there are no results, or a robot was found, or it is the result of a mission,
            which has a ``why`` of its own.
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

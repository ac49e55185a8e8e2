"""Paths that cannot be followed, explained in three ways: what is tried until a motion is found.

*cores* are srgc's: few cells that motions are asked to visit, at whatever samples.  *IIS* is the
loop of SMC-LTL (Shoukry et al., *Linear temporal logic motion planning for teams of underactuated
robots using satisfiability modulo convex programming*, CDC 2017), in an implementation of our own
on the same cells: an irreducible set of constraints of the convex program, found by a deletion
filter, each a cell at a position of the path.  *none* leaves out the path alone.  All have the same
plans, in the same order, and the same search along a path; proofs are not asked for.  The deferred
paths are those of the first plans that a clause is about.

    python benchmarks/path_cores.py --tasks 40 --json out/path_cores.json
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean, median
from typing import Any

import numpy as np
from cluttered_tasks import cluttered_task
from timing import machine

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.words.structures import structures
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load_text
from solvers.planner import CounterExample, Plan, Planner
from solvers.run_context import RunContext
from solvers.search.configuration_search import Configuration, search_configuration
from solvers.search.path_cores import TRIAL, PathCore, PathCores
from solvers.search.path_search import PathSearch, StructureTask
from solvers.search.round_task import round_tasks
from solvers.search.sampled_cells import start_cells, within_reach
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_relaxation import PathRelaxation
from solvers.verdict import Holds

MOST_PATHS = 20
FEW = 2
"""So many cells are few."""
PLANS = 300
"""So many plans, the first ones, are looked at for what a clause defers."""
Clause = Callable[[tuple[int, ...]], bool]
"""Whether a path is deferred."""


@dataclass
class Tried:
    """What a loop came to on a task."""

    found: bool = False
    by_explanation: bool = False
    paths: int = 0
    seconds: float = 0.0
    sizes: list[int] = field(default_factory=list[int])
    shares: list[float] = field(default_factory=list[float])
    deferred: list[int] = field(default_factory=list[int])


@dataclass
class Case:
    """A task with its plans, in order."""

    search: PathSearch
    cells: Any
    plans: list[Plan]

    @staticmethod
    def of(seed: int) -> Case:
        """The task of a seed."""
        program = load_text(cluttered_task(seed), f"task{seed}.srg").program
        if program is None:
            raise SystemExit(f"task {seed} is not valid")
        task = program.tasks["Go"]
        family = family_of(program, task)
        derivation = next(iter(structures(family.language, 12)))
        numeric = NumericRobot(robot_graph(family.robot(derivation), task.gravity))
        given = StructureTask(program, task, RunContext(), derivation, numeric, 0, "", Unheard())
        (shape,) = round_tasks(task, 0)
        cells = abstract(program.workspaces[task.workspace])
        starts = start_cells(cells, task, numeric)
        problem = planning_problem(cells, task, 0, starts)
        planner = Planner(within_reach(problem, numeric, cells, 0))
        plans = list[Plan]()
        while len(plans) < PLANS and isinstance(answer := planner.next_plan(), Holds):
            plans.append(answer.witness)
        return Case(PathSearch(given, shape, 0), cells, plans)


class Unheard:
    """Is told of motions, which are not wanted here."""

    def keep(self, design: object) -> None:
        """Nothing."""

    def see(self, motion: object) -> None:
        """Nothing."""


Explained = tuple[Clause, int] | ControlOutcome
"""What is deferred, by how many cells; or a motion."""


def by_cores(case: Case, path_problem: PathProblem, found: Configuration) -> Explained:
    """srgc's own."""
    why = PathCores(case.search.structure.context, "").explained(
        path_problem, found, str(path_problem.cells)
    )
    if isinstance(why, ControlOutcome):
        return why
    core = why or PathCore(tuple(range(len(path_problem.cells))))
    cells = tuple(path_problem.cells[place] for place in core.places)
    known = CounterExample(0, cells, "", ordered=core.ordered)
    return (lambda path: known.meets(0, path)), len(cells)


def by_iis(_: Case, path_problem: PathProblem, found: Configuration) -> Explained:
    """A deletion filter over cells at positions, each at the middle of its stay."""
    ends = [*(entry - 1 for entry in found.entries[1:]), path_problem.task.steps]
    times = {
        p: (first + last) // 2
        for p, (first, last) in enumerate(zip(found.entries, ends, strict=True))
    }

    def fails(places: list[int]) -> bool:
        relaxation = PathRelaxation(path_problem, {p: times[p] for p in places}, apart=False)
        start = found.outcome.trajectory
        return not relaxation.outcome(start, found.entries, None, TRIAL).feasible

    kept = list(times)
    if fails(kept):
        for place in list(times):
            fewer = [each for each in kept if each != place]
            if fails(fewer):
                kept = fewer
    facts = [(place, path_problem.cells[place]) for place in kept]
    return (lambda path: all(p < len(path) and path[p] == c for p, c in facts)), len(facts)


def by_itself(_: Case, path_problem: PathProblem, __: Configuration) -> Explained:
    """The path and no other."""
    own = path_problem.cells
    return (lambda path: path == own), len(own)


LOOPS = {"cores": by_cores, "IIS": by_iis, "none": by_itself}


def loop(case: Case, explain: Callable[[Case, PathProblem, Configuration], Explained]) -> Tried:
    """Plans in their order, but for those deferred, until one has a motion."""
    tried, clauses, began = Tried(), list[Clause](), time.process_time()
    for plan in case.plans:
        (path,) = plan.paths
        if any(clause(path.cells) for clause in clauses):
            continue
        tried.paths += 1
        path_problem = case.search.posed(case.cells, plan)
        found = search_configuration(path_problem, "", RunContext())
        tried.found = found.outcome.feasible
        if not tried.found:
            why = explain(case, path_problem, found)
            if isinstance(why, ControlOutcome):
                tried.found = tried.by_explanation = True
            else:
                clause, size = why
                clauses.append(clause)
                tried.sizes.append(size)
                tried.shares.append(size / len(path.cells))
                tried.deferred.append(sum(clause(p.paths[0].cells) for p in case.plans))
        if tried.found or tried.paths == MOST_PATHS:
            break
    tried.seconds = time.process_time() - began
    return tried


def row(name: str, *cells: object) -> str:
    """A row of the table."""
    return f"{name:<8}" + "".join(f"{cell!s:>10}" for cell in cells)


def shown(name: str, results: list[Tried]) -> dict[str, Any]:
    """A line of the table, printed."""
    shares = [share for each in results for share in each.shares]
    deferred = [count for each in results for count in each.deferred]
    line = {
        "loop": name,
        "found": sum(each.found for each in results),
        "by explanation": sum(each.by_explanation for each in results),
        "paths": sum(each.paths for each in results),
        "median paths": median(each.paths for each in results),
        "counterexamples": len(shares),
        "few cells": sum(size <= FEW for each in results for size in each.sizes),
        "mean share": mean(shares) if shares else None,
        "mean deferred": mean(deferred) if deferred else None,
        "seconds": sum(each.seconds for each in results),
    }
    share = "" if line["mean share"] is None else f"{100 * line['mean share']:.0f} %"
    more = "" if line["mean deferred"] is None else f"{line['mean deferred']:.1f}"
    cells = [line["found"], line["by explanation"], line["paths"], line["median paths"]]
    print(row(name, *cells, len(shares), line["few cells"], share, more, f"{line['seconds']:.1f}"))
    return line


def seeds(count: int) -> Iterator[int]:
    """Those of tasks whose first plan has no motion at once, and that some plan is for."""
    seed, chosen = 0, 0
    while chosen < count:
        case = Case.of(seed)
        if case.plans:
            found = search_configuration(
                case.search.posed(case.cells, case.plans[0]), "", RunContext()
            )
            if not found.outcome.feasible:
                chosen += 1
                yield seed
        seed += 1


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=40)
    parser.add_argument("--json", type=Path)
    options = parser.parse_args()
    print(machine())
    np.seterr(all="ignore")
    chosen = list(seeds(options.tasks))
    results = {name: list[Tried]() for name in LOOPS}
    for seed in chosen:
        case = Case.of(seed)
        for name, explain in LOOPS.items():
            results[name].append(loop(case, explain))
    print(f"{len(chosen)} tasks whose first path has no motion, at most {MOST_PATHS} paths each")
    print(
        row(
            "loop",
            "found",
            "explained",
            "paths",
            "median",
            "clauses",
            "few",
            "cells",
            "deferred",
            "s",
        )
    )
    lines = [shown(name, each) for name, each in results.items()]
    if options.json:
        content = {"tasks": chosen, "loops": lines}
        options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

"""Algorithm 1 as the paper prints it, on the case study, with srgc's planner and control synthesis.

For each structure: a path by SAT (P.Planning), the best parameters by GP-ACB (P.Synthesis), and
where that is negative a counterexample, which excludes paths; the next structure (S.Synthesis) once
no path is left.  There is no proof in it: that is what srgc's own loop adds.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from search_methods import COMPARED
from search_runs import searched
from timing import SPEC

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.words.structures import derivations_of
from compiler.workspaces.abstraction import Abstraction, abstract
from grammar_lang.load import load
from paper.kept_records import digest, kept
from solvers.parameters.parameter_search import parameter_space
from solvers.planner import CounterExample, Planner
from solvers.run_context import RunContext
from solvers.search.configuration_search import Configuration
from solvers.search.evaluation import evaluate
from solvers.search.path_cores import PathCore, PathCores
from solvers.search.path_task import PathTask
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.verdict import Holds

STRUCTURES = ("B eps JO eps L eps EN", "B eps JO eps L eps JO eps L eps EN")
"""Those of the paper's case study: one link, and after that two."""


@dataclass(frozen=True)
class Step:
    """A round of the loop: a structure, a path, its best robustness, and what that leads to.

    ``core`` names the cells of the counterexample, in turn where it is ``ordered``; an empty one
    stands for every path; None: the robustness is not negative.  ``explained``: what looked for a
    counterexample, with the lengths as unknowns, found a motion that GP-ACB had not.
    """

    word: str
    path: tuple[str, ...]
    lengths: tuple[float, ...]
    robustness: float
    core: tuple[str, ...] | None
    ordered: bool
    explained: bool


def paper_steps(folder: Path, evaluations: int) -> list[Step]:
    """The rounds of the loop, kept in the folder; so many evaluations for each path."""
    records = kept(
        folder / "algorithm-1.json",
        {"spec": digest("planar_arm"), "evaluations": evaluations},
        lambda: [asdict(step) for step in _loop(evaluations)],
    )
    return [
        Step(
            each["word"],
            tuple(each["path"]),
            tuple(each["lengths"]),
            each["robustness"],
            None if each["core"] is None else tuple(each["core"]),
            each["ordered"],
            each["explained"],
        )
        for each in records
    ]


def _loop(evaluations: int) -> list[Step]:
    program = load(SPEC).program
    assert program is not None
    (task,) = program.tasks.values()
    family = family_of(program, task)
    cells = abstract(program.workspaces[task.workspace])
    steps = list[Step]()
    for name in STRUCTURES:
        derivation = next(iter(derivations_of(family.language, name.split())))
        numeric = NumericRobot(robot_graph(family.robot(derivation), task.gravity))
        place = PathTask(program, task, numeric, None, 0)
        planner = Planner(planning_problem(cells, task, 0, None))
        while isinstance(answer := planner.next_plan(), Holds):
            path = answer.witness.paths[0].cells
            step = _round(name, place.path_problem(cells, 0, 0, path), cells, evaluations)
            steps.append(step)
            if step.core is None:
                return steps
            core = tuple(map(cells.index, step.core))
            planner.block(CounterExample(0, core, "", ordered=step.ordered))
    return steps


def _round(name: str, problem: PathProblem, cells: Abstraction, evaluations: int) -> Step:
    """P.Synthesis along a path; the counterexample where the best robustness is negative."""
    best = _best(problem, evaluations)
    names = tuple(cells.cells[cell].name for cell in problem.cells)
    core, ordered, explained = None, True, False
    if not best.feasible:
        found = Configuration(best, problem.waypoints()[1], problem.cells)
        why = PathCores(RunContext(), name).explained(problem, found, name)
        if isinstance(why, ControlOutcome):
            best, explained = why, True
        else:
            known = PathCore(tuple(range(len(names)))) if why is None else why
            core, ordered = tuple(names[place] for place in known.places), known.ordered
    lengths = tuple(map(float, best.trajectory.theta))
    return Step(name, names, lengths, float(best.robustness), core, ordered, explained)


def _best(problem: PathProblem, evaluations: int) -> ControlOutcome:
    space = parameter_space(problem.model)
    outcomes = list[ControlOutcome]()

    def value(point: Array) -> float:
        with np.errstate(all="ignore"):
            outcomes.append(evaluate(problem, space.from_cube(point)))
        return outcomes[-1].robustness

    searched(COMPARED["gp-acb"](space.cube, 0), value, evaluations)
    return max(outcomes, key=lambda outcome: outcome.robustness)

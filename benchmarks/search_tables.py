"""Tables of the robustness of planar arms over their lengths, from evaluations as `synth` makes."""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from timing import SPEC, seconds

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.parameters.parameter_search import ParameterSpace, parameter_space
from solvers.planner import Planner
from solvers.search.evaluation import evaluate
from solvers.search.path_task import PathTask
from solvers.trajectory.path_following import PathProblem
from solvers.verdict import Holds


@dataclass(frozen=True)
class Arm:
    """The arm that is tabulated: a path of its cells to follow, and its lengths."""

    path_problem: PathProblem
    space: ParameterSpace


@cache
def arm(links: int) -> Arm:
    """The arm of so many links in the case study, on the path that `srgc plan` finds."""
    program = load(SPEC).program
    assert program is not None
    (task,) = program.tasks.values()
    family = family_of(program, task)
    model = family.robot(family.replay(("tool", *("link", "joint") * links, "base")))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    cells = abstract(program.workspaces[task.workspace])
    planned = Planner(planning_problem(cells, task, 0, None)).next_plan()
    if not isinstance(planned, Holds):
        raise SystemExit("the planner has no path")
    path = planned.witness.paths[0].cells
    path_problem = PathTask(program, task, numeric, None, 0).path_problem(cells, 0, 0, path)
    return Arm(path_problem, parameter_space(model))


def robustness(links: int, point: Array) -> float:
    """The robustness at a point of the unit cube, or minus the violation."""
    chosen = arm(links)
    return evaluate(chosen.path_problem, chosen.space.from_cube(point)).robustness


def table(links: int, side: int, folder: Path) -> Array:
    """The table with so many lengths per link, read from the folder or made and kept there."""
    digest = hashlib.sha256(SPEC.read_bytes()).hexdigest()[:12]
    path = folder / f"robustness-{links}-links-{side}-{digest}.csv"
    nodes = np.stack(np.meshgrid(*[np.linspace(0, 1, side)] * links, indexing="ij"), axis=-1)
    nodes = nodes.reshape(-1, links)
    if not path.exists():
        found: list[float] = []
        took = seconds(lambda: found.extend(robustness(links, node) for node in nodes))
        folder.mkdir(parents=True, exist_ok=True)
        thetas = [arm(links).space.from_cube(node) for node in nodes]
        names = ",".join(f"length{i + 1}" for i in range(links)) + ",robustness"
        columns = np.column_stack([thetas, found])
        np.savetxt(path, columns, "%.17g", delimiter=",", header=names, comments="")
        print(f"{path}: {len(nodes)} evaluations, {took / len(nodes):.3f} s each", file=sys.stderr)
    values = np.loadtxt(path, delimiter=",", skiprows=1)[:, -1]
    if len(values) != len(nodes):
        raise SystemExit(f"{path}: not a table of {len(nodes)} evaluations")
    return np.asarray(values.reshape((side,) * links))

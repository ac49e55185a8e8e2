"""Control problems that solvers are compared on: arms, lengths, a path of cells, a grid of time.

Half-planes that a solver may choose afresh at every step are fixed once, so that everybody has the
same constraints.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.words.structures import derivations_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load_text
from solvers.planner import Planner
from solvers.search.evaluation import hopeful
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import ControlOutcome, ControlProblem
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.task_size import LEAST_MARGIN
from solvers.trajectory.trajectory import Trajectory
from solvers.verdict import Holds
from srgc.session import check_loaded

SPEC = Path(__file__).resolve().parents[1] / "specs" / "planar_arm.srg"
DURATION = Fraction(81, 8)
"""Seconds; the case study's 81 steps of 0.125 s, however many steps there are."""
STEPS = 81
QUARTER_TURN = """workspace Bench {
  plane xy;
  bounds box [0, 5] x [0, 5] m;
  region S box [3.7, 4.3] x [0.6, 1.1] m;
  obstacle O box [0, 2] x [0, 2] m;
  target T box [0.6, 1.1] x [3.7, 4.3] m;
}
"""
"""A quarter of a circle about the base: what an arm of any number of links can do, one included."""
REACH = 4.0
"""The length of the arm of one link there, in metres."""


@dataclass(frozen=True)
class Case:
    """A path problem with its timing, the parameters of its robot and a seed there."""

    path_problem: PathProblem
    theta: Array
    seed: Trajectory
    entries: Entries

    @property
    def name(self) -> str:
        """The number of links and of steps."""
        return f"{len(self.theta)} links, {len(self.seed.u)} steps"

    @property
    def problem(self) -> ControlProblem:
        """Our own problem: half-planes refreshed about every reference."""
        return self.path_problem.problem(self.entries)


@cache
def path_problem(links: int, steps: int = STEPS, *, turning: bool = False) -> PathProblem:
    """An arm of so many links in the case study's task, the time divided into so many steps.

    ``turning``: the workspace is that of the quarter turn.
    """
    text = SPEC.read_text(encoding="utf-8")
    if turning:
        text = re.sub(r"workspace Bench \{.*?\n\}\n", QUARTER_TURN, text, flags=re.DOTALL)
    program = check_loaded(load_text(text, SPEC.name)).program
    if program is None:
        raise SystemExit(f"{SPEC.name} has errors")
    task = replace(next(iter(program.tasks.values())), steps=STEPS)
    place = program.workspaces[task.workspace]
    cells = abstract(place)
    found = Planner(planning_problem(cells, task, 0)).next_plan()
    if not isinstance(found, Holds):
        raise SystemExit("there is no path")
    family = family_of(program, task)
    word = ("B", "eps", "JO", "eps", "L", *("eps", "JO", "eps", "L") * (links - 1), "eps", "EN")
    model = family.robot(next(iter(derivations_of(family.language, word))))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    task = replace(task, steps=steps, step=DURATION / steps)
    path = found.witness.paths[0].cells
    return PathProblem(numeric, place, task, cells, 0, path, LEAST_MARGIN, 0)


def case(lengths: Sequence[float], steps: int = STEPS, *, turning: bool = False) -> Case:
    """An arm with given lengths in metres, and the first hopeful seed there."""
    found = path_problem(len(lengths), steps, turning=turning)
    theta, entries = np.array(lengths, dtype=np.float64), found.waypoints()[1]
    seed = hopeful(found.problem(entries), found.seeds(theta))[0]
    return Case(found, theta, seed, entries)


def quarter_turn(links: int, steps: int = STEPS) -> Case:
    """An arm of equal links, somewhat longer than the circle where it can bend."""
    length = REACH if links == 1 else 1.2 * REACH / links
    return case([length] * links, steps, turning=True)


def fixed(problem: ControlProblem, outcome: ControlOutcome) -> ControlProblem:
    """The problem with the half-planes that belong to an outcome, whatever the reference."""
    trajectory = outcome.trajectory
    points = problem.numeric.points(trajectory.x[:, : problem.numeric.n], trajectory.theta)
    rows = problem.rows(trajectory, points)

    def same(*_: Array) -> PositionRows:
        return rows

    return replace(problem, rows_of=same)


def shared_problem(one: Case) -> tuple[ControlProblem, PositionRows, ControlOutcome]:
    """The problem that all solvers get, its half-planes, and the outcome they come from."""
    outcome = synthesise_control(one.problem, one.seed)
    if not outcome.feasible:
        raise SystemExit(f"our own control synthesis failed: {outcome.ending}")
    problem = fixed(one.problem, outcome)
    return problem, problem.rows_of(np.zeros(0), np.zeros(0)), outcome

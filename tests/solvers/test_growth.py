"""How small deviations grow along a motion, against the solutions of linear robots."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.words.structures import structures
from compiler.workspaces.abstraction import abstract
from solvers.trajectory.fine_motion import growth
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory
from tests.oracles.formulas import program
from tests.oracles.small_specs import SLIDER, TURNER, replaced

HORIZON = 2.0


def problem(text: str, modules: int) -> PathProblem:
    found = program(text)
    (task,) = found.tasks.values()
    workspace, family = found.workspaces[task.workspace], family_of(found, task)
    model = family.robot(next(iter(structures(family.language, modules))))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    given = PathProblem(numeric, workspace, task, abstract(workspace), 0, (0,), 1e-3, 0)
    return replace(given, substeps=16)


def resting(given: PathProblem, theta: list[float]) -> Trajectory:
    k, numeric = given.task.steps, given.numeric
    x = np.zeros((k + 1, numeric.size))
    return Trajectory(x, np.zeros((k, numeric.m)), np.array(theta))


def test_a_mass_that_nothing_holds_drifts() -> None:
    given = problem(SLIDER, 4)
    assert growth(given, resting(given, [])) == pytest.approx(1 + HORIZON, rel=1e-12)


def test_an_upright_link_falls() -> None:
    text = replaced(TURNER, "contains EN and starts with B eps JO", "matches B eps JO eps L eps EN")
    text = replaced(text, "reach T;", "reach T; gravity (-9.81, 0) m/s^2;")
    given, length = problem(text, 4), 1.3
    rate = np.sqrt(9.81 / (2 * length / 3))
    fallen, falling = np.cosh(rate * HORIZON), np.sinh(rate * HORIZON)
    due = fallen + max(falling / rate, falling * rate)
    assert growth(given, resting(given, [length])) == pytest.approx(due, rel=1e-5)

"""Cells of two effectors on one joint, against their circles: angles differ by 2 atan(0.2)."""

from __future__ import annotations

from dataclasses import replace
from math import atan, cos, sin, sqrt

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import PlanningProblem, planning_problem
from compiler.tasks.word_formula import Literal, every, some, throughout
from compiler.workspaces.abstraction import Abstraction, abstract
from grammar_lang.load import load_text
from solvers.search.sampled_cells import together
from tests.srgc.test_formula_tasks import FORK

BETWEEN = 2 * atan(0.2)


def posed_in(text: str) -> tuple[PlanningProblem, Abstraction, NumericRobot]:
    program = load_text(text, "fork.srg").program
    assert program is not None
    task = program.tasks["T"]
    cells, family = abstract(program.workspaces["W"]), family_of(program, task)
    numeric = NumericRobot(robot_graph(family.robot(family.replay(("whole",))), task.gravity))
    return planning_problem(cells, task, 0), cells, numeric


@pytest.fixture(scope="module")
def posed() -> tuple[PlanningProblem, Abstraction, NumericRobot]:
    return posed_in(FORK)


def passed(cells: Abstraction, angles: np.ndarray) -> set[int]:
    """The cells that contain tips at angles."""
    found = set[int]()
    for angle in angles:
        cell = cells.locate(sqrt(1.04) * np.array([cos(angle), sin(angle)]))
        if cell is not None:
            found.add(cell)
    return found


def beside(cells: Abstraction, some: set[int]) -> set[int]:
    return some.union(*(cells.neighbours[cell] for cell in some))


def test_the_second_one_starts_next_to_where_the_first_allows_it(
    posed: tuple[PlanningProblem, Abstraction, NumericRobot],
) -> None:
    problem, cells, numeric = posed
    every = np.linspace(-2.9, 2.9, 20001)
    home = cells.index("Home")
    first = [a for a in every if cells.locate(sqrt(1.04) * np.array([cos(a), sin(a)])) == home]
    own = passed(cells, np.array(first) - BETWEEN)
    assert own
    one, other = together(problem, numeric, cells, 0).effectors
    assert one.start == (home,)
    assert own <= set(other.start) <= beside(cells, passed_near(cells, every, home))
    assert cells.index("B.1") not in other.start


def passed_near(cells: Abstraction, every: np.ndarray, home: int) -> set[int]:
    """The cells of the second tip while the first is in a cell or next to it."""
    near = beside(cells, {home})
    angles = [a for a in every if passed(cells, np.array([a])) <= near and passed(cells, [a])]
    return passed(cells, np.array(angles) - BETWEEN)


def test_regions_in_which_two_effectors_are_never_at_once(
    posed: tuple[PlanningProblem, Abstraction, NumericRobot],
) -> None:
    """The first is in A up to 49 degrees, and the second in B from 61 degrees on."""
    problem, cells, numeric = posed
    away = [Literal("A", 1, positive=False), Literal("B", 2, positive=False)]
    found = together(problem, numeric, cells, 0)
    assert problem.formula is not None
    assert found.formula == every([problem.formula, throughout(some(away), 0, None)])


def test_regions_in_which_they_can_be_at_once() -> None:
    """With the first in the middle of A the second is at 30 degrees, in D."""
    text = FORK.replace("last[0.2 s] B by", "last[0.2 s] D by").replace(
        "  region B", "  region D box [0.8, 1] x [0.4, 0.6] m; region B"
    )
    problem, cells, numeric = posed_in(text.replace("not B by effector 2 until ", ""))
    assert together(problem, numeric, cells, 0).formula == problem.formula


def test_one_effector_alone_is_left_as_it_is(
    posed: tuple[PlanningProblem, Abstraction, NumericRobot],
) -> None:
    problem, cells, numeric = posed
    alone = replace(problem, effectors=problem.effectors[:1])
    assert together(alone, numeric, cells, 0) is alone

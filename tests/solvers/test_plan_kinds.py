"""Kinds of plans, against winding numbers; and ways round an obstacle on its other side."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from compiler.tasks.specification import planning_problem
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.planner import CounterExample, Planner
from solvers.search.plan_kinds import crossings, kind_of, obstacle_points, other_kinds
from solvers.verdict import Holds

SPEC = Path(__file__).parents[2] / "specs" / "planar_arm.srg"


def turns(line: np.ndarray, point: np.ndarray) -> int:
    """The winding number of a closed line about a point, by its angles."""
    ways = line - point
    angles = np.unwrap(np.arctan2(ways[:, 1], ways[:, 0]))
    return round(float(angles[-1] - angles[0]) / (2 * np.pi))


@pytest.mark.parametrize("seed", range(200))
def test_letters_add_up_to_winding_numbers(seed: int) -> None:
    """A ray upwards is crossed leftwards once for every turn about its point."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-1, 1, (9, 2))
    fine = np.concatenate([corners, corners[:1]])
    points = rng.uniform(-0.7, 0.7, (3, 2))
    word = crossings(fine, points)
    dense = np.concatenate(
        [a + np.linspace(0, 1, 400)[:, None] * (b - a) for a, b in pairwise(fine)]
    )
    for index, point in enumerate(points, 1):
        count = sum((letter < 0) - (letter > 0) for letter in word if abs(letter) == index)
        assert count == turns(dense, point)


def test_a_way_and_back_is_no_way() -> None:
    there = np.array([[-1.0, 1.0], [1.0, 1.0]])
    assert crossings(there, np.zeros((1, 2))) == (1,)
    assert crossings(there[::-1], np.zeros((1, 2))) == (-1,)
    assert crossings(np.concatenate([there, there[:1]]), np.zeros((1, 2))) == ()
    assert crossings(there - [0.0, 2.0], np.zeros((1, 2))) == ()


def test_the_other_side_of_an_obstacle_is_another_kind() -> None:
    program = load(SPEC).program
    assert program is not None
    task = program.tasks["PickAndPlace"]
    workspace = program.workspaces[task.workspace]
    cells = abstract(workspace)
    points = obstacle_points(workspace, task)
    np.testing.assert_allclose(points, [[2.35, 2.5]])
    problem = planning_problem(cells, task, 0)
    answer = Planner(problem).next_plan()
    assert isinstance(answer, Holds)
    (other,) = other_kinds(problem, answer.witness, cells, points)
    sides = {kind_of(plan, cells, points): plan.paths[0].cells for plan in (answer.witness, other)}
    assert set(sides) == {((),), ((1,),)}
    assert sides[(),] != sides[(1,),]
    blocked = CounterExample(0, other.paths[0].cells[:2], "")
    kinds = other_kinds(problem, answer.witness, cells, points, [blocked])
    assert not any(blocked.meets(0, plan.paths[0].cells) for plan in kinds)

"""The seeds of a path problem in the case study, with the whole arm and with its effector only."""

from __future__ import annotations

from math import cos, sin
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
import shapely

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.trajectory.path_following import PathProblem

SPECS = Path(__file__).parents[2] / "specs"
OBSTACLE = shapely.box(1.7, 2, 3, 3)
WORD = ("tool", "link", "joint", "link", "joint", "base")


def path_problem(spec: str) -> PathProblem:
    program = load(SPECS / f"{spec}.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    workspace = program.workspaces[task.workspace]
    family = family_of(program, task)
    numeric = NumericRobot(robot_graph(family.robot(family.replay(WORD)), task.gravity))
    cells = abstract(workspace)
    graph = nx.Graph(
        (i, j)
        for i, near in enumerate(cells.neighbours)
        for j in near
        if not {"O"} & (cells.cells[i].propositions | cells.cells[j].propositions)
    )
    path = nx.shortest_path(graph, cells.index("S"), cells.index("T"))
    return PathProblem(numeric, workspace, task, cells, 0, tuple(path), 2e-3, 0)


def clearance(theta: tuple[float, float], q: np.ndarray) -> float:
    gaps = []
    for first, second in q:
        elbow = (theta[0] * cos(first), theta[0] * sin(first))
        angle = first + second
        tip = (elbow[0] + theta[1] * cos(angle), elbow[1] + theta[1] * sin(angle))
        gaps.append(shapely.LineString([(0, 0), elbow, tip]).distance(OBSTACLE))
    return min(gaps)


@pytest.mark.parametrize("theta", [(3.89, 2.92), (3.3, 4.0), (3.4, 2.9)])
def test_seeds_are_clear_where_there_are_such(theta: tuple[float, float]) -> None:
    seeds = path_problem("planar_arm_body").seeds(np.array(theta))
    assert seeds
    gaps = [clearance(theta, seed.x[:, :2]) for seed in seeds]
    assert min(gaps) > 0
    assert gaps == sorted(gaps, reverse=True) or len(gaps) == 1
    for seed in seeds:
        assert seed.x.shape == (82, 4)
        assert np.all(seed.x[0, 2:] == 0)


def test_where_no_pose_is_clear_something_is_left_to_measure() -> None:
    seeds = path_problem("planar_arm_body").seeds(np.array([2.23, 3.35]))
    assert 1 <= len(seeds) <= 2
    assert all(clearance((2.23, 3.35), seed.x[:, :2]) == 0 for seed in seeds)


def test_the_effector_alone_keeps_all_branches() -> None:
    own = path_problem("planar_arm")
    assert not own.binds_bodies
    starts = [seed.x[0, :2] for seed in own.seeds(np.array([2.23, 3.35]))]
    assert {float(np.sign(np.sin(elbow))) for _, elbow in starts} == {-1.0, 1.0}

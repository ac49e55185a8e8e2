"""What lemmas exclude, looked for: random poses of random words, and inverse kinematics."""

from __future__ import annotations

import random
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.candidate import candidates_of
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.tasks.necessary import stops
from grammar_lang import ir
from grammar_lang.load import load
from solvers.impossibility.distance_lemmas import distance_lemma
from solvers.lemma import DistanceLemma
from solvers.parameters.parameter_search import parameter_space

SPECS = Path(__file__).parents[2] / "specs"
NAMES = ["far_shelf", "endless_arm", "boom_crane", "planar_arm"]


def learnt(name: str) -> tuple[RobotFamily, ir.Task, DistanceLemma]:
    """The lemma that the first word of a family teaches."""
    program = load(SPECS / f"{name}.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    family = family_of(program, task)
    word = next(family.language.words())
    lemma = distance_lemma(family, task, word)
    assert lemma is not None
    return family, task, lemma


def robots(family: RobotFamily, lemma: DistanceLemma, count: int, seed: int) -> list[NumericRobot]:
    """Robots of random words of a lemma, some longer than any bound of a task."""
    accept = ir.AllOf((family.grammar.accept, lemma.condition))
    about = replace(family, grammar=replace(family.grammar, accept=accept))
    words = list(islice(about.language.words(max_modules=12), 4000))
    found: list[NumericRobot] = []
    choose = random.Random(seed)
    while len(found) < count:
        word = choose.choice(words)
        candidate = next(candidates_of(about, [word], None))
        if candidate.model is not None and candidate.model.effectors:
            found.append(NumericRobot(robot_graph(candidate.model, (0, 0, 0))))
    return found


def rows(family: RobotFamily, task: ir.Task, region: str) -> tuple[Array, Array]:
    """Unit normals and offsets of a region."""
    shape = family.program.workspaces[task.workspace].region(region).shape
    assert isinstance(shape, tuple) or hasattr(shape, "rows")
    half_spaces = shape if isinstance(shape, tuple) else shape.rows
    normals = np.array([[float(a) for a in row.normal] for row in half_spaces])
    offsets = np.array([float(row.offset) for row in half_spaces])
    length = np.linalg.norm(normals, axis=1)
    return normals / length[:, None], offsets / length


def limits(robot: NumericRobot) -> tuple[Array, Array]:
    """Ranges of the coordinates; of those without one a full turn."""
    low, high = [], []
    for dof in robot.graph.model.dofs:
        whole = dof.range is None
        low.append(-np.pi if whole else _number(dof.range.lower))
        high.append(np.pi if whole else _number(dof.range.upper))
    return np.array(low), np.array(high)


def _number(expression: ir.Expr) -> float:
    from compiler.expressions.evaluators.balls import closed_ball

    return float(closed_ball(expression).mid())


def excess(robot: NumericRobot, q: Array, theta: Array, region: tuple[Array, Array]) -> float:
    """By how much the nearest effector is outside of the region, in metres."""
    points = robot.points(q[None], theta).value[0][: len(robot.graph.model.effectors)]
    return float(np.min(np.max(points @ region[0].T - region[1], axis=1)))


def check(name: str, poses: int, restarts: int) -> None:
    family, task, lemma = learnt(name)
    assert lemma.region in {stop.region for stop in stops(family.program, task)}
    region = rows(family, task, lemma.region)
    rng = np.random.default_rng(1)
    some = robots(family, lemma, 20, 1)
    nearest = np.inf
    for robot in some:
        low, high = limits(robot)
        space = parameter_space(robot.graph.model)
        for _ in range(10):
            theta = space.drawn(rng)
            q = rng.uniform(low, high, size=(poses // 200, robot.n))
            count = len(robot.graph.model.effectors)
            points = robot.points(q, theta).value[:, :count]
            out = np.max(points @ region[0].T - region[1], axis=2)
            nearest = min(nearest, float(np.min(out)))
        for _ in range(restarts // 20):
            theta, start = space.drawn(rng), rng.uniform(low, high)
            if not len(start):
                continue
            found = least_squares(
                lambda q, r=robot, t=theta: np.maximum(  # type: ignore[misc]
                    r.points(q[None], t).value[0, 0] @ region[0].T - region[1], 0
                ),
                start,
                bounds=(low - 1e-9, high + 1e-9),
                max_nfev=60,
            )
            nearest = min(nearest, excess(robot, found.x, theta, region))
    assert nearest > 0, f"an effector is in `{lemma.region}`"


@pytest.mark.parametrize("name", NAMES)
def test_poses(name: str) -> None:
    check(name, 4_000, 40)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_hundred_thousand_poses(name: str) -> None:
    check(name, 100_000, 1_000)

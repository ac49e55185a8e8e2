"""Drives that seem able to do a task are not looked at closer: against a quintic by hand."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.words.structures import structures
from solvers.impossibility.drive_search import drives_seem_able
from solvers.impossibility.pose_search import PoseWitness
from tests.oracles.formulas import program
from tests.oracles.small_specs import SLIDER, replaced

HORIZON, WAY, PULL, MASS = 2.0, 1.8, 1.5, 1.3
STRONGEST = MASS * (10 / np.sqrt(3) * WAY / HORIZON**2 + PULL)
"""The force in N that moves the mass from rest to rest, against a pull."""
FASTEST = 15 / 8 * WAY / HORIZON
"""The greatest rate on the way, in m/s."""


def seems_able(
    force: float,
    rate: float = 2 * FASTEST,
    start: float | None = 0.3,
    by: tuple[Fraction | None, ...] = (None, None),
) -> bool:
    """Whether drives with these bounds seem able to do it; None: without a pose to start from."""
    text = replaced(SLIDER, "effort <= 10 N", f"effort <= {force:.4f} N")
    text = replaced(text, "reach T;", f"reach T; gravity (-{PULL}, 0) m/s^2;")
    text = replaced(text, "mass = 1 kg", f"mass = {MASS} kg")
    text = replaced(text, "in [0, 3] m", f"in [0, 3] m rate in [-{rate:.4f}, {rate:.4f}] m/s")
    found = program(text)
    (task,) = found.tasks.values()
    family = family_of(found, task)
    model = family.robot(next(iter(structures(family.language, 4))))
    assert model is not None
    numeric = NumericRobot(robot_graph(model, task.gravity))
    first = None if start is None else np.array([start])
    poses = PoseWitness(np.zeros(0), first, np.array([0.3 + WAY]), 0, 0)
    assert not drives_seem_able(numeric, task, [], [])
    assert not drives_seem_able(numeric, task, [poses, None], by)
    return drives_seem_able(numeric, task, [poses, poses], by)


@pytest.mark.parametrize(("share", "able"), [(1.001, True), (0.9, False)])
def test_forces_of_a_straight_motion(share: float, able: bool) -> None:
    assert seems_able(share * STRONGEST) is able
    assert seems_able(2 * STRONGEST, share * FASTEST) is able


@pytest.mark.parametrize(("share", "able"), [(1.001, True), (0.9, False)])
def test_a_deadline_leaves_less_time(share: float, able: bool) -> None:
    force = MASS * (10 / np.sqrt(3) * WAY / 1.2**2 + PULL)
    by = (None, Fraction(6, 5))
    assert seems_able(share * force, 5 * FASTEST, by=by) is able
    assert seems_able(share * force, 5 * FASTEST)


def test_a_robot_that_cannot_move_is_driven_nowhere() -> None:
    still = replaced(SLIDER, "matches B eps P eps M eps EN", "matches B eps M eps EN")
    found = program(still)
    (task,) = found.tasks.values()
    family = family_of(found, task)
    model = family.robot(next(iter(structures(family.language, 4))))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    assert not numeric.n
    none = np.zeros(0)
    assert not drives_seem_able(numeric, task, [PoseWitness(none, none, none, 0, 0)], [None])


def test_without_poses_nothing_seems_able() -> None:
    assert not seems_able(2 * STRONGEST, start=None)

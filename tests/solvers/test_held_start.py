"""Whether drives hold robots still in a pose, against statics by hand."""

from __future__ import annotations

from math import cos

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.held_start import holds_still
from solvers.trajectory.task_limits import input_groups
from tests.oracles.driven_chains import Segment, problem, robot_of

GRAVITY = "gravity (0, -9.81) m/s^2; horizon 10 steps of 0.1 s;"


def held(arm, efforts, q, rates=0.0):
    clauses = f"start at ({', '.join('0' for _ in q)}); reach T at rest; {efforts} {GRAVITY}"
    model, _, task = robot_of(problem(arm, "[0, 1] x [0, 1]", clauses))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    state = np.array([*q, *(rates for _ in q)])
    return holds_still(numeric, state, np.zeros(0), input_groups(model, task))


@pytest.mark.parametrize("rates", [0.0, 3.0])
def test_two_links_hold_their_weight(rates):
    """Rods of 0.8 m and 2 kg/m, and of 0.5 m and 1 kg/m; whatever the rates, it is about rest."""
    arm = [Segment(0.8, density=2.0), Segment(0.5, density=1.0)]
    q = (0.3, -0.9)
    elbow, last = 0.8 * cos(0.3), 0.5 * cos(-0.6)
    first = 9.81 * (1.6 * elbow / 2 + 0.5 * (elbow + last / 2))
    second = 9.81 * 0.5 * last / 2
    assert second < 0.2 * first
    for share, expected in ((0.999, False), (1.001, True)):
        assert held(arm, f"effort <= {share * first} N*m;", q, rates) is expected
        both = f"effort <= {share * np.hypot(first, second)} N*m norm 2;"
        assert held(arm, both, q, rates) is expected


def test_a_slide_and_a_joint():
    arm = [Segment(0.4, kind="prismatic", axis="y", limits="in [0, 1] m"), Segment(0.6)]
    weight, lever = 9.81 * 1.0, 9.81 * 0.6 * 0.3 * cos(0.5)
    for force, torque, expected in ((1.01, 1.01, True), (0.99, 1.01, False), (1.01, 0.99, False)):
        efforts = f"effort <= {force * weight} N; effort <= {torque * lever} N*m;"
        assert held(arm, efforts, (0.2, 0.5)) is expected


def test_what_nothing_drives_hangs_or_falls():
    arm = [Segment(0.5), Segment(0.5, own="torque(q) = 0 N*m;")]
    assert held(arm, "effort <= 100 N*m;", (0.0, -np.pi / 2))
    assert not held(arm, "effort <= 100 N*m;", (0.0, -1.4))


@pytest.mark.parametrize(("fixed", "held_up"), [(1, True), (-1, False)])
def test_a_fixed_input_bears_its_part(fixed, held_up):
    """At -0.2 rad a rod of 1 kg needs 4.807 N m; a bias of 1 N m helps a drive that has 4 N m."""
    own = f"input bias in [{fixed}, {fixed}] N*m; torque(q) = u + bias;"
    assert held([Segment(1, own=own)], "effort <= 4 N*m;", (-0.2,)) is held_up

"""The fastest timing of a way, against closed forms of bang-bang motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory import time_optimal
from solvers.trajectory.task_limits import input_groups, motion_limits
from solvers.trajectory.time_optimal import Timing, fastest_timing
from tests.oracles.bang_bang import swing_up
from tests.oracles.driven_chains import robot_of

MASS, FORCE, WAY, GRAVITY = 1.5, 20.0, 0.8, 9.81
LENGTH, DENSITY, TORQUE, ANGLE = 0.7, 2.0, 0.4, 1.1
INERTIA = DENSITY * LENGTH**3 / 3
PLACES = (time_optimal.PLACES, 8 * time_optimal.PLACES)
PARTS = (3e-3, 5e-4)
"""By what part a timing may be off, with so many places."""

SPEC = """
module Base {{ role base; }}
module Joint {{ role joint; dof q: {dof}; }}
module Tip {{ role effector; }}
edge e;
grammar One {{
  start S; base: S -> Base; joint: S -> S e Joint; tip: S -> S e Tip;
  accept matches Base e Joint e Tip;
}}
semantics One {{
  base {{ this.frame = world; }}
  joint {{ this.frame = S.frame * {moved}; {body} }}
  tip {{ this.frame = S.frame * {out}; effector(frame: this.frame); }}
}}
workspace W {{ plane xy; bounds box [-9, 9] x [-9, 9] m; region A box [-9, 9] x [-9, 9] m; }}
task Go {{
  robot One; workspace W; start in A at rest; reach A {end};
  effort <= {bound}; horizon at most 40 steps of 0.1 s; {clauses}
}}
"""


@dataclass(frozen=True, slots=True)
class Slide:
    """A mass on rails, along an axis."""

    axis: str = "x"
    limits: str = ""
    end: str = "at rest"
    clauses: str = ""

    @property
    def text(self) -> str:
        return SPEC.format(
            dof=f"prismatic {self.axis} in [-3, 3] m {self.limits}",
            moved=f"move({self.axis}, Joint.q)",
            body=f"point(frame: this.frame, mass: {MASS} kg);",
            out="move(x, 0 m)", end=self.end, bound=f"{FORCE} N", clauses=self.clauses,
        )  # fmt: skip


def arm(end: str = "at rest", clauses: str = "", limits: str = "") -> str:
    """A rod that turns about its end."""
    return SPEC.format(
        dof=f"revolute z in [-170, 170] deg {limits}", moved="rot(z, Joint.q)",
        body=f"rod(frame: this.frame, axis: x, length: {LENGTH} m, density: {DENSITY} kg/m);",
        out=f"move(x, {LENGTH} m)", end=end, bound=f"{TORQUE} N*m", clauses=clauses,
    )  # fmt: skip


def timing(text: str, motion: Sequence[float]) -> Timing | None:
    """The fastest timing of the robot of a spec along coordinates of its one joint."""
    model, _, task = robot_of(text)
    numeric = NumericRobot(robot_graph(model, task.gravity))
    limits, groups = motion_limits(model, task), input_groups(model, task)
    return fastest_timing(numeric, limits, groups, np.zeros(0), np.array(motion)[:, None])


def duration(text: str, first: float, last: float) -> float:
    found = timing(text, np.linspace(first, last, 12).tolist())
    assert found is not None
    np.testing.assert_allclose(found.way[[0, -1], 0], [first, last], atol=1e-12)
    assert np.all(np.diff(found.times) > 0)
    return found.duration


@pytest.fixture(params=list(zip(PLACES, PARTS, strict=True)), ids=lambda each: str(each[0]))
def part(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> float:
    """By what part a timing may be off, with as many places as there are now."""
    places, off = request.param
    monkeypatch.setattr(time_optimal, "PLACES", places)
    return float(off)


A = FORCE / MASS
UP, DOWN = A - GRAVITY, A + GRAVITY
FAST, GENTLE = 1.2, 4.0
CASES = {
    "rest to rest": (Slide(), 2 * sqrt(WAY / A)),
    "free end": (Slide(end=""), sqrt(2 * WAY / A)),
    "end with a rate": (
        Slide(end="rates <= 2 m/s"),
        # With v at the end, half of what the task says: up to sqrt(a d + v^2 / 2), then down to v.
        (2 * sqrt(A * WAY + 1 / 2) - 1) / A,
    ),
    "rate limit": (Slide(limits=f"rate in [-{FAST}, {FAST}] m/s"), WAY / FAST + FAST / A),
    "rate limit, free end": (
        Slide(limits=f"rate in [-9, {FAST}] m/s", end=""),
        WAY / FAST + FAST / (2 * A),
    ),
    "a rate limit that is not met": (Slide(limits="rate in [-9, 9] m/s"), 2 * sqrt(WAY / A)),
    "acceleration limit": (Slide(limits=f"accel <= {GENTLE} m/s^2"), 2 * sqrt(WAY / GENTLE)),
    "an acceleration limit that is not met": (
        Slide(limits="accel <= 90 m/s^2"),
        2 * sqrt(WAY / A),
    ),
    "rate and acceleration": (
        Slide(limits=f"rate in [-1, 1] m/s accel <= {GENTLE} m/s^2"),
        WAY + 1 / GENTLE,
    ),
    "upwards and downwards": (
        Slide(axis="y", clauses=f"gravity (0, -{GRAVITY}) m/s^2;"),
        sqrt(2 * WAY * (UP + DOWN) / (UP * DOWN)),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_a_slide(name: str, part: float) -> None:
    robot, closed = CASES[name]
    for first, last in ((0.0, WAY), (-1.3, WAY - 1.3)):
        assert duration(robot.text, first, last) == pytest.approx(closed, rel=part)
    if "free end" not in name:
        assert duration(robot.text, WAY, 0.0) == pytest.approx(closed, rel=part)


def test_gravity_helps_one_way(part: float) -> None:
    """With a free end: upwards against it, downwards with it."""
    robot = Slide(axis="y", end="", clauses=f"gravity (0, -{GRAVITY}) m/s^2;")
    assert duration(robot.text, 0.0, WAY) == pytest.approx(sqrt(2 * WAY / UP), rel=part)
    assert duration(robot.text, WAY, 0.0) == pytest.approx(sqrt(2 * WAY / DOWN), rel=part)


@pytest.mark.parametrize(("first", "last"), [(0.0, ANGLE), (2.0, 2.0 - ANGLE)])
def test_an_arm_that_turns_level(first: float, last: float, part: float) -> None:
    closed = 2 * sqrt(INERTIA * ANGLE / TORQUE)
    assert duration(arm(), first, last) == pytest.approx(closed, rel=part)
    free = sqrt(2 * INERTIA * ANGLE / TORQUE)
    assert duration(arm(end=""), first, last) == pytest.approx(free, rel=part)
    slow = arm(limits="rate in [-0.9, 0.9] rad/s")
    saturated = ANGLE / 0.9 + 0.9 * INERTIA / TORQUE
    assert duration(slow, first, last) == pytest.approx(saturated, rel=part)


def test_a_pendulum(part: float) -> None:
    """Against the bang-bang motion along the same way, integrated by SciPy."""
    weight = DENSITY * LENGTH**2 / 2 * GRAVITY
    torque, hangs = 1.6 * weight, -np.pi / 2
    text = arm(clauses=f"gravity (0, -{GRAVITY}) m/s^2;")
    text = text.replace(f"effort <= {TORQUE} N*m", f"effort <= {torque} N*m")
    closed = swing_up(torque, weight, INERTIA, ANGLE)
    assert duration(text, hangs, hangs + ANGLE) == pytest.approx(closed, rel=part)


def test_the_way_alone_counts() -> None:
    """Not how a motion goes along it, nor where it waits."""
    even = timing(Slide().text, np.linspace(0, WAY, 40).tolist())
    uneven = timing(Slide().text, [0, 0, 0.1, 0.1, 0.1, 0.15, 0.7, WAY, WAY])
    assert even is not None
    assert uneven is not None
    np.testing.assert_allclose(even.times, uneven.times, rtol=1e-9)
    assert timing(Slide().text, [0.3, 0.3, 0.3]) is None


def test_samples_of_a_timing() -> None:
    """Of the closed form: half the way at half the time, an eighth at a quarter."""
    found = timing(Slide().text, np.linspace(0, WAY, 40).tolist())
    assert found is not None
    q = found.sampled(4)[:, 0]
    np.testing.assert_allclose(q, WAY * np.array([0, 1 / 8, 1 / 2, 7 / 8, 1]), atol=2e-3)


GANTRY = """
module Base { role base; }
module Along { role joint; dof q: prismatic x in [-3, 3] m accel <= FIRST m/s^2; }
module Across { role joint; dof q: prismatic y in [-3, 3] m accel <= LAST m/s^2; }
module Tip { role effector; }
edge e;
grammar Both {
  start S; base: S -> Base; along: S -> S e Along; across: S -> S e Across; tip: S -> S e Tip;
  accept matches Base e Along e Across e Tip;
}
semantics Both {
  base { this.frame = world; }
  along { this.frame = S.frame * move(x, Along.q); point(frame: this.frame, mass: 1 kg); }
  across { this.frame = S.frame * move(y, Across.q); point(frame: this.frame, mass: 1 kg); }
  tip { this.frame = S.frame; effector(frame: this.frame); }
}
workspace W { plane xy; bounds box [-9, 9] x [-9, 9] m; region A box [-9, 9] x [-9, 9] m; }
task Go {
  robot Both; workspace W; start in A at rest; reach A at rest;
  effort <= 1000 N; horizon at most 40 steps of 0.1 s;
}
"""


@pytest.mark.parametrize(("first", "last"), [(1, 4), (4, 1), (2, 2)])
def test_each_joint_keeps_its_own_bound_on_accelerations(
    first: float, last: float, part: float
) -> None:
    """Both axes move by WAY, so the slower one decides: it speeds up and brakes at its bound."""
    model, _, task = robot_of(GANTRY.replace("FIRST", str(first)).replace("LAST", str(last)))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    limits, groups = motion_limits(model, task), input_groups(model, task)
    way = np.linspace((0, 0), (WAY, -WAY), 12)
    found = fastest_timing(numeric, limits, groups, np.zeros(0), way)
    assert found is not None
    assert found.duration == pytest.approx(2 * sqrt(WAY / min(first, last)), rel=part)

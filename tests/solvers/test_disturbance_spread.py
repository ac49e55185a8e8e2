"""The room that a search leaves for disturbed motions, against a closed form and differences."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from grammar_lang import ir
from solvers.trajectory.disturbance_spread import DisturbanceSpread, disturbance_spread
from solvers.trajectory.trajectory import Trajectory
from tests.solvers.test_disturbed_proof import SLIDE, TWO, scene, spec

SUBSTEPS = 8


def moved(labels: Sequence[str], disturbances: str, start: Array, u: Array):
    where = scene(labels, spec(len(u), disturbances))
    numeric = NumericRobot(robot_graph(where.model, where.task.gravity))
    theta = np.zeros(0)
    x = numeric.simulate(start, u, theta, float(where.task.step), SUBSTEPS)
    return where, numeric, Trajectory(x, u, theta)


def spread_of(
    numeric: NumericRobot, task: ir.Task, motion: Trajectory, gains: Array | None = None
) -> DisturbanceSpread:
    steps = numeric.step(motion.x[:-1], motion.u, motion.theta, float(task.step), SUBSTEPS)
    return disturbance_spread(numeric, task, motion, steps, gains)


def test_a_slide_against_its_closed_form() -> None:
    """1.5 kg: x = x0 + v0 t + the double integral of u / m, each disturbance at its end."""
    u = np.array([[3.0], [-2.0], [0.5], [4.0], [-1.0], [-4.0]])
    radii = "robust start 3 cm; robust start 2 cm/s; robust effort 4 %;"
    where, numeric, motion = moved(SLIDE, radii, np.array([0.2, 0.5]), u)
    found = spread_of(numeric, where.task, motion)
    h, pushed = 0.1, 0.04 * np.abs(u[:, 0]) / 1.5
    places, rates = [], []
    for sample in range(7):
        ages = h * (sample - np.arange(sample))
        rates.append(0.02 + np.sum(pushed[:sample] * h))
        places.append(
            0.03 + 0.02 * h * sample + np.sum(pushed[:sample] * (ages**2 - (ages - h) ** 2) / 2)
        )
    np.testing.assert_allclose(found.points[:, 0], places, rtol=1e-9)
    np.testing.assert_allclose(found.states[:, 0], np.transpose([places, rates]), rtol=1e-9)
    # What grows is largest at the end of the step that begins at a sample.
    later = np.transpose([[*places[1:], places[-1]], [*rates[1:], rates[-1]]])
    np.testing.assert_allclose(found.within_steps[:, 0], later, rtol=1e-9)
    assert found.widest == pytest.approx(places[-1])
    np.testing.assert_allclose(found.scaled(2.5).points, 2.5 * found.points)


def test_two_links_against_differences() -> None:
    """Each disturbance alone, by central differences of whole simulations; then all together."""
    rng = np.random.default_rng(5)
    u = rng.uniform(-2, 2, (8, 2))
    radii = "robust start 0.3 deg; robust start 0.2 deg/s; robust effort 1 %;"
    start = np.array([0.4, -1.1, 0.3, 0.7])
    where, numeric, motion = moved(TWO, radii, start, u)
    angle, rate = np.deg2rad(0.3), np.deg2rad(0.2)
    step, small = float(where.task.step), 1e-3

    def simulated(start: Array, u: Array) -> tuple[Array, Array]:
        x = numeric.simulate(start, u, motion.theta, step, SUBSTEPS)
        return x, numeric.points(x[:, :2], motion.theta).value

    states, places = (np.zeros_like(each) for each in simulated(start, u))
    for number in range(4 + u.size):
        shift, more = np.zeros(4), np.zeros(u.size)
        if number < 4:
            shift[number] = small * (angle, angle, rate, rate)[number]
        else:
            more[number - 4] = small * 0.01 * abs(u.ravel()[number - 4])
        one, other = (
            simulated(start + sign * shift, u + sign * more.reshape(u.shape)) for sign in (1, -1)
        )
        states += np.abs(one[0] - other[0]) / (2 * small)
        places += np.abs(one[1] - other[1]) / (2 * small)
    found = spread_of(numeric, where.task, motion)
    np.testing.assert_allclose(found.points, np.linalg.norm(places, axis=2), rtol=1e-5)
    np.testing.assert_allclose(found.states[:, :, 0], states[:, :2], rtol=1e-5)
    np.testing.assert_allclose(found.states[:, :, 1], states[:, 2:], rtol=1e-5)


def test_what_feedback_commands_at_each_sample_against_differences() -> None:
    """Errors of the start and of each measurement alone, by differences of whole closed loops."""
    rng = np.random.default_rng(7)
    u, start = rng.uniform(-2, 2, (6, 2)), np.array([0.4, -1.1, 0.3, 0.7])
    radii = "robust start 0.3 deg, 0.2 deg/s; robust measure 0.1 deg, 0.4 deg/s;"
    where, numeric, motion = moved(TWO, radii, start, u)
    gains = rng.uniform(-3, 3, (6, 2, 4))
    step, small = float(where.task.step), 1e-3
    sizes, noise = (
        np.deg2rad([angle, angle, rate, rate]) for angle, rate in ((0.3, 0.2), (0.1, 0.4))
    )

    def closed(shift: Array, misread: Array) -> tuple[Array, Array]:
        x, inputs = [start + shift], []
        for k, planned in enumerate(u):
            inputs.append(planned - gains[k] @ (x[-1] + misread[k] - motion.x[k]))
            x.append(numeric.simulate(x[-1], inputs[-1][None], motion.theta, step, SUBSTEPS)[1])
        return np.array(x), np.array(inputs)

    states, inputs = np.zeros((7, 4)), np.zeros((6, 2))
    errors = np.concatenate([np.diag(sizes), np.zeros((24, 4))])
    noises = np.zeros((28, 6, 4))
    noises[4:] = np.diag(np.tile(noise, 6)).reshape(24, 6, 4)
    for error, misread in zip(small * errors, small * noises, strict=True):
        one, other = closed(error, misread), closed(-error, -misread)
        states += np.abs(one[0] - other[0]) / (2 * small)
        inputs += np.abs(one[1] - other[1]) / (2 * small)
    found = spread_of(numeric, where.task, motion, gains)
    np.testing.assert_allclose(found.states[:, :, 0], states[:, :2], rtol=1e-5)
    np.testing.assert_allclose(found.states[:, :, 1], states[:, 2:], rtol=1e-5)
    np.testing.assert_allclose(found.inputs, inputs, rtol=1e-5)
    assert found.size == pytest.approx(max(found.widest, float(np.max(states[:, :2]))), rel=1e-5)


def test_without_disturbances_there_is_none() -> None:
    u = np.ones((3, 1))
    where, numeric, motion = moved(SLIDE, "robust effort 1 %;", np.array([0.2, 0.5]), u)
    still = Trajectory(motion.x, np.zeros_like(u), motion.theta)
    assert spread_of(numeric, where.task, still).widest == 0
    assert where.task.robust is not None
    assert where.task.robust.effort == Fraction(1, 100)


@pytest.mark.parametrize(("clause", "samples"), [("", 1), ("rates <= 1 for 0.25 s", 4)])
def test_final_rates_spread_as_the_last_samples_say(clause: str, samples: int) -> None:
    """A slide whose drive is off by 4 % keeps its rate off by what has added up."""
    u = np.array([[3.0], [-2.0], [0.5], [4.0], [-1.0], [-4.0]])
    text = spec(6, "robust start 2 cm/s; robust effort 4 %;", clauses=f"reach End {clause};")
    where = scene(SLIDE, text)
    numeric = NumericRobot(robot_graph(where.model, where.task.gravity))
    x = numeric.simulate(np.array([0.2, 0.5]), u, np.zeros(0), 0.1, SUBSTEPS)
    # Feedback of the rate alone, so that errors fade.
    gains = np.tile([[0.0, 9.0]], (6, 1, 1))
    found = spread_of(numeric, where.task, Trajectory(x, u, np.zeros(0)), gains)
    rates = [0.02]
    for push in u[:, 0]:
        kept = 1 - 9 * 0.1 / 1.5
        rates.append(kept * rates[-1] + 0.1 * 0.04 * (abs(push) + 9 * rates[-1]) / 1.5)
    assert found.final == pytest.approx(max(rates[-samples:]), rel=0.05)
    assert found.scaled(3).final == pytest.approx(3 * found.final)

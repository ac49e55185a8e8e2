"""What a motion violates between its samples, against scipy's integrator and plain distances."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.simulated_motion import (
    INSTANTS,
    SimulatedMotion,
    clear_violations,
    simulated_motion,
)
from solvers.verifier.proofs.checked_condition import CheckedCondition, decisive
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.scene import Watch
from solvers.verifier.proofs.trajectory_proof import Motion, Scene, prove_motion
from solvers.verifier.proofs.tube_checks import Status
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.some_cases import some as chosen
from tests.solvers.test_disturbed_proof import ONE, TWO, scene, spec, tips

F = Fraction
STEPS, STEP = 8, 0.1
CLAUSES = "reach End rates <= 0.4 rad/s; avoid Post with effector, margin 10 cm;"
END = ((-1.0, 1.9), (-1.0, 1.6))


def where(clauses: str = CLAUSES, disturbances: str = "") -> Scene:
    return scene(TWO, spec(STEPS, disturbances, "box [-1, 1.9] x [-1, 1.6]", clauses))


def robot(here: Scene) -> NumericRobot:
    return NumericRobot(robot_graph(here.model, here.task.gravity))


def simulated(here: Scene, motion: Motion) -> SimulatedMotion:
    found = simulated_motion(robot(here), motion, STEP, 2)
    assert found is not None
    return found


def random_motion(seed: int, *, closed: bool) -> Motion:
    rng = np.random.default_rng(seed)

    def some(shape: tuple[int, ...], size: int) -> list[Fraction]:
        return [F(int(x), 100) for x in rng.integers(-size, size + 1, shape).ravel()]

    start = tuple(
        a + b for a, b in zip((F(1, 5), F(7, 10), F(0), F(0)), some((4,), 105), strict=True)
    )
    pulls = some((STEPS, 2), 400)
    inputs = tuple(zip(pulls[::2], pulls[1::2], strict=True))
    path = (("free",) * (STEPS + 1),)
    if not closed:
        return Motion((), start, inputs, 0, path)
    about, gains = some((STEPS, 4), 100), some((STEPS, 2, 4), 300)
    reference = tuple(tuple(about[4 * k : 4 * k + 4]) for k in range(STEPS))
    rows = [tuple(gains[4 * i : 4 * i + 4]) for i in range(2 * STEPS)]
    law = ControlLaw(reference, tuple(zip(rows[::2], rows[1::2], strict=True)))
    return Motion((), start, inputs, 0, path, law)


def integrated(motion: Motion, per_step: int) -> tuple[Array, Array]:
    """States at the instants and what is commanded, by Dormand and Prince's method of order 8."""
    lengths = np.array([1.3, 0.9])
    states, commanded = [np.array([[float(x) for x in motion.state]])], []
    for k, row in enumerate(motion.inputs):
        u = np.array([float(x) for x in row])
        if motion.law is not None:
            gain = np.array([[float(x) for x in line] for line in motion.law.gains[k]])
            u -= gain @ (states[-1][-1] - [float(x) for x in motion.law.reference[k]])
        commanded.append(u)

        def slope(_: float, x: Array, u: Array = u) -> Array:
            mass, coriolis, _ = chain_dynamics(lengths, np.ones(2), x[:2], x[2:], (0, 0))
            return np.concatenate([x[2:], np.linalg.solve(mass, u - coriolis)])

        at = np.linspace(0, STEP, per_step + 1)
        found = solve_ivp(slope, (0, STEP), states[-1][-1], "DOP853", at, rtol=1e-11, atol=1e-12)
        states.append(found.y.T[1:])
    return np.concatenate(states), np.array(commanded)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_the_motion_is_that_of_its_decimals(seed: int, closed: bool) -> None:
    motion = random_motion(seed, closed=closed)
    seen = simulated(where(), motion)
    states, commanded = integrated(motion, seen.fine)
    assert np.all(np.abs(seen.states - states) <= seen.errors + 1e-9)
    assert np.all(np.abs(seen.inputs - commanded) <= seen.off + 1e-8)
    assert float(np.max(seen.errors)) < 1e-6


def gaps(motion: Motion) -> dict[str, float]:
    """The least distance from a violation of each condition, negative beyond it."""
    states, commanded = integrated(motion, INSTANTS)
    places = tips(states)
    along = (3 * places[:, 0] + 4 * places[:, 1]) / 5
    across = (4 * places[:, 0] - 3 * places[:, 1]) / 5
    beyond = np.maximum(np.maximum(1.6 - along, along - 1.76), 0)
    beside = np.maximum(np.maximum(1.6 - across, across - 2), 0)
    end = [min(x - low, high - x) for x, (low, high) in zip(places[-1], END, strict=True)]
    found = {
        "bounds": float(np.min(3 - np.abs(places))),
        "clearance of effector to Post": float(np.min(np.hypot(beyond, beside))) - 0.1,
        "target End": float(min(end)),
        "rates at the end": float(np.min(0.4 - np.abs(states[-1, 2:]))),
        "start rates": float(np.min(1 - np.abs(states[0, 2:]))),
    }
    if motion.law is not None:
        found["effort (N*m)"] = float(np.min(9 - np.abs(commanded)))
    for joint in range(2):
        found[f"range of J.q (joint {joint + 1})"] = float(np.min(2 - np.abs(states[:, joint])))
        found[f"rate of J.q (joint {joint + 1})"] = float(np.min(3 - np.abs(states[:, 2 + joint])))
    return found


Conditions: TypeAlias = tuple[CheckedCondition, ...]


def violated(here: Scene, motion: Motion) -> dict[str, CheckedCondition]:
    found = clear_violations(here, motion, robot(here), simulated(here, motion))
    # Which cells a random motion passes is not known here.
    return {each.name: each for each in found if not each.name.startswith("cell path")}


@pytest.mark.parametrize("closed", chosen([True, False], 1))
def test_what_is_violated_at_the_instants_is_found_and_nothing_else(closed: bool) -> None:
    here, seen = where(), set[str]()
    for seed in range(12):
        motion = random_motion(seed, closed=closed)
        expected = {name: gap for name, gap in gaps(motion).items() if gap < 0}
        found = violated(here, motion)
        assert set(found) == set(expected)
        for name, gap in expected.items():
            # In an obstacle its depth counts, too.
            if name.startswith("clearance"):
                assert found[name].margin <= gap + 1e-6
            else:
                assert found[name].margin == pytest.approx(gap, abs=1e-6)
        seen |= set(found)
    assert seen >= {"target End", "rates at the end"}
    assert ("effort (N*m)" if closed else "clearance of effector to Post") in seen
    assert any(name.startswith("rate of J.q") for name in seen)
    assert any(name.startswith("range of J.q") for name in seen)


@pytest.mark.parametrize("closed", chosen([True, False], 1))
def test_no_proof_goes_through_where_a_violation_is_clear(closed: bool) -> None:
    here = where("reach End; avoid Post with effector, margin 1 cm;")
    looked_at = 0
    for seed in range(5):
        motion = random_motion(seed, closed=closed)
        if violated(here, motion):
            looked_at += 1
            worst = decisive(prove_motion(here, motion))
            assert worst is not None
    assert looked_at


def proved(here: Scene, motion: Motion, *, brief: bool) -> tuple[Conditions, int]:
    """The conditions, and how many steps were looked at."""
    steps = [0]
    watch = Watch(part=lambda done, _: steps.append(done), brief=brief)
    return prove_motion(here, motion, watch), max(steps)


def failed(conditions: Conditions) -> set[str]:
    return {each.name for each in conditions if each.status is Status.FAILS}


def test_a_brief_proof_ends_at_the_first_violation() -> None:
    """What fails in it fails in the whole one; where nothing fails, both are the same."""
    here, shorter = where("reach End; avoid Post with effector, margin 1 cm;"), 0
    for seed in range(8):
        motion = random_motion(seed, closed=False)
        brief, some = proved(here, motion, brief=True)
        whole, every = proved(here, motion, brief=False)
        assert failed(brief) <= failed(whole)
        assert bool(failed(brief)) == bool(failed(whole))
        shorter += some < every
        assert some == every or failed(brief)
        assert brief == whole or failed(brief)
    assert shorter


def test_what_the_errors_may_explain_is_not_clear() -> None:
    here, motion = where(), random_motion(1, closed=True)
    seen = simulated(here, motion)
    assert violated(here, motion)
    doubtful = replace(seen, errors=seen.errors + 10.0, off=seen.off + 100.0)
    found = clear_violations(here, motion, robot(here), doubtful)
    # How the motion starts, and that there is no such cell, is exact.
    assert all(each.name == "start rates" or "no cell" in each.name for each in found)


def test_an_obstacle_between_two_samples() -> None:
    """The tip of a turning rod is in a box of 2 cm half way between two samples."""
    x, y = 1.3 * np.cos(0.25), 1.3 * np.sin(0.25)
    box = f"box [{x - 0.01:.4f}, {x + 0.01:.4f}] x [{y - 0.01:.4f}, {y + 0.01:.4f}]"
    here = scene(ONE, spec(STEPS, "", box, "reach Begin; avoid End with effector;"))
    numeric = robot(here)
    motion = Motion((), (F(0), F(1)), ((F(0),),) * STEPS, 0, ())
    seen = simulated_motion(numeric, motion, STEP, 2)
    assert seen is not None
    (found,) = clear_violations(here, motion, numeric, seen)
    assert (found.name, found.time) == ("clearance of effector to End", pytest.approx(0.25))
    assert found.margin == pytest.approx(-0.01, abs=1e-4)
    places = numeric.points(seen.states[:: seen.fine, :1], seen.theta).value[:, 0]
    assert np.all(np.max(np.abs(places - [x, y]), axis=1) > 0.02)


def test_a_target_that_is_left_while_it_binds() -> None:
    """The tip comes back into the target at the end, but is to be there for the last 0.3 s."""
    pulls = [F(0)] * 5 + [F(-5), F(5), F(5)]
    clauses = "reach End rates <= 9 rad/s for 0.3 s;"
    here = scene(ONE, spec(STEPS, "", "box [-3, 3] x [-0.05, 3]", clauses))
    numeric = robot(here)
    motion = Motion((), (F(0), F(0)), tuple((u,) for u in pulls), 0, ())
    seen = simulated_motion(numeric, motion, STEP, 2)
    assert seen is not None
    names = {each.name for each in clear_violations(here, motion, numeric, seen)}
    inertia, angle, rate, low = 1.3**3 / 3, 0.0, 0.0, []
    for u in pulls:
        times = np.linspace(0, STEP, INSTANTS + 1)
        low.append(np.min(1.3 * np.sin(angle + rate * times + float(u) / inertia * times**2 / 2)))
        angle += rate * STEP + float(u) / inertia * STEP**2 / 2
        rate += float(u) / inertia * STEP
    assert 1.3 * np.sin(angle) > -0.05
    assert min(low[:-3]) > -0.05 > min(low[-3:])
    assert names == {"target End"}

"""Robots with modules' own dynamics: convex steps, tubes and certificates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from flint import arb
from scipy.integrate import solve_ivp

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import ball, constant_ball, working_precision
from compiler.expressions.tape import tape
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_states
from grammar_lang import ir
from solvers.trajectory.convex_step import ConvexStep
from solvers.trajectory.linear_model import Model, PositionRows, fictitious_inputs
from solvers.trajectory.reference_step import ReferenceStep
from solvers.trajectory.subproblem import StepResult, SubproblemSpec, TrustRegion, Weights
from solvers.trajectory.task_limits import InputGroup, MotionLimits
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs.enclosure import Accuracy, tube
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.driven_robots import driven
from tests.oracles.result_files import alter, alter_spec
from tests.oracles.robots import Builder, rod_chain

DT = 0.1
STEPS = 5
NONE = PositionRows(
    np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0)
)


# --- one convex step -----------------------------------------------------------------------------


@pytest.mark.parametrize("free", [False, True])
def test_the_optimum_is_that_of_the_readable_formulation(*, free: bool) -> None:
    numeric = NumericRobot(robot_graph(driven(rod_chain(2))))
    assert (numeric.size, numeric.m) == (5, 2)
    rng = np.random.default_rng(3)
    x = np.concatenate(
        [
            np.cumsum(rng.uniform(-0.1, 0.1, (STEPS + 1, 2)), axis=0),
            rng.uniform(-0.5, 0.5, (STEPS + 1, 3)),
        ],
        axis=1,
    )
    about = Trajectory(x, rng.uniform(-1, 1, (STEPS, 2)), np.array([1.3, 0.8]))
    model = Model(
        about,
        numeric.step(x[:-1], about.u, about.theta, DT, 2),
        numeric.points(x[:, :2], about.theta),
        fictitious_inputs(numeric, about, DT),
    )
    inf = np.full(2, np.inf)
    limits = MotionLimits(-inf, inf, -inf, inf, 0.0, 0.3, None, np.array([0.25]))
    # An input whose bounds are not symmetric, beside an effort.
    groups = (InputGroup((1,), -9.0, 9.0, norm2=False), InputGroup((0,), -3.0, 5.0, norm2=False))
    box = (np.full(2, 0.5), np.full(2, 5.0)) if free else None
    question = SubproblemSpec(limits, groups, box, Weights())
    values = []
    for step in (ConvexStep(question), ReferenceStep(question)):
        found = step.solve(model, NONE, TrustRegion(0.5), 1e-9)
        assert isinstance(found, StepResult)
        worth = (found.margin - Weights().fictitious * found.largest_fictitious) / 9.0
        squares = np.sum((found.trajectory.u / 9.0) ** 2)
        values.append(worth - Weights().quadratic * float(squares))
        np.testing.assert_allclose(found.trajectory.x[0, 4:], [0.25], atol=1e-7)
    assert values[0] == pytest.approx(values[1], abs=1e-6 * (1 + abs(values[1])))


# --- enclosures ----------------------------------------------------------------------------------


def turntable() -> RobotModel:
    """A motor with a flywheel of 3/2 kg m^2: linear, so that its motion has a closed form."""
    builder = Builder()
    frame = builder.joint(0)
    builder.solid(frame, 2, (0, 0, 0), (Fraction(3, 2),))
    builder.effector(builder.move(frame, "x", builder.number(1)))
    model = driven(builder.build())
    own = model.own[0]
    linear = ir.Binary("*", ir.Num(Fraction(4, 5)), ir.StateOf(ir.THIS, "current"))
    return replace(model, own=(replace(own, torques=(replace(own.torques[0], value=linear),)),))


def test_the_tube_contains_the_exact_motion_of_a_motor() -> None:
    """x' = A x + b u has x(t) = expm(A t) x(0) + integral, computed to 40 digits."""
    model = turntable()
    graph = robot_graph(model)
    start, volts = (Fraction(1, 3), Fraction(-1, 2), Fraction(2)), (Fraction(5), Fraction(-7))
    with working_precision(160), mp.workdps(40):
        tail = tuple(constant_ball(constant) for constant in graph.constants)
        field = VectorField(tape(graph.balance), tape(graph.variation), 1, tail, 1)
        segments = list(
            tube(
                field,
                [ball(x) for x in start],
                [[ball(u)] for u in volts],
                ball(Fraction(1, 5)),
                Accuracy(12, 160, 1e-20),
            )
        )
        # Row by row: q' = v, 3/2 v' = 4/5 i, 3/10 i' = u - 3/2 i - 4/5 v; the last column is b u.
        slope = mp.matrix(
            [
                [0, 1, 0, 0],
                [0, 0, mp.mpf(8) / 15, 0],
                [0, -mp.mpf(8) / 3, -5, mp.mpf(10) / 3],
                [0, 0, 0, 0],
            ]
        )
        x = mp.matrix([mp.mpf(v.numerator) / v.denominator for v in start] + [0])
        for number, u in enumerate(volts):
            x[3] = mp.mpf(int(u))
            for segment in segments:
                if segment.number != number:
                    continue
                offset = segment.start - ball(Fraction(number, 5))
                for part in (Fraction(1, 3), Fraction(1)):
                    tau = segment.length * ball(part)
                    time = mp.mpf(str((offset + tau).mid().str(45, radius=False)))
                    exact = mp.expm(slope * time) * x
                    for found, value in zip(segment.at(tau), exact, strict=False):
                        assert (found - arb(mp.nstr(value, 38))).abs_lower() < 1e-30
                        assert found.rad() < 1e-15
            x = mp.expm(slope * mp.mpf("0.2")) * x


def test_the_tube_contains_the_motion_of_a_driven_arm() -> None:
    """Against scipy's DOP853 at 1e-12 on the float graph, friction in |rate| included."""
    model = driven(rod_chain(2))
    graph, numeric = robot_graph(model), NumericRobot(robot_graph(model))
    theta, start = np.array([1.25, 0.75]), np.array([0.5, -0.25, 0.75, 1.5, -0.5])
    inputs = np.array([[3.0, -2.0], [-4.0, 1.0]])
    assert len(robot_states(model)) == 1
    with working_precision(128):
        exact = [ball(Fraction(value)) for value in theta]
        tail = (*exact, *(constant_ball(constant) for constant in graph.constants))
        field = VectorField(tape(graph.balance), tape(graph.variation), 2, tail, 1)
        state = [ball(Fraction(value)) for value in start]
        rows = [[ball(Fraction(value)) for value in row] for row in inputs]
        ends = {}
        for segment in tube(field, state, rows, ball(Fraction(1, 10)), Accuracy(12, 128, 1e-9)):
            ends[segment.number] = segment.end
    x = start
    for number, u in enumerate(inputs):

        def slope(_: float, at: np.ndarray, u: np.ndarray = u) -> np.ndarray:
            value, _ = numeric.acceleration(at[None, :], u[None, :], theta)
            return np.concatenate([at[2:4], value[0]])

        x = solve_ivp(slope, (0, 0.1), x, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        for found, value in zip(ends[number], x, strict=True):
            assert abs(float(found.mid()) - value) <= 1e-9 + float(found.rad())
            assert float(found.rad()) < 1e-6


# --- certificates --------------------------------------------------------------------------------


def test_a_motor_arm_is_found_and_verified(result: Callable[[str], Path]) -> None:
    folder = result("motor")
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    names = {finding.name: finding for finding in report.conditions}
    assert names["input M.voltage (symbol 2)"].unit == "V"
    assert not any(name.startswith("effort") for name in names)
    head = (folder / "trajectory.csv").read_text().splitlines()[0]
    assert head == "t,q1,qd1,s1,u1,e1_x,e1_y"


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda c: c["inputs"].__setitem__(3, ["24.001"]), "input M.voltage"),
        (lambda c: c["inputs"].__setitem__(3, ["0", "0"]), "rows of 1"),
        (lambda c: c["start"].append("0"), "coordinates"),
        (lambda c: c.__setitem__("robustness", "23"), "robustness"),
        (lambda c: c.__setitem__("effort_peak", "1"), "effort_peak"),
        (lambda c: [row.__setitem__(0, "0") for row in c["inputs"]], "is"),
    ],
)
def test_what_is_wrong_with_a_motor_arm_is_seen(
    change: Callable[[dict[str, Any]], object], reason: str, result: Callable[[str], Path]
) -> None:
    folder = result("motor")
    (folder / "design.json").unlink()
    alter(folder, lambda content: change(content) and None, sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert reason in str(report.reason)


def test_the_initial_state_of_a_module_matters(result: Callable[[str], Path]) -> None:
    """Another initial current in the spec's copy: the motion misses what it is claimed to reach."""
    folder = result("motor")
    (folder / "design.json").unlink()
    alter_spec(folder, "state current A;", "state current A = 5 A;", sign=True)
    assert verify_directory(folder).outcome is Outcome.REFUTED

"""Tubes of sets of states and of disturbed inputs hold what they should, and not much more."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product

import casadi as ca
import mpmath as mp
import numpy as np
import pytest
from flint import arb
from scipy.integrate import solve_ivp

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.expressions.evaluators.balls import (
    BALLS,
    ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.tape import tape
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_states
from solvers.verifier.proofs.control_law import InputError
from solvers.verifier.proofs.enclosure import Accuracy, TubeSegment, tube
from solvers.verifier.proofs.vector_field import Curvature, VectorField
from solvers.verifier.proofs.zonotope import (
    InitialSet,
)
from tests.oracles.driven_robots import driven
from tests.oracles.precise_flow import DIGITS, chain_flow
from tests.oracles.robots import Builder, rod_chain
from tests.oracles.some_cases import examples

ROUGH = Accuracy(order=10, bits=64, remainder=1e-8)
DT = Fraction(1, 10)


def field_of(graph: RobotGraph, theta: list[Fraction]) -> VectorField:
    tail = (*map(ball, theta), *map(constant_ball, graph.constants))
    return VectorField(
        tape(graph.balance),
        tape(graph.variation),
        len(graph.model.dofs),
        tail,
        len(robot_states(graph.model)),
        tape(graph.input_slopes),
        Curvature.of(graph),
    )


def linear_field(force: ca.SX, q: ca.SX, v: ca.SX, u: ca.SX) -> VectorField:
    """q'' = force(q, v, u), of unit mass."""
    a = ca.SX.sym("a", q.size1())
    n = q.size1()
    balance = ca.vertcat(ca.vec(ca.SX.eye(n)), force)
    slopes = ca.jacobian(force - a, ca.vertcat(q, v))
    return VectorField(
        tape(ca.Function("balance", [q, v, u], [ca.densify(balance)])),
        tape(ca.Function("variation", [q, v, a, u], [ca.vec(ca.densify(slopes))])),
        n,
        (),
        0,
        tape(ca.Function("slopes", [q, v, u], [ca.vec(ca.densify(ca.jacobian(force, u)))])),
    )


def holding(segments: list[TubeSegment], time: Fraction, step: Fraction) -> list[TubeSegment]:
    found = [s for s in segments if s.steps[0] * step <= time <= s.steps[1] * step]
    assert found
    return found


def states_at(segment: TubeSegment, time: Fraction, step: Fraction) -> list[arb]:
    return segment.at(ball(time - segment.steps[0] * step))


# --- closed forms --------------------------------------------------------------------------------


def test_the_set_of_a_harmonic_motion_stays_near_the_true_one() -> None:
    """q'' = -q turns the square of states rigidly; a box about each of 150 steps would grow
    by a factor of |cos h| + |sin h| a step, 10^12 in all.
    """
    q, v, u = (ca.SX.sym(name) for name in "qvu")
    width, step, count = Fraction(1, 100), Fraction(1, 4), 150
    with working_precision(64):
        field = linear_field(-q + u, q, v, u)
        start = [arb(1) + arb(0, 1) * ball(width), arb(0) + arb(0, 1) * ball(width)]
        inputs = [[arb(0)]] * count
        segments = list(tube(field, start, inputs, ball(step), ROUGH))
        for segment in segments:
            time = float(segment.steps[1] * step)
            exact = float(width) * (abs(np.cos(time)) + abs(np.sin(time)))
            assert exact * (1 - 1e-9) <= float(segment.end[0].rad()) <= 1.1 * exact
            for a, b in product((-1, 1), repeat=2):
                place = (1 + a * float(width)) * np.cos(time) + b * float(width) * np.sin(time)
                assert abs(place - float(segment.end[0].mid())) < float(segment.end[0].rad()) + 1e-9
        assert len(segments) >= count


def part_of(effort: Fraction, inputs: Sequence[Sequence[object]]) -> InputError:
    """Inputs that are off by so large a part of themselves."""
    return InputError((ball(effort),) * len(inputs[0]), (arb(0),) * len(inputs[0]))


def test_disturbed_inputs_of_a_double_integrator() -> None:
    """q'' = u with |d| <= p |u|: exactly |dq| <= p |u| t^2 / 2 and |dv| <= p |u| t are reached."""
    q, v, u = (ca.SX.sym(name) for name in "qvu")
    effort, push, step, count = Fraction(1, 50), 3, Fraction(1, 4), 12
    with working_precision(64):
        field = linear_field(u * 1, q, v, u)
        inputs = [[arb(push)]] * count
        found = tube(
            field, [arb(0), arb(0)], inputs, ball(step), ROUGH, error=part_of(effort, inputs)
        )
        for segment in found:
            for share in (Fraction(1, 3), Fraction(1)):
                tau = share * (segment.steps[1] - segment.steps[0]) * step
                t = float(segment.steps[0] * step + tau)
                place, rate = segment.at(ball(tau))
                for sign in (-1, 1):
                    worst = push * (1 + sign * float(effort))
                    assert abs(worst * t * t / 2 - float(place.mid())) <= float(place.rad()) + 1e-12
                    assert abs(worst * t - float(rate.mid())) <= float(rate.rad()) + 1e-12
            t = float(segment.steps[1] * step)
            assert float(segment.end[1].rad()) <= 1.001 * push * float(effort) * t
            assert float(segment.end[0].rad()) <= 1.2 * push * float(effort) * t * t / 2


def test_disturbed_inputs_of_a_harmonic_motion() -> None:
    """The worst disturbance switches with sin(T - s), within steps: it adds p times the
    integral of |sin|, which grows linearly; a bound that lost the turning would grow
    exponentially.
    """
    q, v, u = (ca.SX.sym(name) for name in "qvu")
    effort, step, count = Fraction(1, 100), Fraction(1, 5), 200
    with working_precision(64):
        field = linear_field(-q + u, q, v, u)
        inputs = [[arb(1)]] * count
        found = tube(
            field, [arb(0), arb(0)], inputs, ball(step), ROUGH, error=part_of(effort, inputs)
        )
        for segment in found:
            end = float(segment.steps[1] * step)
            turns, rest = divmod(end, np.pi)
            reached = float(effort) * (2 * turns + 1 - np.cos(rest))
            radius = float(segment.end[0].rad())
            assert abs(1 - np.cos(end) - float(segment.end[0].mid())) + reached <= radius + 1e-6
            assert radius <= 1.75 * reached + 0.004


# --- random robots -------------------------------------------------------------------------------


@pytest.mark.parametrize("links", [1, 2, 3])
def test_disturbed_arms_under_gravity_stay_in_their_tube(links: int) -> None:
    """Sixty digits, inputs that switch inside the steps, starts all over the set."""
    rng = np.random.default_rng(40 + links)
    pull = (Fraction(1, 3), Fraction("-9.81"))
    graph = robot_graph(rod_chain(links), pull)

    def rationals(low: float, high: float, count: int) -> list[Fraction]:
        return [Fraction(int(1000 * (low + (high - low) * r)), 1000) for r in rng.random(count)]

    lengths, state = rationals(1, 2, links), rationals(-1, 1, 2 * links)
    inputs = [rationals(-4, 4, links) for _ in range(2)]
    radius, effort = Fraction(1, 10**5), Fraction(1, 200)
    with working_precision(64):
        field = field_of(graph, lengths)
        centre = [ball(x) for x in state]
        # Sums and differences of neighbours: a set that no box describes.
        rows = [
            [int(i == j) + (Fraction(-1, 2) if i == j + 1 else 0) for j in range(2 * links)]
            for i in range(2 * links)
        ]
        initial = InitialSet(
            tuple(centre),
            tuple(tuple(ball(x) for x in row) for row in rows),
            (ball(radius),) * (2 * links),
        )
        rates = [[ball(x) for x in u] for u in inputs]
        segments = list(tube(field, initial, rates, ball(DT), ROUGH, error=part_of(effort, inputs)))
    with mp.workdps(DIGITS), working_precision(200):
        for _ in range(3 - min(links, 2)):
            signs = rng.choice([-1, 1], 2 * links)
            offset = [
                sum(c * int(s) for c, s in zip(row, signs, strict=True)) * radius for row in rows
            ]
            current = [mp.mpf((x + o).numerator) / (x + o).denominator
                       for x, o in zip(state, offset, strict=True)]  # fmt: skip
            time = Fraction(0)
            for u in inputs:
                first = Fraction(int(997 * rng.random()) + 1, 1000) * DT
                for part in (first, DT - first):
                    applied = [x * (1 + effort * int(rng.choice([-1, 1]))) for x in u]
                    args = [[mp.mpf(x.numerator) / x.denominator for x in row]
                            for row in (applied, lengths, pull)]  # fmt: skip
                    current = chain_flow(current, *args, mp.mpf(part.numerator) / part.denominator)
                    time += part
                    for segment in holding(segments, time, DT):
                        found = states_at(segment, time, DT)
                        for item, value in zip(found, current, strict=True):
                            exact = arb(mp.nstr(value, DIGITS))
                            assert abs(exact - item.mid()) <= item.rad() + arb(10) ** -20
    # Forces of 0.02 N m on a light forearm for 0.2 s: rates of some tenths, not more.
    assert all(float(item.rad()) < 0.4 for item in segments[-1].end)


def spatial() -> RobotModel:
    """A turret with a shoulder and an elbow, and a point at its tip: in space."""
    builder = Builder(dimension=3)
    shoulder = builder.joint(builder.link(builder.joint(0), builder.number(1), axis="z"), "y")
    elbow = builder.joint(builder.link(shoulder, builder.parameter()), "y")
    tip = builder.link(elbow, builder.parameter())
    builder.point(tip, builder.number(Fraction(1, 2)))
    builder.effector(tip)
    return builder.build()


@pytest.mark.parametrize("kind", ["space", "motors with friction"])
def test_other_disturbed_robots_stay_in_their_tube(kind: str) -> None:
    """Against DOP853 on the equations that floats use, derived by inverse dynamics."""
    rng = np.random.default_rng(7)
    space = kind == "space"
    model = spatial() if space else driven(rod_chain(2))
    pull = (Fraction(0), Fraction(0), Fraction("-9.81")) if space else (Fraction(0), Fraction(-3))
    graph = robot_graph(model, pull)
    numeric = NumericRobot(graph)
    theta = [Fraction(5, 4), Fraction(3, 4)]
    size, m = numeric.size, numeric.m
    state = [Fraction(int(1000 * x), 1000) for x in rng.uniform(-0.9, 0.9, size)]
    inputs = [[Fraction(int(100 * x), 100) for x in rng.uniform(-4, 4, m)] for _ in range(2)]
    radius, effort = Fraction(1, 10**5), Fraction(1, 100)
    with working_precision(64):
        field = field_of(graph, theta)
        start = [ball(x) + arb(0, 1) * ball(radius) for x in state]
        rates = [[ball(x) for x in u] for u in inputs]
        segments = list(tube(field, start, rates, ball(DT), ROUGH, error=part_of(effort, inputs)))
    values = np.array([float(x) for x in theta])
    for _ in range(examples(2, 4)):
        x = np.array([float(x) for x in state]) + float(radius) * rng.uniform(-1, 1, size)
        time = Fraction(0)
        for row in inputs:
            first = Fraction(int(997 * rng.random()) + 1, 1000) * DT
            for part in (first, DT - first):
                u = np.array([float(v) for v in row]) * (1 + float(effort) * rng.choice([-1, 1], m))

                def slope(_: float, at: np.ndarray, u: np.ndarray = u) -> np.ndarray:
                    value, _ = numeric.acceleration(at[None, :], u[None, :], values)
                    n = numeric.n
                    return np.concatenate([at[n : 2 * n], value[0]])

                span = (0, float(part))
                x = solve_ivp(slope, span, x, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
                time += part
                for segment in holding(segments, time, DT):
                    for item, value in zip(states_at(segment, time, DT), x, strict=True):
                        assert abs(value - float(item.mid())) <= float(item.rad()) + 1e-9
    assert all(float(item.rad()) < 0.15 for item in segments[-1].end)


def test_the_slopes_in_the_inputs_are_those_of_the_forces() -> None:
    model = driven(rod_chain(2))
    graph = robot_graph(model, (Fraction(0), Fraction(-3)), absolute_angles(model))
    rng = np.random.default_rng(3)
    n, r = len(model.dofs), len(robot_states(model))
    m, k = graph.input_slopes.size1_in(2), [float(c.value) for c in graph.constants]
    q, w, u = rng.uniform(-1, 1, n), rng.uniform(-1, 1, n + r), rng.uniform(-1, 1, m)
    found = np.array(graph.input_slopes(q, w, u, [1.25, 0.75], k)).reshape((n + r, m), order="F")
    for j in range(m):
        step = 1e-6 * np.eye(m)[j]
        ends = [np.array(graph.balance(q, w, u + s, [1.25, 0.75], k)).ravel()[n * n :]
                for s in (step, -step)]  # fmt: skip
        np.testing.assert_allclose(found[:, j], (ends[0] - ends[1]) / 2e-6, atol=1e-8)
    assert np.abs(found).max() > 0.5


def test_disturbed_inputs_need_the_slopes() -> None:
    q, v, u = (ca.SX.sym(name) for name in "qvu")
    field = linear_field(u - q, q, v, u)
    bare = VectorField(field.balance, field.variation, 1, ())
    with working_precision(64), pytest.raises(ValueError, match="slopes"):
        list(
            tube(
                bare,
                [arb(0), arb(0)],
                [[arb(1)]],
                arb(1),
                ROUGH,
                error=InputError((arb("0.1"),), (arb(0),)),
            )
        )


def test_a_plan_computes_what_its_tape_does() -> None:
    """Against CasADi's own evaluation in doubles; also for the first outputs alone."""
    rng = np.random.default_rng(5)
    for model in (rod_chain(3), driven(rod_chain(2)), spatial()):
        graph = robot_graph(model, (Fraction(1, 2),) * model.dimension)
        for function in (graph.balance, graph.variation, graph.points):
            program = tape(function)
            point = rng.uniform(-1, 1, function.nnz_in())
            sizes = np.cumsum([function.nnz_in(i) for i in range(function.n_in())])[:-1]
            plain = np.asarray(function(*np.split(point, sizes)).nonzeros())
            inputs = [arb(float(x)) for x in point]
            for count in (program.outputs, 2):
                found = program.first(count).evaluate(inputs, BALLS)
                assert len(found) == count
                for a, b in zip(found, plain[:count], strict=True):
                    assert abs(float(a.mid()) - b) < 1e-9 * (1 + abs(b))
                    assert float(a.rad()) < 1e-9

"""Tubes contain the motions that another method computes to many more digits."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import casadi as ca
import mpmath as mp
import numpy as np
import pytest
from flint import arb, ctx
from scipy.integrate import solve_ivp

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.expressions.evaluators.balls import ball, constant_ball, working_precision
from compiler.expressions.tape import tape
from compiler.robots.robot import WORLD
from solvers.verifier.proofs.enclosure import (
    Accuracy,
    EnclosureFailure,
    TubeSegment,
    polynomial,
    tube,
)
from solvers.verifier.proofs.vector_field import VectorField
from tests.oracles.exact_chain import Multiprecision
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.precise_flow import DIGITS, chain_flow, chain_slope
from tests.oracles.robots import Builder, rod_chain
from tests.oracles.some_cases import examples, some

PULL = (Fraction(1, 3), Fraction("-9.81"))
DT = Fraction(10, 81)
ACCURATE = Accuracy(order=12, bits=128, remainder=1e-9)


def field_of(graph: RobotGraph, theta: list[arb]) -> VectorField:
    tail = (*theta, *map(constant_ball, graph.constants))
    return VectorField(tape(graph.balance), tape(graph.variation), len(graph.model.dofs), tail)


def rationals(rng: np.random.Generator, low: float, high: float, count: int) -> list[Fraction]:
    return [Fraction(int(low * 1000 + (high - low) * 1000 * r), 1000) for r in rng.random(count)]


def number(value: Fraction) -> mp.mpf:
    return mp.mpf(value.numerator) / value.denominator


def encloses(box: list[arb], values: list[mp.mpf]) -> bool:
    """Containment, the values being known to 20 digits at least."""
    tolerance = arb(10) ** -20
    return all(
        bool(item.overlaps(arb(mp.nstr(value, DIGITS)) + arb(0, 1) * tolerance))
        for item, value in zip(box, values, strict=True)
    )


def inside(segment: TubeSegment, time: arb) -> bool:
    return bool(segment.start <= time) and bool(time <= segment.start + segment.length)


def test_the_precise_flow_agrees_with_the_chain_formula_and_dop853() -> None:
    rng = np.random.default_rng(0)
    state, u, lengths = rng.uniform(-1, 1, 6), rng.uniform(-3, 3, 3), rng.uniform(1, 2, 3)

    def slope(_: float, x: np.ndarray) -> np.ndarray:
        mass, coriolis, gravity = chain_dynamics(lengths, np.ones(3), x[:3], x[3:], (0.3, -9.81))
        return np.concatenate([x[3:], np.linalg.solve(mass, u - coriolis - gravity)])

    with mp.workdps(DIGITS):
        args = ([mp.mpf(x) for x in u], [mp.mpf(x) for x in lengths], (mp.mpf(0.3), mp.mpf(-9.81)))
        precise = chain_flow([mp.mpf(x) for x in state], *args, mp.mpf(0.125))
        np.testing.assert_allclose(
            [float(x) for x in chain_slope([mp.mpf(x) for x in state], *args)], slope(0, state)
        )
    found = solve_ivp(slope, (0, 0.125), state, method="DOP853", rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.y[:, -1], [float(x) for x in precise], atol=1e-10)


def test_segments_tile_the_horizon_exactly() -> None:
    """The first step is smooth, the second is so hard a push that its segments are halved."""
    with working_precision(ACCURATE.bits):
        field = field_of(robot_graph(rod_chain(2), PULL), [arb(1), arb(2)])
        inputs = [[arb(0), arb(0)], [arb(60), arb(-60)], [arb(0), arb(0)]]
        segments = list(tube(field, [arb(1), arb(0), arb(0), arb(0)], inputs, ball(DT), ACCURATE))
        assert len({last - first for first, last in (s.steps for s in segments)}) > 1
        assert segments[0].steps[0] == 0
        assert segments[-1].steps[1] == 3
        assert all(s.steps[1] == t.steps[0] for s, t in pairwise(segments))
        for segment in segments:
            first, last = segment.steps
            assert segment.number <= first < last <= segment.number + 1
            assert segment.start.overlaps(ball(first * DT))
            assert (segment.start + segment.length).overlaps(ball(last * DT))


@pytest.mark.parametrize("links", some([1, 2, 3], 2))
def test_the_tube_contains_the_motion_at_random_times(links: int) -> None:
    rng = np.random.default_rng(links)
    # Three links under gravity move too fast for boxes of this width.
    pull = PULL if links < 3 else (Fraction(0), Fraction(0))
    graph = robot_graph(rod_chain(links), pull)
    state, lengths = rationals(rng, -0.9, 0.9, 2 * links), rationals(rng, 1, 2, links)
    inputs = [rationals(rng, -4 / links, 4 / links, links) for _ in range(3)]
    with mp.workdps(DIGITS), working_precision(ACCURATE.bits):
        field = field_of(graph, [ball(x) for x in lengths])
        segments = list(
            tube(
                field,
                [ball(x) for x in state],
                [[ball(x) for x in u] for u in inputs],
                ball(DT),
                ACCURATE,
            )
        )
        current = [number(x) for x in state]
        for k, u in enumerate(inputs):
            args = ([number(x) for x in u], [number(x) for x in lengths], [number(x) for x in pull])
            parts = [Fraction(int(r * 997), 997) for r in rng.random(3)]
            for part in [*parts, Fraction(1)]:
                reached = chain_flow(current, *args, number(part * DT))
                time = ball((k + part) * DT)
                holding = [
                    s for s in segments
                    if s.number == k and not (time < s.start or time > s.start + s.length)
                ]  # fmt: skip
                assert holding
                for segment in holding:
                    assert encloses(segment.at(time - segment.start), reached)
                if part == 1:
                    assert encloses(list(segment.end), reached)
            current = reached
        assert all(item.rad() < 1e-7 for segment in segments for item in segment.end)


def test_segments_are_adjacent_and_cover_the_horizon() -> None:
    graph = robot_graph(rod_chain(2), PULL)
    with working_precision(ACCURATE.bits):
        field = field_of(graph, [ball(1), ball(Fraction(1, 2))])
        state = [ball(x) for x in (1, 0, 2, -1)]
        inputs = [[ball(1), ball(0)], [ball(-20), ball(3)], [ball(0), ball(0)]]
        segments = list(tube(field, state, inputs, ball(DT), ACCURATE))
        assert [s.number for s in segments] == sorted(s.number for s in segments)
        for k in range(3):
            total = sum((s.length for s in segments if s.number == k), arb(0))
            assert total.overlaps(ball(DT))
        for before, after in pairwise(segments):
            assert (before.start + before.length).overlaps(after.start)
            for end, late, early in zip(
                before.end, before.at(before.length), after.at(arb(0)), strict=True
            ):
                assert end.overlaps(late)
                assert early.contains(end) or early.overlaps(end)
        # A ball of times encloses the states at all of them.
        for segment in segments:
            wide = segment.at(arb(0).union(segment.length))
            for share in (0, Fraction(1, 3), 1):
                at = segment.at(segment.length * ball(share))
                assert all(w.contains(a) for w, a in zip(wide, at, strict=True))


@pytest.mark.parametrize("links", [1, 2])
def test_the_tube_of_a_box_contains_the_motions_of_its_points(links: int) -> None:
    rng = np.random.default_rng(10 + links)
    graph = robot_graph(rod_chain(links), PULL)
    lengths, width = rationals(rng, 1, 2, links), Fraction(1, 1000)
    state = rationals(rng, -1, 1, 2 * links)
    inputs = [rationals(rng, -4, 4, links) for _ in range(2)]
    with working_precision(80):
        field = field_of(graph, [ball(x) for x in lengths])
        box = [ball(x) + arb(0, 1) * ball(width) for x in state]
        # A large box has a large remainder, which this accuracy allows.
        accuracy = Accuracy(12, 80, 1e-2)
        segments = list(
            tube(field, box, [[ball(x) for x in u] for u in inputs], ball(DT), accuracy)
        )
    corners = rng.choice([-1, 1], (examples(2, 4), 2 * links))
    with mp.workdps(DIGITS), working_precision(80):
        for offset in [*corners, *rng.uniform(-1, 1, (examples(2, 4), 2 * links))]:
            current = [
                number(x + width * Fraction(float(o))) for x, o in zip(state, offset, strict=True)
            ]
            for k, u in enumerate(inputs):
                args = (
                    [number(x) for x in u],
                    [number(x) for x in lengths],
                    [number(x) for x in PULL],
                )
                half = chain_flow(current, *args, number(DT / 2))
                current = chain_flow(current, *args, number(DT))
                for part, reached in ((Fraction(1, 2), half), (Fraction(1), current)):
                    time = ball((k + part) * DT)
                    for s in segments:
                        if s.number == k and not (time < s.start or time > s.start + s.length):
                            assert encloses(s.at(time - s.start), reached)
        last = [s for s in segments if s.number == 1][-1]
        # The box is not blown up: the flow stretches it by a small factor only.
        assert all(item.rad() < 40 * ball(width) for item in last.end)


def test_parameters_may_be_boxes() -> None:
    """The robot of every length in an interval: one rod is a double integrator."""
    graph = robot_graph(rod_chain(1))
    with working_precision(80):
        length = arb("1.5", "0.01")
        field = field_of(graph, [length])
        (segment,) = tube(field, [arb(0), arb(1)], [[arb(2)]], arb("0.125"), Accuracy(6, 80, 1e-2))
        for exact in (Fraction("1.49"), Fraction("1.5"), Fraction("1.51")):
            slope = 6 / exact**3
            place = Fraction(1, 8) + slope / 2 * Fraction(1, 64)
            assert segment.end[0].overlaps(ball(place))
            assert segment.end[1].overlaps(ball(1 + slope / 8))


def test_the_tube_satisfies_the_differential_equation() -> None:
    """Coefficients by coefficients: i x_i is the series of the right side, in exact arithmetic."""
    graph = robot_graph(rod_chain(2), PULL)
    program = tape(graph.acceleration)
    with mp.workdps(DIGITS), working_precision(150):
        field = field_of(graph, [ball(1), ball(Fraction(3, 2))])
        state, u = [ball(Fraction(i + 1, 7)) for i in range(4)], [ball(1), ball(-2)]
        found = field.taylor(state, u, 8)
        h = mp.mpf("1e-3")

        def value(i: int, t: mp.mpf) -> mp.mpf:
            terms = [mp.mpf(c.mid().str(38, radius=False)) for c in found[i]]
            return mp.fsum(c * t**k for k, c in enumerate(terms))

        def rate(i: int, t: mp.mpf) -> mp.mpf:
            terms = [mp.mpf(c.mid().str(38, radius=False)) for c in found[i]]
            return mp.fsum(k * c * t ** (k - 1) for k, c in enumerate(terms) if k)

        x = [value(i, h) for i in range(4)]
        constants = [number(c.value) if hasattr(c, "value") else +mp.pi for c in graph.constants]
        inputs = [*x, mp.mpf(1), mp.mpf(-2), mp.mpf(1), mp.mpf(3) / 2, *constants]
        slopes = [*x[2:], *program.evaluate(inputs, Multiprecision())]
        for i in range(4):
            assert abs(rate(i, h) - slopes[i]) < 1e-17


def test_a_singular_robot_has_no_tube() -> None:
    """A joint that moves nothing, M = 0."""
    builder = Builder()
    wrist = builder.joint(builder.link(builder.joint(WORLD), builder.number(1)))
    builder.effector(wrist)
    graph = robot_graph(builder.build())
    with working_precision(80), pytest.raises(EnclosureFailure, match="beyond 0"):
        list(tube(field_of(graph, []), [arb(0)] * 4, [[arb(1)] * 2], arb(1), ACCURATE))


def test_a_numerically_singular_robot_has_no_tube() -> None:
    """A point on the axis of its turret: M = diag(0, 1), but only for this length."""
    builder = Builder()
    turret = builder.joint(WORLD)
    builder.point(builder.move(turret, "x", builder.parameter()), builder.number(1))
    graph = robot_graph(builder.build())
    with working_precision(80):
        for length in (arb(0), arb(0, "0.1"), arb(0, 10)):
            with pytest.raises(EnclosureFailure, match="beyond 0"):
                list(tube(field_of(graph, [length]), [arb(0)] * 2, [[arb(1)]], arb(1), ACCURATE))


def test_a_robot_that_becomes_singular_has_no_tube_beyond() -> None:
    """A point on a slide through the axis of its turret: M = diag(r^2, 1), singular at r = 0."""
    builder = Builder()
    slide = builder.joint(builder.joint(WORLD), "x", "prismatic")
    builder.point(slide, builder.number(1))
    builder.effector(slide)
    graph = robot_graph(builder.build())
    with working_precision(80):
        field = field_of(graph, [])
        state = [arb(0), ball(Fraction(1, 2)), arb(0), arb(-4)]
        found = tube(field, state, [[arb(0), arb(0)]] * 3, arb("0.125"), Accuracy(10, 80, 1e-6))
        times = []
        with pytest.raises(EnclosureFailure, match="no enclosure"):
            times.extend(float((s.start + s.length).mid()) for s in found)
        assert max(times, default=0.0) <= 0.125 + 1e-9


def test_an_escape_in_finite_time_has_no_tube_beyond() -> None:
    """q'' = 2 q^3, q(0) = q'(0) = 1: q = 1 / (1 - t), gone at t = 1."""
    q, v, a, u = (ca.SX.sym(name) for name in "qvau")
    slope = 2 * q * q * q
    jacobian = ca.vec(ca.densify(ca.jacobian(slope - a, ca.vertcat(q, v))))
    field = VectorField(
        tape(ca.Function("balance", [q, v, u], [ca.vertcat(1, slope)])),
        tape(ca.Function("variation", [q, v, a, u], [jacobian])),
        1,
        (),
    )
    with working_precision(80):
        inputs, step, segments = [[arb(0)]] * 16, ball(Fraction(1, 8)), []
        with pytest.raises(EnclosureFailure):
            segments.extend(tube(field, [arb(1), arb(1)], inputs, step, ACCURATE))
        ends = [segment.start + segment.length for segment in segments]
        for segment, end in zip(segments, ends, strict=True):
            assert segment.end[0].overlaps(1 / (1 - end))
            assert segment.end[1].overlaps(1 / (1 - end) ** 2)
        assert 0.9 < float(ends[-1].mid()) < 1


def test_a_larger_remainder_needs_fewer_segments() -> None:
    graph = robot_graph(rod_chain(2), PULL)
    with working_precision(128):
        field = field_of(graph, [ball(1), ball(1)])
        state, inputs = [arb(1), arb(-1), arb(2), arb(3)], [[arb(5), arb(-5)]] * 2
        counts = []
        for remainder in (1e-3, 1e-9, 1e-14):
            accuracy = replace(ACCURATE, remainder=remainder)
            counts.append(len(list(tube(field, state, inputs, ball(DT), accuracy))))
        assert counts[0] <= counts[1] <= counts[2]
        assert counts[0] < counts[2]


def test_a_step_of_uncertain_length_is_covered_to_its_end() -> None:
    """q'' = 0 from a ball of lengths: the end contains q0 + v0 h for the shortest and longest h."""
    builder = Builder()
    builder.point(builder.joint(WORLD, "x", "prismatic"), builder.number(1))
    field = field_of(robot_graph(builder.build()), [])
    step = arb("0.125", "0.01")
    (segment,) = tube(field, [arb(1), arb(2)], [[arb(0)]], step, Accuracy(4, 53, 1e-2))
    for h in ("0.1151", "0.1349"):
        assert segment.end[0].contains(1 + 2 * arb(h))
    # The enclosures hold over all of the longest step, from 0 on.
    for h in (arb(0), step, arb("0.1349", 0)):
        assert segment.at(h)[0].contains(1 + 2 * h)


def test_polynomials() -> None:
    assert polynomial([arb(1), arb(2), arb(3)], arb(2)) == 17
    assert polynomial([], arb(2)) == 0
    assert ctx.prec == 53

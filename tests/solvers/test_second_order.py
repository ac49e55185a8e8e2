"""What is of second order in deviations: forms over sets, second derivatives, wide sets."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

import mpmath as mp
import numpy as np
import pytest
from flint import arb, arb_mat

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.expressions.tape import tape
from compiler.robots.robot import WORLD, RobotModel
from solvers.verifier.proofs.control_law import InputError
from solvers.verifier.proofs.enclosure import Accuracy, tube
from solvers.verifier.proofs.second_derivatives import mean_derivatives
from solvers.verifier.proofs.second_order import range_of_forms
from solvers.verifier.proofs.vector_field import Curvature, VectorField
from tests.oracles.driven_robots import driven
from tests.oracles.precise_flow import DIGITS, chain_flow
from tests.oracles.robots import Builder, rod_chain
from tests.solvers.test_enclosure_sets import field_of

ROUGH = Accuracy(order=10, bits=64, remainder=1e-8)


def matrix(values: np.ndarray) -> arb_mat:
    return arb_mat([[arb(x) for x in row] for row in values.tolist()])


def test_the_range_of_a_form_holds_all_its_values_and_is_close() -> None:
    """Against all corners, and points between, of random forms; scales differ by 10^8."""
    rng = np.random.default_rng(22)
    for trial in range(40):
        size, count = int(rng.integers(1, 5)), int(rng.integers(1, 8))
        scales = 10.0 ** rng.uniform(-4, 4, size)
        columns = rng.normal(size=(size, count)) * scales[:, None]
        half = rng.normal(size=(size, size)) / np.outer(scales, scales)
        hessian = half + half.T if trial % 2 else half @ half.T
        with working_precision(53):
            centre, radius = range_of_forms([matrix(hessian)], matrix(columns))[0]
            low, high = float((centre - radius).lower()), float((centre + radius).upper())
        corners = np.array(list(product((-1.0, 1.0), repeat=count)))
        points = np.concatenate([corners, corners * rng.uniform(0, 1, corners.shape), 0 * corners])
        values = 0.5 * np.einsum("ai,ij,aj->a", points @ columns.T, hessian, points @ columns.T)
        assert low <= values.min() + 1e-12 * abs(low)
        assert values.max() <= high + 1e-12 * abs(high)
        form = columns.T @ hessian @ columns
        diagonal = np.abs(np.diag(form)).sum()
        most = 0.5 * np.abs(form).sum() - 0.25 * diagonal
        assert float(radius) <= most * (1 + 1e-3)


def test_the_range_of_a_diagonal_form_is_exact() -> None:
    """3 r^2 - 5 s^2 over the unit square has the values [-5, 3]."""
    with working_precision(53):
        found = range_of_forms([matrix(np.diag([6.0, -10.0]))], matrix(np.eye(2)))
        centre, radius = (float(item) for item in found[0])
    assert centre - radius == pytest.approx(-5, rel=1e-4)
    assert centre + radius == pytest.approx(3, rel=1e-4)


def test_uncertain_second_derivatives_widen_a_form() -> None:
    """(2 +- 1) r^2 / 2 over |r| <= 2 reaches 6."""
    with working_precision(53):
        centre, radius = range_of_forms([arb_mat([[arb(2, 1)]])], arb_mat([[arb(2)]]))[0]
        assert float(centre + radius) >= 6
        assert float(centre + radius) <= 6.01


@pytest.mark.parametrize("motors", [False, True])
def test_the_second_derivatives_are_those_of_what_is_balanced(motors: bool) -> None:
    """Against differences of the Jacobian, in floats."""
    rng = np.random.default_rng(4)
    model = driven(rod_chain(2)) if motors else rod_chain(3)
    graph = robot_graph(model, (Fraction(1, 3), Fraction(-3)), absolute_angles(model))
    assert graph.curvature is not None
    function, places = graph.curvature
    n, m = len(model.dofs), graph.input_slopes.size1_in(2)
    size = graph.variation.size1_in(1) + n
    theta = [1.25, 0.75, 1.5][: len(model.parameters)]
    k = [float(c.value) for c in graph.constants]
    u, z = rng.uniform(-1, 1, m), rng.uniform(-1, 1, size + n)
    values = np.array(function(z[:n], z[n:size], z[size:], u, theta, k)).ravel()
    height = size - n
    found = np.zeros((height, size + n, size + n))
    for (i, j, c), value in zip(places, values, strict=True):
        found[i, j, c] = found[i, c, j] = value

    def slopes(at: np.ndarray) -> np.ndarray:
        jacobian = graph.variation(at[:n], at[n:size], at[size:], u, theta, k)
        rows = np.array(jacobian).reshape((height, size), order="F")
        mass = np.array(graph.mass_matrix(at[:n], theta, k))
        rest = np.zeros((height - n, n))
        return np.concatenate([rows, np.concatenate([-mass, rest])], axis=1)

    for j in range(size + n):
        step = 1e-6 * np.eye(size + n)[j]
        expected = (slopes(z + step) - slopes(z - step)) / 2e-6
        np.testing.assert_allclose(found[:, :, j], expected, atol=1e-7)
    assert np.abs(found).max() > 0.5


def arm_in_space(joints: int) -> RobotModel:
    """A chain of joints about z, y and x, with solid links; nothing in it is aligned."""
    builder, frame = Builder(dimension=3), WORLD
    inertia = [Fraction(x, 1000) for x in (20, 25, 33, 2, 0, 1)]
    com = Fraction(1, 10), Fraction(1, 50), Fraction(1, 30)
    for i in range(joints):
        frame = builder.joint(frame, "zyzxyz"[i % 6])
        builder.solid(frame, Fraction(3, 2), com, inertia)
        frame = builder.move(frame, "zx"[i % 2], builder.number(Fraction(3, 10)))
    builder.effector(frame)
    return builder.build()


@pytest.mark.parametrize(("joints", "made"), [(6, True), (12, False)])
def test_second_derivatives_of_large_robots_are_not_made(joints: int, made: bool) -> None:
    """Those of twelve joints in space take seconds, and one evaluation half of one."""
    down = (Fraction(0), Fraction(0), Fraction("-9.81"))
    assert (robot_graph(arm_in_space(joints), down).curvature is not None) is made


@pytest.mark.parametrize("model", [rod_chain(2), arm_in_space(3)], ids=["plane", "space"])
@pytest.mark.parametrize("in_machine", [False, True])
def test_means_hold_second_derivatives_on_the_way(model: RobotModel, in_machine: bool) -> None:
    """Against quadrature with the weight 2 (1 - h), and natural enclosures part by part."""
    rng = np.random.default_rng(8)
    pull = (Fraction(1, 3), Fraction(-3), Fraction(2))[: model.dimension]
    graph = robot_graph(model, pull)
    curvature, second = Curvature.of(graph), graph.curvature
    assert curvature is not None
    assert curvature.slopes is not None
    assert second is not None
    n, m = len(model.dofs), len(model.dofs)
    theta = [1.25, 0.75][: len(model.parameters)]
    k = [float(c.value) for c in graph.constants]
    u, p = rng.uniform(-1, 1, m), rng.uniform(-1, 1, 3 * n)
    most = 0.05 * rng.uniform(0.5, 2, 3 * n)
    tail, inputs = tuple(arb(x) for x in [*theta, *k]), [arb(x) for x in u]
    point, reach = [arb(x) for x in p], [arb(x) for x in most]
    field = VectorField(tape(graph.balance), tape(graph.variation), n, tail, in_machine=in_machine)
    near = mean_derivatives(field, curvature, point, inputs, reach)
    parts = mean_derivatives(field, replace(curvature, slopes=None), point, inputs, reach)
    places, weights = np.polynomial.legendre.leggauss(12)
    places, weights = (places + 1) / 2, weights / 2
    for _ in range(30):
        z = most * rng.choice([-1.0, 1.0], 3 * n) * rng.choice([1.0, rng.random()], 3 * n)
        mean = 0.0
        for h, weight in zip(places, weights, strict=True):
            at = p + h * z
            values = second[0](at[:n], at[n : 2 * n], at[2 * n :], u, theta, k)
            mean = mean + 2 * (1 - h) * weight * np.array(values).ravel()
        for enclosures in (near, parts):
            for found, value in zip(enclosures, mean, strict=True):
                assert float(abs(found.mid() - value)) <= float(found.rad()) + 1e-12
    total = [sum(float(x.rad()) for x in enclosures) for enclosures in (near, parts)]
    assert total[0] < 0.8 * total[1]


def test_the_slopes_of_second_derivatives_are_those() -> None:
    """Against differences, in floats."""
    rng = np.random.default_rng(3)
    graph = robot_graph(arm_in_space(2), (Fraction(0), Fraction(1), Fraction(-3)))
    assert graph.curvature is not None
    assert graph.curvature_slopes is not None
    (second, _), (slopes, places) = graph.curvature, graph.curvature_slopes
    k = [float(c.value) for c in graph.constants]
    z, u = rng.uniform(-1, 1, 6), rng.uniform(-1, 1, 2)
    found = np.zeros((second.size1_out(0), 6))
    for (value, entry), slope in zip(
        places, np.array(slopes(z[:2], z[2:4], z[4:], u, [], k)).ravel(), strict=True
    ):
        found[value, entry] = slope

    def at(z: np.ndarray) -> np.ndarray:
        return np.array(second(z[:2], z[2:4], z[4:], u, [], k)).ravel()

    for entry in range(6):
        step = 1e-5 * np.eye(6)[entry]
        expected = (at(z + step) - at(z - step)) / 2e-5
        np.testing.assert_allclose(found[:, entry], expected, atol=1e-8)
    assert np.abs(found).max() > 0.1


def test_wide_sets_of_an_arm_hold_its_motions_and_are_narrower_than_by_boxes() -> None:
    """Sixty digits, starts at corners of a set of half a degree, inputs off by 5 %, l1 != l2."""
    rng = np.random.default_rng(9)
    pull = (Fraction(1, 3), Fraction("-9.81"))
    graph = robot_graph(rod_chain(2), pull)
    lengths = [Fraction(5, 4), Fraction(3, 4)]
    state = [Fraction(2, 5), Fraction(-4, 5), Fraction(1, 2), Fraction(-3, 4)]
    inputs = [[Fraction(20), Fraction(3)], [Fraction(15), Fraction(-2)]]
    radius, part, step = Fraction(1, 40), Fraction(1, 20), Fraction(1, 20)
    with working_precision(64):
        field = field_of(graph, lengths)
        start = [ball(x) + arb(0, 1) * ball(radius) for x in state]
        rows = [[ball(x) for x in u] for u in inputs]
        error = InputError((ball(part),) * 2, (arb(0), arb(0)))
        closer = list(tube(field, start, rows, ball(step), ROUGH, error=error))
        boxes = replace(field, curvature=None)
        coarser = list(tube(boxes, start, rows, ball(step), ROUGH, error=error))
    pairs = zip(closer[-1].end, coarser[-1].end, strict=True)
    ratios = [float(a.rad()) / float(b.rad()) for a, b in pairs]
    assert all(ratio < limit for ratio, limit in zip(ratios, (1, 1, 0.9, 0.9), strict=True))
    with mp.workdps(DIGITS), working_precision(200):
        for _ in range(6):
            signs = rng.choice([-1, 1], 4)
            corner = [x + int(s) * radius for x, s in zip(state, signs, strict=True)]
            current = [mp.mpf(x.numerator) / x.denominator for x in corner]
            for number, u in enumerate(inputs):
                applied = [x * (1 + part * int(rng.choice([-1, 1]))) for x in u]
                args = [[mp.mpf(x.numerator) / x.denominator for x in row]
                        for row in (applied, lengths, pull)]  # fmt: skip
                current = chain_flow(current, *args, mp.mpf(1) / 20)
                last = next(each for each in closer if each.steps[1] == number + 1)
                for item, value in zip(last.end, current, strict=True):
                    exact = arb(mp.nstr(value, DIGITS))
                    assert abs(exact - item.mid()) <= item.rad() + arb(10) ** -20

"""A robot's field in balls of doubles holds that in balls of any precision; and so do its tubes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from solvers.verifier.proofs.control_law import InputError
from solvers.verifier.proofs.enclosure import Accuracy, tube
from solvers.verifier.proofs.linearisation import Coefficients
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import InitialSet, box
from tests.oracles.driven_robots import driven
from tests.oracles.robots import rod_chain
from tests.oracles.some_cases import campaign, examples, some
from tests.solvers.test_enclosure_sets import field_of
from tests.solvers.test_second_order import arm_in_space

PRECISE, DOUBLES = 256, 64
MODELS = {
    "plane": rod_chain(2),
    "three links": rod_chain(3),
    "motor and friction": driven(rod_chain(2)),
    "space": arm_in_space(3),
}
THETA = [Fraction(5, 4), Fraction(3, 4), Fraction(7, 8)]


def graph_of(model: RobotModel) -> RobotGraph:
    pull = (Fraction(1, 3), Fraction(-3), Fraction(2))[: model.dimension]
    return robot_graph(model, pull)


class Twins:
    """The same field twice, with balls of doubles and without, and random numbers for it."""

    def __init__(self, model: RobotModel, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        with working_precision(PRECISE):
            self.precise = field_of(graph_of(model), THETA[: len(model.parameters)])
        self.doubles = replace(self.precise, in_machine=True)
        self.inputs = len(robot_inputs(model))

    def points(self, count: int, scale: float = 1.0) -> list[Fraction]:
        return [Fraction(int(x), 1024) for x in self.rng.uniform(-1e3, 1e3, count) * scale]

    def about(self, points: Sequence[Fraction], radius: float) -> list[arb]:
        """Balls that hold the points, which are not their middles."""
        moved = self.rng.uniform(-radius, radius, len(points))
        return [ball(x) + arb(0, radius) + arb(m) for x, m in zip(points, moved, strict=True)]

    def series(self, count: int, length: int, radius: float) -> tuple[list[Coefficients], ...]:
        """Exact series, and such of balls that hold them."""
        rows = [self.points(length) for _ in range(count)]
        exact = [list(map(ball, row)) for row in rows]
        return exact, [self.about(row, radius) for row in rows]


def hold(wide: Sequence[arb], exact: Sequence[arb]) -> None:
    assert len(wide) == len(exact) > 0
    for near, point in zip(wide, exact, strict=True):
        assert float(point.rad()) < 1e-60
        assert near.is_finite()
        assert abs(point - near.mid()) <= near.rad()


@pytest.mark.parametrize("radius", [0.0, 1e-12, 1e-2])
@pytest.mark.parametrize("name", MODELS)
def test_all_that_is_asked_of_a_field(name: str, radius: float) -> None:
    twins = Twins(MODELS[name], 3)
    precise, doubles = twins.precise, twins.doubles
    n, size = precise.dofs, precise.size
    with working_precision(PRECISE):
        u = twins.points(twins.inputs)
        exact_u, wide_u = list(map(ball, u)), twins.about(u, radius)
        exact, wide = twins.series(size, 7, radius)
        pulls, wide_pulls = twins.series(n, 5, radius)
        state = [row[0] for row in exact]
        expected = (
            precise.acceleration(state, exact_u),
            precise.defect(exact, exact_u, 6),
            precise.linearise(exact, pulls, exact_u, 5),
            precise.smooth_values(precise.balance, state, exact_u),
        )
    with working_precision(DOUBLES):
        assert doubles.machine is not None
        box_of = [row[0] for row in wide]
        found = (
            doubles.acceleration(box_of, wide_u),
            doubles.defect(wide, wide_u, 6),
            doubles.linearise(wide, wide_pulls, wide_u, 5),
            doubles.smooth_values(doubles.balance, box_of, wide_u),
        )
    with working_precision(PRECISE):
        hold(found[0], expected[0])
        for near, row in zip(found[1], expected[1], strict=True):
            hold(near, row)
        for part in ("inertia", "slopes"):
            pairs = zip(getattr(found[2], part), getattr(expected[2], part), strict=True)
            for near, matrix in pairs:
                hold(near.entries(), matrix.entries())
        hold(found[3], expected[3])


@pytest.mark.parametrize("name", MODELS)
def test_taylor_coefficients_are_near_those_of_the_solution(name: str) -> None:
    twins = Twins(MODELS[name], 5)
    with working_precision(PRECISE):
        state = [ball(x) for x in twins.points(twins.precise.size)]
        u = [ball(x) for x in twins.points(twins.inputs)]
        expected = twins.precise.taylor(state, u, 9)
    with working_precision(DOUBLES):
        found = twins.doubles.taylor(state, u, 9)
        few = twins.doubles.taylor(state, u, 9, lambda rows: len(rows[0]) == 5)
    for near, row in zip(found, expected, strict=True):
        assert near[0] == row[0]
        assert list(map(float, near)) == pytest.approx(list(map(float, row)), rel=1e-9, abs=1e-9)
    assert [row[:5] for row in found] == few


def test_more_digits_than_doubles_have_are_arb_s() -> None:
    twins = Twins(MODELS["plane"], 1)
    for bits, fits in ((53, True), (96, True), (97, False), (192, False)):
        with working_precision(bits):
            assert (twins.doubles.machine is not None) is fits
            assert twins.precise.machine is None


# --- Tubes ----------------------------------------------------------------------------------------

ROUGH, FINE = Accuracy(10, 96, 1e-10), Accuracy(20, 192, 1e-22)


def ends(
    field: VectorField,
    start: InitialSet,
    rows: Sequence[Sequence[Fraction]],
    accuracy: Accuracy,
    error: InputError | None = None,
) -> list[tuple[arb, ...]]:
    """The boxes of the states at the ends of the steps."""
    found = {}
    with working_precision(accuracy.bits):
        inputs = [[ball(u) for u in row] for row in rows]
        for segment in tube(field, start, inputs, ball(Fraction(1, 10)), accuracy, error):
            found[segment.number] = segment.end
    return [found[number] for number in sorted(found)]


def contained(name: str, seed: int, *, in_machine: bool = True) -> None:
    """A motion from a point of a start is in the tube from all of it, inputs being off, too."""
    twins = Twins(MODELS[name], seed)
    field = twins.doubles if in_machine else twins.precise
    start = twins.points(field.size, 0.7)
    rows = [twins.points(twins.inputs, 2.0) for _ in range(3)]
    radius = float(twins.rng.choice([0.0, 1e-9, 1e-4]))
    off = float(twins.rng.choice([0.0, 1e-3]))
    with working_precision(PRECISE):
        wide = box(twins.about(start, radius))
        error = InputError((arb(0),) * twins.inputs, (arb(off),) * twins.inputs) if off else None
    signs = twins.rng.uniform(-1, 1, (len(rows), twins.inputs))
    given = [
        [u + Fraction(off * s) for u, s in zip(row, part, strict=True)]
        for row, part in zip(rows, signs, strict=True)
    ]
    found = ends(field, wide, rows, ROUGH, error)
    with working_precision(FINE.bits):
        point = box([ball(x) for x in start])
    exact = ends(twins.precise, point, given, FINE)
    with working_precision(PRECISE):
        for near, row in zip(found, exact, strict=True):
            for x, y in zip(near, row, strict=True):
                assert x.is_finite()
                # Where friction changes its sign, no tube is narrow.
                narrow = float(y.rad()) < 1e-15
                held = x.contains(y) if narrow else x.overlaps(y)
                assert held, (name, seed)


@pytest.mark.parametrize("name", MODELS)
def test_some_tubes_hold_motions_of_high_precision(name: str) -> None:
    for seed in range(examples(1, 4)):
        contained(name, seed)


@pytest.mark.parametrize("in_machine", some([True, False], 1))
def test_from_an_exact_start_disturbed_motions_spread(in_machine: bool) -> None:
    """A point has no columns; its tube is soon so wide that what is of second order counts."""
    contained("space", 107, in_machine=in_machine)


@pytest.mark.parametrize("part", campaign(range(5), 1))
@pytest.mark.parametrize("name", MODELS)
def test_a_thousand_tubes_hold_motions_of_high_precision(name: str, part: int) -> None:
    for seed in range(100 + 50 * part, 150 + 50 * part):
        contained(name, seed)

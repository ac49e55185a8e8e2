"""Guesses of how long a segment of a tube may be."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice
from math import factorial

import pytest
from flint import arb

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import ball, constant_ball, working_precision
from compiler.expressions.tape import tape
from solvers.verifier.proofs.enclosure import tube
from solvers.verifier.proofs.step_control import StepControl, good_length
from solvers.verifier.proofs.trajectory_proof import ACCURACIES
from solvers.verifier.proofs.vector_field import VectorField
from tests.oracles.robots import rod_chain


def sine(order: int, noise: float) -> list[arb]:
    """The Taylor coefficients of sin(10 t); those that are zero may be rounded."""
    return [
        arb(noise if k % 2 == 0 else (-1) ** (k // 2) * 10.0**k / factorial(k))
        for k in range(order + 1)
    ]


@pytest.mark.parametrize("noise", [0.0, 1e-40, 1e-25])
@pytest.mark.parametrize("order", [6, 7, 10, 11, 14, 15])
def test_powers_that_are_missing_say_nothing_about_the_length(order: int, noise: float) -> None:
    """The first coefficient left out is a tenth of the tolerance to a tenth of the length."""
    length = good_length([sine(order, noise)], 1e-15)
    left_out = order + 1 if order % 2 == 0 else order + 2
    size = 10.0**left_out / factorial(left_out)
    assert length == pytest.approx((1e-15 / size) ** (1 / left_out), rel=0.6)


def test_a_start_at_rest_is_enclosed_at_every_accuracy() -> None:
    """The rates are odd in the time there, but for what is rounded."""
    graph = robot_graph(rod_chain(3), (Fraction(0), Fraction("-9.81")))
    for accuracy in ACCURACIES:
        with working_precision(accuracy.bits):
            start = [ball(Fraction(text)) for text in ("0.5", "0.3", "-0.4", "0", "0", "0")]
            inputs = [ball(Fraction(text)) for text in ("1", "-0.5", "0.3")]
            tail = (*[arb(1) / 2] * 3, *map(constant_ball, graph.constants))
            field = VectorField(tape(graph.balance), tape(graph.variation), 3, tail)
            segments = list(islice(tube(field, start, [inputs], arb(1), accuracy), 3))
            assert all(bool(segment.length > 0.004) for segment in segments), accuracy


def test_segments_get_short_where_what_is_of_second_order_adds_much() -> None:
    """A fifth of the rates in a step is too much, however close the box; an eighth is little."""
    control, length = StepControl(0.1), Fraction(1)
    while not control.close_enough(length, 1.0, 2.1):
        assert control.most == length / 2
        length = control.most
    assert length == Fraction(1, 16)
    assert control.close_enough(length, 1.0, 1.5)
    assert control.most == length
    assert control.close_enough(length, 1.0, 1.2)
    assert control.most == 2 * length


def test_a_box_that_is_too_large_shortens_segments_to_half_a_step() -> None:
    control = StepControl(0.1)
    assert not control.close_enough(Fraction(1), 3.0, 0.0)
    assert control.most == Fraction(1, 2)
    assert control.close_enough(Fraction(1, 2), 3.0, 0.0)

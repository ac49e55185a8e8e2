"""Refutations against hand-computed radii, and soundness against sampled poses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import hypot

import numpy as np
import pytest

from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.normal_form import normalise
from grammar_lang import ir
from solvers.backends.smt import solve_script
from tests.oracles.arms import ArmBuilder, effector_positions, interval, planar_arm
from tests.oracles.questions import (
    EVERYWHERE,
    SAT,
    UNSAT,
    decide,
    question,
    random_design,
    random_pose,
    random_robot,
    round_box_about,
)
from tests.oracles.some_cases import some

# --- hand-computed radii -------------------------------------------------------------------------


def distances(box):
    """Least and greatest distance of a box from the origin."""
    nearest = [max(lower, 0.0, -upper) for lower, upper in box]
    farthest = [max(abs(lower), abs(upper)) for lower, upper in box]
    return hypot(*nearest), hypot(*farthest)


def meets(box, ring):
    near, far = distances(box)
    return near <= ring[1] and far >= ring[0]


def ring(lengths):
    """The radii that freely turning links reach: an annulus."""
    return max(0.0, 2 * max(lengths) - sum(lengths)), sum(lengths)


@pytest.mark.parametrize("seed", range(40))
def test_arms_of_given_lengths_reach_their_annulus(seed):
    rng = np.random.default_rng(seed)
    lengths = [Fraction(int(n), 8) for n in rng.integers(2, 24, size=rng.integers(1, 5))]
    boxes = []
    for _ in range(2):
        low = rng.integers(-20, 20, size=2) / 4
        size = rng.integers(1, 5, size=2) / 8
        boxes.append(tuple(zip(low, low + size, strict=True)))
    arm = ArmBuilder()
    for length in lengths:
        arm.revolute().link(length)
    radii = ring([float(length) for length in lengths])
    if any(abs(d - r) < 1e-9 for box in boxes for d in distances(box) for r in radii):
        pytest.skip("touching")
    exact = [tuple(tuple(map(Fraction, side)) for side in box) for box in boxes]
    expected = SAT if all(meets(box, radii) for box in boxes) else UNSAT
    assert decide(arm.effector(), question(*exact, ((-9, 9), (-9, 9)))) == expected


@pytest.mark.parametrize("seed", range(40))
def test_one_link_of_free_length_needs_a_common_radius(seed):
    rng = np.random.default_rng(100 + seed)
    boxes = []
    for _ in range(2):
        low = rng.integers(0, 20, size=2) / 4
        boxes.append(tuple(zip(low, low + rng.integers(1, 5, size=2) / 8, strict=True)))
    (a, b), (c, d) = map(distances, boxes)
    low, high = max(a, c, 0.5), min(b, d, 5.0)
    if abs(low - high) < 1e-9:
        pytest.skip("touching")
    exact = [tuple(tuple(map(Fraction, side)) for side in box) for box in boxes]
    expected = SAT if low < high else UNSAT
    assert decide(planar_arm(1), question(*exact, ((-9, 9), (-9, 9)))) == expected


# --- soundness -----------------------------------------------------------------------------------


BUDGET = 30_000


def pinned(model, theta):
    """The model with every parameter at one value, so that the solver has an easy time."""
    parameters = tuple(
        replace(parameter, domain=interval(Fraction(value), Fraction(value)))
        if isinstance(parameter.domain, ir.Interval)
        else parameter
        for parameter, value in zip(model.parameters, map(float, theta), strict=True)
    )
    return replace(model, parameters=parameters)


def sound(seed, dimension, budget, *, pin):
    """Ask of a random robot what it just did; the answers."""
    rng = np.random.default_rng(1000 * dimension + seed)
    model = random_robot(rng, dimension)
    theta = random_design(rng, model)
    if pin:
        model = pinned(model, theta)
    places = [effector_positions(model, random_pose(rng, model), theta) for _ in range(2)]
    width = Fraction(1, 10 ** int(rng.integers(1, 4)))
    for start in range(len(model.effectors)):
        for reach in range(len(model.effectors)):
            boxes = (
                round_box_about(places[0][start], width),
                round_box_about(places[1][reach], width),
            )
            named = {"start_effector": start, "reach_effector": reach}
            asked = question(*boxes, EVERYWHERE[:dimension], **named)
            yield solve_script(refutation_script(normalise(model), asked), resources=budget)
            # Whatever the normal form does, the model itself is treated alike.
            yield solve_script(refutation_script(model, asked), resources=budget)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", some(range(60), 8))
def test_what_a_robot_does_is_never_refuted(seed, dimension):
    assert UNSAT not in sound(seed, dimension, BUDGET, pin=True)


@pytest.mark.slow
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", range(60, 90))
def test_what_a_robot_does_is_never_refuted_with_free_parameters(seed, dimension):
    assert UNSAT not in sound(seed, dimension, BUDGET, pin=False)

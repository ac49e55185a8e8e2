"""The bounds on forces, energies and distances against brute force and closed forms."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.expressions.evaluators.intervals import Ends, around
from compiler.unreachability.actuation_levels import Ramp, RateBounds, budget
from compiler.unreachability.actuation_metric import (
    EffortGroup,
    EnclosedMass,
    kinetic_speed,
    metric,
    most_power,
)
from compiler.unreachability.actuation_region import Neighbourhood


def enclosed(matrix, radius=0.0):
    """A matrix whose entries are all known up to a radius."""
    entries = [around(arb(float(x), radius)) for x in np.asarray(matrix).T.ravel()]
    middle = [around(entry.ball().mid()) for entry in entries]
    units = [[around(arb(i == j)) for i in range(len(entries))] for j in range(len(entries))]
    changes = [(unit, arb(radius)) for unit in units] if radius else []
    return EnclosedMass(entries, middle, changes)


def random_mass(rng, size):
    root = rng.normal(size=(size, size))
    return root @ root.T + 0.3 * np.eye(size)


GROUPS = {
    "each": [EffortGroup((0, 1, 2), arb(2), norm2=False)],
    "norm": [EffortGroup((0, 1, 2), arb(2), norm2=True)],
    "both": [EffortGroup((0, 2), arb(2), norm2=True), EffortGroup((1,), arb(3), norm2=False)],
}


def inputs_of(groups, rng):
    """Inputs on the bounds of the groups."""
    u = np.zeros(3)
    for group in groups:
        part = rng.normal(size=len(group.joints))
        size = np.linalg.norm(part) if group.norm2 else np.abs(part)
        u[list(group.joints)] = part / size * float(group.bound)
    return u


@pytest.mark.parametrize("kind", GROUPS)
@pytest.mark.parametrize("seed", range(5))
def test_no_force_is_larger_than_its_bound(kind, seed):
    rng = np.random.default_rng(seed)
    mass = random_mass(rng, 3)
    found = metric(enclosed(mass, 0.005), 3)
    bound, tight = (
        float(found.largest(GROUPS[kind])),
        float(metric(enclosed(mass), 3).largest(GROUPS[kind])),
    )
    largest = 0.0
    for _ in range(300):
        noise = rng.uniform(-0.005, 0.005, (3, 3))
        true = np.linalg.inv(mass + (noise + noise.T) / 2)
        u = inputs_of(GROUPS[kind], rng)
        largest = max(largest, float(np.sqrt(u @ true @ u)))
        force = rng.normal(size=3)
        assert np.sqrt(force @ true @ force) <= float(found.size([arb(x) for x in force])) + 1e-12
    assert largest <= bound
    assert tight <= 1.8 * largest


def test_of_a_chain_of_two_links_the_bound_is_attained():
    mass = np.array([[1.6, 0.36], [0.36, 0.114]])
    found = metric(enclosed(mass), 2).largest([EffortGroup((0, 1), arb(1), norm2=False)])
    true = max(u @ np.linalg.inv(mass) @ u for u in map(np.array, product((-1, 1), repeat=2)))
    assert float(found) == pytest.approx(np.sqrt(true), rel=1e-9)


def test_a_matrix_that_may_be_singular_has_no_metric():
    assert metric(enclosed([[1, 1], [1, 1.0]]), 2) is None
    assert metric(enclosed([[1, 0.9], [0.9, 1]], 0.2), 2) is None
    assert metric(enclosed([[1, 2], [2, 1.0]]), 2) is None
    unknown = EnclosedMass([Ends(arb("nan"), arb("nan"))], [around(arb(1))], [])
    assert metric(unknown, 1) is None


def test_the_centred_form_is_used():
    # M = [[1, x], [x, 1]] with x = 0.9 + y, known by its derivative only.
    wide = [around(arb(1)), around(arb(0, 3)), around(arb(0, 3)), around(arb(1))]
    middle = [around(ball(Fraction(x))) for x in ("1", "0.5", "0.5", "1")]
    slope = [around(arb(x)) for x in (0, 1, 1, 0)]
    found = metric(EnclosedMass(wide, middle, [(slope, ball(Fraction(1, 10)))]), 2)
    for x in (0.4, 0.5, 0.6):
        true = np.linalg.inv(np.array([[1, x], [x, 1]]))
        assert float(found.size([arb(1), arb(-1)])) ** 2 >= np.array([1, -1]) @ true @ [1, -1]


def test_power_and_kinetic_speed():
    rates = [arb(1), arb(2), arb(3)]
    assert float(most_power(GROUPS["each"], rates)) == pytest.approx(12)
    assert float(most_power(GROUPS["norm"], rates)) == pytest.approx(2 * np.sqrt(14))
    assert most_power(GROUPS["both"], [arb(1), None, arb(1)]) is None
    mass = [around(arb(x)) for x in (2, -1, -1, 3)]
    assert float(kinetic_speed(mass, [arb(1), arb(2)])) == pytest.approx(np.sqrt(2 + 4 + 12))


@pytest.mark.parametrize(
    ("first", "growth", "last", "time"),
    [(0, 2, 0, 3), (1, 2, None, 3), (1, 2, 0.5, 3), (9, 1, 0, 2), (0, 1, 9, 2), (3, 0, 1, 2)],
)
def test_a_ramp_is_the_lesser_of_two_lines(first, growth, last, time):
    ramp = Ramp(arb(first), arb(growth), None if last is None else arb(last))
    times = np.linspace(0, time, 200_001)
    lines = first + growth * times
    if last is not None:
        lines = np.minimum(lines, last + growth * (time - times))
    area = float(np.mean((lines[1:] + lines[:-1]) / 2)) * time
    assert float(ramp.integral(arb(time))) == pytest.approx(area, rel=1e-6)
    assert lines.max() - 1e-9 <= float(ramp.highest(arb(time)))
    if first != 9 and last != 9:
        assert float(ramp.highest(arb(time))) == pytest.approx(lines.max(), rel=1e-3)


def test_a_budget_takes_the_least_of_its_bounds():
    calm, wild = Ramp(arb(0), arb(1)), Ramp(arb(0), arb(9))
    assert float(budget(calm, wild, arb(0), arb(2)).length) == 2
    assert float(budget(wild, calm, arb(0), arb(2)).length) == 2
    found = budget(calm, calm, arb(-5), arb(2))
    assert [float(found.speed), float(found.energy)] == [2, -3]
    slow = budget(calm, calm, arb(-5), arb(2), RateBounds(arb(0.25), arb(0.125)))
    assert float(slow.length) == 0.5
    assert float(slow.energy) == pytest.approx(-5 + 0.25)


def test_boxes_that_touch():
    sides = [arb(x, 0.5) for x in (0.5, 1.5, 3.5, 5.7)]
    line = Neighbourhood([[side] for side in sides], [False])
    everything, seeds = np.ones(4, dtype=bool), np.array([True, False, False, False])
    assert list(line.joined(seeds, everything)) == [True, True, False, False]
    # 5.2 to 6.2 and 0 to 1 do not touch on the line; less a turn, -1.08 to -0.08 is near 0 only.
    circle = Neighbourhood([[arb(-3, 0.15)], [arb(3, 0.15)], [arb(0, 0.1)]], [True])
    assert list(circle.joined(np.array([True, False, False]), np.ones(3, dtype=bool))) == [
        True, True, False,
    ]  # fmt: skip
    corners = Neighbourhood([[arb(0, 1), arb(0, 1)], [arb(2, 1), arb(2, 1)]], [False, False])
    assert corners.joined(np.array([True, False]), np.ones(2, dtype=bool)).all()
    assert not corners.joined(np.array([True, False]), np.array([False, True])).any()

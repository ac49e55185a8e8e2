"""What momentum gives where weight pulls one way, against closed forms of optimal motions."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb

from compiler.unreachability.actuation_levels import Side, climb
from tests.oracles.driven_chains import Segment, answer, problem, spot

WEIGHT = "gravity (0, -9.8) m/s^2;"
SECOND = "horizon 4 steps of 0.25 s;"
LIFT = Segment(1, axis="y", along="x", kind="prismatic", limits="in [-8, 8] m")
"""A metre and a kilogram on a vertical slide: its weight is 9.8 N."""


def lifted(height, effort, rest="", segments=(LIFT,), start="start at (0)", halvings=(9,)):
    """Whether the tip provably does not get as far as to a height in a second."""
    joints = len(segments)
    target = spot((joints, height))
    clauses = f"{start}; reach T {rest}; effort <= {effort} N; {WEIGHT} {SECOND}"
    return answer(problem(list(segments), target, clauses), list(halvings))


@pytest.mark.parametrize("height", [0.1, 1, 5])
def test_what_is_weaker_than_the_weight_lifts_nothing(height):
    found = lifted(height, 9.7)
    assert found is not None
    assert found.available == 0


@pytest.mark.parametrize(
    ("effort", "height", "rest", "refuted"),
    [
        # (u - g) T^2 / 2 up, (u + g) T^2 / 2 down
        (11.8, 0.98, "", False), (11.8, 1.05, "", True),
        (1.8, -5.78, "", False), (1.8, -5.85, "", True),
        # from rest to rest: (u - g) (u + g) / (4 u) T^2 up, the same down, none with u < g
        (11.8, 0.90, "at rest", False), (11.8, 0.96, "at rest", True),
        (11.8, -0.90, "at rest", False), (11.8, -0.96, "at rest", True),
        (9.7, -0.1, "at rest", True),
    ],
)  # fmt: skip
def test_weight_counts_with_its_direction(effort, height, rest, refuted):
    assert (lifted(height, effort, rest) is not None) is refuted


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("height", "rates", "refuted"),
    [
        # t = (v + 21.6) / 23.6 s up at 2 m/s^2, then down at 21.6 m/s^2 to v: 0.952 m
        (0.94, "rates <= 0.5 m/s", False), (0.985, "rates <= 0.5 m/s", True),
        (0.985, "rates <= 2.1 m/s", False), (0.94, "rates <= 0.01 m/s", True),
    ],
)  # fmt: skip
def test_the_rate_at_the_end_counts(height, rates, refuted, side):
    weight = side * 9.8
    target = spot((1, side * height))
    clauses = f"start at (0); reach T {rates}; effort <= 11.8 N; gravity (0, {-weight}) m/s^2;"
    found = answer(problem([LIFT], target, f"{clauses} {SECOND}"), [9])
    assert (found is not None) is refuted


def test_friction_does_not_lift():
    brake = Segment(1, axis="y", kind="prismatic", limits="in [-8, 8] m",
                    own="torque(q) = u - 0.5 N*s/m * rate(q);")  # fmt: skip
    assert lifted(0.1, 9.7, segments=[brake]) is not None
    assert lifted(0.95, 11.8, segments=[brake]) is None
    assert lifted(1.05, 11.8, segments=[brake]) is not None
    # It takes the speed at the end, so that all of a fall may be at rest in the end.
    assert lifted(-0.96, 11.8, "at rest", segments=[brake]) is None


def test_a_slide_on_another_one_climbs_for_itself():
    # 2 kg on the rail; the lift on it is not coupled to it, whatever the order.
    rail = Segment(1, axis="x", kind="prismatic", limits="in [-8, 8] m", density=2)
    for segments in ([rail, LIFT], [LIFT, rail]):
        start = "start at (0, 0)"
        weak = 9.7 * (1 if segments[0] is rail else 3)
        assert lifted(0.8, weak, segments=segments, start=start, halvings=[5, 5]) is not None
        assert lifted(0.8, 1.3 * weak, segments=segments, start=start, halvings=[5, 5]) is None


def test_a_throw_rises_by_its_speed():
    start = "start in A rates <= 4 m/s"
    clauses = f"{start}; reach T; effort <= 4.8 N; {WEIGHT} {SECOND}"
    # 5 m/s^2 take 4 m/s in 1.6 m.
    for height, refuted in ((1.55, False), (1.7, True)):
        text = problem([LIFT], spot((1, height)), clauses, start=spot((1, 0)))
        assert (answer(text, [9]) is not None) is refuted


@pytest.mark.parametrize("growth", [-3, -0.5, 0, 2])
@pytest.mark.parametrize("back", [None, -1, 0, 4])
def test_a_climb_is_the_area_below_both_lines(growth, back):
    first, last, time = 1.5, 0.75, 2.0
    times = np.linspace(0, time, 200_001)
    lines = first + growth * times
    if back is not None:
        lines = np.minimum(lines, last + back * (time - times))
    area = float(np.mean(np.maximum(lines, 0))) * time
    end = None if back is None else Side(arb(last), arb(back))
    found = float(climb(Side(arb(first), arb(growth)), end, arb(time)))
    assert area - 1e-4 <= found
    if back is None:
        assert found <= area + 1e-4

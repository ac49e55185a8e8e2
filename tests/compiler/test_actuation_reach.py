"""Goals out of reach of the drives, against closed forms of optimal motions."""

from __future__ import annotations

from math import acos, cos, pi, sin

import pytest
from flint import arb

from compiler.unreachability.actuation_bounds import LeafBox
from compiler.unreachability.actuation_reach import drive_reach, out_of_reach
from compiler.unreachability.box_tree import Part
from compiler.unreachability.motion_conditions import motion_conditions
from tests.oracles.driven_chains import (
    LIMITED,
    Segment,
    answer,
    answers,
    problem,
    robot_of,
    spot,
)
from tests.oracles.some_cases import some

ROD = [Segment(1)]
"""One metre and one kilogram: an inertia of 1/3 kg m^2 about the joint."""
FREE = [Segment(1, limits="")]
PUSH = "effort <= 1 N*m;"


def turned(angle, clauses, segments=ROD, halvings=9, **more):
    """Whether the tip of a rod provably does not get as far as to an angle."""
    target = spot((cos(angle), sin(angle)))
    return answer(problem(segments, target, clauses, **more), [halvings])


# --- effort: a bang, or a bang-bang, is optimal --------------------------------------------------


@pytest.mark.parametrize(
    ("angle", "rest", "refuted"),
    [(0.94, "", False), (0.99, "", True), (0.46, "at rest", False), (0.51, "at rest", True)],
)
@pytest.mark.parametrize("side", [1, -1])
def test_a_rod_turns_by_u_over_2_inertia_times_the_time_squared(angle, rest, refuted, side):
    # u T^2 / (2 I) = 0.96 rad in 0.8 s, half of it from rest to rest.
    clauses = f"start at (0); reach T {rest}; {PUSH} horizon 8 steps of 0.1 s;"
    found = turned(side * angle, clauses)
    assert (found is not None) is refuted
    if found is not None:
        assert found.available == pytest.approx(0.48 if rest else 0.96, abs=1e-6)
        assert angle - 0.03 < found.needed <= angle + 0.003
        assert found.unit == "rad"


@pytest.mark.parametrize(("angle", "refuted"), [(0.94, False), (0.99, True)])
@pytest.mark.parametrize(
    "formula",
    [
        "eventually[0.2 s, 0.8 s] T by effector 1",
        "eventually[0 s, 0.5 s] (not T by effector 1 and eventually[0 s, 0.3 s] T by effector 1)",
        "always[0.8 s, 0.9 s] T by effector 1",
    ],
)
def test_a_visit_has_a_deadline_before_the_end(angle, refuted, formula):
    # The same 0.96 rad in 0.8 s, although the horizon is 3 s.
    clauses = f"start at (0); satisfy {formula}; {PUSH} horizon 30 steps of 0.1 s;"
    found = turned(angle, clauses)
    assert (found is not None) is refuted
    assert found is None or found.available == pytest.approx(0.96, abs=1e-6)
    late = clauses.replace("0.8 s", "2 s").replace("0.9 s", "2 s").replace("0.3 s", "1.5 s")
    assert turned(angle, late) is None


@pytest.mark.parametrize(
    ("angle", "rest", "refuted"),
    [
        (0.94, "rates <= 99 rad/s for 0.5 s", False),
        (0.99, "rates <= 99 rad/s for 0.5 s", True),
        (0.46, "at rest for 0.5 s", False),
        (0.51, "at rest for 0.5 s", True),
        (0.51, "at rest", False),
    ],
)
def test_a_stay_in_the_target_begins_before_the_end(angle, rest, refuted):
    # 0.8 s of 1.3 s are left before it: u T^2 / (2 I) = 0.96 rad, half of it from rest to rest.
    found = turned(angle, f"start at (0); reach T {rest}; {PUSH} horizon 13 steps of 0.1 s;")
    assert (found is not None) is refuted
    assert found is None or found.available == pytest.approx(
        0.48 if "at rest" in rest else 0.96, abs=1e-6
    )


@pytest.mark.parametrize("horizon", ["8", "at most 8"])
@pytest.mark.parametrize(
    ("limit", "most"),
    # 0.3 s with 1 rad/s; with 4 rad/s^2, 0.3 s from rest to rest: at most 0.6 rad/s all that time.
    [("rate in [-1, 1]", 0.3), ("accel <= 4", 0.18)],
)
def test_rates_count_until_the_stay_begins(horizon, limit, most):
    clauses = (
        "start at (0); reach T at rest for 0.5 s; effort <= 99 N*m; "
        f"horizon {horizon} steps of 0.1 s;"
    )
    limited = [Segment(1, limits=f"{LIMITED} {limit}")]
    assert turned(most - 0.02, clauses, limited) is None
    found = turned(most + 0.03, clauses, limited)
    assert found is not None
    assert found.available == pytest.approx(most, abs=1e-3)
    assert turned(most + 0.03, clauses.replace(" for 0.5 s", ""), limited) is None


def test_a_robot_that_stays_all_the_time_starts_in_its_target():
    clauses = f"start at (0); reach T at rest for 0.8 s; {PUSH} horizon 8 steps of 0.1 s;"
    assert turned(0, clauses) is None
    assert turned(0.1, clauses) is not None


@pytest.mark.parametrize(
    ("limit", "most"),
    # 0.8 s with 1.2 rad/s; accelerations bound the rate, to 3 rad/s^2 * 0.8 s.
    [("rate in [-1.2, 1.2]", 0.96), ("accel <= 3", 1.92)],
)
def test_rates_and_accelerations_count_until_the_deadline(limit, most):
    clauses = (
        "start at (0); satisfy eventually[0 s, 0.8 s] T by effector 1; effort <= 99 N*m; "
        "horizon 30 steps of 0.1 s;"
    )
    limited = [Segment(1, limits=f"{LIMITED} {limit}")]
    assert turned(most - 0.02, clauses, limited) is None
    found = turned(most + 0.03, clauses, limited)
    assert found is not None
    assert found.available == pytest.approx(most, abs=1e-6)


@pytest.mark.parametrize(("angle", "refuted"), [(0.46, False), (0.51, True)])
@pytest.mark.parametrize("drive", ["gear 10 rotor 0.0033333333 kg*m^2", "rotor 0.33333333 kg*m^2"])
def test_a_rotor_turns_with_the_rod(angle, refuted, drive):
    # An inertia of 2/3 kg m^2: half of the way of the rod alone.
    clauses = f"start at (0); reach T; {PUSH} horizon 8 steps of 0.1 s;"
    found = turned(angle, clauses, [Segment(1, own=f"drive q: {drive};")])
    assert (found is not None) is refuted
    assert found is None or found.available == pytest.approx(0.48, abs=1e-6)


def test_a_flywheel_keeps_its_rate():
    # At 1 rad/s it turns by 0.8 rad and 1e-4 more in 0.8 s, whatever the drive.
    wheel = [Segment(1, own="drive q: rotor 1000 kg*m^2;")]
    clauses = f"start in A rates <= 1; reach T; {PUSH} horizon 8 steps of 0.1 s;"
    for angle, refuted in ((0.78, False), (0.84, True)):
        found = turned(angle, clauses, wheel, start=spot((1, 0), 0.01), halvings=10)
        assert (found is not None) is refuted


@pytest.mark.parametrize("side", some([1, -1], 1))
@pytest.mark.parametrize(
    ("rates", "most"),
    # Speeding up to V = (a T + v) / 2, then slowing down to v, a = 3 rad/s^2: V^2 / a - v^2 / 2 a.
    # With a stay of 0.4 s, T is 0.4 s.
    [("rates <= 0.6 rad/s", 0.69), ("rates <= 0.6 rad/s for 0.4 s", 0.21), ("rates <= 2.4", 0.96),
     ("rates <= 9", 0.96), ("rates <= 0.001", 0.4804), ("rates <= 0.0001", 0.48004)],
)  # fmt: skip
def test_the_faster_a_rod_may_end_the_farther_it_turns(rates, most, side):
    clauses = f"start at (0); reach T {rates}; {PUSH} horizon 8 steps of 0.1 s;"
    assert turned(side * (most - 0.02), clauses) is None
    found = turned(side * (most + 0.04), clauses)
    assert found is not None
    assert found.available == pytest.approx(most, abs=6e-4)  # it has three digits


@pytest.mark.parametrize(("angle", "refuted"), [(1.05, False), (1.12, True), (-1.12, True)])
def test_a_full_turn_leads_both_ways(angle, refuted):
    # From 3 rad past pi: the way is that on the circle, 1.0667 rad in a second and 2/3 N m.
    clauses = "start at (3); reach T; effort <= 0.7111 N*m; horizon 10 steps of 0.1 s;"
    assert (turned(3 + angle, clauses, FREE) is not None) is refuted


@pytest.mark.parametrize(("angle", "refuted"), [(0.94, False), (0.51, False), (0.99, True)])
def test_friction_brakes_so_that_a_bang_may_be_all(angle, refuted):
    # Rest at the end costs nothing if friction may do it: only the bound of the bang is left.
    own = "torque(q) = u - 0.001 N*m*s/rad * rate(q);"
    clauses = f"start at (0); reach T at rest; {PUSH} horizon 8 steps of 0.1 s;"
    assert (turned(angle, clauses, [Segment(1, own=own)]) is not None) is refuted


def test_what_drives_instead_of_braking_is_not_bounded():
    own = "param b in [-0.125, 0.125] N*m*s/rad; torque(q) = u - b * rate(q);"
    clauses = f"start at (0); reach T; {PUSH} horizon 1 steps of 0.1 s;"
    text = problem([Segment(1, own=own)], spot((0, 1)), clauses)
    assert answer(text, [5]) is None
    brakes = text.replace("[-0.125", "[0")
    assert answer(brakes, [5]) is not None
    halves = [answer(text, [5], [half]) is not None for half in Part().halves()]
    assert halves == [False, True]


@pytest.mark.parametrize(("angle", "refuted"), [(1.70, False), (1.83, True)])
def test_a_start_with_a_rate(angle, refuted):
    # v T + u T^2 / (2 I) = 0.8 + 0.96 rad; the start region adds 0.01 rad.
    clauses = f"start in A rates <= 1; reach T; {PUSH} horizon 8 steps of 0.1 s;"
    found = turned(angle, clauses, start=spot((1, 0), 0.01), halvings=10)
    assert (found is not None) is refuted


def test_lengths_of_a_box_of_parameters():
    # The lightest rod has an inertia of 0.9^3 / 3: 1.317 rad; of half the box, 0.96 rad.
    clauses = f"start at (0); reach T; {PUSH} horizon 8 steps of 0.1 s;"
    rod, target = [Segment("[0.9, 1.1]")], "[-2, 0.3] x [0.3, 2]"
    text = problem(rod, target, clauses)
    assert answer(text, [8]) is None
    heavy = answer(text, [8], [Part(3, 2)])
    assert heavy is not None


@pytest.mark.parametrize("axis", ["z", "-z"])
def test_the_same_rod_in_space(axis):
    clauses = f"start at (0); reach T; {PUSH} horizon 8 steps of 0.1 s;"
    for angle, refuted in ((0.94, False), (0.99, True)):
        target = spot((cos(angle), sin(angle), 0))
        found = answer(problem([Segment(1, axis=axis)], target, clauses), [9])
        assert (found is not None) is refuted


@pytest.mark.parametrize(("way", "refuted"), [(1.55, False), (1.65, True)])
def test_a_slider(way, refuted):
    # F T^2 / (2 m) = 8 * 1 / (2 * 2.5) = 1.6 m.
    slider = [Segment(1, axis="x", kind="prismatic", limits="in [-3, 3] m", density=2.5)]
    clauses = "start at (0); reach T; effort <= 8 N; horizon 10 steps of 0.1 s;"
    found = answer(problem(slider, spot((1 + way, 0)), clauses), [9])
    assert (found is not None) is refuted


# --- energy --------------------------------------------------------------------------------------

HANGING = "start at (-1.570796327);"
WEIGHT = "gravity (0, -9.81) m/s^2;"


def lifted(energy):
    """The angle of a rod of one metre and one kilogram that was lifted from hanging, rad."""
    return acos(1 - energy / (9.81 / 2)) - pi / 2


@pytest.mark.parametrize(("fraction", "refuted"), [(1.1, True), (0.9, False)])
def test_a_pendulum_gets_the_energy_that_its_drive_can_give(fraction, refuted):
    # sqrt(2 E) grows by u / sqrt(I) per second: at most 0.96 J in 0.8 s.
    clauses = f"{HANGING} reach T; {PUSH} {WEIGHT} horizon 8 steps of 0.1 s;"
    found = turned(lifted(0.96 * fraction), clauses, halvings=9)
    assert (found is not None) is refuted
    if found is not None:
        assert found.unit == "J"
        assert found.available == pytest.approx(0.96, rel=1e-3)
        assert found.needed == pytest.approx(0.96 * fraction, rel=0.05)


@pytest.mark.parametrize(("fraction", "refuted"), [(1.1, True), (0.9, False)])
def test_power_is_effort_times_rate(fraction, refuted):
    # 0.1 rad/s for 20 s with 1 N m: 2 J, and 2 rad, which would do.
    slow = [Segment(1, limits=f"{LIMITED} rate in [-0.1, 0.1]")]
    clauses = f"{HANGING} reach T; {PUSH} {WEIGHT} horizon 20 steps of 1 s;"
    found = turned(lifted(2 * fraction), clauses, slow, halvings=9)
    assert (found is not None) is refuted


def test_a_barrier_of_potential_energy():
    # The goal is as low as the start, and the way over the top takes 9.81 J.
    clauses = f"start at (-2.9); reach T; {PUSH} {WEIGHT} horizon 10 steps of 0.1 s;"
    upwards = "in [-170, 5] deg"  # the way below is open
    target = spot((cos(-0.24), sin(-0.24)), 0.05)
    below = problem([Segment(1, limits=upwards)], target, clauses)
    above = problem(
        [Segment(1, limits="in [-15, 195] deg")], target, clauses.replace("-2.9", "3.38")
    )
    assert answer(below, [6]) is None
    assert answer(above, [6]) is not None


# --- rates ---------------------------------------------------------------------------------------

MOTOR = """
state current A = 0 A; input voltage in [-24, 24] V;
der(current) = (voltage - 1.5 V/A * current) / (0.3 V*s/A); torque(q) = 0.8 N*m/A * current;
"""


@pytest.mark.parametrize("own", ["", MOTOR])
@pytest.mark.parametrize(("angle", "refuted"), [(0.97, False), (1.03, True), (-1.03, True)])
def test_rate_limits_bound_the_way(own, angle, refuted):
    slow = [Segment(1, limits=f"{LIMITED} rate in [-0.5, 0.25]", own=own)]
    effort = "" if own else "effort <= 99 N*m;"
    clauses = f"start at (0); reach T; {effort} horizon 20 steps of 0.1 s;"
    assert (turned(angle, clauses, slow) is not None) is refuted


def test_a_motor_without_rate_limits_is_not_bounded():
    clauses = "start at (0); reach T; horizon 1 steps of 0.001 s;"
    assert turned(2.5, clauses, [Segment(1, own=MOTOR)]) is None


# --- several joints ------------------------------------------------------------------------------

ARM = [Segment(1), Segment(0.7)]


def half_a_turn(tenths, rest="", segments=ARM, effort=PUSH):
    clauses = f"start in A; reach T {rest}; {effort} horizon {tenths} steps of 0.1 s;"
    target = "[-1.7, -1.6] x [-0.1, 0.1]"
    text = problem(segments, target, clauses, start="[1.6, 1.7] x [-0.1, 0.1]")
    return answer(text, [4, 5])


@pytest.mark.parametrize(
    ("tenths", "rest", "refuted"),
    [(14, "", True), (30, "", False), (20, "at rest", True), (42, "at rest", False)],
)
def test_an_arm_turns_by_the_momentum_that_its_first_drive_gives(tenths, rest, refuted):
    # Stretched, 1.638 kg m^2 turn by pi in 3.2 s, or in 4.5 s from rest to rest.
    assert (half_a_turn(tenths, rest) is not None) is refuted


@pytest.mark.slow
def test_the_other_drive_has_no_part_in_the_momentum():
    strong = [ARM[0], Segment(0.7, axis="-z", limits=LIMITED)]
    assert half_a_turn(14, segments=strong) is not None
    # A full turn of the second joint may turn the arm, and friction takes its momentum.
    assert half_a_turn(14, segments=[ARM[0], Segment(0.7, limits="")]) is None
    drag = "torque(q) = u - 0.1 N*m*s/rad * rate(q);"
    assert half_a_turn(14, segments=[Segment(1, own=drag), ARM[1]]) is None


@pytest.mark.parametrize(("way", "refuted"), [(1.5, False), (2.2, True)])
def test_the_com_of_a_cart_with_an_arm_moves_as_a_point(way, refuted):
    # 2 kg of cart and 0.5 kg of arm: F T^2 / (2 m) = 1.6 m of the com; the arm turns by 1 rad.
    cart = Segment(1, axis="x", kind="prismatic", limits="in [-4, 4] m", density=2)
    arm = Segment(0.5, limits="in [-1, 1]", density=1)
    clauses = (
        "start at (0, 0); reach T; effort <= 8 N; effort <= 99 N*m; horizon 10 steps of 0.1 s;"
    )
    found = answer(problem([cart, arm], spot((1.5 + way, 0)), clauses), [6, 3])
    assert (found is not None) is refuted


def test_a_norm_of_efforts_is_less_than_each_of_them():
    free = [Segment(1, limits=""), Segment(0.7, limits="")]  # without a momentum
    # 1.2 N m of both together are less than 1.2 N m of each, and more than half of that.
    both = [half_a_turn(6, segments=free, effort=f"effort <= 1.2 N*m {n};") for n in ("", "norm 2")]
    assert [found is not None for found in both] == [False, True]


def test_three_links():
    bent = "in [-15, 15] deg"
    links = [Segment(0.6), Segment(0.7, limits=bent), Segment(0.5, limits=bent)]
    texts = [
        problem(
            links, "[-0.2, 0.2] x [1.6, 1.8]",
            f"start at (-1.5707963, 0, 0); reach T; effort <= 1 N*m; {WEIGHT} "
            f"horizon {n} steps of 0.1 s;",
        )
        for n in (2, 20)
    ]  # fmt: skip
    found = [answer(text, [4, 2, 2]) for text in texts]
    assert found[1] is None
    assert found[0] is not None
    # From hanging to within 0.3 m of stretched upwards; 1.8 kg with the com 0.9 m from the base.
    assert found[0].unit == "J"
    assert found[0].needed < 1.8 * 9.81 * 1.8


def test_nothing_is_said_of_boxes_without_ends():
    text = problem(ROD, spot((-1, 0)), f"start at (0); reach T; {PUSH} horizon 1 steps of 0.1 s;")
    model, workspace, task = robot_of(text)
    ((passage,),) = motion_conditions(model, workspace, task).passages
    drive = drive_reach(model, workspace, task)
    far = [LeafBox((arb(0, 0.1),), True, False), LeafBox((arb(3, 0.1),), False, True)]
    assert out_of_reach(drive, passage, [], far) is not None
    unknown = LeafBox((arb("nan"),), False, True)
    assert out_of_reach(drive, passage, [], [*far, unknown]) is None


# --- questions and effectors ---------------------------------------------------------------------


def test_a_region_that_a_formula_has_visited():
    # At some instant, so that nothing is at rest: 0.96 rad.
    for angle, refuted in ((0.94, False), (0.99, True)):
        clauses = f"start at (0); satisfy eventually T; {PUSH} horizon 8 steps of 0.1 s;"
        assert (turned(angle, clauses) is not None) is refuted


def test_each_choice_of_effectors_is_a_question_of_its_own():
    # The first effector, at 0.5 m, gets to the target in time, the second one at 1 m does not.
    arm = [
        Segment(0.5, effector=True),
        Segment(0.5, kind="prismatic", axis="x", limits="in [0, 0.1] m"),
    ]
    clauses = f"start at (0, 0); reach T; {PUSH} effort <= 1 N; horizon 5 steps of 0.1 s;"
    near = answers(problem(arm, spot((0.5, 0), 0.01), clauses), [5, 3])
    assert [[found is None for found in choices] for choices in near] == [[True, False]]
    mixed = clauses.replace("at (0, 0); reach T", "in A by effector 1; reach T by effector 2")
    text = problem(arm, spot((1, 0.0), 0.05), mixed, start=spot((0.5, 0), 0.05))
    assert answer(text, [5, 3]) is None
    assert answer(text.replace("by effector 2", "by effector 1"), [5, 3]) is not None

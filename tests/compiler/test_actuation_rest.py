"""Goals at which drives cannot hold a robot still, against the statics of rods."""

from __future__ import annotations

import random
from dataclasses import replace
from math import cos, sin

import numpy as np
import pytest
from flint import arb

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import constant_ball, working_precision
from compiler.robots.robot import RobotDof
from compiler.robots.state_and_input import joint_names
from compiler.unreachability.actuation_bounds import LeafBox
from compiler.unreachability.actuation_reach import drive_reach, out_of_reach
from compiler.unreachability.motion_conditions import motion_conditions
from tests.compiler.test_actuation_reach_soundness import random_arm
from tests.oracles.driven_chains import Segment, answer, problem, robot_of, spot
from tests.oracles.some_cases import examples, some

WEIGHT = "gravity (0, -9.81) m/s^2;"
TIP = spot((cos(0.2), sin(0.2)))
STATIC = 9.81 / 2 * cos(0.2)
"""What holds a rod of one metre and one kilogram at 0.2 rad, in N m; it begins above that."""


def held(effort, rest="at rest for 0.5 s", own="", halvings=9, start=1.2):
    clauses = f"start at ({start}); reach T {rest}; {WEIGHT} horizon 30 steps of 0.1 s;"
    return answer(
        problem([Segment(1, own=own)], TIP, f"{clauses} effort <= {effort} N*m;"), [halvings]
    )


def test_a_rod_is_held_by_its_weight_times_its_lever():
    assert held(1.003 * STATIC) is None
    found = held(0.97 * STATIC)
    assert found is not None
    assert (found.unit, found.available) == ("N*m", pytest.approx(0.97 * STATIC, rel=0.01))
    assert 0.985 * STATIC < found.needed <= STATIC * 1.001
    assert "J0.q needs" in found.reason
    assert "hold still" in found.reason


def test_joints_have_the_names_of_their_modules():
    """With their numbers where a module occurs twice; merged joints have both names."""
    dofs = [
        RobotDof((number,), "revolute", "z", None, None, called=name)
        for number, name in enumerate(["A.q", "B.q", "A.q", "C.q and D.q", ""])
    ]
    model = replace(
        robot_of(
            problem(
                [Segment(1)], TIP, "start at (1); reach T; horizon 3 steps of 1 s; effort <= 1 N*m;"
            )
        )[0],
        dofs=tuple(dofs),
    )
    expected = "A.q (joint 1)", "B.q", "A.q (joint 3)", "C.q and D.q", "joint 5"
    assert joint_names(model) == expected


def test_it_may_pass_where_it_need_not_stay():
    assert held(0.9 * STATIC, rest="at rest") is None
    assert held(0.9 * STATIC, rest="") is None


@pytest.mark.parametrize(("coulomb", "refuted"), [(0.05, True), (0.2, False)])
def test_dry_friction_helps_to_hold(coulomb, refuted):
    own = f"drive q: coulomb {coulomb * STATIC} N*m;"
    assert (held(0.85 * STATIC, own=own) is not None) is refuted


@pytest.mark.parametrize(
    ("rest", "refuted"),
    [
        # 2 r I = 0.667 mN m s, and the weight exceeds the drive by 1 N m.
        ("at rest for 0.0005 s", False),
        ("at rest for 0.001 s", True),
        # Now 40 mN m s; within 0.06 rad.
        ("rates <= 0.06 rad/s for 0.03 s", False),
        ("rates <= 0.06 rad/s for 1 s", True),
    ],
)
def test_a_short_fall_is_no_fall(rest, refuted):
    assert (held(STATIC - 1, rest=rest, halvings=10) is not None) is refuted


def test_a_heavy_rotor_falls_slowly():
    # At most 0.97 N m on 10^4 kg m^2: 5e-5 rad/s after half a second.
    wheel = "drive q: gear 100 rotor 1 kg*m^2;"
    assert held(STATIC - 0.97, own=wheel, start=0.2) is None
    light = wheel.replace("1 kg", "1e-4 kg")
    assert held(STATIC - 0.97, own=light, start=0.2) is not None


def test_a_lift_is_held_by_its_weight():
    lift = [Segment(1, kind="prismatic", axis="y", along="y", limits="in [0, 4] m")]
    for effort, refuted in ((9.9, False), (9.7, True)):
        clauses = f"start at (1); reach T at rest for 0.5 s; {WEIGHT} effort <= {effort} N;"
        text = problem(lift, spot((0, 2)), f"{clauses} horizon 30 steps of 0.1 s;")
        found = answer(text, [9])
        assert (found is not None) is refuted
        assert found is None or (found.unit == "N" and "hold still" in found.reason)


@pytest.mark.parametrize(
    "gravity", some(["(0, -9.81) m/s^2", "(6, -7.8) m/s^2", "(-9.81, 0.5) m/s^2"], 1)
)
def test_two_links_with_the_elbow_up_or_down(gravity):
    """The least that a pose at the target needs, from the positions of both rods."""
    lengths, densities, at = (0.9, 0.6), (2.0, 1.0), (1.0, 0.7)
    masses = [length * density for length, density in zip(lengths, densities, strict=True)]
    pull = np.array([float(x) for x in gravity.split(")")[0].strip("(").split(",")])
    reach = np.hypot(*at)
    bend = np.arccos((reach**2 - lengths[0] ** 2 - lengths[1] ** 2) / (2 * np.prod(lengths)))
    torques = []
    for elbow in (bend, -bend):
        behind = np.arctan2(lengths[1] * sin(elbow), lengths[0] + lengths[1] * cos(elbow))
        one = np.arctan2(at[1], at[0]) - behind
        ways = [np.array([cos(a), sin(a)]) for a in (one, one + elbow)]
        middles = [lengths[0] / 2 * ways[0], lengths[0] * ways[0] + lengths[1] / 2 * ways[1]]
        forces = [mass * pull for mass in masses]
        moment = sum(m[0] * f[1] - m[1] * f[0] for m, f in zip(middles, forces, strict=True))
        torques.append(abs(moment))
    needed = min(torques)
    arm = [Segment(lengths[0], density=2.0), Segment(lengths[1], density=1.0)]
    for share, refuted in ((0.7, True), (1.02, False)):
        clauses = (
            f"start in A; reach T at rest for 1 s; gravity {gravity}; "
            f"effort <= {share * needed} N*m; horizon 60 steps of 0.1 s;"
        )
        text = problem(arm, spot(at, 0.01), clauses, start="[-1.5, 1.5] x [-1.5, 1.5]")
        found = answer(text, [6, 6])
        held_back = found is not None and "hold still" in found.reason
        assert held_back is refuted


@pytest.mark.parametrize("length", ["[0.8, 1.2]"])
def test_all_lengths_of_a_box(length):
    """The lightest rod that may be at the target: its weight counts, and its lever."""
    clauses = f"start at (1.2); reach T at rest for 0.5 s; {WEIGHT} horizon 30 steps of 0.1 s;"
    target = "[0.75, 1.3] x [-0.1, 0.1]"
    least = 9.81 * 0.8 * 0.8 / 2 * cos(np.arcsin(0.1 / 0.8))
    for effort, refuted in ((0.9 * least, True), (1.02 * least, False)):
        text = problem([Segment(length)], target, f"{clauses} effort <= {effort} N*m;")
        assert (answer(text, [8]) is not None) is refuted


def test_a_payload_hangs_on_the_first_joint_wherever_the_others_are():
    """Three links of 0.25 to 0.55 m: 12 kg at x >= 0.5 m, less what balances it behind."""
    arm = [Segment("{0.25, 0.4, 0.55}", density=0.1) for _ in range(3)]
    target = "[0.5, 0.8] x [0.2, 0.5]"
    clauses = f"start in A; reach T at rest for 0.5 s; payload 12 kg; {WEIGHT} "
    least = 9.81 * (12 * 0.5 - 0.1 * 3 * 0.55**2)
    most = 9.81 * 12 * 0.5  # the arm itself, folded behind the axis, may hold a part of it
    for effort, refuted in ((0.95 * least, True), (1.01 * most, False)):
        efforts = f"effort <= {effort} N*m; horizon 40 steps of 0.1 s;"
        text = problem(arm, target, clauses + efforts, start="[-0.5, -0.2] x [0.4, 0.7]")
        found = answer(text, [2, 2, 2])
        assert (found is not None) is refuted
        assert found is None or "J0.q needs" in found.reason


@pytest.mark.parametrize(("coulomb", "refuted"), [(0.0, True), (0.05, True), (0.2, False)])
def test_a_start_that_is_held(coulomb, refuted):
    """A rod at 0.2 rad, below which it may hang: only `held` asks for the torque that holds it."""
    own = f"drive q: coulomb {coulomb * STATIC} N*m;" if coulomb else ""
    clauses = f"reach T; {WEIGHT} horizon 30 steps of 0.1 s; effort <= {0.85 * STATIC} N*m;"
    for begin, expected in (("held", refuted), ("", False)):
        text = problem(
            [Segment(1, own=own)], spot((cos(-1.5), sin(-1.5))),
            f"start in A at rest {begin}; {clauses}", start=TIP,
        )  # fmt: skip
        found = answer(text, [9])
        assert (found is not None) is expected
        assert found is None or "to hold still at the start" in found.reason


@pytest.mark.parametrize("turn", [0, 30, -75])
def test_a_tilted_target_bounds_the_lever(turn):
    """One long box, turned: its corner nearest to the axis is the place that needs least."""
    way = np.array([cos(np.radians(turn)), sin(np.radians(turn))])
    corners = np.array([[0.6, -0.1], [0.9, -0.1], [0.9, 0.1], [0.6, 0.1]])
    turned = corners @ np.array([way, [-way[1], way[0]]])
    least = 9.81 * 5 * max(turned[:, 0].min(), 0.0)
    arm = [Segment(0.5, density=0.01), Segment(0.5, density=0.01), Segment(0.1, density=0.01)]
    hull = ", ".join(f"({x:.9f}, {y:.9f})" for x, y in turned)
    clauses = f"start in A; reach T at rest for 0.5 s; payload 5 kg; {WEIGHT} "
    for effort, refuted in ((0.9 * least, True), (1.2 * least, False)):
        efforts = f"effort <= {effort} N*m; horizon 40 steps of 0.1 s;"
        text = problem(arm, "[0, 1] x [0, 1]", clauses + efforts, start="[-1, 1] x [-1, 1]")
        text = text.replace("target T box [0, 1] x [0, 1] m", f"target T hull {hull} m")
        found = answer(text, [3, 3, 3])
        assert (found is not None and "still" in found.reason) is refuted


def at_rest(seed, share, widths=(0.0, 1e-3, 0.02), *, at_start=False):
    """Whether a random arm that stays at a pose, with inputs times a share, is said to be too weak.

    It has to hold still at its start or at its target, which are at one place. The pose is in the
    middle of a box with one of the ``widths``. The inputs are those at which the
    equations of motion have no acceleration. None: some joints turn about the same axis, or the
    equations have no value.
    """
    rng = random.Random(seed)
    dimension, joints = rng.choice([2, 3]), rng.randint(1, 3)
    arm = random_arm(rng, dimension, joints)
    gravity = [round(rng.uniform(-9, 9), 2) for _ in range(dimension)]
    q = np.array([round(rng.uniform(-3, 3), 3) for _ in range(joints)])
    kinds = {segment.kind for segment in arm}

    def posed(target, most):
        units = [unit for kind, unit in (("revolute", "N*m"), ("prismatic", "N")) if kind in kinds]
        efforts = "".join(f"effort <= {most} {unit};" for unit in units)
        pose = f"start at ({', '.join(map(str, q))}); reach T at rest for 1 s; {efforts}"
        if at_start:
            pose = f"start in A at rest held; reach T; {efforts}"
        pull = f"gravity ({', '.join(map(str, gravity))}) m/s^2; horizon 20 steps of 0.1 s;"
        there = spot(target, 0.01)
        return robot_of(problem(arm, there, pose + pull, start=there if at_start else ""))

    model, _, task = posed([0.0] * dimension, 1)
    if len(model.dofs) < joints:
        return None
    graph = robot_graph(model, task.gravity)
    constants = [float(constant_ball(item)) for item in graph.constants]

    def acceleration(u):
        return np.array(graph.acceleration(q, np.zeros(joints), u, [], constants)).ravel()

    free = acceleration(np.zeros(joints))
    driven = np.array([acceleration(row) for row in np.eye(joints)])
    if not np.isfinite([free, *driven]).all():
        return None  # a rod turns about its own axis, without any inertia
    slope = (driven - free).T
    inputs = np.linalg.solve(slope, -free)
    tip = np.array(graph.effectors(q, [], constants)).ravel()[:dimension]
    model, workspace, task = posed(tip, share * np.abs(inputs).max() + 1e-6)
    ((passage,),) = motion_conditions(model, workspace, task).passages
    width = rng.choice(widths)
    leaf = LeafBox(tuple(arb(x, width) for x in q), True, True)
    with working_precision(64):
        return out_of_reach(drive_reach(model, workspace, task), passage, [], [leaf]) is not None


def test_what_stays_where_it_is_is_not_refuted():
    assert not any(at_rest(seed, 1.001) for seed in range(examples(40, 1000)))


@pytest.mark.parametrize("at_start", [False, True])
def test_nor_in_a_wide_box_about_it(at_start):
    seeds, widths = range(examples(40, 1000)), (0.0, 0.3, 1, 3)
    assert not any(at_rest(seed, 1.001, widths, at_start=at_start) for seed in seeds)


@pytest.mark.parametrize("at_start", [False, True])
def test_half_of_the_inputs_are_too_weak(at_start):
    found = [at_rest(seed, 0.5, at_start=at_start) for seed in range(examples(40, 300))]
    known = [each for each in found if each is not None]
    assert sum(known) > 0.8 * len(known)

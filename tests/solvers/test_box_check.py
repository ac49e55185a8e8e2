"""Coverings against closed forms: what is impossible is proved on a fine grid, and nothing else."""

from __future__ import annotations

from fractions import Fraction
from math import cos, pi, radians

import pytest

from grammar_lang import ir
from solvers.verifier.refutations.box_check import why_not
from tests.oracles.arms import ArmBuilder, degrees, number
from tests.oracles.coverings import avoiding, covering, errand, spot, world
from tests.oracles.planes import box, row

S, T = spot("S", 1, 0), spot("T", 0, 1)
DIAGONAL = spot("O", "0.65", "0.65", "0.15")
"""At 45 degrees, 0.71 to 1.13 m from the base."""
OPPOSITE = spot("P", "-0.65", "-0.65", "0.15")
ROUND = ir.Interval(degrees(-180), degrees(180))


def proved(text, model, workspace, task):
    reason = why_not(text, model, workspace, task)
    assert reason is None or "there may be a way" in reason
    return reason is None


def one_link(length=1, limits=(-180, 180)):
    arm = ArmBuilder().revolute(limits=limits)
    return arm.link(arm.parameter(*length) if isinstance(length, tuple) else length).effector()


# --- poses ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("longest", "impossible"), [("1.8", True), ("1.91", False)])
def test_one_link_reaches_as_far_as_it_is_long(longest, impossible):
    # The nearest point of the target is 1.9 m from the base.
    workspace = world(spot("T", 0, 2))
    model = one_link(("0.5", longest)).model()
    task = errand(start=ir.StartAt((number(0),)))
    assert proved(covering("AAA", "aaaaaa"), model, workspace, task) is impossible


@pytest.mark.parametrize(("inner", "impossible"), [("1.25", True), ("1.05", False)])
def test_both_poses_have_the_same_parameters(inner, impossible):
    # The start needs 0.9 to 1.1 m (and a little at its corners); the target at least `inner`.
    workspace = world(S, box("T", "target", ("-0.1", "0.1"), (inner, 3)))
    model = one_link(("0.5", 2)).model()
    assert proved(covering("AAAAA", "aaaaaaa"), model, workspace, errand()) is impossible
    # Without dividing the lengths, both poses exist.
    assert not proved(covering("", "aaaaaaa"), model, workspace, errand())


@pytest.mark.parametrize("values", [("1", "1.3"), ("0.2", "1"), ("1.3", "0.2", "1", "2")])
def test_a_finite_set_of_lengths(values):
    workspace = world(S, box("T", "target", ("-0.1", "0.1"), ("1.25", "1.35")))
    choices = ir.Choices(tuple(number(value) for value in values))
    arm = ArmBuilder().revolute()
    model = arm.link(arm.parameter(choices)).effector().model()
    halvings = {2: "A", 4: "AA"}[len(values)]
    assert proved(covering(halvings, "aaaaaaa"), model, workspace, errand())
    both = world(S, box("T", "target", ("-0.1", "0.1"), ("1.05", "1.35")))
    near = one_link_of(ir.Choices((number("1.08"), number("0.2"))))
    assert not proved(covering("A", "aaaaaaa"), near, both, errand())


def one_link_of(domain):
    arm = ArmBuilder().revolute()
    return arm.link(arm.parameter(domain)).effector().model()


@pytest.mark.parametrize(("bend", "impossible"), [(60, True), (80, False)])
def test_two_links_do_not_come_nearer_than_the_elbow_allows(bend, impossible):
    # |tip|^2 = 1.49 + 1.4 cos q2 >= 1.49 + 1.4 cos(bend); the target is at most 1.404 m away.
    nearest = (1.49 + 1.4 * cos(radians(bend))) ** 0.5
    assert (nearest > (1.4**2 + 0.1**2) ** 0.5) is impossible
    workspace = world(spot("S", 0, "1.55"), box("T", "target", ("-0.1", "0.1"), ("-1.4", "-1")))
    arm = ArmBuilder().revolute().link(1).revolute(limits=(-bend, bend)).link("0.7").effector()
    assert proved(covering("", "aaaaaabbbbb"), arm.model(), workspace, errand()) is impossible


def test_the_hole_in_the_middle_of_two_links():
    # 1 - 0.7 = 0.3 m: the target's farthest corner is 0.14 m from the base.
    workspace = world(S, spot("T", 0, "0.05", "0.08"))
    arm = ArmBuilder().revolute(limits=None).link(1).revolute(limits=None).link("0.7").effector()
    assert proved(covering("", "aaaaabbbbbb"), arm.model(), workspace, errand())
    near = world(S, spot("T", 0, "0.22"))
    assert not proved(covering("", "aaaaabbbbbb"), arm.model(), near, errand())


# --- ways ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limits", "obstacles", "impossible"),
    [
        ((-180, 180), [], False),
        ((-180, 180), [DIAGONAL], True),
        (None, [DIAGONAL], False),  # the other way round
        (None, [DIAGONAL, OPPOSITE], True),
        ((-180, 180), [OPPOSITE], False),
        ((-270, 90), [DIAGONAL], False),  # -270 degrees is the target too
        ((-269, 90), [DIAGONAL], False),  # the target is wide
        ((-240, 90), [DIAGONAL], True),
        ((-20, 20), [], True),  # the joint does not turn so far
    ],
)
def test_the_one_joint_passes_all_values_between(limits, obstacles, impossible):
    workspace = world(S, T, *obstacles)
    model = one_link(limits=limits).model()
    task = errand(avoid=avoiding(*(item.name for item in obstacles)) if obstacles else ())
    assert proved(covering("", "aaaaaaa"), model, workspace, task) is impossible
    assert not proved(covering("", "aa"), model, workspace, task) or limits == (-20, 20)


def test_a_circle_closes_where_its_ends_are():
    # From 170 to -170 degrees: straight on across 180, or the long way through an obstacle.
    workspace = world(
        spot("S", "-0.985", "0.174", "0.05"), spot("T", "-0.985", "-0.174", "0.05"), DIAGONAL
    )
    task = errand(avoid=avoiding("O"))
    assert not proved(covering("", "aaaaaaaa"), one_link(limits=None).model(), workspace, task)
    assert proved(covering("", "aaaaaaaa"), one_link().model(), workspace, task)


@pytest.mark.parametrize(("subject", "impossible"), [("body", True), ("effector", False)])
def test_a_body_is_more_than_its_effector(subject, impossible):
    # The obstacle is between 0.5 and 0.8 m from the base: the tip, at 1 m, passes behind it.
    workspace = world(S, T, box("O", "obstacle", ("0.4", "0.55"), ("0.4", "0.55")))
    task = errand(avoid=avoiding("O", subject=subject))
    assert proved(covering("", "aaaaaaa"), one_link().model(), workspace, task) is impossible


def test_an_obstacle_is_touched_but_not_entered():
    # The tip turns about the origin with radius 1 and touches the obstacle's corner (0.6, 0.8).
    corner = ir.Inequalities((row("-0.6", "-0.8", -1), row(1, 1, 9)))
    workspace = world(S, T, ir.Region("O", "obstacle", corner))
    task = errand(avoid=avoiding("O", subject="effector"))
    assert not proved(covering("", "aaaaaaaaa"), one_link().model(), workspace, task)
    entered = ir.Inequalities((row("-0.6", "-0.8", "-0.99"), row(1, 1, 9)))
    deeper = world(S, T, ir.Region("O", "obstacle", entered))
    assert proved(covering("", "aaaaaaaaa"), one_link().model(), deeper, task)


@pytest.mark.parametrize("subject", ["body", "effector"])
def test_a_box_that_sticks_out_of_an_obstacle_is_not_blocked(subject):
    # In the middle of the box, at 0 degrees, the tip is deep inside; from 90 to 180 it is free.
    ahead = box("O", "obstacle", ("0.5", 9), ("-0.5", "0.5"))
    workspace = world(spot("S", 0, 1), spot("T", -1, 0), ahead)
    task = errand(avoid=avoiding("O", subject=subject))
    for letters in ("", "a", "aaaaaaa"):
        assert not proved(covering("", letters), one_link().model(), workspace, task)


def test_an_obstacle_without_interior_blocks_nothing_here():
    wall = box("O", "obstacle", ("0.65", "0.65"), (0, 9))
    workspace = world(S, T, wall)
    for subject in ("body", "effector"):
        task = errand(avoid=avoiding("O", subject=subject))
        assert not proved(covering("", "aaaaaaaa"), one_link().model(), workspace, task)


@pytest.mark.parametrize("subject", ["body", "effector"])
def test_bounds_are_kept_by_effectors_and_by_bodies_where_asked(subject):
    # A stub behind the joint sticks out by 0.3 m on the other side: below -0.2 on the way.
    arm = ArmBuilder().revolute()
    joint = arm.frame
    arm.link("-0.5")
    arm.frame = joint
    arm.link(1).effector()
    # The stub's end passes (-0.35, -0.35); the bounds end at y = -0.3 and x = -0.6.
    workspace = world(S, T, bounds=(("-0.6", 2), ("-0.3", 2)))
    task = errand(bounds_body=subject == "body")
    found = proved(covering("", "aaaaaaaa"), arm.model(), workspace, task)
    assert found is (subject == "body")
    narrow = world(S, T, bounds=(("-0.6", 2), ("-0.3", "0.996")))
    # The tip is at y = 0.99499 where it enters the target.
    assert not proved(covering("", "aaaaaaaa"), one_link().model(), narrow, errand())
    lower = world(S, T, bounds=(("-0.6", 2), ("-0.3", "0.99")))
    assert proved(covering("", "aaaaaaaa"), one_link().model(), lower, errand())


def test_two_links_in_a_ring_of_obstacles():
    # Four blocks around the base leave gaps; the elbow is 1 m out, so no link gets round.
    blocks = [spot(f"B{i}", x, y, "0.25") for i, (x, y) in enumerate([("0.6", "0.6"),
              ("-0.6", "0.6"), ("-0.6", "-0.6"), ("0.6", "-0.6")])]  # fmt: skip
    arm = ArmBuilder().revolute(limits=None).link(1).revolute(limits=None).link("0.3").effector()
    workspace = world(spot("S", "1.1", 0), spot("T", 0, "1.1"), *blocks)
    task = errand(avoid=avoiding(*(block.name for block in blocks)))
    assert proved(covering("", "aaaaaabbbb"), arm.model(), workspace, task)
    # One block fewer in the way, and the first link can turn on to the target.
    fewer = errand(avoid=avoiding("B1", "B2", "B3"))
    assert not proved(covering("", "aaaaaabbbb"), arm.model(), workspace, fewer)


# --- clauses -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limits", "angle", "impossible"),
    [
        ((-180, 180), 0, False),
        ((-180, 180), 100, False),
        ((-180, 180), 181, True),  # outside the range
        ((-180, 180), 45, True),  # in the obstacle
        ((-180, 180), 20, True),  # on the wrong side of it
        (None, 20, False),  # goes the other way
        (None, 380, False),  # the same angle
        (None, 405, True),  # in the obstacle, after a turn
        (None, -315, True),
        (None, 180, False),
        (None, -900, False),
    ],
)
def test_a_given_pose(limits, angle, impossible):
    blocked = limits is not None and -180 < angle <= 45 and angle != 0
    workspace = world(T, DIAGONAL)
    task = errand(start=ir.StartAt((degrees(angle),)), avoid=avoiding("O"))
    if angle == 0:
        task = errand(start=ir.StartAt((degrees(angle),)))
    model = one_link(limits=limits).model()
    assert proved(covering("", "aaaaaaaa"), model, workspace, task) is impossible
    assert blocked <= impossible


def test_a_pose_of_another_number_of_coordinates_is_of_no_candidate():
    task = errand(start=ir.StartAt((number(0), number(0))))
    assert proved(covering("", ""), one_link().model(), world(T), task)


def test_a_pose_may_be_missed_by_as_little_as_the_verifier_allows():
    workspace = world(T)
    for beyond, impossible in (("1e-10", False), ("1e-8", True)):
        model = one_link(limits=None).model()
        model = one_of_range(model, ir.Interval(number(0), number(2)))
        start = ir.StartAt((number(Fraction(2) + Fraction(beyond)),))
        assert proved(covering("", "aaaaaa"), model, workspace, errand(start=start)) is impossible


def one_of_range(model, interval):
    from dataclasses import replace

    return replace(model, dofs=(replace(model.dofs[0], range=interval),))


def two_tips():
    """Effector 1 at 1 m, effector 2 at 2 m, on one link."""
    arm = ArmBuilder().revolute().link(1).effector()
    return arm.link(1).effector().model()


@pytest.mark.parametrize(
    ("start", "reach", "impossible"),
    [
        (None, None, False),  # effector 1 does both
        (1, 1, False),
        (1, None, True),  # the start names one, any may reach: both are tried, see below
        (None, 1, False),
        (2, 1, True),  # S is not where effector 2 gets
        (1, 2, True),
    ],
)
def test_the_named_effectors(start, reach, impossible):
    workspace = world(S, T)
    task = errand(start=ir.StartIn("S", start, Fraction(0)), reach=ir.Reach("T", reach))
    expected = impossible and (start, reach) != (1, None)
    assert proved(covering("", "aaaaaaa"), two_tips(), workspace, task) is expected


def test_effectors_that_start_and_reach_may_differ_where_the_task_says_so():
    workspace = world(S, spot("T", 0, 2))
    free = errand(start=ir.StartIn("S", 1, Fraction(0)))
    assert not proved(covering("", "aaaaaaa"), two_tips(), workspace, free)
    one = errand()  # one and the same recorded effector
    assert proved(covering("", "aaaaaaa"), two_tips(), workspace, one)
    named = errand(start=ir.StartIn("S", 3, Fraction(0)))
    assert proved(covering("", ""), two_tips(), workspace, named)


def atom(region, effector=1):
    return ir.Atom(region, effector)


def test_formulas_alone_are_asked_about_what_they_visit():
    always = ir.Window(Fraction(0), None)
    visit = ir.Satisfy(ir.Eventually(atom("T"), always))
    keep_out = ir.Satisfy(ir.Always(ir.Not(atom("O")), always))
    entered = box("O", "obstacle", ("0.6", "0.8"), ("0.6", "0.8"))
    workspace = world(S, T, entered)
    one = one_link().model()
    assert not proved(covering("", "aaaaaaa"), one, workspace, errand(reach=None, satisfy=(visit,)))
    both = errand(reach=None, satisfy=(visit, keep_out))
    assert proved(covering("", "aaaaaaa"), one, workspace, both)
    # Of effector 1 alone: effector 2 may enter.
    apart = errand(reach=ir.Reach("T", 2), start=ir.StartIn("S", 2, Fraction(0)),
                   satisfy=(keep_out,))  # fmt: skip
    arm = ArmBuilder().revolute().link("0.5").effector().link("0.5").effector().model()
    assert not proved(covering("", "aaaaaaa"), arm, workspace, apart)


def test_without_any_goal_the_start_region_is_all_there_is():
    task = errand(reach=None, satisfy=(ir.Satisfy(ir.Not(ir.Eventually(atom("T"),
                  ir.Window(Fraction(0), Fraction(1))))),))  # fmt: skip
    assert not proved(covering("", "aaaaaa"), one_link().model(), world(S, T), task)
    far = world(spot("S", 3, 0), T)
    assert proved(covering("", "aaaaaa"), one_link().model(), far, task)


def test_a_robot_without_degrees_of_freedom():
    arm = ArmBuilder()
    model = arm.link(arm.parameter("0.5", 2)).effector().model()
    overlapping = world(S, box("T", "target", (1, 2), (-1, 1)))
    assert not proved(covering("", ""), model, overlapping, errand())
    apart = world(S, box("T", "target", ("1.15", 2), (-1, 1)))
    assert not proved(covering("", ""), model, apart, errand())
    assert proved(covering("AAAAAA", ""), model, apart, errand())


def test_sliders_have_ranges():
    arm = ArmBuilder().prismatic(0, (0, 3)).effector().model()
    assert not proved(covering("", "aaaaa"), arm, world(S, spot("T", 2, 0)), errand())
    assert proved(covering("", "aaaaa"), arm, world(S, spot("T", 4, 0)), errand())
    free = ArmBuilder().prismatic(0, None).effector().model()
    reason = why_not(covering("", "aaaaa"), free, world(S, spot("T", 4, 0)), errand())
    assert "without a range" in str(reason)


def test_an_arm_in_space():
    arm = ArmBuilder(3).revolute(2, None).link(1).revolute(1, (-90, 90)).link("0.6").effector()
    cube = (("-9", "9"),) * 3
    start = box("S", "region", ("1.5", "1.7"), ("-0.1", "0.1"), ("-0.1", "0.1"))
    # Height is 0.6 m at most.
    for low, impossible in (("0.62", True), ("0.5", False)):
        target = box("T", "target", (-1, 1), (-1, 1), (low, 2))
        found = proved(covering("", "aaaaabbbbb"), arm.model(), world(start, target, bounds=cube),
                       errand())  # fmt: skip
        assert found is impossible


# --- drives --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("effort", "impossible"), [("0.05", True), (40, False)])
def test_a_pendulum_is_not_lifted_by_a_weak_drive(effort, impossible):
    # A rod of 1 kg and 1 m hangs down; up to the target its middle rises by 1 m, 9.8 J.
    down = ir.StartAt((degrees(-90),))
    task = errand(
        start=down, gravity=(Fraction(0), Fraction("-9.8")),
        effort=(ir.Effort("revolute", Fraction(effort), False),), steps=2, step=Fraction(1, 2),
    )  # fmt: skip
    model = one_link(limits=None).model()
    workspace = world(T)
    assert not proved(covering("", "aaaaaa"), model, workspace, task)
    reason = why_not(covering("", "aaaaaa", "!"), model, workspace, task)
    assert reason is None if impossible else "too weak" in str(reason)


def test_where_there_is_no_way_the_drives_do_not_matter():
    workspace = world(S, spot("T", 0, 2))
    assert why_not(covering("", "aaaaaa", "!"), one_link().model(), workspace, errand()) is None


# --- files ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "first line"),
        ("boxes 1\n", "too early"),
        ("boxes 1\nA|.|.", "does not have"),
        ("boxes 1\n|b..", "does not have"),
        ("boxes 1\n!.", "too weak"),
        ("boxes 1\n|.", "box 1 of the parameters: there may be a way"),
    ],
)
def test_what_proves_nothing(text, reason):
    assert reason in str(why_not(text, one_link().model(), world(S, T), errand()))


def test_rules_without_a_value_prove_nothing():
    arm = ArmBuilder().revolute()
    arm.link(arm.apply("/", 1, 0)).effector()
    reason = why_not(covering("", "aaaa"), arm.model(), world(S, spot("T", 0, 2)), errand())
    assert "no exact value" in str(reason)
    arm = ArmBuilder().revolute()
    arm.link(arm.apply("sqrt", arm.parameter(-2, -1))).effector()
    assert not proved(covering("A", "aaaa"), arm.model(), world(S, spot("T", 0, 2)), errand())


def test_a_proof_of_one_robot_is_none_of_a_longer_one():
    workspace, task = world(spot("T", 0, 2)), errand(start=ir.StartAt((number(0),)))
    text = covering("AAA", "aaaaaa")
    assert proved(text, one_link(("0.5", "1.8")).model(), workspace, task)
    assert not proved(text, one_link(("0.5", "2.5")).model(), workspace, task)
    # One box of many that is open is enough.
    assert not proved(text, one_link(("0.5", "1.95")).model(), workspace, task)


def test_whole_turns_by_pi_are_met_exactly():
    # Limits that are irrational: pi/2 is reached, and the target begins just there or beyond.
    workspace = world(S, box("T", "target", (-2, 0), (0, 2)))
    model = one_link(limits=(-90, 90)).model()
    assert not proved(covering("", "aaaaaaaaaa"), model, workspace, errand())
    beyond = world(S, box("T", "target", (-2, "-0.001"), (0, 2)))
    assert proved(covering("", "aaaaaaaaaaaa"), model, beyond, errand())
    assert pi / 2 > 1.57

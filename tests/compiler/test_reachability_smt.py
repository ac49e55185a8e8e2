"""Every encoding by itself, and the text of the scripts."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from io import StringIO

import numpy as np
import pytest
from pysmt.environment import Environment
from pysmt.smtlib.parser import SmtLibParser

from compiler.encodings.pose_questions import effector_choices, pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.normal_form import normalise
from grammar_lang import ir
from solvers.backends.smt import solve_script
from tests.oracles.arms import ArmBuilder, number, planar_arm
from tests.oracles.planes import bench
from tests.oracles.questions import (
    EVERYWHERE,
    SAT,
    UNSAT,
    box_about,
    decide,
    question,
    random_robot,
)

# --- the running example -------------------------------------------------------------------------


@pytest.mark.parametrize(("links", "answer"), [(1, UNSAT), (2, SAT), (3, SAT), (6, SAT)])
def test_planar_arms(links, answer):
    assert decide(planar_arm(links)) == answer


@pytest.mark.parametrize("links", [1, 2, 3, 4, 5, 6])
def test_arms_that_are_too_short_are_refuted(links):
    # The nearest corner of the target is hypot(3.5, 3.8) = 5.1662 from the base.
    assert decide(planar_arm(links, "1/2", Fraction(51, 10) / links)) == UNSAT
    assert decide(planar_arm(links + 1, "1/2", Fraction(52, 10) / links)) == SAT


def test_the_published_lengths():
    arm = ArmBuilder()
    for length in ("2.23", "3.35"):
        arm.revolute().link(arm.parameter(length, length))
    assert decide(arm.effector()) == SAT


def test_links_behind_one_joint_are_one_link():
    arm = ArmBuilder().revolute()
    for _ in range(5):
        arm.link(arm.parameter("1/2", 5))
    assert decide(arm.effector()) == UNSAT


def fixed_then_turning(*longest):
    arm = ArmBuilder()
    for upper in longest:
        arm.link(arm.parameter("1/2", upper))
    arm.revolute()
    return arm.link(arm.parameter("1/2", 5)).effector()


def test_links_fixed_to_the_base_shift_the_centre():
    # The centre (a, 0) is as far from s as from t: a = (|t|^2 - |s|^2) / 2 (t_x - s_x).
    sx, sy, tx, ty = np.meshgrid(
        *(np.linspace(*ends, 21) for ends in ((0.8, 1.2), (1.0, 1.4), (3.5, 4.2), (3.8, 4.5)))
    )
    centres = (tx**2 + ty**2 - sx**2 - sy**2) / (2 * (tx - sx))
    assert 4.31 < centres.min() < 4.34
    assert decide(fixed_then_turning("4.3")) == UNSAT
    assert decide(fixed_then_turning("4.4")) == SAT
    assert decide(fixed_then_turning("2.1", "2.2")) == UNSAT
    assert decide(fixed_then_turning(5, 5)) == SAT


# --- rigid turns ---------------------------------------------------------------------------------


def test_a_right_angle_is_exact():
    # An L of 3 and 4 turns about the base: radius 5 exactly.
    arm = ArmBuilder().revolute().link(3)
    arm.turn(arm.degrees(90)).link(4).effector()
    wide = ((-9, 9), (-9, 9))
    at = box_about((3, 4), 0)
    assert decide(arm, question(at, box_about((-5, 0), 0), wide)) == SAT
    near = ((Fraction(-5) + Fraction(1, 10**9), -4), (0, 0))
    assert decide(arm, question(at, near, wide)) == UNSAT


@pytest.mark.parametrize("bend", [45, 60, 120, -150, 17])
def test_a_bent_link_has_the_radius_of_the_law_of_cosines(bend):
    arm = ArmBuilder().revolute().link(2)
    arm.turn(arm.degrees(bend)).link(1).effector()
    r = float(np.sqrt(5 + 4 * np.cos(np.radians(bend))))
    gap, wide = Fraction(1, 10**6), ((-9, 9), (-9, 9))
    inside = ((Fraction(r) - gap, Fraction(r) + gap), (0, 0))
    outside = ((Fraction(r) + gap, 9), (0, 0))
    assert decide(arm, question(inside, inside, wide)) == SAT
    assert decide(arm, question(inside, outside, wide)) == UNSAT
    assert decide(arm, question(inside, ((0, Fraction(r) - gap), (0, 0)), wide)) == UNSAT


def test_a_turn_before_the_first_joint_places_its_centre():
    arm = ArmBuilder()
    arm.turn(arm.degrees(30)).link(2).revolute().link(1).effector()
    centre = (Fraction(3**0.5), 1)  # 2 (cos 30, sin 30)
    wide = ((-9, 9), (-9, 9))
    top = ((centre[0] - 1, centre[0] + 1), (Fraction("1.9"), 2))
    assert decide(arm, question(top, top, wide)) == SAT
    assert decide(arm, question(top, ((-9, 9), (Fraction("2.001"), 9)), wide)) == UNSAT


def test_an_angle_that_is_a_parameter():
    # Two links of 1 with a bend in [1, 2] rad, one joint: radii 2 cos(bend / 2), 1.0806 to 1.7552.
    arm = ArmBuilder().revolute().link(1)
    arm.turn(arm.parameter(1, 2, name="bend", unit="")).link(1).effector()
    wide = ((-9, 9), (-9, 9))

    def at(radius):
        return box_about((radius, 0), 0)

    assert decide(arm, question(at(1.2), at(-1.2), wide)) == SAT
    assert decide(arm, question(at(1.2), at(1.3), wide)) == UNSAT  # one bend for both poses
    assert decide(arm, question(at(1.0), at(1.0), wide)) == UNSAT
    assert decide(arm, question(at(1.8), at(1.8), wide)) == UNSAT


# --- prismatic joints ----------------------------------------------------------------------------


def test_a_slider_changes_the_radius_from_pose_to_pose():
    assert decide(ArmBuilder().revolute().link(1).prismatic(0, (0, 5)).effector()) == SAT
    assert decide(ArmBuilder().revolute().link(1).prismatic(0, (0, 4)).effector()) == UNSAT
    assert decide(ArmBuilder().revolute().link(1).prismatic(0, None).effector()) == SAT


def test_sliders_alone_are_exact():
    def gantry(limit):
        return ArmBuilder().prismatic(0, (0, 4)).prismatic(1, (0, limit), sign=-1).effector()

    assert decide(gantry("-1")) == UNSAT  # limits the wrong way round: no pose at all
    arm = ArmBuilder().prismatic(0, (0, 4)).prismatic(1, (-4, 0), sign=-1).effector()
    assert decide(arm) == SAT
    arm = ArmBuilder().prismatic(0, (0, 4)).prismatic(1, ("-3.79", 0), sign=-1).effector()
    assert decide(arm) == UNSAT


def test_irrational_limits_are_rounded_outwards():
    wide = ((-9, 9), (-9, 9))
    arm = ArmBuilder().prismatic(0, (0, ir.Unary("sqrt", number(2)))).effector()
    assert decide(arm, question(box_about((0, 0), 0), (("1.414", "1.415"), (0, 0)), wide)) == SAT
    assert decide(arm, question(box_about((0, 0), 0), (("1.4143", 2), (0, 0)), wide)) == UNSAT


# --- parameters ----------------------------------------------------------------------------------


def choosing(*values):
    arm = ArmBuilder()
    for _ in range(2):
        arm.revolute().link(arm.parameter(ir.Choices(tuple(number(v) for v in values))))
    return arm.effector()


def test_choices():
    assert decide(choosing("2", "4")) == SAT
    assert decide(choosing("1", "2")) == UNSAT  # 4 < 5.1662
    assert decide(choosing("1", "7")) == SAT  # 7 and 7: a disc of radius 14


def test_the_design_is_the_same_at_both_poses():
    # One link may have either radius, but not both in one robot.
    arm = ArmBuilder().revolute()
    arm.link(arm.parameter(ir.Choices((number("1.6"), number("5.5"))))).effector()
    model = normalise(arm.model())
    assert decide(model) == UNSAT
    assert decide(model, question(target=((0, 5), (0, 5)))) == SAT
    assert decide(model, question(start=None)) == SAT


# --- effectors -----------------------------------------------------------------------------------


def two_effectors():
    """One at radius 1.6 (the start), one at radius 5.5 (the target) on one rigid arm."""
    return ArmBuilder().revolute().link("1.6").effector().link("3.9").effector().model()


@pytest.mark.parametrize(
    ("start", "reach", "answer"),
    [
        (None, None, UNSAT),
        (0, 1, SAT),
        (1, 0, UNSAT),
        (0, 0, UNSAT),
        (None, 1, UNSAT),
        (0, 2, UNSAT),
    ],
)
def test_effectors_by_name(start, reach, answer):
    asked = question(start_effector=start, reach_effector=reach)
    assert decide(two_effectors(), asked) == answer


def test_effector_choices():
    model = two_effectors()
    assert effector_choices(model, question()) == [(0, 0), (1, 1)]
    assert effector_choices(model, question(reach_effector=1)) == [(1, 1)]
    assert effector_choices(model, question(start_effector=0)) == [(0, 0), (0, 1)]
    assert effector_choices(model, question(start_effector=1, reach_effector=0)) == [(1, 0)]
    assert effector_choices(model, question(start_effector=2)) == []


def test_one_of_several_effectors_suffices():
    # The first stays at radius 3, the second is anywhere up to 6.
    arm = ArmBuilder().revolute().link(3).effector()
    arm.revolute().link(3).effector()
    assert decide(arm) == SAT
    assert "(assert (or " in refutation_script(arm.model(), question())


def test_effectors_that_move_alike_are_encoded_once():
    arm = planar_arm(2)
    twice = replace(arm, effectors=arm.effectors * 2)
    assert refutation_script(twice, question()) == refutation_script(arm, question())


def test_no_effector_is_false_in_so_many_words():
    arm = ArmBuilder().revolute().link(1).model()
    script = refutation_script(arm, question())
    assert "; No effector of the structure is a candidate" in script
    assert "(assert false)" in script
    assert solve_script(script) == UNSAT


def test_an_effector_that_nothing_moves():
    arm = ArmBuilder()
    arm.move(arm.parameter(0, 5), arm.parameter(0, 5)).effector()
    assert decide(arm) == UNSAT  # one place cannot be two
    assert decide(arm, question(target=((1, 2), (1, 2)))) == SAT
    assert decide(arm, question(start=None)) == SAT
    assert decide(ArmBuilder().effector(), question(start=None)) == UNSAT


def test_start_at_asks_about_the_target_only():
    one = planar_arm(1, "1/2", "5.2")
    script = refutation_script(one, question(start=None))
    assert "start_" not in script
    assert solve_script(script) == SAT
    assert decide(planar_arm(1, "1/2", "5.1"), question(start=None)) == UNSAT


def test_bounds_bind_both_ends():
    assert decide(planar_arm(2), question(bounds=((0, "3.4"), (0, 5)))) == UNSAT
    assert decide(planar_arm(2), question(bounds=(("1.3", 5), (0, 5)))) == UNSAT


# --- space ---------------------------------------------------------------------------------------


def asked_in_space(start, target):
    return question(start, target, EVERYWHERE)


def at(*point):
    return tuple((Fraction(x), Fraction(x)) for x in point)


def test_one_joint_in_space_moves_on_a_circle():
    arm = ArmBuilder(3).move(0, 0, 1).revolute(2).move(3, 0, 4).effector()
    assert decide(arm, asked_in_space(at(3, 0, 5), at(0, -3, 5))) == SAT
    assert decide(arm, asked_in_space(at(3, 0, 5), at(0, -3, "5.01"))) == UNSAT
    assert decide(arm, asked_in_space(at(3, 0, 5), at(0, "-3.01", 5))) == UNSAT


def test_parallel_axes_keep_the_height():
    arm = ArmBuilder(3)
    arm.revolute(2).move(2, 0, 1).revolute(2, sign=-1).move(1).prismatic(2, (0, 1)).effector()
    assert decide(arm, asked_in_space(at(0, 3, 1), at(-1, 0, 2))) == SAT
    assert decide(arm, asked_in_space(at(0, 3, 1), at(-1, 0, "2.1"))) == UNSAT
    assert decide(arm, asked_in_space(at(0, 3, 1), at(0, "3.1", 1))) == UNSAT
    assert decide(arm, asked_in_space(at(0, 3, 1), at(0, "0.9", 1))) == UNSAT


def test_a_tilted_base_tilts_the_plane_of_motion():
    arm = ArmBuilder(3)
    arm.turn(arm.degrees(90), 0).revolute(2).move(2).effector()  # the axis is -y now
    assert decide(arm, asked_in_space(at(2, 0, 0), at(0, 0, 2))) == SAT
    assert decide(arm, asked_in_space(at(2, 0, 0), at(0, 2, 0))) == UNSAT
    arm = ArmBuilder(3)
    arm.turn(arm.degrees(45), 0).revolute(2).move(2).effector()  # the axis is (0, -1, 1) / sqrt 2
    there = tuple(box_about((0, 2**0.5, 2**0.5), Fraction(1, 10**6)))
    assert decide(arm, asked_in_space(at(2, 0, 0), there)) == SAT
    assert decide(arm, asked_in_space(at(2, 0, 0), at(0, 2, 0))) == UNSAT


def test_an_elbow_arm_in_space():
    # A post of 1, then shoulder and elbow of 2 and 1: a shell about (0, 0, 1) from 1 to 3.
    arm = ArmBuilder(3).revolute(2).move(0, 0, 1).revolute(1).move(2).revolute(1).move(1).effector()
    assert decide(arm, asked_in_space(at(0, 0, 4), at(0, -1, 1))) == SAT
    assert decide(arm, asked_in_space(at(0, 0, "4.01"), at(0, -1, 1))) == UNSAT
    assert decide(arm, asked_in_space(at(0, 0, 4), at(0, "-0.99", 1))) == UNSAT


def test_a_later_joint_after_an_arm_that_turns():
    # A boom of 2 about z, then a link of 1 about its own x, y or z: a torus-like set.
    arm = ArmBuilder(3).revolute(2).move(2).revolute(1).move(1).effector()
    assert decide(arm, asked_in_space(at(3, 0, 0), at(0, -2, 1))) == SAT
    assert decide(arm, asked_in_space(at(3, 0, 0), at(0, 0, 0))) == UNSAT
    assert decide(arm, asked_in_space(at(3, 0, 0), at(0, -2, "1.01"))) == UNSAT


def test_a_joint_along_a_displacement_moves_nothing():
    """A wrist about the forearm leaves the height; turned aside, the tip leaves it too."""
    arm = ArmBuilder(3).revolute(2).move(2, 0, 1).revolute(0).move(1)
    assert decide(arm.effector(), asked_in_space(at(3, 0, 1), at(0, -3, 1))) == SAT
    assert decide(arm, asked_in_space(at(3, 0, 1), at(0, -3, "1.01"))) == UNSAT
    assert decide(arm, asked_in_space(at(3, 0, 1), at(0, "-2.99", 1))) == UNSAT
    sliding = ArmBuilder(3).revolute(2).move(2, 0, 1).revolute(0).turn(1, 0).prismatic(0, (0, 1))
    assert decide(sliding.effector(), asked_in_space(at(2, 0, 1), at(0, 3, 1))) == SAT
    assert decide(sliding, asked_in_space(at(2, 0, 1), at(0, 3, "1.01"))) == UNSAT
    bent = ArmBuilder(3).revolute(2).move(2, 0, 1).revolute(0).move(1).move(0, 1).effector()
    above = asked_in_space(at(3, 1, 1), tuple(box_about((0, -3, 1.5), Fraction(1, 2))))
    assert decide(bent, above) == SAT


# --- the text ------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(10))
def test_scripts_parse(seed):
    model = random_robot(np.random.default_rng(seed), 3)
    asked = question(((0, 1),) * 3, ((1, 2),) * 3, EVERYWHERE)
    script = refutation_script(model, asked)
    parsed = SmtLibParser(Environment()).get_script(StringIO(script))
    names = [command.name for command in parsed.commands]
    assert names[0] == "set-logic"
    assert parsed.commands[0].args[0].name == "QF_NRA"
    assert names[-1] == "check-sat"
    assert names.count("check-sat") == 1
    assert script.isascii()
    assert max(map(len, (line for line in script.splitlines() if line[0] == ";"))) <= 100


PROGRAM = """
import numpy as np
from compiler.encodings.reachability_smt import refutation_script
from tests.oracles.questions import question, random_robot
asked = question(((0, 1),) * 3, ((1, 2),) * 3, ((-9, 9),) * 3)
for seed in range(5):
    print(refutation_script(random_robot(np.random.default_rng(seed), 3), asked))
"""


@pytest.mark.slow
def test_the_bytes_do_not_depend_on_the_hash_seed():
    outputs = set()
    for seed in ("0", "7"):
        environment = {
            **os.environ,
            "PYTHONHASHSEED": seed,
            "PYTHONPATH": os.pathsep.join(sys.path),
        }
        run = subprocess.run(
            [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, check=True
        )
        outputs.add(run.stdout)
    assert len(outputs) == 1


def test_a_long_arm_has_a_short_script():
    arm = ArmBuilder(3)
    for i in range(150):
        arm.turn(arm.parameter(0, 1, name="bend", unit=""), i % 3)
        arm.link(arm.parameter(1, 2))
    script = refutation_script(arm.effector().model(), question(*[EVERYWHERE] * 3))
    assert len(script) < 400_000


# --- from a task ---------------------------------------------------------------------------------


def test_a_task_asks_about_its_regions():
    task = ir.Task(
        "T", "G", "Bench", ir.StartIn("S", 2, Fraction(0)), ir.Reach("T", None),
        (), (), 81, Fraction(1, 8), Fraction(0), (), None, bounds_body=False,
    )  # fmt: skip
    assert pose_questions(bench(), task) == (question(start_effector=1, effectors=2),)
    pose = ir.StartAt((ir.Num(Fraction(1)), ir.Pi()))
    fixed = replace(task, start=pose, reach=ir.Reach("T", 1))
    wanted = question(start=None, reach_effector=0, start_at=pose, effectors=1)
    assert pose_questions(bench(), fixed) == (wanted,)


def test_a_parameter_of_one_value_is_a_constant():
    arm = ArmBuilder().revolute()
    arm.link(arm.parameter("1.6", "1.6")).effector()
    assert "theta" not in refutation_script(arm.model(), question())


def test_a_start_pose_of_another_number_of_joints_is_no_candidate():
    """`start at (...)` names one value per degree of freedom; others are no candidates."""
    asked = question(start=None)
    for values, answer in ((2, SAT), (3, UNSAT)):
        pose = ir.StartAt((ir.Num(Fraction(0)),) * values)
        assert decide(planar_arm(2), replace(asked, start_at=pose)) == answer

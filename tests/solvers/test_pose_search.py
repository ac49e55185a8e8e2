from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.reachability_smt import refutation_script
from grammar_lang import ir
from solvers.backends.smt import solve_script
from solvers.impossibility.pose_search import find_poses, find_poses_of
from solvers.verdict import Fails
from tests.oracles.arms import ArmBuilder, effector_positions, number, planar_arm
from tests.oracles.questions import question, random_robot


def search(model, asked, seed=0):
    return find_poses(NumericRobot(robot_graph(model)), asked, seed)


def inside(rows, point):
    return all(
        sum(float(a) * x for a, x in zip(row.normal, point, strict=True))
        <= float(row.offset) + 1e-9
        for row in rows
    )


def check(model, asked, found):
    """A witness is one by another forward kinematics."""
    ends = [(found.target, asked.target, found.effector)]
    if asked.start is not None:
        ends.append((found.start, asked.start, found.start_effector))
    for q, region, effector in ends:
        place = effector_positions(model, q, found.theta)[effector]
        assert inside((*region, *asked.bounds), place)


@pytest.mark.parametrize("links", [2, 3, 4])
@pytest.mark.parametrize("seed", range(4))
def test_arms_of_the_running_example(links, seed):
    model = planar_arm(links)
    found = search(model, question(), seed)
    check(model, question(), found)
    assert np.all(found.theta >= 0.5)
    assert np.all(found.theta <= 5)


def test_one_link_is_not_found():
    assert search(planar_arm(1), question()) is None


def test_lengths_that_only_just_suffice_are_found():
    # 5.1662 is the distance of the nearest corner.
    model = planar_arm(2, "1/2", "2.59")
    check(model, question(), search(model, question()))


def test_joint_limits_are_honoured():
    model = planar_arm(3, limits=(-150, 150))
    found = search(model, question())
    check(model, question(), found)
    for q in (found.start, found.target):
        assert np.all(np.abs(q) <= np.radians(150) + 1e-12)
    # An elbow of at most 100 degrees keeps arms that reach the target too far from the start.
    assert search(planar_arm(2, limits=(-100, 100)), question()) is None


def test_a_slider_has_its_limits():
    arm = ArmBuilder().revolute().link(1).prismatic(0, (0, 5)).effector().model()
    found = search(arm, question())
    check(arm, question(), found)
    assert 0 <= found.start[1] <= found.target[1] <= 5
    unlimited = ArmBuilder().revolute(limits=None).prismatic(0, None).effector().model()
    check(unlimited, question(), search(unlimited, question()))


def test_choices_are_kept():
    arm = ArmBuilder()
    for _ in range(2):
        arm.revolute().link(arm.parameter(ir.Choices((number(1), number(3)))))
    model = arm.effector().model()
    found = search(model, question())
    check(model, question(), found)
    assert list(found.theta) == [3, 3]


def test_effectors_by_name():
    model = ArmBuilder().revolute().link("1.6").effector().link("3.9").effector().model()
    assert search(model, question()) is None
    asked = question(start_effector=0, reach_effector=1)
    found = search(model, asked)
    check(model, asked, found)
    assert (found.start_effector, found.effector) == (0, 1)
    numeric = NumericRobot(robot_graph(model))
    assert find_poses_of(numeric, asked, (1, 0), 0) is None
    assert search(model, question(reach_effector=2)) is None


def test_a_given_start_leaves_the_target():
    found = search(planar_arm(1, 5, 6), question(start=None))
    assert found.start is None
    check(planar_arm(1, 5, 6), question(start=None), found)


def test_robots_that_cannot_move():
    fixed = ArmBuilder().move("1.1", "1.2").effector().model()
    assert search(fixed, question()) is None
    found = search(fixed, question(target=((1, 2), (1, 2))))
    assert found.target.shape == (0,)
    none = replace(fixed, effectors=())
    assert search(none, question()) is None


def test_the_same_seed_gives_the_same_poses():
    first, second = (search(planar_arm(3), question(), seed=3) for _ in range(2))
    assert np.array_equal(first.theta, second.theta)
    assert np.array_equal(first.start, second.start)
    assert np.array_equal(first.target, second.target)


@pytest.mark.parametrize("seed", range(12))
def test_what_is_found_is_never_refuted(seed):
    rng = np.random.default_rng(seed)
    model = random_robot(rng, 2)
    boxes = []
    for _ in range(2):
        low = [Fraction(int(n), 2) for n in rng.integers(-6, 6, size=2)]
        boxes.append(tuple((x, x + Fraction(1, 2)) for x in low))
    asked = question(*boxes, ((-9, 9), (-9, 9)))
    found = search(model, asked)
    answer = solve_script(refutation_script(model, asked), resources=30_000)
    if found is not None:
        check(model, asked, found)
        assert answer != Fails(None)

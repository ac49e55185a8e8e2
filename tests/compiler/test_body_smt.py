"""Scripts about poses of the whole body, decided by z3, against the geometry of small arms."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.encodings.body_smt import Poses, body_script, body_scripts
from compiler.encodings.pose_questions import MOST, BodyConditions, PoseQuestion, body_conditions
from compiler.encodings.region_terms import PolygonTerms, polygon_terms
from compiler.robots.normal_form import normalise
from compiler.robots.robot import PointBody, RobotModel, RodBody, SolidBody
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from solvers.backends.smt import solve_script
from solvers.verifier.refutations.solver_process import smt_solver
from tests.compiler.test_reachability_soundness import pinned
from tests.oracles.arms import ArmBuilder, effector_positions, planar_arm
from tests.oracles.planar_bodies import bodies_of, depth, random_polygon, two_link_poses
from tests.oracles.planes import box, box_rows
from tests.oracles.questions import (
    EVERYWHERE,
    SAT,
    UNSAT,
    question,
    random_design,
    random_pose,
    random_robot,
    round_box_about,
)
from tests.oracles.some_cases import some
from tests.oracles.tasks import task

BUDGET, SMALL_BUDGET = 4_000_000, 5_000
PLANE = EVERYWHERE[:2]
TARGET: Poses = ("target",)


def demands(
    *polygons: Polytope, effectors: Sequence[Polytope] = (), bounds_body: bool = False
) -> BodyConditions:
    return BodyConditions(tuple(map(known, polygons)), tuple(map(known, effectors)), bounds_body)


def known(polygon: Polytope) -> PolygonTerms:
    found = polygon_terms(polygon)
    assert found is not None
    return found


def decide(
    arm: RobotModel | ArmBuilder,
    asked: PoseQuestion,
    wanted: BodyConditions,
    poses: Poses = TARGET,
    budget: int = BUDGET,
) -> object:
    model = arm.model() if isinstance(arm, ArmBuilder) else arm
    script = body_script(model, asked, wanted, poses)
    assert script is not None
    return solve_script(script, resources=budget)


def rectangle(x: tuple[object, object], y: tuple[object, object]) -> Polytope:
    return Polytope(box_rows(x, y).rows)


def at(x: object, y: object, bounds: object = PLANE, start: object = None) -> PoseQuestion:
    """The effector is at a point."""
    return question(start, ((x, x), (y, y)), bounds)


# --- exactness and soundness --------------------------------------------------------------------


@pytest.mark.parametrize("seed", some(range(16), 4))
def test_two_links_reach_a_point_if_and_only_if_one_of_two_poses_is_clear(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, x, y = (Fraction(int(n), 10) for n in rng.integers((8, 8, -20, -20), (20, 20, 21, 21)))
    arm = ArmBuilder().revolute().link(a).revolute().link(b).effector().model()
    polygons = [random_polygon(rng, rng.uniform(-1.5, 1.5, 2), 0.6) for _ in range(2)]
    poses = [np.array(p) for p in two_link_poses(*map(float, (a, b, x, y)))]
    depths = [
        min(depth(bodies_of(arm, q, np.zeros(0)), polygon.vertices) for polygon in polygons)
        for q in poses
    ]
    expected = SAT if any(d > 0 for d in depths) else UNSAT
    # A thousandth about the point; the pose moves by more than that, but not by thirty.
    if any(abs(d) < 0.03 for d in depths):
        expected = None
    near = question(None, round_box_about((x, y), Fraction(1, 1000)), PLANE)
    answer = decide(arm, near, demands(*polygons))
    assert expected in (answer, None)


def test_the_two_links_are_of_both_kinds() -> None:
    """What the test above looks at: arms that cannot reach, that may not, and that may."""
    kinds = set()
    for seed in range(16):
        rng = np.random.default_rng(seed)
        a, b, x, y = (int(n) / 10 for n in rng.integers((8, 8, -20, -20), (20, 20, 21, 21)))
        arm = ArmBuilder().revolute().link(Fraction(a)).revolute().link(Fraction(b)).effector()
        polygons = [random_polygon(rng, rng.uniform(-1.5, 1.5, 2), 0.6) for _ in range(2)]
        poses = two_link_poses(a, b, x, y)
        bodies = [bodies_of(arm.model(), np.array(q), np.zeros(0)) for q in poses]
        clear = [min(depth(b, p.vertices) for p in polygons) > 0 for b in bodies]
        kinds.add((len(clear), sum(clear)))
    assert {(0, 0), (2, 0), (2, 1), (2, 2)} <= kinds


def sound(seed: int, *, pin: bool) -> Iterator[object]:
    """Ask of a random robot what it just did, among obstacles that it just missed."""
    rng = np.random.default_rng(seed)
    model = random_robot(rng, 2)
    theta = random_design(rng, model)
    if pin:
        model = pinned(model, theta)
    poses = [random_pose(rng, model) for _ in range(2)]
    bodies = [bodies_of(model, q, theta) for q in poses]
    tips = [effector_positions(model, q, theta) for q in poses]
    obstacles: list[Polytope] = []
    while len(obstacles) < 3:
        polygon = random_polygon(rng, rng.uniform(-3, 3, 2), 0.7)
        if min(depth(body, polygon.vertices) for body in bodies) > 1e-6:
            obstacles.append(polygon)
    width = Fraction(1, 100)
    for start in range(len(model.effectors)):
        boxes = round_box_about(tips[0][start], width), round_box_about(tips[1][-1], width)
        last = len(model.effectors) - 1
        asked = question(*boxes, PLANE, start_effector=start, reach_effector=last)
        wanted = demands(*obstacles, bounds_body=True)
        for subject in (model, normalise(model)):
            for names in body_scripts(asked):
                yield decide(subject, asked, wanted, names, SMALL_BUDGET)


@pytest.mark.parametrize("seed", some([1, 0, 2], 1))
def test_what_a_robot_does_is_never_refuted(seed: int) -> None:
    answers = list(sound(seed, pin=True))
    assert UNSAT not in answers


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3, 40))
def test_what_a_robot_does_is_never_refuted_with_free_parameters(seed: int) -> None:
    assert UNSAT not in sound(seed, pin=False)


# --- the case study -----------------------------------------------------------------------------

OBSTACLE = rectangle(("1.7", 3), (2, 3))


def published(first: str, second: str) -> RobotModel:
    arm = ArmBuilder().revolute().link(first).revolute().link(second)
    return normalise(arm.effector().model())


def test_the_published_lengths_have_no_pose_in_the_target() -> None:
    """Row 4.14; another order of the same links has one."""
    wanted = demands(OBSTACLE)
    answers = [decide(published("2.23", "3.35"), question(), wanted, poses)
               for poses in body_scripts(question())]  # fmt: skip
    assert answers == [UNSAT, SAT, UNSAT]
    assert decide(published("2.23", "3.35"), question(), demands()) == SAT
    assert decide(published("3.35", "2.23"), question(), wanted) == SAT


def test_both_poses_share_the_parameters() -> None:
    """One link: every length in range reaches one of two places, none reaches both."""
    arm = planar_arm(1, "1/2", 3)
    asked = question((("0.9", "1.1"), ("-0.1", "0.1")), (("1.9", "2.1"), ("-0.1", "0.1")), PLANE)
    wanted = demands(rectangle((5, 6), (5, 6)))
    answers = [decide(arm, asked, wanted, poses) for poses in body_scripts(asked)]
    assert answers == [SAT, SAT, UNSAT]


def test_a_given_start_pose_is_not_asked_about() -> None:
    assert body_scripts(question(start=None)) == (("target",),)


# --- each part of a pose ------------------------------------------------------------------------

WALL = rectangle((1, 2), (-5, 5))
"""Between the base and x = 2; a link along x from the base to beyond it crosses it."""


def test_a_base_that_cannot_move_is_a_body_too() -> None:
    blocked = ArmBuilder().link(3).revolute().link(1).effector()
    assert decide(blocked, at(4, 0), demands(WALL)) == UNSAT
    assert decide(blocked, at(4, 0), demands(rectangle((1, 2), (1, 5)))) == SAT


def test_rods_of_other_branches_are_bodies_too() -> None:
    """The first branch reaches; the second one, fixed to it, is in the way."""
    arm = ArmBuilder().revolute()
    joint = arm.frame
    arm.link(1).effector()
    arm.frame = joint
    arm.turn(arm.degrees(90)).link(2)
    asked = at(1, 0)
    assert decide(arm, asked, demands(rectangle((-1, 1), (1, "3/2")))) == UNSAT
    assert decide(arm, asked, demands(rectangle((-1, 1), (-9, -1)))) == SAT


def test_points_and_centres_of_mass() -> None:
    arm = ArmBuilder().revolute().move(2)
    arm.effector()
    model = arm.model()
    mass = len(model.scalars) - 1
    point = replace(model, bodies=(PointBody(model.effectors[0], mass),))
    inside = rectangle(("1.5", "2.5"), ("-0.5", "0.5"))
    assert decide(point, at(2, 0), demands(inside)) == UNSAT
    assert decide(replace(model, bodies=()), at(2, 0), demands(inside)) == SAT
    arm.scalar("0.75")
    beside = arm.scalar("0.75")
    zero = arm.scalar(0)
    scalars = arm.model().scalars
    solid = SolidBody(model.effectors[0], mass, (beside, zero, zero), (mass,))
    swung = replace(model, scalars=scalars, bodies=(solid,))
    assert decide(swung, at(2, 0), demands(inside)) == SAT
    assert decide(swung, at(2, 0), demands(rectangle(("2.7", 3), ("-0.1", "0.1")))) == UNSAT


def test_rods_beside_and_behind_their_frame() -> None:
    """A rod against the axis from its frame, one across, and one that starts away from a joint."""
    arm = ArmBuilder().revolute().move(2).effector().model()

    def with_rod(frame: int, axis: int, sign: int) -> RobotModel:
        scalar = next(i for i, s in enumerate(arm.scalars) if getattr(s, "value", None) == 2)
        return replace(arm, bodies=(RodBody(frame, axis, sign, scalar, scalar, None),))

    tip, joint = arm.effectors[0], 1
    bar = rectangle(("0.9", "1.1"), ("-0.1", "0.1"))
    across = rectangle(("1.9", "2.1"), ("0.9", "1.1"))
    for frame, axis, sign, hit in (
        (tip, 0, -1, bar), (joint, 0, 1, bar), (tip, 1, 1, across),
        (tip, 0, 1, rectangle(("2.9", "3.1"), ("-0.1", "0.1"))),
        (tip, 1, -1, rectangle(("1.9", "2.1"), ("-1.1", "-0.9"))),
        (joint, 0, -1, rectangle(("-1.1", "-0.9"), ("-0.1", "0.1"))),
    ):  # fmt: skip
        model = with_rod(frame, axis, sign)
        others = [bar, across] if hit not in (bar, across) else [{0: across, 1: bar}[axis]]
        assert decide(model, at(2, 0), demands(hit)) == UNSAT
        assert decide(model, at(2, 0), demands(*others)) == SAT


def test_sliders_keep_their_limits() -> None:
    def gantry(limit: int) -> ArmBuilder:
        return ArmBuilder().prismatic(1, (0, limit)).link(1).prismatic(0, (0, 3)).effector()

    lintel = rectangle(("0.2", "0.8"), ("0.5", 9))
    assert decide(gantry(2), at(2, "1/4"), demands(lintel)) == SAT
    assert decide(gantry(2), at(2, 1), demands(lintel)) == UNSAT
    assert decide(gantry(2), at("9/2", "1/4"), demands(lintel)) == UNSAT


def test_effectors_bounds_and_bodies_within_them() -> None:
    """An elbow that has to leave the bounds, and an effector on the way out."""
    arm = ArmBuilder().revolute().link(2).revolute().link(2).effector()
    narrow = ((-1, 3), (-1, 1))
    assert decide(arm, at(1, 0, narrow), demands()) == SAT
    assert decide(arm, at(1, 0, narrow), demands(bounds_body=True)) == UNSAT
    assert decide(arm, at(1, 0), demands(bounds_body=True)) == SAT
    middle = ArmBuilder().revolute().link(2).effector().revolute().link(2).effector()
    asked = replace(at(1, 0, narrow), reach_effector=1)
    assert decide(middle, asked, demands()) == UNSAT
    above, below = rectangle((-9, 9), ("1/2", 9)), rectangle((-9, 9), (-9, "-1/2"))
    asked = replace(at(1, 0), reach_effector=1)
    assert decide(middle, asked, demands(effectors=[above])) == SAT
    assert decide(middle, asked, demands(effectors=[above, below])) == UNSAT


# --- relaxations: each adds solutions, none takes any away ---------------------------------------


def test_limits_of_revolute_joints_are_left_out() -> None:
    arm = ArmBuilder().revolute(limits=(-10, 10)).link(1).effector()
    assert decide(arm, at(-1, 0), demands(WALL)) == SAT


def test_touching_is_allowed() -> None:
    arm = ArmBuilder().revolute().link(2).effector()
    assert decide(arm, at(2, 0), demands(rectangle((1, "3/2"), (0, 1)))) == SAT
    assert decide(arm, at(2, 0), demands(rectangle((1, "3/2"), ("-0.001", 1)))) == UNSAT


def test_margins_and_radii_are_left_out() -> None:
    """A rod passes an obstacle at 0.1, with a margin of 0.2 and a radius of 0.3."""
    built = ArmBuilder().revolute().link(2).effector()
    thick = built.scalar("0.3")
    arm = built.model()
    (rod,) = arm.bodies
    assert isinstance(rod, RodBody)
    arm = replace(arm, bodies=(replace(rod, radius=thick),))
    near = box("O", "obstacle", (1, "3/2"), ("0.1", 1))
    workspace = ir.Workspace("W", 2, box("bounds", "bounds", *PLANE), (near,))
    asked = task(ir.Avoid(("O",), "body", Fraction(1, 5)))
    wanted = body_conditions(workspace, asked)
    assert wanted is not None
    assert decide(arm, at(2, 0), wanted) == SAT


def test_irrational_angles_are_enclosed() -> None:
    """A bend of 45 degrees: the tip is at sqrt(2) times (1, 1), and a box about it is reached."""
    arm = ArmBuilder()
    arm.turn(arm.degrees(45)).link(2).revolute().link(1).effector()
    tip = question(None, (("1.41", "1.42"), ("2.41", "2.42")), PLANE)
    assert decide(arm, tip, demands(rectangle((1, 2), (0, "0.9")))) == SAT
    assert decide(arm, tip, demands(rectangle((1, 2), (0, "1.1")))) == UNSAT


def test_a_turn_behind_a_joint_alone_is_absorbed() -> None:
    """But not where something else hangs on the joint."""
    arm = ArmBuilder().revolute()
    bend = arm.parameter(-1, 1, name="bend", unit="")
    arm.turn(bend).link(2).effector()
    script = body_script(arm.model(), at(0, 2), demands(WALL), TARGET)
    assert script is not None
    assert "theta" not in script.replace("theta1 () Real", "").partition("The target pose")[2]
    assert solve_script(script, resources=BUDGET) == SAT
    fork = ArmBuilder().revolute().effector()
    tilt = fork.apply("/", fork.degrees(180), 2)
    fork.turn(tilt).link(2).effector()
    first = replace(at(0, 2), reach_effector=1)
    assert decide(fork, first, demands(WALL)) == SAT


def test_in_space_the_body_is_left_out() -> None:
    near = box("O", "obstacle", (1, 2), (1, 2), (1, 2))
    workspace = ir.Workspace("W", 3, box("bounds", "bounds", *EVERYWHERE), (near,))
    asked = replace(task(ir.Avoid(("O",), "body", Fraction(0))), bounds_body=True)
    assert body_conditions(workspace, asked) is None


# --- demands ------------------------------------------------------------------------------------


def crowd(count: int) -> ir.Workspace:
    obstacles = tuple(
        box(f"O{i}", "obstacle", (i, i + Fraction(1, 2)), (0, 1)) for i in range(-count, count)
    )
    return ir.Workspace("W", 2, box("bounds", "bounds", *PLANE), obstacles)


def test_only_tasks_about_bodies_have_demands() -> None:
    workspace = crowd(1)
    effector = ir.Avoid(("O0",), "effector", Fraction(0))
    body = ir.Avoid(("O-1", "O0", "O-1"), "body", Fraction(0))
    assert body_conditions(workspace, task(effector)) is None
    both = body_conditions(workspace, task(effector, body))
    assert both is not None
    assert (len(both.bodies), len(both.effectors), both.bounds_body) == (2, 1, False)
    bounds = body_conditions(workspace, replace(task(), bounds_body=True))
    assert bounds == BodyConditions((), (), True)


def test_of_many_obstacles_those_near_the_middle_are_kept() -> None:
    names = tuple(f"O{i}" for i in range(-MOST, MOST))
    wanted = body_conditions(crowd(MOST), task(ir.Avoid(names, "body", Fraction(0))))
    assert wanted is not None
    places = sorted(min(x for x, _ in polygon.vertices) for polygon in wanted.bodies)
    assert places == list(range(-MOST // 2, MOST // 2))


# --- scripts ------------------------------------------------------------------------------------


def test_the_same_bytes_and_a_solver_of_its_own() -> None:
    texts = {
        body_script(published("2.23", "3.35"), question(), demands(OBSTACLE), ("start", "target"))
        for _ in range(2)
    }
    (text,) = texts
    assert text is not None
    assert text.startswith("; Is there a robot of this structure with a pose that brings")
    assert text.isascii()
    assert text.endswith("(check-sat)\n")
    assert max(map(len, (line for line in text.splitlines() if line[0] == ";"))) <= 100
    assert smt_solver("z3").run(text) == UNSAT


def test_effectors_that_are_alike_are_one_alternative() -> None:
    arm = ArmBuilder().revolute().link(2).effector().effector()
    script = body_script(arm.model(), at(2, 0), demands(WALL), TARGET)
    assert script is not None
    assert script.count("(or") == 1  # the obstacle


def test_no_candidate_no_script() -> None:
    arm = ArmBuilder().revolute().link(2).effector().model()
    assert body_script(arm, replace(at(2, 0), effectors=2), demands(WALL), TARGET) is None

"""What tasks with formulas ask of poses, decided by a solver for small robots."""

from __future__ import annotations

import pytest

from compiler.encodings.pose_questions import effector_choices, pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.normal_form import normalise
from compiler.robots.robot import RobotModel
from solvers.backends.smt import solve_script
from solvers.verdict import Fails
from tests.oracles.arms import ArmBuilder
from tests.oracles.formulas import TWO_ARMS, program, spec

REGIONS = """
region Near box [0.8, 1.2] x [-0.5, 0.5] m; region Mid box [2.4, 2.6] x [-0.5, 0.5] m;
region Far box [3.5, 4] x [-0.5, 0.5] m; target T box [-0.2, 0.2] x [0.9, 1.1] m;
"""


def two_effectors() -> RobotModel:
    """The first effector turns at radius 1, the second at 2.5 (they are one arm)."""
    arm = ArmBuilder().revolute().link(1).effector()
    return normalise(arm.link("3/2").effector().model())


def decided(clauses: str, model: RobotModel) -> list[bool]:
    """Per question whether the script is refuted."""
    found = program(spec(clauses, REGIONS, arms=TWO_ARMS))
    questions = pose_questions(found.workspaces["W"], found.tasks["P"])
    scripts = [refutation_script(model, question) for question in questions]
    return [isinstance(solve_script(script), Fails) for script in scripts]


@pytest.mark.parametrize(
    ("clauses", "refuted"),
    [
        ("start in Near; reach T;", [False]),
        ("start in Near by effector 2; reach T;", [True]),
        ("start in Mid; reach T; satisfy not T by effector 1 until T by effector 1;",
         [True, False]),  # the reaching effector starts: the second; but the first gets to T
        ("start in Near; satisfy eventually Mid by effector 2;", [False]),
        ("start in Near; satisfy eventually Mid by effector 1;", [True]),
        (("start in Mid by effector 2; satisfy eventually Near by effector 1 and last[0] "
         "Mid by effector 2;"), [False, False]),
        (("start in Near; reach T by effector 1; satisfy eventually Mid by effector 2 and "
         "eventually Far by effector 2;"), [False, True, False]),  # sorted by name
        ("start in Mid; reach T by effector 1; satisfy eventually Mid by effector 2;",
         [True, True]),  # it is the one that reaches that starts
        ("start in Near; satisfy eventually Mid by effector 1 or eventually Far by effector 1;",
         [False]),  # no visit is necessary; the start is asked about alone
        ("start in Far; satisfy always not Mid by effector 1;", [True]),
        ("start in Near; satisfy always not Mid by effector 3;", [True]),  # it has no third
        ("start in Near; reach T; satisfy not eventually Mid by effector 3;", [True]),
        ("start at (0); satisfy eventually Mid by effector 2;", [False]),
        ("start at (0); satisfy eventually Far by effector 2;", [True]),
        ("start at (0, 1); satisfy eventually Mid by effector 2;", [True]),  # one joint only
        ("start at (0); satisfy not Near by effector 1 until Near by effector 1;", [False]),
        ("start at (0); satisfy always not Mid by effector 1;", [False]),
    ],
)  # fmt: skip
def test_what_is_refuted(clauses: str, refuted: list[bool]) -> None:
    assert decided(clauses, two_effectors()) == refuted


def test_any_effector_starts_where_only_the_visitor_has_a_number() -> None:
    text = spec("start in Near; satisfy eventually T by effector 2;", REGIONS, arms=TWO_ARMS)
    found = program(text)
    (asked,) = pose_questions(found.workspaces["W"], found.tasks["P"])
    assert effector_choices(two_effectors(), asked) == [(0, 1), (1, 1)]


def test_a_script_says_what_it_is_about() -> None:
    text = (
        "start in Near by effector 1; reach T by effector 1; satisfy eventually Mid by effector 2;"
    )
    found = program(spec(text, REGIONS, arms=TWO_ARMS))
    questions = pose_questions(found.workspaces["W"], found.tasks["P"])
    first, second = (refutation_script(two_effectors(), question) for question in questions)
    assert "brings it into the target," in first
    assert "brings another one into Mid, which it has to visit," in second

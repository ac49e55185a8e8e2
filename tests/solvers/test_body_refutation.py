"""What becomes of structures whose whole body has to be clear: witnesses, scripts, and claims."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.body_smt import body_script
from compiler.encodings.pose_questions import body_conditions, pose_questions
from compiler.encodings.reachability_smt import refutation_script
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.words.structures import structures
from grammar_lang import ir
from solvers.impossibility import structure_refutation
from solvers.impossibility.pose_search import clear_poses
from solvers.impossibility.structure_refutation import Refutation, refute_structure
from solvers.run_context import RunContext
from solvers.verdict import Reason, Unknown
from solvers.verifier.claims.certificate import ImpossibleClaim
from solvers.verifier.claims.structure_claims import StructureClaim
from solvers.verifier.refutations.impossibility_check import Impossibility, check_impossible
from solvers.verifier.refutations.solver_process import smt_solver
from tests.oracles.formulas import program, spec

START, TARGET, BOTH = ("start",), ("target",), ("start", "target")
ARM = "eps J eps L eps J eps L eps E"
"""Two links of 0.5 m to 2 m."""

SHELF = "start in Near; reach T; avoid Shelf with body margin 0.01 m;"
REGIONS = """
region Near box [0.8, 1.2] x [-0.5, 0.5] m; target T box [-0.2, 0.2] x [2.0, 2.4] m;
obstacle Shelf polytope {{ -x + 10*y <= 18; x - 10*y <= -17; x <= {right}; -x <= 3; }} m;
"""
"""A tilted shelf below the target: to x = 3 no arm can get around it, to x = 0.5 it can."""


def task_of(right: float, clauses: str = SHELF) -> tuple[ir.Program, ir.Task]:
    text = spec(f"{clauses} modules <= 6;", REGIONS.format(right=right), arms=ARM)
    found = program(text)
    return found, found.tasks["P"]


def robot_of(found: ir.Program, task: ir.Task) -> RobotModel:
    (derivation,) = structures(family_of(found, task).language, 6)
    return family_of(found, task).robot(derivation)


def answer(right: float, clauses: str = SHELF) -> Refutation:
    found, task = task_of(right, clauses)
    numeric = NumericRobot(robot_graph(robot_of(found, task), task.gravity))
    return refute_structure(numeric.graph.model, numeric, found, task, RunContext(seed=0))


def sampled(right: float, clauses: str = SHELF) -> frozenset[tuple[str, ...]]:
    found, task = task_of(right, clauses)
    numeric = NumericRobot(robot_graph(robot_of(found, task), task.gravity))
    workspace = found.workspaces[task.workspace]
    (question,) = pose_questions(workspace, task)
    return frozenset(clear_poses(numeric, workspace, task, question, 0))


def test_a_shelf_that_no_link_gets_around() -> None:
    refuted = answer(3.9)
    assert refuted.refuted
    assert refuted.reason == "no pose in the target with the whole body clear, for any parameters"
    assert refuted.script is not None
    assert "the whole body clear of the obstacles" in refuted.script
    assert sampled(3.9) == {START}


def test_one_that_the_arm_gets_around_costs_no_solver_call() -> None:
    open_ = answer(0.5)
    assert (open_.refuted, open_.solver_calls) == (False, 0)
    assert sampled(0.5) == {START, TARGET, BOTH}


def test_the_effector_alone_gets_to_the_target() -> None:
    alone = answer(3.9, SHELF.replace("body", "effector"))
    assert (alone.refuted, alone.solver_calls) == (False, 0)


def test_a_limit_leaves_the_structure_open(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def nothing(script: str, *, resources: int) -> None:
        asked.append((script, resources))

    monkeypatch.setattr(structure_refutation, "solve_script", nothing)
    for name in ("box_refutation", "drive_refutation"):
        monkeypatch.setattr(structure_refutation, name, lambda *_robot: None)
    left = answer(3.9)
    assert (left.refuted, left.solver_calls, left.script) == (False, 2, None)
    assert asked[0][1] > asked[1][1] > 0  # both poses at once are harder to find


def test_a_covering_is_looked_for_before_scripts_of_the_body(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """No arm of 4 m reaches 4.1 m; nobody answers the question about the effector alone."""
    regions = f"{REGIONS.format(right=0.5)} target Far box [-0.2, 0.2] x [4.1, 4.3] m;"
    clauses = SHELF.replace("reach T", "reach Far")
    found = program(spec(f"{clauses} modules <= 6;", regions, arms=ARM))
    numeric = NumericRobot(robot_graph(robot_of(found, found.tasks["P"]), (Fraction(0),) * 2))
    silent = Unknown(Reason.RESOURCE_LIMIT, "")
    monkeypatch.setattr(structure_refutation, "solve_script", lambda *_, **__: silent)
    refuted = refute_structure(
        numeric.graph.model, numeric, found, found.tasks["P"], RunContext(seed=0)
    )
    assert (refuted.script, refuted.solver_calls) == (None, 1)
    assert refuted.boxes is not None


@pytest.mark.parametrize("kind", ["target", "both", "margin", "other"])
def test_every_script_of_the_body_is_evidence(tmp_path: Path, kind: str) -> None:
    """Scripts of other obstacles are not; what z3 does not refute is none either."""
    found, task = task_of(3.9)
    model, workspace = robot_of(found, task), found.workspaces[task.workspace]
    (question,) = pose_questions(workspace, task)
    demands = body_conditions(workspace, task)
    assert demands is not None
    if kind == "other":
        other, its = task_of(Fraction(7, 2))
        demands = body_conditions(other.workspaces[its.workspace], its)
        assert demands is not None
    script = {
        "target": body_script(model, question, demands, ("target",)),
        "both": body_script(model, question, demands, ("start", "target")),
        "other": body_script(model, question, demands, ("target",)),
        "margin": refutation_script(model, question),
    }[kind]
    assert script is not None
    (tmp_path / "0000.smt2").write_text(script, encoding="utf-8")
    (derivation,) = structures(family_of(found, task).language, 6)
    structure = StructureClaim(derivation.word, derivation.labels, "0000.smt2", None)
    claim = ImpossibleClaim("P", "a.srg", "", 6, (structure,))
    # Both poses with common lengths take z3 long: that script is only compared.
    trust = () if kind == "both" else (smt_solver("z3"),)
    shown = Impossibility(structures=1, by_boxes=0)
    expected = {
        "target": shown, "both": shown,
        "other": "0000.smt2 is not the script of structure 0",
        "margin": "z3 does not refute structure 0: its script has a model",
    }[kind]  # fmt: skip
    assert check_impossible(tmp_path, claim, found, task, trust) == expected

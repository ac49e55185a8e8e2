"""What becomes of the structures of tasks with formulas: poses, refutations, and the effector."""

from __future__ import annotations

from pathlib import Path

import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.words.structures import structures
from grammar_lang import ir
from solvers.impossibility import structure_refutation
from solvers.impossibility.structure_refutation import Refutation, refute_structure
from solvers.run_context import RunContext
from solvers.verifier.claims.certificate import ImpossibleClaim
from solvers.verifier.claims.structure_claims import StructureClaim
from solvers.verifier.refutations.impossibility_check import Impossibility, check_impossible
from solvers.verifier.refutations.solver_process import smt_solver
from tests.oracles.formulas import program, spec

REGIONS = """
region Near box [0.8, 1.2] x [-0.5, 0.5] m; region Mid box [2.4, 2.6] x [-0.5, 0.5] m;
region Far box [3.5, 4] x [-0.5, 0.5] m; target T box [-0.2, 0.2] x [0.9, 1.1] m;
"""
ARMS = "eps J eps L eps E eps J eps L eps E"
"""The first effector at radius 0.5 to 2, the second from the base to radius 4."""


def task_of(clauses: str) -> tuple[ir.Program, ir.Task]:
    found = program(spec(f"{clauses} modules <= 7;", REGIONS, arms=ARMS))
    return found, found.tasks["P"]


def answer(clauses: str) -> Refutation:
    found, task = task_of(clauses)
    (derivation,) = structures(family_of(found, task).language, 7)
    model = family_of(found, task).robot(derivation)
    numeric = NumericRobot(robot_graph(model, task.gravity))
    return refute_structure(model, numeric, found, task, RunContext(seed=0))


@pytest.mark.parametrize(
    ("clauses", "effector"),
    [
        ("start in Near; satisfy eventually T by effector 2;", 0),  # the first that can
        ("start in Mid; satisfy eventually T by effector 1;", 1),
        ("start in Near by effector 2; satisfy always not Far by effector 1;", 1),
        ("start in Mid by effector 2; reach T; satisfy eventually Far by effector 2;", 0),
        (
            "start in Mid; satisfy eventually Mid by effector 2 and eventually Near by effector 1;",
            1,
        ),
    ],
)
def test_the_effector_of_the_poses(clauses: str, effector: int) -> None:
    found = answer(clauses)
    assert (found.refuted, found.solver_calls) == (False, 0)
    assert found.effector == effector


@pytest.mark.parametrize(
    ("clauses", "reason", "calls"),
    [
        ("start in Far by effector 1; reach T;", "in the target", 1),
        ("start in Near; reach T; satisfy eventually Mid by effector 1;", "in Mid, which", 1),
        ("start in Near; satisfy eventually Near by effector 1 and eventually Far by effector 1;",
         "in Far, which", 1),
        ("start at (0, 0); satisfy eventually Far by effector 1;", "no pose in Far", 1),
        ("start in Near; reach T; satisfy always not Far by effector 3;", "in the target", 1),
    ],
)  # fmt: skip
def test_one_question_suffices(clauses: str, reason: str, calls: int) -> None:
    found = answer(clauses)
    assert found.refuted
    assert (reason in found.reason, found.solver_calls) == (True, calls)


def test_what_the_solver_leaves_open(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(structure_refutation, "solve_script", lambda _script, **_budget: None)
    clauses = "start in Near; reach T; satisfy eventually Mid by effector 1;"
    covered = answer(clauses)
    assert (covered.refuted, covered.solver_calls, covered.script) == (True, 1, None)
    assert covered.boxes is not None
    for name in ("box_refutation", "drive_refutation"):
        monkeypatch.setattr(structure_refutation, name, lambda *_robot: None)
    left = answer(clauses)
    assert (left.refuted, left.solver_calls, left.effector) == (False, 1, 0)


@pytest.mark.parametrize("other", [False, True])
def test_the_script_of_any_question_is_evidence(tmp_path: Path, other: bool) -> None:
    clauses = "start in Near; reach T; satisfy eventually Mid by effector 1;"
    found, task = task_of(clauses)
    (derivation,) = structures(family_of(found, task).language, 7)
    script = answer(clauses.replace("Mid", "Far") if other else clauses).script
    assert script is not None
    (tmp_path / "0000.smt2").write_text(script, encoding="utf-8")
    structure = StructureClaim(derivation.word, derivation.labels, "0000.smt2", None)
    claim = ImpossibleClaim("P", "a.srg", "", 7, (structure,))
    answered = check_impossible(tmp_path, claim, found, task, (smt_solver("z3"),))
    if other:
        assert answered == "0000.smt2 is not the script of structure 0"
    else:
        assert answered == Impossibility(structures=1, by_boxes=0)

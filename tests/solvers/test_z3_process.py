import os
import subprocess
import sys

import numpy as np
import pytest

from compiler.encodings.reachability_smt import refutation_script
from solvers.backends.smt import solve_script
from solvers.verdict import Fails, Holds, Reason, Unknown
from solvers.verifier.refutations import solver_process as z3_process
from solvers.verifier.refutations.solver_process import run_z3_subprocess, z3_command
from tests.oracles.arms import planar_arm
from tests.oracles.questions import question, random_robot

SCRIPT = "(set-logic QF_NRA)\n(declare-fun x () Real)\n(assert (= (* x x) {}))\n(check-sat)\n"


def says(text):
    return [sys.executable, "-c", f"import sys; sys.stdin.read(); {text}"]


def test_the_answers_of_the_process():
    assert run_z3_subprocess(SCRIPT.format("2.0")) == Holds(None)
    assert run_z3_subprocess(SCRIPT.format("(- 2.0)")) == Fails(None)


def test_without_the_executable_the_package_answers(monkeypatch, tmp_path):
    monkeypatch.setattr(z3_process.sysconfig, "get_path", lambda _: str(tmp_path))
    monkeypatch.setattr(z3_process.Path, "is_file", lambda _: False)
    assert z3_command()[0] == sys.executable
    assert run_z3_subprocess(SCRIPT.format("2.0")) == Holds(None)
    assert run_z3_subprocess(SCRIPT.format("(- 2.0)")) == Fails(None)


@pytest.mark.parametrize(
    "text",
    [
        "print('(error \"line 1\")'); print('unsat')",  # z3 goes on after an error
        "print('unsat'); print('unsat')",
        "print('unsat'); sys.exit(1)",
        "print('unsatisfiable')",
        "pass",
    ],
)
def test_anything_but_one_word_is_no_answer(text):
    answer = run_z3_subprocess(SCRIPT.format("2.0"), command=says(text))
    assert isinstance(answer, Unknown)
    assert answer.reason is Reason.INCOMPLETE


def test_unknown_and_absent():
    answer = run_z3_subprocess("", command=says("print('unknown')"))
    assert isinstance(answer, Unknown)
    assert answer.reason is Reason.RESOURCE_LIMIT
    assert isinstance(run_z3_subprocess("", command=["/no/such/z3"]), Unknown)
    assert isinstance(run_z3_subprocess("(assert"), Unknown)


def test_a_budget_is_positive():
    with pytest.raises(ValueError, match="budget"):
        run_z3_subprocess("", resources=0)


@pytest.mark.parametrize("links", [1, 2, 3])
def test_both_ways_agree_on_arms(links):
    script = refutation_script(planar_arm(links), question())
    assert run_z3_subprocess(script) == solve_script(script)


@pytest.mark.parametrize("seed", range(8))
def test_both_ways_agree_on_random_robots(seed):
    model = random_robot(np.random.default_rng(seed), 2)
    script = refutation_script(model, question())
    here = solve_script(script, resources=30_000)
    if not isinstance(here, Unknown):
        assert run_z3_subprocess(script) == here


def test_the_verifier_loads_no_solver():
    # Neither writing a script nor handing it to z3 loads z3 here.
    program = """
import sys
from compiler.encodings.reachability_smt import refutation_script
from solvers.verifier.refutations.solver_process import run_z3_subprocess
from compiler.encodings.pose_questions import PoseQuestion
from tests.oracles.arms import planar_arm
from tests.oracles.planes import box_rows
boxes = [box_rows((i, i + 1), (i, i + 1)).rows for i in (1, 3)]
question = PoseQuestion(*boxes, box_rows((0, 5), (0, 5)).rows)
print(run_z3_subprocess(refutation_script(planar_arm(1), question)))
sys.exit("z3" in sys.modules)
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == str(Fails(None))

"""SMT solvers in processes of their own: their answers, and everything that is none."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from compiler.encodings.reachability_smt import refutation_script
from compiler.time_limits.time_limit import OutOfTimeError, time_limit
from solvers.backends.smt import solve_script
from solvers.verdict import Fails, Holds, Reason, Unknown
from solvers.verifier.refutations import solver_process
from solvers.verifier.refutations.solver_process import (
    DisagreementError,
    SmtSolver,
    UnknownSolverError,
    agreed,
    named_solvers,
    smt_solver,
    smt_solvers,
    z3_command,
)
from tests.oracles.arms import planar_arm
from tests.oracles.questions import question, random_robot

SCRIPT = "(set-logic QF_NRA)\n(declare-fun x () Real)\n(assert (= (* x x) {}))\n(check-sat)\n"
SAT, UNSAT = SCRIPT.format("2.0"), SCRIPT.format("(- 2.0)")
HERE = ["z3", "cvc5"]


def says(text: str, name: str = "stub") -> SmtSolver:
    return SmtSolver(name, (sys.executable, "-c", f"import sys; sys.stdin.read(); {text}"))


@pytest.mark.parametrize("name", HERE)
def test_the_answers_of_the_process(name: str) -> None:
    solver = smt_solver(name)
    assert solver.run(SAT) == Holds(None)
    assert solver.run(UNSAT) == Fails(None)
    broken = solver.run("(assert")
    assert isinstance(broken, Unknown)
    assert broken.detail.startswith(f"{name} ended with status ")


def test_without_the_executable_the_package_answers(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(solver_process.sysconfig, "get_path", lambda _: str(tmp_path))
    monkeypatch.setattr(solver_process.Path, "is_file", lambda _: False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert z3_command()[0] == sys.executable
    solver = smt_solver("z3")
    assert (solver.run(SAT), solver.run(UNSAT)) == (Holds(None), Fails(None))


@pytest.mark.parametrize(
    "text",
    [
        "print('(error \"line 1\")'); print('unsat')",  # z3 goes on after an error
        "print('unsat'); print('unsat')",
        "print('unsat'); sys.exit(1)",
        "print('unsatisfiable')",
        "pass",
        "sys.stdout.buffer.write(b'unsat\\xff')",
        "import os; os.abort()",
    ],
)
def test_anything_but_one_word_is_no_answer(text: str) -> None:
    answer = says(text).run(SAT)
    assert isinstance(answer, Unknown)
    assert answer.reason is Reason.INCOMPLETE
    assert "stub" in answer.detail


def test_unknown_and_absent() -> None:
    answer = says("print('unknown')").run(SAT)
    assert answer == Unknown(Reason.RESOURCE_LIMIT, "stub answers unknown")
    absent = SmtSolver("gone", ("/no/such/solver",)).run(SAT)
    assert isinstance(absent, Unknown)
    assert absent.detail == "gone does not start: No such file or directory"


def test_a_solver_that_hangs_is_ended() -> None:
    answer = says("import time; time.sleep(60)").run(SAT, seconds=0.5)
    assert answer == Unknown(Reason.TIME_LIMIT, "stub did not answer within 0.5 s")


def test_a_solver_that_reads_nothing_answers_all_the_same() -> None:
    solver = SmtSolver("hasty", (sys.executable, "-c", "print('unsat')"))
    assert solver.run(SAT * 20_000) == Fails(None)


def test_a_wrapper_may_end_before_the_solver_that_it_started() -> None:
    late = "import time; time.sleep(1); print('unsat')"
    answer = says(f"import subprocess; subprocess.Popen([sys.executable, '-c', {late!r}])").run(SAT)
    assert answer == Fails(None)


def test_a_limit_of_time_ends_it() -> None:
    with time_limit(lambda: True), pytest.raises(OutOfTimeError):
        says("import time; time.sleep(60)").run(SAT)


def test_several_have_to_agree() -> None:
    yes, no, mute = says("print('sat')", "y"), says("print('unsat')", "n"), says("pass", "m")
    assert agreed(SAT, "a script", [yes, yes]) == Holds(None)
    assert agreed(SAT, "a script", [no, no]) == Fails(None)
    for some in ([no, mute], [mute, no], [yes, mute]):
        assert isinstance(agreed(SAT, "a script", some), Unknown)
    with pytest.raises(DisagreementError) as raised:
        agreed(SAT, "a script", [yes, mute, no])
    assert str(raised.value) == "the solvers disagree about a script: y says sat, n says unsat"
    assert raised.value.script == SAT
    assert str(pickle.loads(pickle.dumps(raised.value))) == str(raised.value)


def test_the_solvers_that_are_here() -> None:
    assert [solver.name for solver in smt_solvers()][:2] == sorted(HERE)
    assert [solver.name for solver in named_solvers("z3, cvc5,z3")] == HERE
    assert named_solvers(None) == ()
    with pytest.raises(UnknownSolverError, match=r"no SMT solver `nix`; here are `cvc5`, `z3`"):
        smt_solver("nix")
    with pytest.raises(UnknownSolverError, match=r"there is no command `\./nix`"):
        smt_solver("./nix")


def test_a_command_by_its_path(tmp_path: Path) -> None:
    command = tmp_path / "mine"
    command.write_text(f"#!{sys.executable}\nimport sys\nsys.stdin.read()\nprint('unsat')\n")
    command.chmod(0o755)
    solver = smt_solver(str(command))
    assert (solver.name, solver.run(SAT)) == (str(command), Fails(None))


def test_a_flood_is_no_answer() -> None:
    answer = says("[print('unsat' * 1000) for _ in iter(int, 1)]").run(SAT)
    assert isinstance(answer, Unknown)
    assert answer.reason is Reason.INCOMPLETE
    assert len(answer.detail) < 300


def test_what_a_command_starts_ends_with_it(tmp_path: Path) -> None:
    """A wrapper waits for a solver that goes on for ever, and tells its number first."""
    told = tmp_path / "child"
    wrapper = (
        "import subprocess; child = subprocess.Popen([sys.executable, '-c', "
        f"'import time; time.sleep(600)']); open({str(told)!r}, 'w').write(str(child.pid)); "
        "child.wait()"
    )
    answer = says(wrapper).run(SAT, seconds=2.0)
    assert isinstance(answer, Unknown)
    assert answer.reason is Reason.TIME_LIMIT
    status = Path(f"/proc/{told.read_text()}/stat")
    for _ in range(50):
        if not status.exists() or status.read_text().split()[2] == "Z":
            return
        time.sleep(0.1)
    pytest.fail("it lives on")


def test_a_solver_that_pysmt_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """z3 as if its command were not known, by way of pySMT."""
    monkeypatch.delitem(solver_process.COMMANDS, "z3")
    solver = smt_solver("z3")
    assert "pysmt" in solver.command[3]
    assert (solver.run(SAT), solver.run(UNSAT)) == (Holds(None), Fails(None))


@pytest.mark.parametrize("name", HERE)
@pytest.mark.parametrize("links", [1, 2, 3])
def test_all_ways_agree_on_arms(name: str, links: int) -> None:
    script = refutation_script(planar_arm(links), question())
    assert smt_solver(name).run(script) == solve_script(script)


@pytest.mark.parametrize("seed", range(8))
def test_both_ways_agree_on_random_robots(seed: int) -> None:
    model = random_robot(np.random.default_rng(seed), 2)
    script = refutation_script(model, question())
    here = solve_script(script, resources=30_000)
    if not isinstance(here, Unknown):
        assert smt_solver("z3").run(script) == here


def test_the_verifier_loads_no_solver() -> None:
    # Neither writing a script nor handing it to a solver loads one here.
    program = """
import sys
from compiler.encodings.reachability_smt import refutation_script
from solvers.verifier.refutations.solver_process import smt_solver
from compiler.encodings.pose_questions import PoseQuestion
from tests.oracles.arms import planar_arm
from tests.oracles.planes import box_rows
boxes = [box_rows((i, i + 1), (i, i + 1)).rows for i in (1, 3)]
question = PoseQuestion(*boxes, box_rows((0, 5), (0, 5)).rows)
script = refutation_script(planar_arm(1), question)
print(smt_solver("z3").run(script), smt_solver("cvc5").run(script))
sys.exit(bool({"z3", "cvc5", "pysmt"} & {*sys.modules}))
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", program]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == f"{Fails(None)} {Fails(None)}"

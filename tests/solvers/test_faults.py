"""Whatever solvers do, nothing false is said: no ``found`` or ``impossible`` rests on them."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import z3
from pysat.solvers import Cadical195

import solvers.verifier.refutations.solver_process
from grammar_lang.load import load
from solvers.backends.conic import Status
from solvers.execution.process_pool import ProcessPool
from solvers.execution.workers import WorkersLostError
from solvers.impossibility import box_evidence, structure_refutation
from solvers.run_context import RunContext
from solvers.search.synthesis import OUT_OF_TIME, synthesise
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from srgc.results.result_folder import ResultFolder
from tests.oracles.faulty_solvers import CLAIMS, GARBAGE, PLAUSIBLE, RAISED, claims, inject
from tests.oracles.result_files import without_boxes
from tests.oracles.small_specs import SLIDER, TURNER, replaced
from tests.oracles.some_cases import some

pytestmark = pytest.mark.usefixtures("without_pictures")


ROOT = Path(__file__).parents[2]
STATUS = {"found": 0, "impossible": 3, "unknown": 4}
CROSS = "module Q  { role joint; dof q: prismatic y in [-1, 1] m; }"
GANTRY = SLIDER
for old, new in (
    ("edge eps;", f"{CROSS}\nedge eps;"),
    ("load:  N", "cross: N -> N eps Q;\n  load:  N"),
    ("P eps M", "P eps Q eps M"),
    ("load  {", "cross { this.frame = N.frame * move(y, Q.q); }\n  load  {"),
    ("  target T", "  obstacle O box [1.1, 1.4] x [-0.4, 0.3] m;\n  target T"),
    ("effort <= 10 N;", "avoid O with effector;\n  effort <= 2 N;"),
):
    GANTRY = replaced(GANTRY, old, new)
"""Two weak slides and a detour: no first guess of a motion is one already."""
TOGETHER = replaced(GANTRY, "effort <= 2 N;", "effort <= 2 N norm 2;")
"""The same with a second-order cone."""
BESIDE = replaced(
    SLIDER, "target T box [2, 2.5] x [-0.2, 0.2] m;", "target T box [2, 2.5] x [0.5, 0.8] m;"
)
"""A target beside the rail."""
FALSE_CLAIMS = ("INFEASIBLE", "UNBOUNDED")


@pytest.fixture(autouse=True)
def _journals_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ResultFolder, "finish", lambda _self: None)


def verdict(folder: Path, text: str) -> tuple[str, str]:
    """The verdict and reason of a synthesis, once nothing in its folder is false or no number."""
    (folder / "spec.srg").write_text(text, encoding="utf-8")
    out = folder / "out"
    status = run(["synth", str(folder / "spec.srg"), "-o", str(out), "--json"])
    content = json.loads((out / "design.json").read_text(encoding="utf-8"))
    assert STATUS[content["verdict"]] == status
    for path in out.rglob("*"):
        if path.suffix in (".json", ".jsonl", ".csv"):
            all_numbers(path)
    if content["verdict"] == "found":
        assert verify_directory(out).outcome is Outcome.VALID
    else:
        assert not (out / "trajectory.csv").exists()
    return content["verdict"], content["reason"] or ""


def all_numbers(path: Path) -> None:
    """No NaN and no infinity is in a file, arrays of a journal included."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".csv":
        assert not {"nan", "inf", "-inf"} & set(text.lower().replace("\n", ",").split(","))
        return
    for line in [text] if path.suffix == ".json" else text.splitlines():
        finite(json.loads(line, parse_constant=lambda name: pytest.fail(f"{name} in {path}")))


def finite(value: object) -> None:
    match value:
        case {"float64": str(text)}:
            assert np.isfinite(np.frombuffer(b64decode(text), dtype="<f8")).all()
        case dict():
            for item in value.values():
                finite(item)
        case list():
            for item in value:
                finite(item)
        case float():
            assert math.isfinite(value)


# --- convex solvers ------------------------------------------------------------------------------


def test_without_a_fault_the_specs_are_found(tmp_path: Path) -> None:
    for number, text in enumerate((GANTRY, TOGETHER)):
        (tmp_path / str(number)).mkdir()
        assert verdict(tmp_path / str(number), text)[0] == "found"


@pytest.mark.parametrize("fault", some(sorted(GARBAGE), 5))
def test_garbage_is_believed_by_nobody(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = inject(monkeypatch, GARBAGE[fault])
    text = TOGETHER if fault in ("NaN", "off the equations") else GANTRY
    answer, reason = verdict(tmp_path, text)
    assert answer == "unknown"
    named = "solver failed" if fault.startswith("no a") else Status.NOT_CREDIBLE.value
    assert f"convex step: {named}" in reason
    assert calls[0] > 2


@pytest.mark.parametrize(
    "fault", some(sorted(CLAIMS, key=lambda name: (name not in FALSE_CLAIMS, name)), 4)
)
def test_a_program_that_is_not_solved_is_unknown_by_name(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """False claims of infeasible and unbounded programs among them."""
    inject(monkeypatch, CLAIMS[fault])
    answer, reason = verdict(tmp_path, GANTRY)
    assert answer == "unknown"
    assert f"convex step: {Status[fault].value}" in reason


@pytest.mark.parametrize("fault", some(sorted(RAISED), 3))
def test_whatever_a_solver_raises_is_a_failure(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inject(monkeypatch, RAISED[fault])
    answer, reason = verdict(tmp_path, GANTRY)
    assert answer == "unknown"
    assert "convex step: solver failed (" in reason
    assert "\n" not in reason


@pytest.mark.parametrize("fault", sorted(PLAUSIBLE))
@pytest.mark.parametrize(
    "text",
    [
        pytest.param(GANTRY, id="slider"),
        pytest.param(TURNER, id="turner", marks=pytest.mark.slow),
    ],
)
def test_what_is_plausible_and_wrong_is_found_only_if_it_is_valid(
    fault: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inject(monkeypatch, PLAUSIBLE[fault])
    assert verdict(tmp_path, text)[0] in ("found", "unknown")


@pytest.mark.parametrize("fault", some(["NaN", "off the equations"], 1))
def test_some_failures_do_not_matter(
    fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another solver is asked, or the same one once more."""
    inject(monkeypatch, GARBAGE[fault], every=3)
    assert verdict(tmp_path, TURNER)[0] == "found"


def test_what_is_impossible_does_not_depend_on_convex_solvers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inject(monkeypatch, claims(Status.NUMERICS))
    assert verdict(tmp_path, BESIDE)[0] == "impossible"


def test_a_solver_that_takes_all_the_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "spec.srg").write_text(GANTRY, encoding="utf-8")
    program = load(tmp_path / "spec.srg").program
    assert program is not None
    calls = inject(monkeypatch, claims(Status.TIME_LIMIT))
    context = RunContext(out_of_time=lambda: calls[0] > 0)
    result = synthesise(program, program.tasks["Slide"], context)
    assert result.verdict == "unknown"
    # A way along the slide is being proved before any solver is asked.
    assert result.reason is not None
    assert result.reason.startswith(f"{OUT_OF_TIME} while a motion of B eps P eps Q eps M eps EN")
    assert result.unfinished


# --- solvers that die ----------------------------------------------------------------------------

DEADLY = """
import os, signal
from solvers.backends.clarabel import Clarabel
from solvers.backends.piqp import ProximalInteriorPoint
def solve(*_arguments):
    os.kill(os.getpid(), signal.SIGKILL)
ProximalInteriorPoint.solve = Clarabel.solve = solve
"""


class EagerPool(ProcessPool):
    """Does no job in this process."""

    def _is_ready(self, function: Callable[..., object]) -> bool:
        self._running(function)
        for ready in self._ready:
            ready.result()
        return True


def test_workers_that_die_are_no_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = "".join(f"    {line}\n" for line in DEADLY.strip().splitlines())
    lines = f"import sys\nif '--multiprocessing-fork' in sys.orig_argv:\n{lines}"
    (tmp_path / "sitecustomize.py").write_text(lines, encoding="utf-8")
    (tmp_path / "spec.srg").write_text(TURNER, encoding="utf-8")
    program = load(tmp_path / "spec.srg").program
    assert program is not None
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), str(ROOT)]))
    pool = EagerPool(1)
    try:
        with pytest.raises(WorkersLostError):
            synthesise(program, program.tasks["Turn"], RunContext(workers=pool))
    finally:
        pool.close()


def test_a_process_that_dies_says_nothing_and_another_one_goes_on(tmp_path: Path) -> None:
    (tmp_path / "spec.srg").write_text(SLIDER, encoding="utf-8")
    main = "from srgc.cli import main; main()"
    for program, status in ((DEADLY + main, -signal.SIGKILL), (main, 0)):
        ended = subprocess.run(
            [sys.executable, "-c", program, "synth", "spec.srg", "-o", "out"],
            cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True,
            check=False,
        )  # fmt: skip
        assert ended.returncode == status
        for name in ("design.json", "certificate.json"):
            assert (tmp_path / "out" / name).exists() == (status == 0)
    assert verify_directory(tmp_path / "out").outcome is Outcome.VALID


# --- the SMT solver ------------------------------------------------------------------------------


def z3_fault(name: str):
    def check(_self, *_assumptions):
        if name == "raises":
            raise z3.Z3Exception("canceled")
        if name == "has no memory":
            raise MemoryError
        return {"unknown": z3.unknown, "garbage": "unsat", "nothing": None}[name]

    return check


@pytest.mark.parametrize(
    "name", some(["raises", "unknown", "garbage", "has no memory", "nothing"], 3)
)
@pytest.mark.parametrize("text", [BESIDE, SLIDER], ids=["impossible", "possible"])
def test_z3_that_fails_refutes_nothing(
    name: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(z3.Solver, "check", z3_fault(name))
    for room in (structure_refutation, box_evidence):
        for search in ("box_refutation", "drive_refutation"):
            monkeypatch.setattr(room, search, lambda *_: None)
    assert verdict(tmp_path, text)[0] == ("unknown" if text == BESIDE else "found")


@pytest.mark.parametrize("name", ["raises", "unknown"])
def test_boxes_need_no_z3(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(z3.Solver, "check", z3_fault(name))
    assert verdict(tmp_path, BESIDE)[0] == "impossible"
    assert verify_directory(tmp_path / "out").level == "validated"


@pytest.mark.parametrize(
    "process",
    [
        "os.kill(os.getpid(), signal.SIGKILL)",
        "print('unsa', end='')",
        "print('unsat core')",
        "print('unknown')",
        "print('\\x00unsat')",
        "sys.stdout.buffer.write(b'unsat\\xff')",
        "print('sat')",
        "sys.exit(3)",
        "print('(error \"out of memory\")')",
        "print('unsat', flush=True); os.kill(os.getpid(), signal.SIGKILL)",
    ],
)
def test_a_z3_process_that_fails_verifies_nothing(process: str, result, monkeypatch) -> None:
    command = (sys.executable, "-c", f"import os, signal, sys; sys.stdin.read(); {process}")
    commands = solvers.verifier.refutations.solver_process.COMMANDS
    monkeypatch.setitem(commands, "z3", lambda: command)
    folder = result("beyond_reach")
    without_boxes(folder)
    assert verify_directory(folder, None, "z3").outcome is not Outcome.VALID


# --- the SAT solver ------------------------------------------------------------------------------


def raising(*_arguments, **_named):
    raise RuntimeError("assertion failed")


SAT_FAULTS = {
    "raises": {"solve_limited": raising},
    "out of conflicts": {"solve_limited": lambda _self, **_named: None},
    "false unsat": {"solve_limited": lambda *_a, **_k: False, "get_core": lambda _self: []},
    "foreign core": {"solve_limited": lambda *_a, **_k: False, "get_core": lambda _self: [7, -9]},
    "no core": {"solve_limited": lambda *_a, **_k: False, "get_core": lambda _self: None},
    "no model": {"get_model": lambda _self: None},
    "empty model": {"get_model": lambda _self: []},
    "all true": {"get_model": lambda _self: list(range(1, 5000))},
    "text": {"get_model": lambda _self: ["v", "1"]},
    "random": {
        "get_model": lambda _self: (
            np.arange(1, 5000) * np.random.default_rng(1).choice([-1, 1], 4999)
        ).tolist()
    },
}


@pytest.mark.parametrize("name", some(SAT_FAULTS, 6))
def test_a_sat_solver_that_fails_plans_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for method, fault in SAT_FAULTS[name].items():
        monkeypatch.setattr(Cadical195, method, fault)
    answer, reason = verdict(tmp_path, SLIDER)
    assert answer == "unknown"
    assert "planning: " in reason
    told = {"out of conflicts": "conflict limit", "false unsat": "", "no core": ""}
    assert told.get(name, "solver failed") in reason

"""Solvers of the benchmark set: commands that are given a task, and what is made of their answers.

A solver is a table of ``benchmarks/tasks/solvers.toml``, or of a file of the same form.  It says
what it found in ``answer.json``; a folder of results in the form of srgc, where it writes one, is
checked by `srgc verify`, and only then counts as proved.
"""

from __future__ import annotations

import json
import os
import resource
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from timing import ROOT

VERDICTS = ("found", "impossible", "unknown")
OF_STATUS = {0: "found", 3: "impossible", 4: "unknown"}
"""The verdicts of `srgc synth` by its exit status."""
GRACE = 10
"""Seconds of processor time after its limit in which a solver may end by itself."""
VERIFY_SECONDS = 600
CHECKED = ("checked", "checked by z3")
NOT_CHECKED = 4
"""The exit status of `srgc verify` where no solver has run on the scripts that are the evidence."""
ANSWER, RESULT = "answer.json", "result"


@dataclass(frozen=True)
class Solver:
    """A command with `{python}`, `{root}`, `{spec}`, `{out}` and `{limit}` to be filled in.

    ``is_srgc``: its exit status is the verdict, and it writes `{out}/result`.
    """

    name: str
    says: str
    command: str
    is_srgc: bool

    def filled(self, spec: Path, out: Path, limit: int) -> list[str]:
        """The command for a task."""
        places = {
            "python": sys.executable, "root": str(ROOT), "spec": str(spec), "out": str(out),
            "limit": str(limit),
        }  # fmt: skip
        return [word.format(**places) for word in shlex.split(self.command)]


@dataclass(frozen=True)
class Task:
    """A task of the set: what is known of it, and why; ``size`` where its family grows."""

    name: str
    family: str
    known: str
    why: str
    size: int | None

    @property
    def path(self) -> Path:
        """Its file."""
        return TASKS / f"{self.name}.srg"


TASKS = Path(__file__).with_name("tasks")


def solvers(file: Path) -> dict[str, Solver]:
    """The solvers of a file, by name; SystemExit where it is not of the form."""
    found = {}
    for name, table in _tables(file).items():
        if not {"says", "command", "answer"} >= set(table) >= {"says", "command"}:
            raise SystemExit(f"{file}: `{name}` needs `says` and `command`, and may have `answer`")
        kind = table.get("answer", "json")
        if kind not in ("json", "srgc"):
            raise SystemExit(f'{file}: `answer` of `{name}` is "json" or "srgc", not "{kind}"')
        found[name] = Solver(name, table["says"], table["command"], kind == "srgc")
    return found


def tasks() -> dict[str, Task]:
    """All tasks of the set, by name, in the order of their list."""
    return {
        name: Task(name, table["family"], table["known"], table.get("why", ""), table.get("size"))
        for name, table in _tables(TASKS / "tasks.toml").items()
    }


def _tables(file: Path) -> Mapping[str, Any]:
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SystemExit(f"{file}: {error}") from None


def run(solver: Solver, task: Task, folder: Path, limit: int) -> dict[str, Any]:
    """What a solver makes of a task, in so many seconds of processor time.

    Returns: ``verdict``; ``cpu_seconds``; ``evidence``, which is one of :data:`CHECKED` after `srgc
    verify`, "refused" where that says no, "not checked" where it cannot say, else what the solver
    says or "claimed"; ``verify_cpu_seconds``; ``value`` and ``bound`` of the objective; ``size`` of
    the evidence, as certificates count it.
    """
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    command = solver.filled(task.path, folder, limit)
    status, seconds = _limited(command, limit + GRACE, folder / "log")
    answer = _answer(solver, folder, status)
    told = {"verdict": answer.pop("verdict"), "cpu_seconds": round(seconds, 1)} | answer
    result = folder / RESULT
    if told["verdict"] in ("found", "impossible"):
        told.setdefault("evidence", "claimed")
        if (result / "certificate.json").exists():
            told |= _verified(result, folder)
            told |= _said_of_result(result)
    return told


def _verified(result: Path, folder: Path) -> dict[str, Any]:
    """What `srgc verify` says; where scripts of a solver are the evidence, z3 is run on them."""
    verify, log = [sys.executable, "-m", "srgc", "verify", str(result)], folder / "verify.log"
    said, (status, spent) = CHECKED[0], _limited(verify, VERIFY_SECONDS, log)
    if status == NOT_CHECKED:
        status, more = _limited([*verify, "--trust", "z3"], VERIFY_SECONDS, log)
        said, spent = CHECKED[1], spent + more
    told = {0: said, NOT_CHECKED: "not checked"}.get(status, "refused")
    return {"evidence": told, "verify_cpu_seconds": round(spent, 1)}


def _limited(command: list[str], seconds: int, log: Path) -> tuple[int, float]:
    """Exit status (negative: by a signal) and processor seconds, of its own children too."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    with log.open("w", encoding="utf-8") as out:
        child = subprocess.Popen(
            command, cwd=ROOT, stdout=out, stderr=subprocess.STDOUT, env=environment
        )
        resource.prlimit(child.pid, resource.RLIMIT_CPU, (seconds, seconds + 5))
        _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, usage.ru_utime + usage.ru_stime


def _answer(solver: Solver, folder: Path, status: int) -> dict[str, Any]:
    if solver.is_srgc:
        verdict = "out of time" if status < 0 else OF_STATUS.get(status, f"exit status {status}")
        return {"verdict": verdict}
    file = folder / ANSWER
    if not file.exists():
        return {"verdict": "out of time" if status < 0 else f"no answer, exit status {status}"}
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        return {"verdict": f"unreadable answer: {error}"}
    if not isinstance(said, dict) or said.get("verdict") not in VERDICTS:
        return {"verdict": "unreadable answer: no verdict"}
    kept = {key: said[key] for key in ("evidence", "value", "bound") if key in said}
    return {"verdict": said["verdict"], **kept}


def _said_of_result(result: Path) -> dict[str, Any]:
    """What a folder of srgc says of the objective, and how much evidence it has."""
    design = json.loads((result / "design.json").read_text(encoding="utf-8"))
    claim = json.loads((result / "certificate.json").read_text(encoding="utf-8"))
    told: dict[str, Any] = {}
    if objectives := design.get("objectives"):
        told |= {"value": objectives[0]["value"], "bound": objectives[0]["least"]}
    if claim["kind"] == "impossible":
        alone = sum(each["same_robot_as"] is None for each in claim["structures"])
        told["size"] = f"{alone} structures, {len(claim.get('claims', []))} lemmas"
    else:
        told["size"] = f"{claim['steps']} steps, {design.get('control') or 'still'}"
    return told

"""What `benchmarks/disturbed.py` simulates is what it says, and it is not simulated twice."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.oracles.benchmark_cases import programs_of
from tests.oracles.small_specs import CLOSED

ROOT = Path(__file__).parents[1]
SCRIPT = ROOT / "benchmarks" / "disturbed.py"


def run(folder: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """The script with a specification of a few steps."""
    (folder / "closed.srg").write_text(CLOSED, encoding="utf-8")
    asked = ["--specs", str(folder / "closed.srg"), "--timestep", "0.02", "-o", str(folder / "o")]
    command = [sys.executable, str(SCRIPT), *asked, *options]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)


@pytest.mark.slow
def test_shards_are_kept(tmp_path: Path) -> None:
    first = run(tmp_path, "--motions", "60", "--part", "2/2")
    assert (first.returncode, first.stderr) == (0, "closed: motions 50 to 59, 0 left\n")
    rest = run(tmp_path, "--motions", "60")
    assert (rest.returncode, rest.stderr) == (0, "closed: motions 0 to 49, 0 left\n")
    (line,) = [each for each in rest.stdout.splitlines() if each.startswith("closed ")]
    assert line.split()[:3] == ["closed", "60", "0"]
    again = run(tmp_path, "--motions", "60")
    assert (again.returncode, again.stderr) == (0, "")
    file = tmp_path / "o" / "closed" / "motions-000050.json"
    known = json.loads(file.read_text(encoding="utf-8"))
    assert (known["asked"]["motions"], known["found"]["left"]) == (10, [])
    # What another certificate was about counts no more.
    before, known["asked"]["certificate_sha256"] = known["asked"]["certificate_sha256"], "0"
    known["found"]["left"] = [55]
    file.write_text(json.dumps(known), encoding="utf-8")
    assert run(tmp_path, "--motions", "60").stderr == "closed: motions 50 to 59, 0 left\n"
    known["asked"]["certificate_sha256"] = before
    file.write_text(json.dumps(known), encoding="utf-8")
    ran = run(tmp_path, "--motions", "60")
    assert (ran.returncode, ran.stderr) == (1, "motions that left their tubes: 1\n")


@pytest.mark.slow
def test_cases_are_sound_and_have_disturbances() -> None:
    programs = programs_of("disturbed")
    assert len(programs) >= 3
    for program in programs.values():
        (task,) = program.tasks.values()
        assert task.robust is not None
        assert not any(module.states for module in program.modules.values())

"""After a command there is nothing outside of what it was told to write."""

from __future__ import annotations

import subprocess
import sys

import pytest

from srgc.cli.command_table import TABLE
from tests.conftest import COMMAND, ROOT
from tests.oracles.small_specs import BEYOND_REACH, TURNER

WORD = "B eps JO eps L eps EN"
RUNS = [
    "new planar -o written/planar.srg",
    "check turner.srg",
    "fmt --check turner.srg",
    "expand turner.srg -o written/expanded.srg",
    "synth turner.srg -o out --jobs 2 --quiet",
    "synth far.srg -o none --all --quiet",
    "verify out",
    "verify none --trust z3,cvc5",
    "synth far.srg -o alone --no-lemmas --smt cvc5 --quiet",
    "graph none --of lemmas",
    "report out --quiet",
    "report none -o written/none.html --quiet",
    "compare out none",
    "evolve out far.srg -o next --quiet",
    "landscape out --points 2 --jobs 2 --quiet",
    "why none --no-runs --quiet",
    "words turner.srg --limit 3",
    f"accepts turner.srg -- {WORD}",
    "language turner.srg",
    "compare turner.srg Turner Turner",
    "graph turner.srg --of sra",
    "graph turner.srg --of workspace -o written/cells.dot",
    f"model turner.srg --word '{WORD}'",
    "plan turner.srg -o written/plan.svg",
    "explain SRG0408",
    "completion bash",
    *(f"export out --to {form} -o written/arm.{form}" for form in ("urdf", "mjcf", "ros2", "npz")),
    *(f"export out --to {form} -o written/arm.{form}" for form in ("gltf", "mcap")),
    "import urdf written/arm.urdf -o written/imported.srg",
    "export out --to ros2-package -o written/package",
    "export out --to controller -o written/controller",
    "export out --to all -o written/all",
    "replay out --in python",
    "replay out --in mujoco",
]
SCRIPT = """\
import shlex, sys
from srgc.cli import run
for line in sys.stdin.read().splitlines():
    status = run(shlex.split(line))
    assert status in (0, 1, 3), (line, status)
"""
PYTHON = """\
import srgc
result = srgc.synthesize(srgc.load("turner.srg"))
assert result.verify().valid
print(result, result._repr_html_()[:9], result.report(verify=False)._repr_html_()[:9])
result.robot._repr_html_()
assert srgc.evolve(result, srgc.load("far.srg")).verdict == "impossible"
"""


@pytest.fixture
def place(tmp_path):
    """A working directory, a home folder and one for temporary files, all of them new."""
    for name in ("work/written", "home", "temporary"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "work" / "turner.srg").write_text(TURNER, encoding="utf-8")
    (tmp_path / "work" / "far.srg").write_text(BEYOND_REACH, encoding="utf-8")
    return tmp_path


def ran(place, command, text=""):
    """Run a program there; it ends well."""
    finished = subprocess.run(
        command,
        cwd=place / "work",
        env={
            "HOME": str(place / "home"),
            "TMPDIR": str(place / "temporary"),
            "PYTHONPATH": str(ROOT),
            "PYTHONDONTWRITEBYTECODE": "1",
        },
        input=text,
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr


def left(place):
    """What is in the home folder and among the temporary files."""
    folders = (place / "home", place / "temporary")
    return sorted(path.name for folder in folders for path in folder.rglob("*"))


def test_after_every_command(place):
    lsp = "lsp"  # below
    view = "view"  # it serves for ever: it ends in tests/srgc/test_view.py, which looks, too
    assert {line.split()[0] for line in RUNS} | {lsp, view} == set(TABLE)
    ran(place, [sys.executable, "-c", SCRIPT], "\n".join(RUNS))
    assert left(place) == []
    written = {path.name for path in (place / "work").iterdir()}
    assert written == {"turner.srg", "far.srg", "written", "out", "none", "alone", "next"}
    named = {line.rpartition("written/")[2].split()[0] for line in RUNS if "written/" in line}
    assert {path.name for path in (place / "work" / "written").iterdir()} == named
    for folder in ("out", "none", "alone", "next"):
        kept = {path.name for path in (place / "work" / folder).iterdir()}
        assert not {name for name in kept if name.startswith(".") or name == "journal.jsonl"}


@pytest.mark.slow
def test_after_python(place):
    """Temporary folders of results go with the process, if not before."""
    ran(place, [sys.executable, "-c", PYTHON])
    assert left(place) == []
    assert {path.name for path in (place / "work").iterdir()} == {
        "turner.srg", "far.srg", "written",
    }  # fmt: skip


@pytest.mark.slow
def test_after_an_editor(place):
    """One that goes without a word: status 1."""
    finished = subprocess.run(
        [*COMMAND, "lsp"], cwd=place / "work", input=b"", capture_output=True, check=False,
        env={"HOME": str(place / "home"), "TMPDIR": str(place / "temporary"),
             "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"},
    )  # fmt: skip
    assert finished.returncode == 1
    assert left(place) == []

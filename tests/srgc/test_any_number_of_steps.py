"""Results of tasks with ``horizon at most``: all that is written is about the motion found."""

from __future__ import annotations

import csv
import io
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from math import ceil, sqrt
from pathlib import Path
from typing import Any

import pytest

import srgc as api
from grammar_lang.load import load_text
from solvers.verifier.claims.certificate import FoundClaim, from_text
from solvers.verifier.claims.spec_copy import task_of_motion
from solvers.verifier.report import Refused
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.slides import slides
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]
MOST = 30
FEWEST = ceil(2 * sqrt(1.5 * 0.8 / 2) / 0.1)
"""Of 1.5 kg over 0.8 m with 2 N, from rest to rest, in steps of 0.1 s."""


def timed(clauses: str = "minimize time;") -> str:
    text = slides("const mass = 1.5 kg", effort="effort <= 2 N;", steps=MOST)
    return replaced(text, f"horizon {MOST}", f"{clauses} horizon at most {MOST}")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("timed") / "timed.srg"
    path.write_text(timed(), encoding="utf-8")
    assert run(["synth", str(path), "-q", "-o", str(path.parent / "out")]) == 0
    return path.parent / "out"


def test_the_fewest_steps_of_the_closed_form(folder: Path) -> None:
    certificate = json.loads((folder / "certificate.json").read_text())
    design = json.loads((folder / "design.json").read_text())
    assert FEWEST <= certificate["steps"] <= FEWEST + 1
    assert design["horizon"] == certificate["steps"] == len(certificate["inputs"])


def test_it_is_said_how_many_were_allowed(srgc: Srgc, tmp_path: Path) -> None:
    spec = tmp_path / "timed.srg"
    spec.write_text(timed(""), encoding="utf-8")
    ran = srgc("synth", spec, "-q", "-o", tmp_path / "out")
    assert "motion:  3 s, 30 of at most 30 steps" in ran.out + ran.err
    spec.write_text(timed("").replace("at most ", ""), encoding="utf-8")
    ran = srgc("synth", spec, "-q", "-o", tmp_path / "other")
    assert "motion:" not in ran.out + ran.err


def test_the_page_says_both(srgc: Srgc, folder: Path, tmp_path: Path) -> None:
    assert srgc("report", folder, "-o", tmp_path / "page.html").status == 0
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    steps = json.loads((folder / "design.json").read_text())["horizon"]
    assert f"{steps / 10:g} s, {steps} of at most {MOST} steps" in page
    assert f"The motion takes at most {MOST} steps of 0.1 s, 3 s" in page
    assert "At the end of the motion" in page


@pytest.mark.usefixtures("tubes_once")
def test_exports_and_replays_have_the_steps_of_the_motion(srgc: Srgc, folder: Path) -> None:
    steps = json.loads((folder / "design.json").read_text())["horizon"]
    table = srgc("export", folder, "--to", "csv").out
    assert len(list(csv.DictReader(io.StringIO(table)))) == steps + 1
    content = json.loads(srgc("export", folder, "--to", "json").out)
    assert (content["steps"], len(content["t"])) == (steps, steps + 1)
    ran = srgc("replay", folder, "--in", "python")
    assert ran.status == 0
    assert "the tube holds the motion" in ran.out


def test_the_library_reads_it(folder: Path) -> None:
    found = api.open_result(folder)
    assert len(found.trajectory.t) == found.design["horizon"] + 1
    program = api.load(folder / "spec" / "timed.srg")
    assert "at most 3 s" in str(program)
    assert "at most 3 s" in program._repr_html_()


@pytest.mark.parametrize("steps", [0, FEWEST - 1, MOST + 1])
def test_other_numbers_of_steps_are_refused(
    srgc: Srgc, folder: Path, tmp_path: Path, steps: int
) -> None:
    """The motion cut short, or gone on with: what is claimed is not proved."""
    shutil.copytree(folder, tmp_path / "out")

    def change(content: dict[str, Any]) -> None:
        content["inputs"] = [*content["inputs"], *[["0"]] * steps][:steps]
        content["path"] = [[*own, *[own[-1]] * steps][: steps + 1] for own in content["path"]]
        content["steps"] = steps

    result_files.alter(tmp_path / "out", change, sign=True)
    ran = srgc("verify", tmp_path / "out")
    assert (ran.status, ran.out.partition(":")[0]) == (1, "refuted")


@pytest.mark.parametrize(("clause", "fewest"), [("at rest", 1), ("at rest for 0.55 s", 6)])
def test_a_motion_lasts_as_long_as_its_end(folder: Path, clause: str, fewest: int) -> None:
    text = replaced(timed(), "reach Goal at rest", f"reach Goal {clause}")
    program = load_text(text, "spec.srg").program
    assert program is not None
    task = program.tasks["Go"]
    claim = from_text((folder / "certificate.json").read_text(encoding="utf-8"))
    assert isinstance(claim, FoundClaim)
    for steps in range(MOST + 3):
        own = replace(claim, steps=steps)
        if fewest <= steps <= MOST:
            assert task_of_motion(own, task) == task.lasting(steps)
        else:
            with pytest.raises(Refused, match=rf"has {steps} steps, and {fewest} to {MOST} are"):
                task_of_motion(own, task)


def test_the_nearest_motion_of_an_unknown_task(tmp_path: Path) -> None:
    weak = replaced(TURNER, "effort <= 10 N*m", "modules <= 4; effort <= 0.34 N*m")
    spec = tmp_path / "weak.srg"
    spec.write_text(replaced(weak, "horizon 10", "horizon at most 10"), encoding="utf-8")
    assert run(["synth", str(spec), "-q", "-o", str(tmp_path / "out")]) == 4
    design = json.loads((tmp_path / "out" / "design.json").read_text())
    assert design["horizon"] == 10
    rows = (tmp_path / "out" / "nearest.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) - 2 in {10, 5, 7, 2}
    stuck = design["nearest"]["stuck"]
    assert stuck is None or stuck["time"] <= 0.2 * (len(rows) - 2) + 1e-9
    assert run(["report", str(tmp_path / "out")]) == 0

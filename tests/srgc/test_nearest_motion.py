"""Of an unknown task the nearest motion is in the folder, drawn, and told."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from grammar_lang.load import load_text
from solvers.run_context import RunContext, Silent
from solvers.search.search_state import Cause
from solvers.search.synthesis import synthesise
from srgc.cli import run
from srgc.render.result_pictures import nearest_figure
from srgc.text_reports.synthesis_report import synthesis_text
from tests.oracles.small_specs import TURNER, replaced

WEAK = replaced(TURNER, "effort <= 10 N*m", "modules <= 4; effort <= 0.335 N*m")
"""Drives that no motion was found for, and that are not proved to be too weak."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("nearest") / "weak.srg"
    path.write_text(WEAK, encoding="utf-8")
    few = ["--paths", "1", "--evaluations", "4"]
    assert run(["synth", str(path), "-q", *few, "-o", str(path.parent / "out")]) == 4
    return path.parent / "out"


def test_it_is_a_motion_of_the_robot_that_is_named(folder: Path) -> None:
    nearest = json.loads((folder / "design.json").read_text())["nearest"]
    assert not nearest["at_samples"]
    assert nearest["robustness"] < 0
    assert nearest["try_first"]
    (length,) = [each["value"] for each in nearest["parameters"]]
    with (folder / "nearest.csv").open(encoding="utf-8") as file:
        rows = [{k: v for k, v in row.items() if v} for row in csv.DictReader(file)]
    angles, tips = (
        np.array([[float(row[name]) for name in names] for row in rows])
        for names in (("q1",), ("e1_x", "e1_y"))
    )
    turned = length * np.concatenate([np.cos(angles), np.sin(angles)], axis=1)
    np.testing.assert_allclose(tips, turned, atol=1e-6)
    stuck = nearest["stuck"]
    if stuck is not None:
        at = next(k for k, row in enumerate(rows) if float(row["t"]) >= stuck["time"] - 1e-9)
        np.testing.assert_allclose(stuck["position"], tips[at], atol=1e-9)


def test_it_is_drawn_in_the_folder_and_in_the_report(folder: Path) -> None:
    assert "the nearest motion, not proved" in (folder / "figures" / "nearest.svg").read_text()
    assert run(["report", str(folder)]) == 0
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "The nearest motion, which fails" in page
    assert '"motion":' in page.partition('id="motion-data">')[2].partition("</script>")[0]
    assert "data:image/svg+xml;base64," not in page  # it moves


def test_it_is_there_when_time_runs_out_while_a_path_is_tried(tmp_path: Path) -> None:
    """The search is ended while parameters are evaluated for the first path."""
    program = load_text(WEAK, "weak.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    seen = list[float]()

    class Seeing(Silent):
        def robustness(self, value: float) -> None:
            seen.append(value)

    context = RunContext(reporter=Seeing(), out_of_time=lambda: len(seen) > 1)
    result = synthesise(program, task, context)
    assert (result.verdict, result.unfinished) == ("unknown", True)
    assert result.nearest is not None
    assert result.nearest.robustness == pytest.approx(max(seen))
    assert result.nearest.cause is Cause.UNDER_WAY
    assert "<svg" in nearest_figure(result.nearest, program.workspaces[task.workspace], task)
    text = synthesis_text(result, task, str(tmp_path))
    assert "try a longer `--time-limit`" in text


def test_a_reason_counts_what_the_folder_has(folder: Path) -> None:
    design = json.loads((folder / "design.json").read_text())
    tried = [
        each
        for each in design["structures_tried"]
        if each["verdict"] == "unresolved" and each["same_robot_as"] is None
    ]
    with (folder / "evaluations.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert tried
    for each in tried:
        number = str(design["structures_tried"].index(each))
        own = [row for row in rows if row["structure"] == number]
        paths = len({row["path"] for row in own})
        found = re.search(r"(\d+) paths? tried, best robustness (\S+?)[;,]?(\s|$)", each["reason"])
        assert found is not None
        assert int(found[1]) == paths
    best = max(float(re.search(r"best robustness ([-\d.e]+)", e["reason"])[1]) for e in tried)
    assert best == pytest.approx(design["nearest"]["robustness"], rel=1e-3)


def test_a_budget_that_is_the_usual_one_is_none(tmp_path: Path) -> None:
    path = tmp_path / "turner.srg"
    path.write_text(TURNER, encoding="utf-8")
    out = str(tmp_path / "out")
    assert run(["synth", str(path), "-q", "-o", out]) == 0
    usual = ["--paths", "6", "--evaluations", "12"]
    assert run(["synth", str(path), "-q", "-o", out, *usual]) == 0
    assert run(["synth", str(path), "-q", "-o", out, "--paths", "5"]) == 2


def test_a_design_takes_its_place(folder: Path) -> None:
    path = folder.parent / "able.srg"
    path.write_text(TURNER, encoding="utf-8")
    assert run(["synth", str(path), "-q", "--force", "-o", str(folder)]) == 0
    assert not (folder / "nearest.csv").exists()
    assert not (folder / "figures" / "nearest.svg").exists()
    assert json.loads((folder / "design.json").read_text())["nearest"] is None

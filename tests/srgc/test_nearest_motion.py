"""Of an unknown task the nearest motion is in the folder, drawn, and told."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from srgc.cli import run
from tests.oracles.small_specs import TURNER, replaced

WEAK = replaced(TURNER, "effort <= 10 N*m", "modules <= 4; effort <= 0.05 N*m")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("nearest") / "weak.srg"
    path.write_text(WEAK, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patched:
        # Else it is proved that the drives are too weak.
        patched.setattr("solvers.search.family_search.out_of_reach_of_drives", lambda *_: None)
        assert run(["synth", str(path), "-q", "-o", str(path.parent / "out")]) == 4
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
    assert "The nearest motion" in page
    assert "data:image/svg+xml;base64," in page


def test_a_design_takes_its_place(folder: Path) -> None:
    path = folder.parent / "able.srg"
    path.write_text(TURNER, encoding="utf-8")
    assert run(["synth", str(path), "-q", "--force", "-o", str(folder)]) == 0
    assert not (folder / "nearest.csv").exists()
    assert not (folder / "figures" / "nearest.svg").exists()
    assert json.loads((folder / "design.json").read_text())["nearest"] is None

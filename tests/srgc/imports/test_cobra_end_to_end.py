"""Tasks in CoBRA's schema: imported, found, verified, and judged by Timor itself."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.conftest import ROOT
from tests.oracles.timor_sets import ask, names_by_id, needs_timor

pytestmark = [pytest.mark.slow, needs_timor]
FOLDER = ROOT / "specs" / "imports"
KIT = FOLDER / "scara_modules"


def samples(folder: Path) -> list[list[float]]:
    """The coordinates of a found motion at its samples."""
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    joints = sorted(name for name in rows[0] if name[0] == "q" and name[1:].isdigit())
    return [[float(row[name]) for name in joints] for row in rows]


@pytest.mark.parametrize("task", ["sort_parts", "tend_machine"])
def test_what_is_found_does_the_task(task: str, srgc: Callable[..., Any], tmp_path: Path) -> None:
    file = FOLDER / f"{task}.json"
    spec, out = tmp_path / f"{task}.srg", tmp_path / "out"
    assert srgc("import", "cobra", file, "--modules", KIT, "-o", spec).status == 0
    assert srgc("synth", spec, "-o", out).status == 0
    assert srgc("verify", out).status == 0
    design = json.loads((out / "design.json").read_text(encoding="utf-8"))
    by_name = {name: key for key, name in names_by_id(spec.read_text(encoding="utf-8")).items()}
    word = [by_name[name] for name in design["word"] if name != "Floor"]
    given = samples(out)
    answer = ask(
        {
            "set": str(KIT / "modules.json"),
            "task": str(file),
            "modules": word,
            "base": np.eye(4).tolist(),
            "samples": given,
        }
    )
    first, last = answer["goals"].values()
    assert 0 in first
    assert len(given) - 1 in last
    assert answer["touching"] == []
    assert answer["in range"]

"""Shipped tasks in which the first paths do not do: what explains them, and what comes of that."""

from __future__ import annotations

import csv
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.oracles import result_files
from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
Made = Callable[[str], Path]


def evaluations(folder: Path) -> list[dict[str, str]]:
    with (folder / "evaluations.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_few_cells_explain_most_paths_of_the_crowded_hall(made: Made) -> None:
    folder = made("crowded_hall") / "out"
    found = result_files.read(folder, "design.json")["counterexamples"]
    small = [one for one in found if len(one["cells"]) <= 2]
    assert len(small) >= 3
    assert all(one["of"] >= 6 for one in small)
    assert sum(one["deferred"] for one in small) >= 100
    # A path that is deferred is none that was tried, but the one it was found at.
    for later, one in enumerate(found):
        for earlier in found[:later]:
            assert one["cells"] != earlier["cells"]
    paths = {int(row["path"]) for row in evaluations(folder)}
    assert len(paths) > len(found)
    assert f"{len(found)} counterexamples, 1 to" in (folder.parent / "stdout").read_text()


def test_the_best_design_takes_the_second_way_round(made: Made) -> None:
    """The rack reaches from 1.5 m to 6.7 m: above it the way is longer by more than 3 m."""
    folder = made("second_way") / "out"
    rows = evaluations(folder)
    first, second = (
        max(float(row["rho"]) for row in rows if int(row["path"]) == path)
        for path in (0, 1)
    )  # fmt: skip
    assert second > first > 0
    design = result_files.read(folder, "design.json")
    assert design["robustness"] == pytest.approx(second, rel=1e-3)
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        motion = list(csv.DictReader(file))
    below = [row for row in motion if row.get("e1_x") and 2.6 < float(row["e1_x"]) < 3.4]
    assert below
    assert all(float(row["e1_y"]) < 1.6 for row in below)


@pytest.mark.parametrize("spec", ["crowded_hall", "far_shelf", "weak_drives"])
def test_more_jobs_find_the_same(srgc: Run, made: Made, tmp_path: Path, spec: str) -> None:
    out = tmp_path / "out"
    ran = srgc("synth", ROOT / "specs" / f"{spec}.srg", "--jobs", 2, "-o", out)
    assert ran.status in (0, 3)
    for name in ("design.json", "certificate.json", "evaluations.csv"):
        known = made(spec) / "out" / name
        assert (out / name).exists() == known.exists()
        if known.exists():
            assert (out / name).read_bytes() == known.read_bytes()

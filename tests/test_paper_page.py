"""The page of `make paper`: its numbers are those of its records, and it has what it is to have."""

from __future__ import annotations

import importlib
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.oracles.html_tables import Page, Table

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[1]
ERRATA = (ROOT / "docs" / "explanation" / "errata.md").read_text(encoding="utf-8")
SEEDS, EVALUATIONS, POINTS = 3, 2, 2
CASE_STUDY = "The case study, Section 5"
SPECS = ("planar_arm", "planar_arm_paper", "planar_arm_body_paper")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, made: Callable[[str], Path]) -> Iterator[Path]:
    """The page with the smallest budgets, of syntheses that other tests ask for as well."""
    folder = tmp_path_factory.mktemp("paper")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(ROOT / "benchmarks"))
        program = importlib.import_module("paper_page")
        syntheses = importlib.import_module("paper.syntheses")
        records = importlib.import_module("paper.kept_records")
        for spec in SPECS:
            shutil.copytree(made(spec) / "out", folder / spec)
            told = (made(spec) / "stderr").read_text(encoding="utf-8")
            verdict = json.loads((folder / spec / "design.json").read_text("utf-8"))["verdict"]
            records.kept(
                folder / f"{spec}.json",
                {"spec": records.digest(spec)},
                lambda spec=spec, told=told, verdict=verdict: syntheses.record_of(
                    folder / spec, told, verdict
                ),
            )
        program.write_page(folder, SEEDS, EVALUATIONS, POINTS, 1)
        yield folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    return Page.of((folder / "index.html").read_text(encoding="utf-8"))


def design(folder: Path, spec: str) -> dict:
    return json.loads((folder / spec / "design.json").read_text(encoding="utf-8"))


def table(page: Page, caption: str) -> Table:
    (found,) = [each for each in page.tables if each.caption == caption]
    return found


def row(page: Page, caption: str, place: str) -> list[str]:
    (found,) = [each for each in table(page, caption).rows if each[0] == place]
    return found


def test_the_page_loads_nothing_and_can_be_read_by_all(folder: Path, page: Page) -> None:
    text = (folder / "index.html").read_text(encoding="utf-8")
    assert '<html lang="en">' in text
    assert "<script" not in text
    assert all(source.startswith("data:image/svg+xml;base64,") for source in page.sources)
    assert [link.removeprefix("#") for link in page.links] == page.names == [
        "figure-1", "figure-2", "figure-3", "figure-4", "algorithm-1", "case-study", "searches",
        "errata",
    ]  # fmt: skip
    assert len(page.pictures) == 3 + 1 + 4 + 1 + 5
    assert all(len(alt) > 30 for alt in page.alts)
    assert set(page.scopes) == {"col", "row"}
    assert all(each.caption for each in page.tables)
    assert str(ROOT) not in text


def test_every_claim_has_both_sides(page: Page) -> None:
    claims = [each for each in page.tables if each.kind == "claims"]
    assert len(claims) == 6
    for each in claims:
        assert each.head == ["Place", "The paper", "srgc", "Result"]
        for cells in each.rows:
            assert len(cells) == 4
            assert all(cells)
    assert len(page.tables[-1].rows) == ERRATA.count("\n## 4.")


def test_the_numbers_of_the_case_study(folder: Path, page: Page) -> None:
    found, published, body = (design(folder, spec) for spec in SPECS)
    lengths = [each["value"] for each in found["parameters"]]
    two = row(page, CASE_STUDY, "Two links")
    assert (
        f"{lengths[0]:.2f} m and {lengths[1]:.2f} m is found, and its certificate is valid"
        in two[2]
    )
    robustness = row(page, CASE_STUDY, "Robustness")[2]
    said = [float(number) for number in re.findall(r"(\d+\.\d+) N\*m", robustness)]
    assert said == pytest.approx([found["robustness"], published["robustness"]], abs=5e-4)
    assert (body["verdict"], found["verdict"]) == ("impossible", "found")
    assert "impossible, and the evidence is valid" in row(page, CASE_STUDY, "The whole arm")[2]
    # By hand: the paper's entry at l = (2.23, 3.35) and an angle of 0, and the right one.
    inertia = row(page, CASE_STUDY, "Inertia, entry D₁₂")
    half = 3.35**2 * 2.23 / 2
    assert inertia[1].startswith(f"{2.23**3 / 3 + half:.2f} ")
    assert inertia[2].startswith(f"{3.35**3 / 3 + half:.2f} ")
    for place in ("Obstacle", "Target"):
        assert row(page, CASE_STUDY, place)[3] == "agrees"


def test_the_traces_are_those_of_the_searches(folder: Path, page: Page) -> None:
    found = design(folder, "planar_arm")
    rows = table(page, "The loop of srgc").rows
    tried = found["structures_tried"]
    assert [int(cells[0]) for cells in rows if "way round" not in cells[5]] == [*range(len(tried))]
    for cells in rows[: len(tried) - 1]:
        assert cells[5] == tried[int(cells[0])]["verdict"] == "refuted"
    (last,) = [cells for cells in rows if cells[5].startswith("found")]
    path = [
        cell for k, cell in enumerate(found["path"][0]) if not k or cell != found["path"][0][k - 1]
    ]
    assert last[2] == " → ".join(path)
    best = [float(value.replace("−", "-")) for value in last[3].split(" → ")]
    assert best == sorted(best)
    assert best[-1] == pytest.approx(found["robustness"], abs=0.02)
    steps = json.loads((folder / "algorithm-1.json").read_text(encoding="utf-8"))["content"]
    printed = table(page, "The loop as the paper prints it").rows
    assert len(printed) == len(steps)
    assert steps[0]["word"] == "B eps JO eps L eps EN"
    for step, cells in zip(steps, printed, strict=True):
        assert cells[2] == " → ".join(step["path"])
        assert float(cells[3].split()[0].replace("−", "-")) == pytest.approx(
            step["robustness"], abs=5e-3
        )
        assert (step["robustness"] < 0) == (step["core"] is not None)
        assert cells[5].startswith("ρ ≥ 0") == (step["core"] is None and not step["explained"])
    # The base is at the origin: no length of one link is the distance of both S and T.
    one_link = [step for step in steps if step["word"] == steps[0]["word"]]
    assert all(step["core"] is not None for step in one_link)


def test_the_numbers_of_the_searches(folder: Path, page: Page) -> None:
    records = [
        json.loads((folder / "searches" / f"seed-{seed:02d}.json").read_text("utf-8"))["content"]
        for seed in range(SEEDS)
    ]
    runs = {name: np.array([each[name]["values"] for each in records]) for name in records[0]}
    target = 0.95 * max(values.max() for values in runs.values())
    rows = {cells[0]: cells for cells in table(page, "Medians with intervals").rows}
    assert set(rows) == set(runs)
    for name, values in runs.items():
        assert values.shape == (SEEDS, EVALUATIONS)
        reached = (values >= target).any(axis=1)
        assert rows[name][2] == f"{reached.sum()} of {SEEDS}"
        ends = np.sort(values.max(axis=1))
        said = [float(each) for each in re.findall(r"-?\d+\.\d+", rows[name][3].replace("−", "-"))]
        assert said == pytest.approx([np.median(ends), ends[0], ends[-1]], abs=5e-4)
    plots = [each for each in page.alts if each.startswith("Best value so far")]
    assert len(plots) == len(runs) - 1


def test_the_numbers_of_figure_4(folder: Path, page: Page) -> None:
    record = json.loads((folder / "figure-4.json").read_text(encoding="utf-8"))["content"]
    values, feasible = np.array(record["robustness"]), np.array(record["feasible"])
    assert values.shape == feasible.shape == (POINTS, POINTS)
    assert np.array_equal(feasible, values >= 0)
    says = row(page, "Figure 4", "Figure 4")[2]
    assert says.startswith(f"{feasible.sum()} of {feasible.size} pairs")
    assert f"the most robust {values.max():.2f} N*m" in says
    assert f"robustness is {record['published']:.2f} N*m" in row(page, "Figure 4", "Section 5")[2]


def test_the_same_records_give_the_same_page(folder: Path) -> None:
    """In another process and with more jobs, and nothing is computed again."""
    before = {file: file.stat().st_mtime_ns for file in folder.rglob("*.json")}
    page = (folder / "index.html").read_bytes()
    budgets = ["--seeds", SEEDS, "--evaluations", EVALUATIONS, "--points", POINTS, "--jobs", 2]
    command = [sys.executable, "benchmarks/paper_page.py", *map(str, budgets), "-o", str(folder)]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (0, "")
    assert run.stderr == f"page: {folder / 'index.html'}\n"
    assert (folder / "index.html").read_bytes() == page
    assert {file: file.stat().st_mtime_ns for file in folder.rglob("*.json")} == before

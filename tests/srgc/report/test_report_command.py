"""The command on folders that are sound, altered or none."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.oracles import result_files
from tests.oracles.html_page import Page
from tests.oracles.small_specs import SLIDER, TURNER
from tests.oracles.some_cases import some
from tests.srgc.report.conftest import page_of

Result = Callable[[str], Path]
Srgc = Callable[..., object]


def test_without_a_check_nothing_is_said_to_be_proved(result: Result) -> None:
    page = page_of(result("turner"), "--no-verify")
    assert page.faults == []
    (badge,) = page.all("p", class_="verdict open")
    assert badge.text == "found, not checked for this page"
    assert "--no-verify" in page.section("verdict")
    assert "every instant of its motion" not in page.source
    assert not page.all("section", id="margins")
    assert page.data("chart-data")["q1"]["v"]


def test_a_false_claim_is_called_refuted(result: Result) -> None:
    """Full effort throughout: the arm is nowhere near its target."""
    folder = result("turner")

    def drive(content: dict) -> None:
        content["inputs"] = [["9"] for _ in content["inputs"]]
        content["effort_peak"], content["robustness"] = "9", "1"

    result_files.alter(folder, drive, sign=True)
    design = result_files.read(folder, "design.json") | {"effort_peak": 9.0, "robustness": 1.0}
    result_files.write(folder, design, "design.json")
    page = page_of(folder)
    (badge,) = page.all("p", class_="verdict bad")
    assert "refuted" in badge.text
    assert "Do not rely" in page.section("verdict")
    assert "violated:" in page.section("margins")
    assert page.faults == []


def test_the_page_belongs_to_the_folder(srgc: Srgc, result: Result, tmp_path: Path) -> None:
    folder = result("turner")
    assert srgc("report", folder).out == f"report: {folder / 'report.html'}\n"
    assert srgc("verify", folder).status == 0
    (tmp_path / "other.srg").write_text(SLIDER, encoding="utf-8")
    ran = srgc("synth", tmp_path / "other.srg", "-o", folder, "--force", "-q")
    assert ran.status == 0, ran.err
    assert not (folder / "report.html").exists()


@pytest.mark.parametrize("name", ["spec/page.html", "figures/page.html"])
def test_results_are_not_overwritten(srgc: Srgc, result: Result, name: str) -> None:
    folder = result("turner")
    ran = srgc("report", folder, "-o", folder / name)
    assert (ran.status, ran.out) == (2, "")
    assert "is one of the results" in ran.err
    assert not (folder / name).exists()


def test_a_page_is_html(srgc: Srgc, result: Result) -> None:
    folder = result("turner")
    ran = srgc("report", folder, "-o", folder / "design.json")
    assert ran.status == 2
    assert ".html" in ran.err


def test_no_results(srgc: Srgc, tmp_path: Path) -> None:
    assert "is not a folder" in srgc("report", tmp_path / "none").err
    ran = srgc("report", tmp_path)
    assert (ran.status, ran.out) == (2, "")
    assert "no design.json" in ran.err
    assert "goes on" not in ran.err
    (tmp_path / "journal.jsonl").touch()
    assert "goes on from there" in srgc("report", tmp_path).err


def test_an_altered_spec(srgc: Srgc, result: Result) -> None:
    folder = result("turner")
    result_files.alter_spec(folder, "reach T;", "reach S;", sign=False)
    ran = srgc("report", folder)
    assert (ran.status, ran.out) == (2, "")
    assert "altered" in ran.err
    assert not (folder / "report.html").exists()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("verdict", "maybe"),
        ("structures_tried", None),
        ("structures_tried", [{}]),
        ("iterations", []),
        ("counterexamples", [{"structure": "x"}]),
        ("satisfy", 3),
        ("word", ["B"]),
        ("leader", 9),
    ],
)
def test_fields_that_are_wrong(srgc: Srgc, result: Result, key: str, value: object) -> None:
    folder = result("turner")
    design = result_files.read(folder, "design.json")
    result_files.write(folder, design | {key: value}, "design.json")
    ran = srgc("report", folder, "--no-verify")
    assert (ran.status, ran.out) == (2, "")
    assert len(ran.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("evaluations.csv", "structure,path,rho\n0,0,?\n"),
        ("landscape.csv", "4.length,rho,feasible\n1,2\n"),
        ("pareto.json", '{"designs": [1]}'),
        ("pareto.json", "[]"),
        ("log.json", "no"),
    ],
)
def test_files_that_are_none_of_ours(srgc: Srgc, result: Result, name: str, content: str) -> None:
    folder = result("turner")
    (folder / name).write_text(content, encoding="utf-8")
    ran = srgc("report", folder, "--no-verify")
    assert (ran.status, ran.out) == (2, "")
    assert name in ran.err
    assert len(ran.err.splitlines()) == 1


@pytest.mark.parametrize("content", some([None, "t,q1\n0,x\n", "half", ""], 3))
def test_the_motion_is_that_of_the_certificate(result: Result, content: str | None) -> None:
    """``trajectory.csv`` has no digest: what it says, or that it is gone, changes nothing."""
    folder = result("turner")
    before = page_of(folder).data("chart-data")
    path = folder / "trajectory.csv"
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
    if content is None:
        path.unlink()
    else:
        altered = "".join(lines[: len(lines) // 2]).replace("0.", "1.")
        path.write_text(altered if content == "half" else content, encoding="utf-8")
    assert page_of(folder).data("chart-data") == before


def test_a_folder_without_its_tables(result: Result) -> None:
    """What only tells of the search may be missing."""
    folder = result("turner")
    for name in ("evaluations.csv", "log.json"):
        (folder / name).unlink()
    page = page_of(folder, "--no-verify")
    assert page.faults == []
    assert "Evaluations" not in page.section("search")


def test_all_designs_are_compared(designs: Path) -> None:
    page = page_of(designs)
    content = json.loads((designs / "pareto.json").read_text(encoding="utf-8"))
    listed = [each["structure"] for each in (*content["designs"], *content["dominated"])]
    rows = page.with_attribute("data-design")
    assert [int(each.attributes["data-design"]) for each in rows] == listed
    inner = page_of(designs / content["designs"][0]["folder"])
    assert inner.faults == page.faults == []
    assert isinstance(inner, Page)


def test_a_landscape_is_drawn(srgc: Srgc, result: Result) -> None:
    folder = result("turner")
    assert srgc("landscape", folder, "--points", 4).status == 0
    page = page_of(folder, "--no-verify")
    text = page.section("search")
    assert "Robustness over L.length, symbol 4: 4 points" in text
    assert page.faults == []


def test_a_long_search_fits_on_a_page(result: Result) -> None:
    """Thousands of structures, a long spec: the page is cut, and says so."""
    folder = result("turner")
    design = result_files.read(folder, "design.json")
    (found,) = [each for each in design["structures_tried"] if each["verdict"] == "found"]
    word = ["B", *["eps", "JO"] * 11]
    others = [
        {"word": word, "derivation": [], "verdict": "refuted", "evidence": f"proofs/{i}.smt2",
         "same_robot_as": None if i % 4 == 0 else i - i % 4, "boxes": None, "reason": "r" * 60}
        for i in range(6000)
    ]  # fmt: skip
    design["structures_tried"] = [*others, found]
    rows = ["structure,path,4.length,rho,feasible"]
    rows += [f"{i // 500},0,{i / 7000},{i % 9},1" for i in range(4000)]
    (folder / "evaluations.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    result_files.write(folder, design, "design.json")
    result_files.alter_spec(folder, "module B ", "// long \n" * 9000 + "module B ", sign=True)
    digest = result_files.read(folder)["spec_sha256"]
    result_files.write(folder, design | {"spec_sha256": digest}, "design.json")
    page = page_of(folder)
    assert page.faults == []
    assert (folder / "report.html").stat().st_size < 1_000_000
    groups = page.with_attribute("data-robots")
    assert sorted(int(each.attributes["data-robots"]) for each in groups) == [1, 1500]
    assert sorted(int(each.attributes["data-equal"]) for each in groups) == [0, 4500]
    assert "1200 more robots are listed in design.json" in page.section("search")
    assert "The rest is in the folder" in page.section("check")


def test_a_robot_that_cannot_move_has_a_report(srgc: Srgc, tmp_path: Path) -> None:
    """Its tube is a point: no box of an instant is magnified until it can be seen."""
    text = TURNER.replace(
        "accept contains EN and starts with B eps JO;", "accept matches B eps EN;"
    )
    text = text.replace("S box [1.2, 1.9] x [-0.3, 0.3]", "S box [-0.2, 0.3] x [-0.1, 0.3]")
    text = text.replace("reach T;", "reach S;")
    (tmp_path / "stands.srg").write_text(text, encoding="utf-8")
    ran = srgc("synth", tmp_path / "stands.srg", "-q", "-o", tmp_path / "out")
    assert ran.status == 0
    assert "effort:  none, no joint is driven" in ran.out
    assert page_of(tmp_path / "out").faults == []

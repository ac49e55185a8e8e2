"""What holds of every page: it is whole, loads nothing, and says what the folder says."""

from __future__ import annotations

import csv
import math
import os
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import replace
from decimal import ROUND_FLOOR, Context
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from solvers.verifier.claims.certificate import ImpossibleClaim
from srgc.cli import run
from srgc.report.evidence import Evidence
from srgc.report.verdict import proved_section
from tests.conftest import COMMAND, ROOT
from tests.oracles import result_files
from tests.oracles.html_page import Page
from tests.oracles.small_specs import TURNER, replaced
from tests.srgc.report.conftest import HOSTILE, page_of

Pages = Callable[[str], tuple[Path, Page]]
Made = tuple[Path, Page]

FOUR_DIGITS = Context(prec=4, rounding=ROUND_FLOOR)
"""Bounds are not rounded up."""


@pytest.fixture(
    params=["turner", "motor", "spatial", "beyond_reach", "learnt", "too_short", "weak", "unknown"]
)
def reported(request: pytest.FixtureRequest, pages: Pages) -> Iterator[Made]:
    """One folder after the other, of every verdict, in the plane and in space."""
    if request.param in ("weak", "unknown"):
        yield request.getfixturevalue(request.param)
    else:
        yield pages(request.param)


def sound(page: Page) -> None:
    """Well-formed, and nothing in it is loaded, runs by an attribute, or leads nowhere."""
    assert page.faults == []
    # A picture that the page carries itself is not loaded from anywhere.
    assert all(each.startswith("data:image/svg+xml;base64,") for each in page.loaded)
    assert page.handlers == []
    assert page.dangling == []
    assert not [each for each in page.elements if each.name in ("link", "iframe", "object")]
    assert "http:" not in page.source
    assert "https:" not in page.source
    ids = [each.attributes["id"] for each in page.with_attribute("id")]
    assert len(set(ids)) == len(ids)


def test_every_page_is_whole_and_alone(reported: Made) -> None:
    folder, page = reported
    sound(page)
    assert (folder / "report.html").stat().st_size < 1_000_000
    (policy,) = page.all("meta", http_equiv="Content-Security-Policy")
    assert policy.attributes["content"].startswith("default-src 'none';")


def test_every_structure_is_counted(reported: Made) -> None:
    folder, page = reported
    tried = result_files.read(folder, "design.json")["structures_tried"]
    groups = page.with_attribute("data-robots")
    counted = [int(e.attributes["data-robots"]) + int(e.attributes["data-equal"]) for e in groups]
    assert sum(counted) == len(tried)
    rows = {
        int(each.attributes["data-structure"]) for each in page.with_attribute("data-structure")
    }
    assert rows == {i for i, each in enumerate(tried) if each["same_robot_as"] is None}
    for row in page.with_attribute("data-structure"):
        assert " ".join(tried[int(row.attributes["data-structure"])]["word"]) in row.text


def test_counterexamples_are_counted(weak: Made) -> None:
    folder, page = weak
    found = result_files.read(folder, "design.json")["counterexamples"]
    assert found
    (part,) = page.with_attribute("data-counterexamples")
    assert int(part.attributes["data-counterexamples"]) == len(found)
    assert all(" → ".join(each["cells"]) in part.text for each in found)


def test_a_design_is_told_in_its_numbers(pages: Pages) -> None:
    folder, page = pages("turner")
    design = result_files.read(folder, "design.json")
    head = page.section("verdict")
    for parameter in design["parameters"]:
        assert f"{parameter['value']:.5g} {parameter['unit']}" in head
    assert f"{design['robustness']:.4g} N*m" in head
    assert f"{design['effort_peak']:.4g} N*m" in head
    assert f"{design['step'] * design['horizon']:g} s" in head
    assert page.all("p", class_="verdict good")


@pytest.mark.parametrize("spec", ["turner", "motor", "closed"])
def test_units_are_spelled_as_in_the_spec(pages: Pages, spec: str) -> None:
    folder, _ = pages(spec)
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert "N*m" in text
    for other in ("N·m", "N m", "·s", "m²", "s²"):
        assert other not in text, other


def test_charts_show_the_motion(pages: Pages) -> None:
    folder, page = pages("motor")
    with (folder / "trajectory.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    data = page.data("chart-data")
    assert set(data) == {"q1", "qd1", "s1", "u1"}
    for name, curve in data.items():
        held = name == "u1"
        times = [float(row["t"]) for row in rows]
        values = [float(row[name]) for row in rows if row[name]]
        assert curve["held"] == held
        if held:
            np.testing.assert_allclose(curve["v"], values, rtol=1e-5, atol=1e-9)
        else:
            shown = np.interp(times, curve["t"], curve["v"])
            np.testing.assert_allclose(shown, values, rtol=1e-5, atol=1e-6)


def drawn_bounds(page: Page, name: str) -> set[float]:
    """The bounds that a chart shows, as lines or at the ends of its gauge."""
    return {
        float(each.attributes["data-bound"])
        for each in page.with_attribute("data-bound")
        if each.within("data-name", name)
    }


def test_bounds_are_those_of_the_spec(pages: Pages) -> None:
    turner = pages("turner")[1]
    assert sorted(drawn_bounds(turner, "q1")) == pytest.approx([-math.pi, math.pi])
    assert drawn_bounds(turner, "u1") == {-10, 10}
    assert drawn_bounds(turner, "qd1") == set()
    assert drawn_bounds(pages("motor")[1], "u1") == {-24, 24}


def test_margins_are_those_of_the_verifier(
    pages: Pages, capsys: pytest.CaptureFixture[str]
) -> None:
    import json

    folder, page = pages("turner")
    capsys.readouterr()
    assert run(["verify", str(folder), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["findings"]
    text = page.section("margins")
    assert [text.index(each["name"]) for each in found] == sorted(
        text.index(each["name"]) for each in found
    )
    times = [
        float(each.attributes["data-seek"])
        for each in page.with_attribute("data-seek")
        if each.within("id", "margins")
    ]
    assert times == [each["time"] for each in found if each["time"] is not None]
    for each in found:
        if each["margin"] is not None:
            shown = FOUR_DIGITS.create_decimal(repr(each["margin"]))
            assert f"{float(shown):.4g}" in text


def test_verdicts_are_told_apart(pages: Pages, weak: Made, unknown: Made) -> None:
    assert "does the task at every instant" in pages("turner")[1].section("verdict")
    impossible = pages("beyond_reach")[1]
    assert "with at most 4 modules can do the task" in impossible.section("verdict")
    assert "at every instant of its motion" not in impossible.section("verdict")
    assert weak[1].all("p", class_="verdict settled")
    assert unknown[1].all("p", class_="verdict open")
    assert "Nothing about the task" in unknown[1].section("verdict")
    for page in (impossible, unknown[1]):
        assert not page.all("section", id="charts")
        assert not page.all("section", id="margins")
        assert "srgc why ." in page.section("check")


def test_what_is_said_of_all_robots_is_bounded(result: Callable[[str], Path]) -> None:
    """The certificate is about four modules; what ``reason`` says was not proved."""
    folder = result("beyond_reach")
    design = result_files.read(folder, "design.json") | {"reason": "no robot whatever can"}
    result_files.write(folder, design, "design.json")
    page = page_of(folder)
    assert "no robot whatever" not in page.source
    (reason,) = page.all("p", class_="reason")
    count = len(result_files.read(folder)["structures"])
    assert reason.text == f"all {count} structures of at most 4 modules are refuted"
    assert "proved" not in page.section("motion")
    assert "proved" not in page_of(folder, "--no-verify").section("motion")


def test_an_unconfirmed_refutation_is_only_told(result: Callable[[str], Path]) -> None:
    folder = result("beyond_reach")
    assert "not confirmed" not in page_of(folder).section("why-not")
    (folder / "certificate.json").unlink()
    assert "not confirmed" in page_of(folder).section("why-not")


def test_what_an_unknown_verdict_rests_on(unknown: Made) -> None:
    check = unknown[1].section("check")
    assert "certificate in its folder does" not in check
    assert "The verifier" not in check


def test_what_changes_of_an_existing_robot(pages: Pages) -> None:
    folder, page = pages("without_link")
    change = result_files.read(folder, "design.json")["reconfiguration"]
    said = page.section("change")
    assert "1 module added (L 4), 0 modules removed" in said
    steps = [each.text for each in page.all("li", class_="word")]
    assert steps == [" ".join(word) for word in change["configurations"]]
    assert "No module" in pages("good_as_it_is")[1].section("change")
    assert "L.length of symbol 4: 1.5 m" in pages("good_as_it_is")[1].section("verdict")
    assert not pages("turner")[1].all("section", id="change")


def test_conflicting_lines_are_shown_with_links(pages: Pages) -> None:
    folder, page = pages("beyond_reach")
    lines = (folder / "spec" / "beyond_reach.srg").read_text(encoding="utf-8").splitlines()
    links = [each for each in page.all("a") if each.attributes["href"].startswith("#spec0-")]
    assert links
    why_not = page.section("why-not")
    for link in links:
        number = int(link.attributes["href"].removeprefix("#spec0-"))
        assert link.text == f"beyond_reach.srg:{number}"
        assert " ".join(lines[number - 1].split()).removesuffix(";") in why_not


def test_the_whole_spec_is_there(reported: Made) -> None:
    folder, page = reported
    (source,) = page.all("div", class_="srg")
    (path,) = (folder / "spec").iterdir()
    assert source.text.strip("\n") == path.read_text(encoding="utf-8").strip("\n")
    digest = result_files.read(folder, "design.json")["spec_sha256"]
    assert digest in page.section("check")


def test_nothing_of_a_folder_becomes_markup(tmp_path: Path) -> None:
    """Comments, names of files and symbols may hold anything."""
    text = replaced(TURNER, "edge eps;", 'edge "</script><b>";').replace(
        " eps ", ' "</script><b>" '
    )
    spec = tmp_path / "a&b <i>.srg"
    spec.write_text(f"// {HOSTILE}\n/* {HOSTILE} */\n{text}", encoding="utf-8")
    assert run(["synth", str(spec), "-o", str(tmp_path / "out"), "-q"]) == 0
    page = page_of(tmp_path / "out")
    sound(page)
    scripts = page.all("script")
    assert [each.attributes.get("type") for each in scripts].count(None) == 1
    assert not page.all("b")
    assert not page.all("i") or not any("srg" in each.text for each in page.all("i"))
    assert "a&b <i>.srg" in page.section("check")
    assert "srgc synth 'spec/a&b <i>.srg' -o again" in page.section("check")
    assert "</script><b>" in page.all("p", class_="word")[0].text
    assert "\u202e" not in page.source


def test_a_reason_is_text(unknown: Made) -> None:
    assert HOSTILE.replace("\u202e", "\ufffd") in unknown[1].section("why-not")


def test_the_same_folder_gives_the_same_bytes(pages: Pages, tmp_path: Path) -> None:
    folder, page = pages("turner")
    other = tmp_path / "other.html"
    subprocess.run(
        [*COMMAND, "report", str(folder), "-o", str(other)],
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "7"},
        capture_output=True,
    )
    assert other.read_text(encoding="utf-8") == page.source


@pytest.mark.slow
def test_every_kind_of_joint_has_its_peak(pages: Pages) -> None:
    """A turning joint and two sliding ones: a peak each, the robustness as a share and by units."""
    folder, page = pages("prismatic")
    claim = result_files.read(folder)
    rows = np.array([[float(Fraction(x)) for x in row] for row in claim["inputs"]])
    torque, force = np.abs(rows[:, 0]).max(), np.abs(rows[:, 1:]).max()
    head = page.section("verdict")
    assert f"{torque:.4g} N*m and {force:.4g} N" in head
    share = 100 * min(1 - torque / 20, 1 - force / 40)
    assert f"{share:.4g} % ({20 - torque:.4g} N*m, {40 - force:.4g} N)" in head


def test_names_in_reasons_are_code(pages: Pages) -> None:
    """They are in backquotes, which a page does not show."""
    folder, page = pages("learnt")
    tried = result_files.read(folder, "design.json")["structures_tried"]
    assert any("`" in each["reason"] for each in tried)
    assert "`" not in page.section("why-not") + page.section("search")


def test_coverings_are_told_of_only_if_there_are_some(
    evidence_on: Callable[[str], Evidence],
) -> None:
    """A lemma may be about all words of the family; then no structure is covered."""
    evidence = evidence_on("learnt")
    claim = evidence.claim
    assert isinstance(claim, ImpossibleClaim)
    assert claim.structures
    others = ", the coverings of the other structures, and that these"
    assert others in proved_section(evidence)
    alone = proved_section(replace(evidence, claim=replace(claim, structures=())))
    assert "coverings" not in alone
    assert "of all robots of its words and that these are all words of the family" in alone


def test_lemmas_are_listed(pages: Pages) -> None:
    folder, page = pages("learnt")
    lemmas = result_files.read(folder)["claims"]
    (table,) = page.with_attribute("data-lemmas")
    assert table.attributes["data-lemmas"] == str(len(lemmas))
    why_not = page.section("why-not")
    assert all(lemma["condition"] in why_not for lemma in lemmas)
    (reason,) = page.all("p", class_="reason")
    assert reason.text.startswith(
        f"all structures of at most 4 modules are refuted, by {len(lemmas)} lemma"
    )

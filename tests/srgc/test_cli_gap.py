"""``srgc synth --gap``: how much more robust any robot may be, and when the search ends."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import srgc
from compiler.time_limits.time_limit import OutOfTimeError
from solvers.search import narrowed_family
from solvers.verifier.verification import Outcome, verify_directory
from srgc.results.folder_writer import JOURNAL
from tests.oracles.result_files import read
from tests.oracles.slides import least_force, slides

pytestmark = pytest.mark.usefixtures("without_pictures")

TWO = slides("const mass = 4 kg; const mass = 2 kg", kinds="Slow Fast")
RESULTS = ("design.json", "certificate.json", "proofs/bound/0000.boxes", "proofs/bound/0001.boxes")


@pytest.mark.parametrize("gap", ["20", "20%", " 20 % "])
def test_the_first_design_is_near_enough(gap, srgc, spec, tmp_path):
    out = tmp_path / "out"
    ran = srgc("synth", spec(TWO), "-o", out, "--gap", gap)
    assert ran.status == 0
    assert "robot:   Base e Slow e Hand" in ran.out
    (line,) = [line for line in ran.out.splitlines() if line.startswith("bound:")]
    design = read(out, "design.json")
    share = 100 * design["bound"]["share"]
    assert line.startswith(
        f"bound:   no robot of at most 3 modules has more than {share:g} % (gap "
    )
    stated = design["bound"]["gap"]
    assert stated == pytest.approx(design["bound"]["share"] / design["robustness_share"] - 1)
    shown = float(line.partition("(gap ")[2].partition(" %")[0]) / 100
    assert stated <= shown <= 1.1 * stated
    assert design["gap"] == 20
    assert verify_directory(out).outcome is Outcome.VALID


def test_it_goes_on_to_the_better_one(srgc, spec, tmp_path):
    out = tmp_path / "out"
    assert srgc("synth", spec(TWO), "-o", out, "--gap", "1", "--quiet").status == 0
    design = read(out, "design.json")
    assert design["word"] == ["Base", "e", "Fast", "e", "Hand"]
    assert [each["verdict"] for each in design["structures_tried"]] == ["found", "found"]
    best = 1 - least_force(2, 0.8, 2, stops=True) / 20
    assert design["robustness_share"] <= best <= design["bound"]["share"]
    assert not (out / "designs").exists()
    page = srgc("report", out)
    assert page.status == 0
    assert "bound on robustness" in (out / "report.html").read_text(encoding="utf-8")


def test_where_there_is_no_bound(srgc, spec, tmp_path):
    out = tmp_path / "out"
    ran = srgc("synth", spec(slides("const mass = 2 kg", travel="")), "-o", out, "--gap", "1")
    assert ran.status == 0
    assert "bound:   none was proved: no share is shown to be too much for the drives of" in ran.out
    assert read(out, "design.json")["bound"] is None
    assert read(out)["format"] == 3
    assert verify_directory(out).outcome is Outcome.VALID


def test_without_the_option_nothing_is_said(srgc, spec, tmp_path):
    ran = srgc("synth", spec(slides("const mass = 2 kg")), "-o", tmp_path / "out")
    assert "bound" not in ran.out
    design = read(tmp_path / "out", "design.json")
    assert "bound" not in design
    assert "gap" not in design


@pytest.mark.parametrize("gap", ["", "-1", "five", "nan", "inf", "5 % %", "1/2"])
def test_no_gap(gap, srgc, spec, tmp_path):
    ran = srgc("synth", spec(TWO), "-o", tmp_path / "out", "--gap", gap)
    assert ran.status == 2
    said = f"error: a gap is a percentage of at least 0, such as `5 %`, not `{gap}`"
    assert " ".join(ran.err.split()) == said
    assert not (tmp_path / "out").exists()


def test_not_with_all(srgc, spec, tmp_path):
    ran = srgc("synth", spec(TWO), "-o", tmp_path / "out", "--gap", "5", "--all")
    assert ran.status == 2
    assert "--all does not go with --gap" in ran.err


def test_out_of_time_and_resumed(srgc, spec, tmp_path, monkeypatch):
    """What was found out about the bound is not found out again, and the end is the same."""
    file, whole, parts = spec(TWO), tmp_path / "whole", tmp_path / "parts"
    asked = narrowed_family.drive_refutation
    counts = {"made": 0, "most": 10**9}

    def counted(*given):
        counts["made"] += 1
        if counts["made"] > counts["most"]:
            raise OutOfTimeError
        return asked(*given)

    monkeypatch.setattr(narrowed_family, "drive_refutation", counted)
    assert srgc("synth", file, "-o", whole, "--gap", "20").status == 0
    all_of_them, counts["made"], counts["most"] = counts["made"], 0, 4
    ran = srgc("synth", file, "-o", parts, "--gap", "20")
    assert ran.status == 0
    assert "bound:   none was proved: the time limit was reached" in ran.out
    assert verify_directory(parts).outcome is Outcome.VALID
    assert (parts / JOURNAL).exists()
    refused = srgc("synth", file, "-o", parts, "--gap", "10")
    assert refused.status == 2
    assert "another gap to be closed" in refused.err
    counts["made"], counts["most"] = 0, 10**9
    assert srgc("synth", file, "-o", parts, "--gap", "20").status == 0
    assert counts["made"] == all_of_them - 4
    for name in RESULTS:
        assert (parts / name).read_bytes() == (whole / name).read_bytes(), name
    assert not (parts / JOURNAL).exists()


def test_from_python(tmp_path: Path) -> None:
    (tmp_path / "two.srg").write_text(TWO, encoding="utf-8")
    program = srgc.load(tmp_path / "two.srg")
    result = srgc.synthesize(program, gap="20 %")
    best = 1 - least_force(2, 0.8, 2, stops=True) / 20
    assert result.bound is not None
    assert result.bound >= best
    assert srgc.synthesize(program).bound is None
    for wrong in ({"gap": -1}, {"gap": 5, "every": True}):
        with pytest.raises(srgc.SrgcError, match="gap"):
            srgc.synthesize(program, **wrong)
    assert json.loads((result.folder / "design.json").read_bytes())["gap"] == 20

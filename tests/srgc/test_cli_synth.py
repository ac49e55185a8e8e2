from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ET
from fractions import Fraction
from types import SimpleNamespace

import pytest

from solvers.planner import Exhaustion
from srgc.text_reports.synthesis_report import after_synthesis
from tests.oracles import result_files
from tests.oracles.formulas import program
from tests.oracles.small_specs import SLIDER, TURNER, replaced

DESIGN_FIELDS = [
    "verdict", "reason", "task", "spec", "word", "derivation", "dofs", "parameters", "robustness",
    "effort_peak", "robustness_share", "robustness_by_unit", "control", "held_at_start",
    "held_at_end", "step", "horizon", "path",
    "leader", "satisfy", "reconfiguration", "cells", "structures_tried", "nearest",
    "counterexamples", "iterations", "seed", "least_cells", "all_designs", "solver", "search",
    "paths", "evaluations", "spec_sha256", "version",
]  # fmt: skip


def names(folder):
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file())


def test_the_folder_of_a_found_robot(made):
    folder = made("turner") / "out"
    design = result_files.read(folder, "design.json")
    refuted = [s for s in design["structures_tried"] if s["verdict"] == "refuted"]
    evidence = {s["evidence"] for s in refuted if "lemma" not in s}
    assert refuted
    assert names(folder) == sorted(
        [
            "certificate.json", "design.json", "evaluations.csv", "figures/inputs.svg",
            "figures/workspace.svg", "log.json", "spec/turner.srg", "trajectory.csv", *evidence,
        ]
    )  # fmt: skip
    assert (folder / "spec/turner.srg").read_bytes() == (made("turner") / "turner.srg").read_bytes()
    assert set(result_files.read(folder, "log.json")) >= {"search_s", "total_s"}


def test_only_the_folder_is_written(made):
    place = made("turner")
    assert sorted(p.name for p in place.iterdir()) == [
        "out", "status", "stderr", "stdout", "turner.srg",
    ]  # fmt: skip


def test_plain_progress_and_a_summary(made):
    place = made("turner")
    assert (place / "status").read_text() == "0"
    lines = (place / "stderr").read_text().splitlines()
    assert lines
    assert all(line.startswith("[") and " s] " in line for line in lines)
    assert any("structure 0: B eps JO eps EN" in line for line in lines)
    assert any("path: S > " in line for line in lines)
    assert any("best robustness: " in line for line in lines)
    out = (place / "stdout").read_text()
    assert out.startswith("verdict: found\nrobot:   B eps JO eps L eps EN\n")
    assert "\x1b" not in out + "".join(lines)


def test_design_fields(made):
    folder = made("turner") / "out"
    design = result_files.read(folder, "design.json")
    assert list(design) == [*DESIGN_FIELDS, "lemmas"]
    assert (design["verdict"], design["reason"], design["task"]) == ("found", None, "Turn")
    word = ["B", "eps", "JO", "eps", "L", "eps", "EN"]
    assert design["word"] == word
    assert design["derivation"] == ["tool", "link", "joint", "base"]
    assert design["dofs"] == [{"symbols": [2], "kind": "revolute", "axis": "z"}]
    (parameter,) = design["parameters"]
    assert {k: parameter[k] for k in ("symbol", "module", "name", "unit")} == {
        "symbol": 4, "module": "L", "name": "length", "unit": "m",
    }  # fmt: skip
    assert 1 <= parameter["value"] <= 2
    assert design["robustness"] == pytest.approx(10 - design["effort_peak"], abs=1e-12)
    assert (design["step"], design["horizon"], design["seed"]) == (0.2, 10, 0)
    ((*path,),) = design["path"]
    assert len(path) == 11
    assert path[0] == "S"
    assert path[-1] == "T"
    assert set(path) <= set(design["cells"])
    spec = (folder / "spec/turner.srg").read_bytes()
    assert design["spec_sha256"] == result_files.spec_digest({"turner.srg": spec})
    for structure in design["structures_tried"]:
        assert list(structure) == [
            "word",
            "derivation",
            "verdict",
            "evidence",
            "same_robot_as",
            "boxes",
            "reason",
            *(["lemma"] if structure["verdict"] == "refuted" else []),
        ]
    assert design["structures_tried"][-1]["verdict"] == "found"
    assert all(s["verdict"] == "refuted" for s in design["structures_tried"][:-1])


def test_cells_are_rational_inequalities(made):
    cells = result_files.read(made("turner") / "out", "design.json")["cells"]
    assert set(cells["T"]) == {"-x <= 3/10", "x <= 3/10", "-y <= -6/5", "y <= 19/10"}


def test_the_trajectory_table(made):
    folder = made("turner") / "out"
    design, certificate = result_files.read(folder, "design.json"), result_files.read(folder)
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = list(csv.reader(file))
    assert head == ["t", "q1", "qd1", "u1", "e1_x", "e1_y"]
    assert len(rows) == design["horizon"] + 1
    for number, row in enumerate(rows):
        assert Fraction(row[0]) == number * Fraction(1, 5)
        assert [row[3]] == (certificate["inputs"][number] if number < 10 else [""])
    assert [rows[0][1], rows[0][2]] == certificate["start"]
    x, y = map(float, rows[-1][4:])
    assert -0.3 < x < 0.3
    assert 1.2 < y < 1.9


@pytest.mark.parametrize(
    ("name", "marks"),
    [
        ("workspace", {"ghost", "trace", "way", "joint", "begin", "finish", "spine", "title"}),
        ("inputs", {"line", "used", "allowed", "title"}),
    ],
)
def test_pictures_are_svg_with_their_content(made, name, marks):
    root = ET.parse(made("turner") / "out" / "figures" / f"{name}.svg").getroot()
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    classes = {name for each in root.iter() for name in each.get("class", "").split()}
    assert marks <= classes


def test_json_prints_the_design_alone(srgc, spec, tmp_path):
    path, out = spec(SLIDER), tmp_path / "out"
    ran = srgc("synth", path, "-o", out, "--json", "--seed", "3")
    assert (ran.status, ran.err) == (0, "")
    assert ran.out == (out / "design.json").read_text(encoding="utf-8")
    assert json.loads(ran.out)["seed"] == 3
    before = {name: (out / name).read_bytes() for name in names(out) if name != "log.json"}
    # The same again, in place, gives the same bytes.
    assert srgc("synth", path, "-o", out, "--json", "--seed", "3").status == 0
    assert before == {name: (out / name).read_bytes() for name in names(out) if name != "log.json"}
    # Another seed, or another file, is refused and nothing is touched.
    for arguments in ((path, "--seed", "4"), (spec(SLIDER + "\n", "b.srg"), "--seed", "3")):
        ran = srgc("synth", *arguments, "-o", out)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.count("\n") == 1
        assert "--force" in ran.err
    assert before == {name: (out / name).read_bytes() for name in names(out) if name != "log.json"}
    # With --force it replaces them.
    ran = srgc("synth", spec(SLIDER + "\n", "b.srg"), "-o", out, "--force")
    assert ran.status == 0
    assert sorted(p.name for p in (out / "spec").iterdir()) == ["b.srg"]
    assert srgc("verify", out).status == 0


def test_the_default_folder(srgc, spec, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert srgc("synth", spec(SLIDER)).status == 0
    assert (tmp_path / "out" / "Slide" / "design.json").is_file()


def test_folders_that_are_refused(srgc, spec, tmp_path):
    path = spec(SLIDER)
    other = tmp_path / "other"
    other.mkdir()
    (other / "thesis.txt").write_text("mine")
    ran = srgc("synth", path, "-o", other)
    assert (ran.status, ran.out) == (2, "")
    assert [p.name for p in other.iterdir()] == ["thesis.txt"]
    ran = srgc("synth", path, "-o", path)
    assert ran.status == 2
    assert ran.err.count("\n") == 1
    assert srgc("synth", path, "-o", other, "--force").status == 0
    assert (other / "thesis.txt").read_text() == "mine"


def test_a_kill_before_the_first_file_is_no_obstacle(srgc, spec, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / ".journal.jsonl.part").write_text("{")
    assert srgc("synth", spec(SLIDER), "-o", out, "--json").status == 0
    assert not (out / ".journal.jsonl.part").exists()


def test_a_time_limit_is_unknown_and_resumed(srgc, spec, tmp_path):
    path, out = spec(SLIDER), tmp_path / "out"
    ran = srgc("synth", path, "-o", out, "--time-limit", "1e-6")
    assert ran.status == 4
    assert ran.out.startswith("verdict: unknown (the time limit was reached)")
    design = result_files.read(out, "design.json")
    assert (design["verdict"], design["word"], design["path"]) == ("unknown", None, [])
    assert not (out / "certificate.json").exists()
    ran = srgc("verify", out)
    assert ran.status == 4
    assert "nothing to verify" in ran.out
    assert srgc("synth", path, "-o", out).status == 0
    assert srgc("verify", out).status == 0


def test_a_family_without_a_bound_is_unknown(srgc, spec, tmp_path):
    text = replaced(SLIDER, "matches B eps P eps M eps EN", "matches B eps EN (eps EN)*")
    ran = srgc("synth", spec(text), "-o", tmp_path / "out", "--no-lemmas")
    assert ran.status == 4
    assert "default search bound" in ran.out
    design = result_files.read(tmp_path / "out", "design.json")
    assert design["verdict"] == "unknown"
    assert "modules <= n" in design["reason"]
    # B and one to eleven effectors: twelve modules at most.
    assert len(design["structures_tried"]) == 11
    assert srgc("verify", tmp_path / "out").status == 4


def test_a_cyclic_grammar_is_refused(srgc, spec, tmp_path):
    text = replaced(SLIDER, "  base:  N -> B;", "  base:  N -> B;\n  again: N -> N;")
    text = replaced(text, "  base  {", "  again { this.frame = N.frame; }\n  base  {")
    path = spec(text)
    checked = srgc("check", path)
    ran = srgc("synth", path, "-o", tmp_path / "out")
    assert checked.status == 0
    assert "warning[SRG0405]" in checked.out
    assert (ran.status, ran.out) == (5, "")
    assert "error[SRG0405]" in ran.err
    assert not (tmp_path / "out").exists()
    word = ["B", "eps", "P", "eps", "M", "eps", "EN"]
    assert srgc("accepts", path, "--trace", "--", *word).status == 0


def test_a_time_limit_is_a_number(srgc, arm_file):
    ran = srgc("synth", arm_file, "--time-limit", "nan")
    assert ran.status == 2
    assert "seconds" in ran.err


SWING = (
    replaced(TURNER, "param length in [1, 2] m", "const length = 1.5 m")
    .replace("[1.2, 1.9] x [-0.3, 0.3]", "[-0.1, 0.1] x [-1.6, -1.4]")
    .replace("[-0.3, 0.3] x [1.2, 1.9]", "[1.4, 1.6] x [-0.1, 0.1]")
    .replace("bounds box [-1, 3] x [-1, 3]", "bounds box [-2, 3] x [-2, 3]")
    .replace("reach T;", "reach T at rest; gravity (0, -9.81) m/s^2;")
)
"""A rod swings up to where it is horizontal: its weight then turns it by 11.04 N m."""


@pytest.mark.parametrize(("effort", "held"), [(9, False), (14, True)])
def test_it_is_told_if_the_drives_do_not_hold_what_they_lifted(srgc, spec, tmp_path, effort, held):
    path = spec(SWING.replace("effort <= 10", f"effort <= {effort}"))
    ran = srgc("synth", path, "-o", tmp_path / "out")
    assert ran.status == 0
    assert ("the drives cannot hold it there" in ran.out) is not held
    design = json.loads((tmp_path / "out/design.json").read_text())
    assert design["held_at_end"] is held
    assert srgc("report", tmp_path / "out").status == 0
    page = (tmp_path / "out/report.html").read_text()
    assert ("at rest there for an instant only" in page) is not held


@pytest.mark.parametrize(("effort", "held"), [(9, False), (14, True)])
def test_it_is_told_if_the_drives_do_not_hold_what_they_let_down(
    srgc, spec, tmp_path, effort, held
):
    """The same rod swings down from where its weight turns it by 11.04 N*m."""
    down = SWING.replace("start in S", "start in Here").replace("reach T at rest", "reach There")
    down = down.replace("region S box", "region There box").replace(
        "target T box", "target Here box"
    )
    path = spec(down.replace("effort <= 10", f"effort <= {effort}"))
    ran = srgc("synth", path, "-o", tmp_path / "out")
    assert ran.status == 0
    assert ("the drives cannot hold it where it begins" in ran.out) is not held
    design = json.loads((tmp_path / "out/design.json").read_text())
    assert (design["held_at_start"], design["held_at_end"]) == (held, None)
    assert srgc("report", tmp_path / "out").status == 0
    page = (tmp_path / "out/report.html").read_text()
    assert ("drives cannot hold it where it begins" in page) is not held


def test_a_wall_that_bodies_alone_avoid_is_named(srgc, spec, tmp_path):
    """Nothing keeps an effector without a body out of it: only with this are cells a proof."""
    wall = "obstacle Wall box [-1, 3] x [0.8, 1] m; target T box [-0.3, 0.3]"
    text = replaced(TURNER, "target T box [-0.3, 0.3]", wall)
    text = text.replace("avoid O with effector;", "avoid Wall with body; avoid O with effector;")
    task = program(text).tasks["Turn"]
    reason = f"planning: {Exhaustion.APART.value}"
    undecided = SimpleNamespace(
        verdict="unknown", reason=reason, nearest=None, unfinished=False, records=()
    )
    said = after_synthesis(undecided, task, "out")
    assert said.startswith("next:    add `avoid Wall with effector;`")
    text = text.replace("avoid Wall with body;", "avoid Wall with body; avoid Wall with effector;")
    ran = srgc("synth", spec(text), "-o", tmp_path / "out")
    assert ran.status == 3
    assert "every way between them leads through `Wall`" in ran.out

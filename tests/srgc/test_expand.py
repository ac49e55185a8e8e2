"""`srgc expand`, and the library in result folders."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
KIT = """\
// A kit.
module Plate { role base; port out: F; frame out = in; }
module Hand { role effector; port in: F; effector(frame: in); }

grammar Arm from ports {
  start Plate;
  with Hand;  // and nothing else
}
"""
EXPANDED = """\
// A kit.
module Plate { role base; port out: F; frame out = in; }
module Hand { role effector; port in: F; effector(frame: in); }

// and nothing else
grammar Arm {
  start Robot;
  Plate: Robot -> Plate F;
  Hand: F -> Hand;
}

semantics Arm {
  Plate { Plate.in = this.frame; F.frame = Plate.out; }
  Hand { Hand.in = this.frame; }
}
"""
TASK = """
include std "pelican.srg";

workspace Wall {
  plane xy;
  bounds box [-1, 1] x [-1, 1] m;
  region Low box [-15, 15] x [-60, -45] cm;
  target Side box [25, 45] x [-45, -25] cm;
}

task Swing {
  robot Std_Pelican;
  workspace Wall;
  start in Low at rest;
  reach Side at rest;
  gravity (0, -9.81) m/s^2;
  effort <= 15 N*m;
  horizon 12 steps of 0.1 s;
}
"""


def test_a_grammar_from_ports_is_printed_as_it_is(srgc: Run, spec: Callable[[str], Path]) -> None:
    ran = srgc("expand", spec(KIT))
    assert (ran.status, ran.out, ran.err) == (0, EXPANDED, "")


def test_what_has_none_stays_as_it_is(srgc: Run) -> None:
    path = ROOT / "specs" / "planar_arm.srg"
    ran = srgc("expand", path)
    assert (ran.status, ran.out) == (0, path.read_text(encoding="utf-8"))


def test_it_is_written_where_asked(srgc: Run, spec: Callable[[str], Path], tmp_path: Path) -> None:
    ran = srgc("expand", spec(KIT), "-o", tmp_path / "out.srg")
    assert (ran.status, ran.out) == (0, "")
    assert (tmp_path / "out.srg").read_text(encoding="utf-8") == EXPANDED


def test_what_names_files_stays_beside_them(
    srgc: Run, spec: Callable[[str], Path], tmp_path: Path
) -> None:
    """Paths are relative to the folder of the file."""
    path = spec(f'include "more.srg";\n{KIT}')
    (path.parent / "more.srg").write_text("module More { role link; }\n", encoding="utf-8")
    (tmp_path / "other").mkdir()
    ran = srgc("expand", path, "-o", tmp_path / "other" / "out.srg")
    assert ran.status == 2
    assert f"write it there: -o {path.parent / 'out.srg'}" in ran.err
    assert not list((tmp_path / "other").iterdir())
    assert srgc("expand", path, "-o", path.parent / "out.srg").status == 0
    assert srgc("check", path.parent / "out.srg").status == 0


def test_a_file_with_errors_is_not_expanded(srgc: Run, spec: Callable[[str], Path]) -> None:
    ran = srgc("expand", spec(KIT.replace("with Hand", "with Plate")))
    assert (ran.status, ran.out) == (5, "")
    assert "SRG0411" in ran.err


def test_results_keep_what_they_read_of_the_library(
    srgc: Run, spec: Callable[[str], Path], tmp_path: Path
) -> None:
    """The copy is what `verify` reads, and a part of the digest."""
    out = tmp_path / "out"
    assert srgc("synth", spec(TASK), "-o", out, "-q").status == 0
    (copy,) = (out / "spec").rglob("pelican.srg")
    assert copy.parent.name == "@std"
    assert srgc("verify", out, "-q").status == 0
    text = copy.read_text(encoding="utf-8")
    copy.write_text(text.replace("0.1213", "0.1214"), encoding="utf-8")
    assert copy.read_text(encoding="utf-8") != text
    ran = srgc("verify", out, "-q")
    assert ran.status != 0
    assert json.loads((out / "certificate.json").read_text(encoding="utf-8"))

"""Drives that are too weak, whatever weights are put on: robot by robot, and where it is false."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from compiler.lemmas.weighted import weighted_robot, weights
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.impossibility.variant_lemmas import weights_lemma
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.result_files import alter, read

SPEC = (Path(__file__).parents[2] / "specs" / "weak_drives.srg").read_text(encoding="utf-8")


def read_in(text: str) -> tuple[ir.Program, ir.Task]:
    program = load_text(text, "spec.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    return program, task


def replaced(text: str, before: str, after: str) -> str:
    assert text.count(before) == 1, before
    return text.replace(before, after)


@pytest.fixture(scope="module")
def learnt(made: Callable[[str], Path]) -> Path:
    return made("weak_drives") / "out"


def test_one_lemma_is_about_all(learnt: Path) -> None:
    claim = read(learnt)
    assert [c["argument"] for c in claim["claims"]] == ["weights"]
    assert claim["structures"] == []
    assert verify_directory(learnt).level == "validated"


@pytest.mark.slow
def test_the_same_one_by_one(learnt: Path, tmp_path: Path) -> None:
    """Each robot with its weights is refuted on its own, too."""
    spec = next((learnt / "spec").iterdir())
    out = tmp_path / "out"
    assert run(["synth", str(spec), "-o", str(out), "-q", "--no-lemmas"]) == 3
    tried = json.loads((out / "design.json").read_text(encoding="utf-8"))["structures_tried"]
    assert len(tried) == 35
    assert {each["verdict"] for each in tried} == {"refuted"}


def test_the_robot_with_weights() -> None:
    """A mass at each of the four places, from nothing up to all that there may be."""
    program, task = read_in(SPEC)
    family = family_of(program, task)
    base = next(candidates(family, 8, None)).derivation
    assert weights(family, task) == {"weight": "Weight"}
    model = weighted_robot(family, task, base, 3)
    assert model is not None
    found = [p for p in model.parameters if p.name.startswith("weight")]
    assert len(found) == 4
    bounds = ir.Interval(ir.Num(Fraction(0)), ir.Num(Fraction(9, 2)))  # 3 times 1.5 kg
    assert {p.domain for p in found} == {bounds}
    assert len(model.dofs) == len(family.robot(base).dofs) == 1


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("start in Left at rest;", "start at (0 rad);"),
        ("reach Right;", "reach Right;\n  avoid Left with body;"),
        ("reach Right;", "reach Right;\n  avoid self with body;"),
        ("this.at = Part.at; point(frame: Part.at, mass: Weight.mass);",
         "this.at = Part.at;\n    point(frame: Part.at * move(x, 1 cm), mass: Weight.mass);"),
        ("this.at = Part.at; point(frame: Part.at, mass: Weight.mass);",
         "this.at = Part.at;\n    rod(frame: Part.at, axis: x, length: 1 cm, density: 1 kg/m);"),
    ],
)  # fmt: skip
def test_where_nothing_is_a_weight(before: str, after: str) -> None:
    program, task = read_in(replaced(SPEC, before, after))
    assert weights(family_of(program, task), task) == {}


def test_a_counterweight_is_asked_about() -> None:
    """Held against gravity by a weight on the other side: no lemma, though the bare arm is weak."""
    text = SPEC
    for before, after in {
        "start in Left at rest;": "gravity (0, -9.81) m/s^2;\n  start in Left at rest;",
        "effort <= 0.5 N*m;": "effort <= 8 N*m;",
        "rod(frame: Part.at, axis: x, length: Tube.length, density: Tube.density);":
            "point(frame: Part.at * move(x, Tube.length), mass: 2 kg);",
        "tube: Part -> Part flange Tube;":
            "tube: Part -> Part flange Tube;\n  tail: Part -> Part flange Tail;\n"
            "  fore: Part -> Part flange Fore;",
        "module Hand {":
            "module Tail { role link; const back = 1 m; }\n"
            "module Fore { role link; const front = 1 m; }\nmodule Hand {",
        "  weight {":
            "  tail { this.at = Part.at * move(x, -1 m); }\n"
            "  fore { this.at = Part.at * move(x, 1 m); }\n  weight {",
        "(flange Weight | flange Tube)* flange Hand":
            "flange Tail (flange Weight)* flange Fore flange Tube (flange Weight)* flange Hand",
        "target Right box [-1.3, -0.7] x [-0.1, 0.1] m;":
            "target Right box [-0.1, 0.1] x [0.7, 1.3] m;",
    }.items():  # fmt: skip
        text = replaced(text, before, after)
    program, task = read_in(text)
    family = family_of(program, task)
    base = next(candidates(family, 8, None)).derivation
    assert weighted_robot(family, task, base, 3) is not None
    assert weights_lemma(family, task, base) is None


ALTERED: dict[str, dict[str, object]] = {
    "a count off by one": {"condition": "count(Weight) <= 5"},
    "every word": {"condition": "length >= 1"},
    "no covering": {"boxes": "proofs/0001.boxes"},
    "the covering without weights": {"boxes": "proofs/0000.boxes"},
    "another derivation": {"derivation": ["hand", "base"]},
    "another word": {"word": ["Base"]},
    "a share": {"most": "4"},
    "more still": {"most": 10**9},
}


@pytest.mark.parametrize("name", ALTERED)
def test_altered(learnt: Path, tmp_path: Path, name: str) -> None:
    target = tmp_path / "altered"
    shutil.copytree(learnt, target)
    (target / "design.json").unlink()
    changes = ALTERED[name]

    def change(content: dict[str, Any]) -> None:
        content["claims"][0].update(changes)

    alter(target, change, sign=True)
    assert verify_directory(target).outcome is Outcome.REFUTED

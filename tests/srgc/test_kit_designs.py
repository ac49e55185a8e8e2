"""A kit with all that modules may have, from its text to a proved design and back to its ports."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from grammar_lang.formatting.expansion import expanded
from grammar_lang.load import load
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

Run = Callable[..., Ran]
KIT = """\
module Torso {
  role base;
  port left: Shoulder female;
  port right: Shoulder female;
  frame left = in * move(y, 20 cm);
  frame right = in * move(y, -20 cm);
}

module Motor {
  role joint;
  const torque_constant = 0.5 N*m/A;
  const resistance = 2 V/A;
  const friction = 0.2 N*m*s/rad;
  dof q: revolute z in [-150, 150] deg;
  state current A;
  input voltage in [-24, 24] V;
  der(current) = (voltage - resistance * current) / 0.1 V*s/A;
  torque(q) = torque_constant * current - friction * rate(q);
  port in: Shoulder male;
  port out: Pin female;
  frame turned = in * rot(z, q);
  frame out = turned * move(x, 30 cm);
  rod(frame: turned, axis: x, length: 30 cm, density: 2 kg/m, radius: 2 cm);
}

module Driven {
  role joint;
  param length in [20, 40] cm;
  dof q: revolute z in [-140, 140] deg rate in [-4, 4] rad/s effort <= 6 N*m;
  drive q: gear 50 rotor 1e-5 kg*m^2 viscous 0.1 N*m*s;
  port in: Pin male;
  port out: Pin female;
  frame turned = in * rot(z, q);
  frame out = turned * move(x, length);
  rod(frame: turned, axis: x, length: length, density: 1 kg/m, radius: 2 cm);
}

module Hand { role effector; port in: Pin male; point(frame: in, mass: 99 g); effector(frame: in); }
module Cap { role link; port in: Shoulder male; }

grammar Arms from ports {
  start Torso;
  with Motor, Driven, Hand, Cap;
  accept count(Hand) == 2;
}

workspace Table {
  plane xy;
  bounds box [-1.5, 1.5] x [-1.5, 1.5] m;
  region Tray box [0.45, 0.6] x [0.2, 0.4] m;
  target Jig box [0.2, 0.35] x [0.5, 0.65] m;
  region Side box [0.3, 0.6] x [-0.6, -0.45] m;
}

task Both {
  robot Arms;
  workspace Table;
  start in Tray by effector 1 at rest;
  reach Jig by effector 1;
  satisfy eventually Side by effector 2;
  avoid self with body;
  horizon 10 steps of 0.1 s;
  modules <= 7;
}
"""
"""A base with two mounts, sizes and genders, motors with states, drives, a cap for the rest."""


@pytest.fixture
def kit(tmp_path: Path) -> Path:
    path = tmp_path / "two.srg"
    path.write_text(KIT, encoding="utf-8")
    return path


def test_the_robots_of_the_kit(kit: Path, srgc: Run) -> None:
    """By hand: an arm is a motor, any number of driven joints and a hand."""
    arms = [f"Motor {'Driven ' * n}Hand" for n in range(3)]
    due = sorted(
        (f"Torso {left} {right}" for left in arms for right in arms),
        key=lambda word: len(word.split()),
    )
    printed = srgc("words", kit, "--max-length", 7).out.splitlines()
    assert set(printed) == {word for word in due if len(word.split()) <= 7}


SMALLEST = ["Torso", "Motor", "Hand", "Motor", "Hand"]
VIEWS = [
    *(["graph", "{}", "--of", kind] for kind in ("sra", "dfa", "dpda", "words", "grammar")),
    ["graph", "{}", "--of", "robot", "--word", " ".join(SMALLEST)],
    ["language", "{}"],
    ["accepts", "{}", "--trace", "--", *SMALLEST],
    ["words", "{}", "--count", "--max-length", "12"],
    ["model", "{}", "--task", "Both", "--word", " ".join(SMALLEST)],
    ["compare", "{}", "Arms", "Arms"],
    ["plan", "{}"],
]


@pytest.mark.parametrize("view", VIEWS, ids=lambda view: " ".join(view[:4]))
def test_all_views_are_those_of_the_grammar_it_stands_for(
    view: list[str], kit: Path, srgc: Run, tmp_path: Path
) -> None:
    text = expanded(load(kit))
    assert "from ports" not in text
    (tmp_path / "again.srg").write_text(text, encoding="utf-8")
    first, second = (
        srgc(*(part.format(path) for part in view)) for path in (kit, tmp_path / "again.srg")
    )
    assert (first.status, first.out) == (second.status, second.out)
    assert first.status == 0
    assert first.out


def test_it_is_not_ambiguous(kit: Path, srgc: Run) -> None:
    assert "ambiguous:          no" in srgc("language", kit).out


@pytest.mark.parametrize("as_text", some(["kit", "expanded"], 1))
def test_a_design_is_found_and_proved(as_text: str, kit: Path, srgc: Run, tmp_path: Path) -> None:
    if as_text == "expanded":
        kit.write_text(expanded(load(kit)), encoding="utf-8")
    out = tmp_path / "out"
    assert srgc("synth", kit, "-o", out, "-q").status == 0
    assert srgc("verify", out, "-q").status == 0
    word = json.loads((out / "design.json").read_text(encoding="utf-8"))["word"]
    assert word == ["Torso", *(2 * ["Motor", "Driven", "Hand"])]


@pytest.mark.slow
def test_an_arm_is_changed_and_the_rest_kept(kit: Path, srgc: Run, tmp_path: Path) -> None:
    clause = "from Torso Motor Hand Motor Hand;"
    kit.write_text(KIT.replace("modules <= 7;", f"modules <= 7;\n  {clause}"), encoding="utf-8")
    ran = srgc("synth", kit, "-o", tmp_path / "out", "-q")
    assert ran.status == 0
    assert "2 modules added, 0 removed" in ran.out
    assert srgc("verify", tmp_path / "out", "-q").status == 0

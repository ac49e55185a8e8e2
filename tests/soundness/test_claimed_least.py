"""Objectives where a least value is easily claimed wrongly: what is claimed is what is true."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.least_specs import least, link, spec
from tests.oracles.result_files import alter, read

pytestmark = pytest.mark.usefixtures("without_pictures")

SPECS = Path(__file__).parents[2] / "specs"
ARMS = "matches Base eps Joint eps (A eps | B eps)+ Hand"
TWO = {"a": ("eps A", link("0.5 m", "1 kg")), "b": ("eps B", link("0.25 m", "0.3 kg"))}
PRICES = {"A": "const price = 10;", "B": "const price = 3;"}
NONE = {"A": "", "B": ""}


def proved(*values: str) -> list[tuple[Fraction, Fraction]]:
    """Each is the value and the least."""
    return [(Fraction(value), Fraction(value)) for value in values]


@pytest.mark.parametrize("options", [(), ("--no-lemmas",)])
@pytest.mark.parametrize("before", ["", "modules then "])
def test_words_with_derivations_of_several_masses(
    before: str, options: tuple[str, ...], tmp_path: Path
) -> None:
    blocks = {
        f"{name.lower()}{number}": (f"eps {name}", link(length, f"{mass} kg"))
        for name, length, masses in [("A", "0.2 m", (1, 5)), ("B", "0.3 m", (2, 6)),
                                     ("C", "0.5 m", (10, 7))]
        for number, mass in enumerate(masses)
    }  # fmt: skip
    text = spec(
        {"A": "", "B": "", "C": ""}, blocks, f"modules <= 4; minimize {before}mass;",
        accept="matches Base eps Joint eps (A | B | C) eps Hand",
    )  # fmt: skip
    expected = proved("4", "7") if before else proved("7")
    assert least(text, tmp_path, *options)[0] == expected


@pytest.mark.parametrize("carried", ["payload 2 kg by effector 1;", ""])
def test_loads_are_no_part_of_the_mass(carried: str, tmp_path: Path) -> None:
    text = spec(NONE, TWO, f"{carried} modules <= 5; minimize mass;", accept=ARMS)
    assert least(text, tmp_path)[0] == proved("3/5")


def test_masses_that_attributes_pass_on(tmp_path: Path) -> None:
    """Each link weighs as many kilograms as there are links before it, and one more."""
    step = "this.frame = Arm.frame * move(x, {0}); this.size = Arm.size + 1;"
    body = "point(frame: Arm.frame * move(x, {0}), mass: Arm.size * 1 kg);"
    blocks = {
        label: (f"eps {label.upper()}", (step + body).format(length))
        for label, length in [("a", "25 cm"), ("b", "10 cm")]
    }
    text = spec(NONE, blocks, "modules <= 6; minimize mass;", accept=ARMS)
    text = text.replace("this.frame = world;", "this.frame = world; this.size = 1;")
    for module in ("rot(z, Joint.q);", "hand { this.frame = Arm.frame;"):
        text = text.replace(module, f"{module} this.size = Arm.size;")
    assert least(text, tmp_path)[0] == proved("3")


def test_a_module_twice_in_a_production(tmp_path: Path) -> None:
    blocks = {
        "a": ("eps A eps A", link("0.5 m", "1 kg")),
        "b": ("eps B", link("0.25 m", "0.6 kg")),
    }
    assert least(spec(NONE, blocks, "modules <= 6; minimize mass;"), tmp_path)[0] == proved("1")


def test_parameters_that_nothing_else_reads(tmp_path: Path) -> None:
    """The least of a robot is the sum of the least values of its parameters."""
    prices = {"A": "param price in [10, 20];", "B": "param price in {8, 3};"}
    text = spec(prices, TWO, "modules <= 5; minimize sum(price);", accept=ARMS)
    (((value, low),), _) = least(text, tmp_path)
    assert low == 6
    assert 6 <= value <= 20


def test_a_default_bound_on_modules_is_stated(tmp_path: Path) -> None:
    """Ever more modules may weigh ever less: no more is said than what was searched."""
    blocks = {
        "a": ("eps A", link("0.01 m", "0 kg")),
        "b": ("eps B", link("0.5 m", "0.3 kg")),
    }
    accept = "matches Base eps Joint eps A eps (A eps)* B eps Hand"
    values, report = least(spec(NONE, blocks, "minimize mass;", accept=accept), tmp_path)
    assert values == proved("3/10")
    assert report.conditions[-1].name == "mass 0.3 kg: no robot with up to 12 modules has less"


def test_no_bound_on_modules(tmp_path: Path) -> None:
    text = spec(PRICES, TWO, "minimize sum(price) within 50 % then mass;", accept=ARMS)
    values, report = least(text, tmp_path)
    assert values == proved("6", "3/5")
    said = [each.name for each in report.conditions[-2:]]
    assert said == [
        "price 6: no robot has less",
        "mass 0.6 kg: no robot with price up to 9 has less",
    ]


def test_irrational_masses(tmp_path: Path) -> None:
    """The stated value is not below the true one, so that the robot is within it."""
    blocks = {"a": ("eps A", link("0.5 m", "sqrt(2) * 1 kg")), "b": TWO["b"]}
    text = spec(NONE, blocks, "modules <= 4; minimize mass then modules;", accept=ARMS)
    (mass, modules), _ = least(text, tmp_path)
    assert mass[0] ** 2 >= 2 >= mass[1] ** 2
    assert modules == (4, 4)

    def lower(content: dict[str, Any]) -> None:
        (claim,) = (c for c in content["claims"] if c["kind"] == "objectives")
        below = str(mass[0] - Fraction(2, 10**9))
        claim["values"][0] |= {"value": below, "least": below}

    (tmp_path / "out" / "design.json").unlink()
    alter(tmp_path / "out", lower, sign=True)
    report = verify_directory(tmp_path / "out")
    assert report.outcome is Outcome.REFUTED
    assert (report.reason or "").startswith("`mass` is about 1.414213563, not 1.414213561")


def test_nothing_is_proved_of_efforts(tmp_path: Path) -> None:
    text = spec(
        PRICES, TWO, "modules <= 5; minimize effort within 50 % then sum(price);", accept=ARMS
    )
    (effort, price), _ = least(text, tmp_path)
    assert 0 == effort[1] < effort[0] < 1
    assert price == (6, 6)


OTHER_TASKS = {
    "robust": ("control open loop;", "robust start 0.5 deg;"),
    "formula": ("reach Shelf;", "satisfy eventually Shelf;"),
    "avoiding": ("reach Shelf;", "reach Shelf; avoid Wall with body;"),
    "gravity": ("reach Shelf;", "reach Shelf; gravity (0, -9.81) m/s^2;"),
    "given": (
        "reach Shelf;",
        "reach Shelf; from Base eps Joint eps A eps Hand;",
    ),
}


@pytest.mark.parametrize("name", OTHER_TASKS)
def test_other_tasks(name: str, tmp_path: Path) -> None:
    text = spec(PRICES, TWO, "modules <= 5; minimize sum(price);", accept=ARMS)
    text = text.replace(*OTHER_TASKS[name])
    text = text.replace(
        "  region Shelf", "  obstacle Wall box [-1, -0.9] x [0, 1] m;\n  region Shelf"
    )
    assert least(text, tmp_path)[0] == proved("6")


def test_values_that_the_existing_robot_fixes(tmp_path: Path) -> None:
    """What is kept costs what it costs; only new modules may cost less."""
    prices = {"A": "param price in [10, 20];", "B": "const price = 30;"}
    origin = "from Base eps Joint eps A eps Hand fixed A.price = 18;"
    text = spec(prices, TWO, f"{origin} modules <= 4; minimize sum(price);", accept=ARMS)
    (((value, low),), _) = least(text, tmp_path)
    assert value == 18
    assert low in (10, 18)


@pytest.mark.slow
def test_lemmas_about_variants(tmp_path: Path) -> None:
    """Arms behind a wall, whatever they weigh and however they bend; a tower stands beyond it."""
    text = (SPECS / "walled_arm.srg").read_text(encoding="utf-8")
    prices = {"B": 1, "JO": 20, "KN": 5, "L": 10, "W": 30, "EN": 2}
    for name, price in prices.items():
        text = text.replace(f"module {name} {{", f"module {name} {{ const price = {price};")
    for before, after in (
        ("module JO", "module Tower { role base; const price = 60; }\nmodule JO"),
        ("base: N -> B;", "base: N -> B;\n  tower: N -> Tower;"),
        ("semantics Arm {", "semantics Arm {\n  tower { this.frame = world * move(y, 1.3 m); }"),
        ("matches B (eps", "matches (B | Tower) (eps"),
        ("region S box [1.8, 2.2] x [-0.1, 0.1] m", "region S box [1.2, 2.2] x [-0.1, 2.0] m"),
        ("modules <= 6;", "modules <= 6; minimize sum(price); control open loop;"),
        ("steps of 0.1 s", "steps of 0.2 s"),
    ):
        assert before in text
        text = text.replace(before, after)
    # Two links fold back to the tower with two knees between them, and not with fewer.
    assert least(text, tmp_path)[0] == proved("92")
    (claim,) = (c for c in read(tmp_path / "out")["claims"] if c["kind"] == "objectives")
    assert "variants" in {each["argument"] for each in claim["lemmas"]}

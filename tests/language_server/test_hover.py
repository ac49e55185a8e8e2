"""Hover against sizes known by hand, and what a production adds against the compiler's dynamics."""

from __future__ import annotations

import re
from fractions import Fraction
from math import pi
from pathlib import Path

import numpy as np
import pytest

from grammar_lang.elaboration.typecheck import EMISSIONS
from srgc.language_server.completions.call_forms import EMISSIONS as FORMS
from srgc.language_server.completions.completion import EMISSION_SNIPPETS
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.hovers.hover import hover, hover_number
from srgc.language_server.hovers.production_physics import AddedPhysics, added_physics
from srgc.language_server.keywords import explained

ROOT = Path(__file__).parents[2]


def analysed(name: str) -> Analysis:
    path = ROOT / "specs" / f"{name}.srg"
    return analyse(str(path), path.read_text(encoding="utf-8"), {})


def told(analysis: Analysis, before: str, word: str) -> str:
    """The hover over a word that stands right after a text."""
    offset = analysis.sources[0].text.index(before + word) + len(before)
    found = hover(analysis, 0, offset)
    assert found is not None
    return str(found.contents.value)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("text", "place", "value"),
    [
        ("param a in [0, 20] cm;", "20", "1/5 m"),
        ("const a = 30 deg;", "30", "0.523599 rad"),
        ("const a = 3 kg/m;", "3", "3 kg/m"),
        ("const a = 90 deg/s;", "90", "1.5708 rad/s"),
        ("gravity (0, 981) cm/s^2;", "981", "9.81 m/s^2"),
        ("polytope { x <= 5; y <= 200 } mm;", "5", "0.005 m"),
        ("hull (1, 2) mm, (3, 4) cm", "3", "0.03 m"),
        ("dof q: revolute z in [-1, 1] deg rate in [-2, 5];", "5", None),
        ("start in S; effort <= 3 kg;", "3", "3 kg"),
        ("modules <= 3;", "3", None),
        ("horizon 8 steps of 250 ms;", "250", "0.25 s"),
    ],
)
def test_numbers(text: str, place: str, value: str | None) -> None:
    offset = re.search(rf"(?<![\d.]){re.escape(place)}(?![\d.])", text)
    assert offset is not None
    found = hover_number(text, offset.start())
    if value is None:
        assert found is None
        return
    assert found is not None
    shown = found[0].partition(" = ")[2].partition("\n")[0]
    number, _, unit = value.partition(" ")
    assert shown.endswith(unit)
    last = shown.removesuffix(unit).replace("≈", " ").split()[-1]
    assert Fraction(last) == Fraction(number)


def test_everything_of_the_running_example() -> None:
    analysis = analysed("planar_arm_body")
    assert "used 4 times" in told(analysis, "module ", "L")
    dof = told(analysis, "dof ", "q")
    assert f"{pi:.6g}" in dof
    assert "at most 10 N*m in task `PickAndPlaceWithBody`" in dof
    assert "[0.5, 5] m" in told(analysis, "param ", "length")
    region = told(analysis, "obstacle ", "O")
    assert "[1.7, 3] x [2, 3] m" in region
    assert "area: 1.3 m^2" in region
    assert f"T = {81 * 0.125} s" in told(analysis, "task ", "PickAndPlaceWithBody")
    assert "words are robots" in told(analysis, "  ", "accept")
    assert "N -> N eps L" in told(analysis, "  ", "link:")
    assert hover(analysis, 0, analysis.sources[0].text.index("judged")) is None


@pytest.mark.parametrize(
    ("loop", "means"), [("open loop", "fixed in advance"), ("feedback", "follow what is measured")]
)
def test_the_control_of_a_task(loop: str, means: str) -> None:
    text = (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
    name, _, rest = text.partition("\ntask ")[2].partition(" ")
    start = text.index(f"task {name} {rest[:8]}")
    place = text.index("{", start) + 1
    analysis = analyse("untitled:x", f"{text[:place]} control {loop};{text[place:]}", {})
    assert f"- control: {loop}" in told(analysis, "task ", name)
    assert means in told(analysis, "control ", loop)


def test_a_task_of_any_number_of_steps() -> None:
    text = (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
    name = text.partition("\ntask ")[2].partition(" ")[0]
    text = text.replace("horizon 81 steps of 0.125 s", "horizon at most 60 steps of 0.05 s")
    analysis = analyse("untitled:x", text, {})
    assert "- horizon: at most 60 steps of 0.05 s, 3 s" in told(analysis, "task ", name)
    assert "any number of steps" in told(analysis, "horizon at ", "most")


def test_a_task_for_ever() -> None:
    text = (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
    name = text.partition("\ntask ")[2].partition(" ")[0]
    place = text.index("{", text.index(f"\ntask {name} ")) + 1
    analysis = analyse("untitled:x", f"{text[:place]} repeat;{text[place:]}", {})
    assert "- goes on for ever" in told(analysis, "task ", name)
    assert "a prefix and one loop" in told(analysis, " ", "repeat")


def test_space_has_volumes() -> None:
    text = """workspace W { space xyz; bounds box [0, 9] x [0, 9] x [0, 9] m;
    region Tetra hull (0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1) m; }"""
    analysis = analyse("untitled:x", text, {})
    assert "volume: 1 m^3" in told(analysis, "region ", "Tetra")


def test_a_code_is_explained_where_it_is_found() -> None:
    analysis = analyse("untitled:x", "module B { role bse; }", {})
    shown = told(analysis, "role ", "bse")
    assert "SRG0201" in shown


def evaluated(text: str, **values: float) -> float:
    """The value of a product as the hover writes it; names have a dot in them."""
    python = re.sub(r"([A-Za-z]\w*)\.(\w+)", r"\2", text).replace("^", "**")
    return float(eval(python, {"__builtins__": {}}, values))


def physics_of(label: str) -> AddedPhysics:
    """What a rule of the motor arm adds."""
    program = analysed("motor_arm").program
    assert program is not None
    added = added_physics(program, program.grammars["MotorArm"], label)
    assert added is not None
    return added


def test_the_rod_is_that_of_the_compiler() -> None:
    """One joint and one rod: the mass matrix is the moment of inertia about the beginning."""
    (rod,) = physics_of("link").bodies
    mass = re.fullmatch(r"`(.*)` kg", rod.mass)
    inertia = re.fullmatch(r"`(.*?)` kg\*m\^2 .*, `(.*?)` about its beginning", rod.inertia)
    assert mass is not None
    assert inertia is not None
    length, density = 0.7, 1.2
    assert evaluated(mass[1], length=length) == pytest.approx(length * density)
    assert rod.least == pytest.approx(0.4 * 1.2)
    assert rod.most == pytest.approx(1.2)
    at_end = evaluated(inertia[2], length=length)
    at_centre = evaluated(inertia[1], length=length)
    # Steiner, from the numbers alone.
    assert at_end == pytest.approx(at_centre + length * density * (length / 2) ** 2)
    assert at_end == pytest.approx(mass_matrix_of_one_link(length, density))


def mass_matrix_of_one_link(length: float, density: float) -> float:
    """The second moment of many points on the rod."""
    step = length / 20_000
    places = (np.arange(20_000) + 0.5) * step
    return float(np.sum(places**2) * density * step)


def test_masses_and_coordinates_of_other_productions() -> None:
    tool = physics_of("tool")
    assert [(b.mass, b.inertia) for b in tool.bodies] == [("`0.3` kg", "none")]
    assert tool.effectors == ("`N.frame`",)
    motor = physics_of("motor")
    assert motor.bodies == ()
    assert len(motor.dofs) == 1
    assert any("torque(q)" in law for law in motor.torques)
    assert any("der(current)" in law for law in motor.torques)


def test_every_word_of_the_grammar_is_explained() -> None:
    """The keywords of the parser's tables, each in some item."""
    from grammar_lang.parsing.tables import tables

    words = {word for word in tables().words if word.isidentifier()}
    plain = {"in", "with", "of", "by", "at", "xy", "xyz", "x", "y", "z", "box"}
    items = ("module", "grammar", "semantics", "workspace", "task", "mission")
    unknown = [
        word
        for word in sorted(words - plain)
        if not any(explained(word, item) for item in items) and explained(word, "") is None
    ]
    assert unknown == []


@pytest.mark.parametrize("name", EMISSIONS)
def test_every_emission_is_known_to_the_editor(name: str) -> None:
    """As a keyword, as a form with parameters, and as a snippet that names these."""
    assert explained(name, "semantics")
    parameters = [parameter for parameter, _ in FORMS[name].parameters]
    snippet = EMISSION_SNIPPETS[name]
    assert snippet.startswith(f"{name}(")
    assert set(re.findall(r"(\w+): \$\{", snippet)) <= set(parameters)

"""Neutral parameters: the hypothesis of Theorem 1, decided from the rules, checked on robots."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.neutral_modules.neutral_parameters import NeutralParameters, neutral_parameters
from compiler.neutral_modules.parameter_domains import Value
from compiler.robots.attributes import evaluate
from compiler.robots.robot import RobotModel
from compiler.words.language import language
from compiler.words.structures import derivations_of
from grammar_lang import ir
from grammar_lang.load import load, load_text
from tests.oracles import robots

SPECS = Path(__file__).parents[2] / "specs"
FAMILY = """
module B  {{ role base; }}
module JO {{ role joint; dof q: revolute z in [-1, 1]; }}
module L  {{ role link; {parameters} }}
module EN {{ role effector; }}
edge eps;
grammar G {{
  start N; base: N -> B; joint: N -> N eps JO; link: N -> N eps L; tool: N -> N eps EN;
}}
semantics G {{
  base {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, JO.q); }}
  link {{ {rules} }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
"""
ROD = (
    "this.frame = N.frame * move(x, L.length);"
    "rod(frame: N.frame, axis: x, length: L.length, density: 2 kg/m);"
)
TURNED = (
    "this.frame = N.frame * move(x, L.length) * rot(z, L.angle);"
    "rod(frame: N.frame, axis: x, length: L.length, density: 2 kg/m);"
)
ELBOW = (
    "this.frame = N.frame * move(x, L.a) * move(y, L.b);"
    "rod(frame: N.frame, axis: x, length: L.a, density: 1 kg/m);"
    "rod(frame: N.frame * move(x, L.a), axis: y, length: L.b, density: 1 kg/m);"
)


def program_of(parameters: str, rules: str) -> ir.Program:
    loaded = load_text(FAMILY.format(parameters=parameters, rules=rules), "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program


def link(parameters: str, rules: str) -> NeutralParameters:
    program = program_of(parameters, rules)
    (found,) = (f for f in neutral_parameters(program, program.grammars["G"]) if f.module == "L")
    return found


def at(**values: Fraction | int) -> tuple[tuple[str, Fraction], ...]:
    return tuple((name, Fraction(value)) for name, value in values.items())


@pytest.mark.parametrize(
    ("parameters", "rules", "values"),
    [
        ("param length in [0, 5] m;", ROD, at(length=0)),
        ("param length in {0.5, 0, 2} m;", ROD, at(length=0)),
        ("param length in [0, 5] m; param angle in [-1, 1];", TURNED, at(length=0, angle=0)),
        ("param a in [0, 1] m; param b in [0, 2] m;", ELBOW, at(a=0, b=0)),
        # The density does not matter once the length is zero.
        (
            "param length in [0, 5] m; param density in [1, 2] kg/m;",
            ROD.replace("2 kg/m", "L.density"),
            at(length=0),
        ),
        # A length of 0.5 (s - 1) vanishes at one, not at zero.
        (
            "param s in [1, 3];",
            ROD.replace("L.length", "0.5 m * (L.s - 1)"),
            at(s=1),
        ),
        ("", "this.frame = N.frame;", ()),
    ],
)
def test_values_in_range_at_which_nothing_changes(
    parameters: str, rules: str, values: tuple[tuple[str, Fraction], ...]
) -> None:
    found = link(parameters, rules)
    assert (found.status, found.values) == ("neutral", values)


@pytest.mark.parametrize(
    ("parameters", "rules", "values", "text"),
    [
        ("param length in [0.5, 5] m;", ROD, at(length=0), "its length is in [0.5, 5]"),
        ("param length in {0.5, 2} m;", ROD, at(length=0), "its length is in {0.5, 2}"),
        (
            "param length in [0, 5] m; param angle in [30, 60] deg;",
            TURNED,
            at(length=0, angle=0),
            "its angle is in [0.5",
        ),
        ("param a in [0.1, 1] m; param b in [0, 2] m;", ELBOW, at(a=0, b=0), "a is in [0.1, 1]"),
    ],
)
def test_ranges_that_exclude_the_neutral_values(
    parameters: str, rules: str, values: tuple[tuple[str, Fraction], ...], text: str
) -> None:
    found = link(parameters, rules)
    assert (found.status, found.values) == ("excluded", values)
    assert text in found.text
    assert "Theorem 1 does not apply" in found.text


@pytest.mark.parametrize(
    ("parameters", "rules", "reason"),
    [
        # The right angle of an L-shaped link stays when its arms vanish.
        (
            "param a in [0, 1] m;",
            "this.frame = N.frame * move(x, L.a) * rot(z, 90 deg) * move(x, L.a);",
            "it turns a frame",
        ),
        ("param length in [0, 1] m;", ROD + "point(frame: N.frame, mass: 1 kg);", "it adds mass"),
        (
            "param length in [0, 1] m; const stub = 0.1 m;",
            ROD.replace("move(x, L.length)", "move(x, L.length) * move(x, L.stub)"),
            "it shifts a frame",
        ),
        # As heavy as a metre however short: no value is known for a mass divided by zero.
        (
            "param length in [0, 1] m;",
            ROD.replace("2 kg/m", "2 kg / L.length"),
            "it adds mass",
        ),
        # A capsule without length is a ball.
        (
            "param length in [0, 1] m;",
            ROD.replace("density: 2 kg/m", "density: 2 kg/m, radius: 0.1 m"),
            "it adds mass",
        ),
    ],
)
def test_no_value_is_invented(parameters: str, rules: str, reason: str) -> None:
    found = link(parameters, rules)
    assert (found.status, found.values) == ("not shown", ())
    assert reason in found.reason


def test_joints_bases_and_effectors_have_no_neutral_values() -> None:
    program = program_of("param length in [0, 5] m;", ROD)
    found = neutral_parameters(program, program.grammars["G"])
    assert [f.module for f in found] == ["B", "JO", "L", "EN"]
    status = {f.module: (f.status, f.reason) for f in found}
    assert status["JO"][0] == status["EN"][0] == status["B"][0] == "not shown"
    assert "degree of freedom" in status["JO"][1]
    assert "held" in status["JO"][1]
    assert "effector" in status["EN"][1]


@pytest.mark.parametrize(
    ("reach", "status"),
    [
        ("N.reach + L.length", "neutral"),
        ("N.reach * cos(L.length / 1 m)", "neutral"),
        ("1 m - L.length", "not shown"),
        ("N.reach * (1 m + L.length) / 1 m + 1 m", "not shown"),
    ],
)
def test_a_copied_number_may_be_felt_elsewhere(reach: str, status: str) -> None:
    rules = f"{ROD} this.reach = {reach};"
    text = FAMILY.format(parameters="param length in [0, 5] m;", rules=rules)
    text = text.replace("this.frame = world;", "this.frame = world; this.reach = 0 m;")
    for label in ("joint {", "tool {"):
        text = text.replace(f"  {label}", f"  {label} this.reach = N.reach;")
    loaded = load_text(text, "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    findings = neutral_parameters(loaded.program, loaded.program.grammars["G"])
    (found,) = (f for f in findings if f.module == "L")
    assert found.status == status, found


def test_the_running_example_does_not_fulfil_the_hypothesis() -> None:
    program = load(SPECS / "planar_arm.srg").program
    assert program is not None
    (grammar,) = program.grammars.values()
    by_module = {f.module: f for f in neutral_parameters(program, grammar)}
    assert by_module["L"].status == "excluded"
    assert by_module["L"].values == at(length=0)


def test_a_grammar_without_semantics_has_no_findings() -> None:
    text = "module B { role base; } grammar G { start N; base: N -> B; }"
    program = load_text(text, "g.srg").program
    assert program is not None
    assert neutral_parameters(program, program.grammars["G"]) == []


# --- what is copied ------------------------------------------------------------------------------

CROSSED = """
module B {{ role base; }} module J {{ role joint; dof q: revolute z; }}
module E {{ role effector; }} module Z {{ role link; {parameters} }}
grammar G {{ start R; r: R -> N E; b: N -> B J; {production} }}
semantics G {{
  r {{ effector(frame: N.at); point(frame: N.at * move(x, 1 m), mass: 1 kg);
       point(frame: N.alt, mass: 1 kg); }}
  b {{ this.at = rot(z, J.q) * move(x, 1 m); this.alt = world * move(y, 1 m); }}
  {rules}
}}
"""
LENGTH = "param l in [0, 1] m;"


def rational(value: Value) -> Fraction:
    assert isinstance(value, Fraction)
    return value


def crossed(
    rules: str, parameters: str = LENGTH, production: str = "add: N -> N Z;"
) -> NeutralParameters:
    text = CROSSED.format(rules=f"add {{ {rules} }}", parameters=parameters, production=production)
    loaded = load_text(text, "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    findings = neutral_parameters(loaded.program, loaded.program.grammars["G"])
    (found,) = (f for f in findings if f.module == "Z")
    return found


@pytest.mark.parametrize(
    ("rules", "reason"),
    [
        ("this.at = N.alt * move(x, Z.l); this.alt = N.alt;", "from another one, `alt`"),
        ("this.at = N.alt; this.alt = N.at;", "from another one, `alt`"),
        ("this.at = world * move(x, Z.l); this.alt = N.alt;", "from the world"),
        ("this.at = N.at * N.alt * move(x, Z.l); this.alt = N.alt;", "from several"),
        # Emissions: steps that name no module, and massless points away from the frame.
        (
            (
                "this.at = N.at; this.alt = N.alt; "
                "point(frame: N.at * move(x, 1 m), mass: 1 kg/m * Z.l);"
            ),
            "it shifts a frame",
        ),
        ("this.at = N.at; this.alt = N.alt; point(frame: N.at, mass: 1 kg);", "it adds mass"),
        (
            "this.at = N.at; this.alt = N.alt; point(frame: world, mass: 1 kg/m * Z.l);",
            "on no frame that is copied",
        ),
    ],
)
def test_a_production_has_to_hand_on_what_it_received(rules: str, reason: str) -> None:
    found = crossed(rules)
    assert found.status == "not shown"
    assert reason in found.text


def test_a_massless_point_is_named() -> None:
    found = crossed("this.at = N.at; this.alt = N.alt; point(frame: this.at, mass: 1 kg/m * Z.l);")
    assert (found.status, found.values) == ("neutral", at(l=0))
    assert "points without mass" in found.text


@pytest.mark.parametrize(
    "step",
    [
        "N.at * move(x, Z.l)",
        "world * N.at * move(x, Z.l)",
        # Steps that cancel are the identity together.
        "N.at * rot(z, 90 deg) * move(x, Z.l) * rot(z, -90 deg)",
    ],
)
def test_frames_that_are_copied(step: str) -> None:
    found = crossed(f"this.at = {step}; this.alt = N.alt;")
    assert (found.status, found.values) == ("neutral", at(l=0))


@pytest.mark.parametrize(
    ("production", "rules", "reason"),
    [
        (
            "add: N -> M Z; m: M -> B J; k: M -> N E;",
            (
                "this.at = M.at * move(x, Z.l); this.alt = M.alt;} "
                "m { this.at = rot(z, J.q); this.alt = world; } "
                "k { this.at = N.at * move(x, 1 m); this.alt = N.alt; effector(frame: N.at);"
            ),
            "makes a `N` of a `M`",
        ),
        (
            "add: N -> left:N Z right:N;",
            "this.at = left.at * move(x, Z.l); this.alt = left.alt;",
            "no single part",
        ),
        (
            "add: N -> N Z J;",
            "this.at = N.at * move(x, Z.l) * rot(z, J.q); this.alt = N.alt;",
            "comes with `J`",
        ),
    ],
)
def test_where_the_robot_without_the_production_is_not_known(
    production: str, rules: str, reason: str
) -> None:
    found = crossed(rules, production=production)
    assert found.status == "not shown"
    assert reason in found.text


@pytest.mark.parametrize(
    ("inherited", "status"),
    [("this.up", "neutral"), ("this.up + 1 kg", "not shown")],
)
def test_inherited_attributes_are_copied_too(inherited: str, status: str) -> None:
    text = f"""
    module B {{ role base; }} module J {{ role joint; dof q: revolute z; }}
    module E {{ role effector; }} module Z {{ role link; param l in [0, 1] m; }}
    grammar G {{ start R; r: R -> N E; b: N -> B J; add: N -> N Z; }}
    semantics G {{
      r {{ effector(frame: N.at); N.up = 2 kg; }}
      b {{ this.at = rot(z, J.q); point(frame: this.at * move(x, 1 m), mass: this.up); }}
      add {{ this.at = N.at * move(x, Z.l); N.up = {inherited}; }}
    }}
    """
    loaded = load_text(text, "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    findings = neutral_parameters(loaded.program, loaded.program.grammars["G"])
    assert [f.status for f in findings if f.module == "Z"] == [status]


TURN = "this.at = N.at * rot(z, Z.a); this.alt = N.alt;"


@pytest.mark.parametrize(
    ("domain", "status", "text"),
    [
        ("{90, 180, 270, 360} deg", "neutral", "a = 2*pi"),
        ("[90, 450] deg", "neutral", "a = 2*pi"),
        ("[-400, -300] deg", "neutral", "a = -2*pi"),
        ("[-10, 10] deg", "neutral", "a = 0"),
        ("{90, 180, 270} deg", "excluded", "without a whole turn"),
        ("[361, 719] deg", "excluded", "without a whole turn"),
        ("[1, 6]", "excluded", "without a whole turn"),
        ("[1, 7]", "neutral", "a = 2*pi"),
        # 159155 turns are 1000000.3... rad; the turns next to it are outside.
        ("[1000000, 1000001]", "neutral", "a = 318310*pi"),
        ("[1000001, 1000002]", "excluded", "without a whole turn"),
        # So many turns that not all are looked at.
        ("[1, 10000]", "neutral", "a = 2*pi"),
    ],
)
def test_whole_turns_are_neutral(domain: str, status: str, text: str) -> None:
    found = crossed(TURN, parameters=f"param a in {domain};")
    assert found.status == status
    assert text in found.text


def test_a_half_turn_of_twice_the_angle_is_neutral() -> None:
    rules = TURN.replace("Z.a", "2 * Z.a")
    assert "a = pi" in crossed(rules, parameters="param a in [90, 300] deg;").text
    found = crossed(rules, parameters="param a in [100, 170] deg;")
    assert found.status == "excluded"


def test_a_length_beside_its_only_root_is_excluded() -> None:
    rules = "this.at = N.at * move(x, 2 * Z.l - 3 m); this.alt = N.alt;"
    found = crossed(rules, parameters="param l in [0, 1] m;")
    assert (found.status, found.values) == ("excluded", at(l=Fraction(3, 2)))
    found = crossed(rules, parameters="param l in [0, 2] m;")
    assert (found.status, found.values) == ("neutral", at(l=Fraction(3, 2)))


def test_exclusion_is_claimed_only_where_all_roots_are_known() -> None:
    # It vanishes at 5/2, within the range, and at 1, which is not.
    rules = "this.at = N.at * move(x, (Z.l - 1) * (2 * Z.l - 5) * 1 m); this.alt = N.alt;"
    found = crossed(rules, parameters="param l in [2, 4];")
    assert found.status == "not shown"


# --- the robots themselves -----------------------------------------------------------------------


def robot(program: ir.Program, word: str) -> RobotModel:
    grammar = program.grammars["G"]
    family = language(grammar, program.terminals, program.modules)
    (derivation,) = derivations_of(family, word.split())
    assert grammar.semantics is not None
    return evaluate(derivation, program.modules, grammar.semantics, 2)


@pytest.mark.parametrize(
    ("parameters", "rules"),
    [
        ("param length in [0, 5] m;", ROD),
        ("param length in [0, 5] m; param angle in [-1, 1];", TURNED),
        ("param a in [0, 1] m; param b in [0, 2] m;", ELBOW),
    ],
)
def test_the_longer_robot_at_neutral_values_has_the_same_physics(
    parameters: str, rules: str
) -> None:
    program = program_of(parameters, rules)
    short = robot(program, "B eps JO eps L eps EN")
    long = robot(program, "B eps JO eps L eps L eps EN")
    found = link(parameters, rules)
    neutral = dict(found.values)
    graphs = [robot_graph(replace(model, own=())) for model in (short, long)]
    rng = np.random.default_rng(3)
    for _ in range(10):
        q, v = rng.uniform(-1, 1, 1), rng.uniform(-1, 1, 1)
        theta = rng.uniform(0.2, 1, len(short.parameters))
        added = [float(rational(neutral[p.name])) for p in long.parameters[len(theta) :]]
        both = (theta, np.concatenate([theta, added]))
        for name, columns in (("mass_matrix", (q,)), ("bias", (q, v)), ("effectors", (q,))):
            values = [
                robots.evaluate(graph, name, *columns, parameters)
                for graph, parameters in zip(graphs, both, strict=True)
            ]
            np.testing.assert_allclose(values[0], values[1], rtol=1e-12, atol=1e-12)
        # At any other values of the added link the robot is another one.
        moved = np.concatenate([theta, np.array(added) + 0.1])
        tips = [
            robots.evaluate(graph, "effectors", q, values)
            for graph, values in zip(graphs, (theta, moved), strict=True)
        ]
        assert np.abs(tips[0] - tips[1]).max() > 1e-3


def test_modules_with_bodies_of_their_own() -> None:
    """Frames of a mounted module are put in where they are read: 0 moves and turns nothing."""
    text = """
    module B { role base; port out: F; frame out = in; }
    module L { role link; param length in [0, 1] m; param bend in [-1, 1] rad;
      port in: F; port out: F;
      frame mid = in * move(x, length); frame out = mid * rot(z, bend);
      rod(frame: in, axis: x, length: length, density: 1 kg/m); }
    module E { role effector; port in: F; effector(frame: in); }
    grammar G from ports { start B; with L, E; }
    """
    program = load_text(text, "t").program
    assert program is not None
    found = {each.module: each for each in neutral_parameters(program, program.grammars["G"])}
    assert found["L"].status == "neutral"
    assert dict(found["L"].values) == {"length": 0, "bend": 0}
    fixed = load_text(text.replace("rot(z, bend)", "rot(z, bend + 1)"), "t").program
    assert fixed is not None
    (other,) = (n for n in neutral_parameters(fixed, fixed.grammars["G"]) if n.module == "L")
    assert dict(other.values).get("bend") != 0

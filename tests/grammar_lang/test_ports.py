"""Modules that own their bodies, ports, grammars from ports, and what they stand for."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

import pytest

from compiler.robots.attributes import evaluate
from compiler.robots.normal_form import normalise
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key
from compiler.words.language import language
from compiler.words.structures import structures
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.formatting.expansion import expanded
from grammar_lang.formatting.formatter import canonical
from grammar_lang.load import load_text
from srgc.session import check_loaded
from tests.oracles.brute_force_grammar import words_of
from tests.oracles.random_kits import RandomKit

KIT = """
module Plate { role base; port out: F; frame out = in * move(z, 5 cm); }
module Drive {
  role joint;
  dof q: revolute y in [-90, 90] deg;
  port in: F;
  port out: F;
  frame out = in * rot(y, q) * move(z, 20 cm);
  point(frame: out, mass: 1 kg);
}
module Fork {
  role link;
  port in: F;
  port left: F;
  port right: G;
  frame left = in * rot(x, 30 deg);
  frame right = in * rot(x, -30 deg);
}
module Hand { role effector; port in: F; effector(frame: in); }
module Cap { role link; port in: G; }
grammar Arm from ports { start Plate; with Drive, Fork, Hand, Cap; }
"""


def found(text: str) -> list[tuple[Code, str, str]]:
    """The findings: code, the text at their place, message."""
    return [
        (d.code, text[d.span.start : d.span.end], d.message)
        for d in load_text(text, "t").diagnostics
    ]


def program_of(text: str) -> ir.Program:
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program


def robots(program: ir.Program, dimension: int) -> Iterator[tuple[tuple[str, ...], RobotModel]]:
    """Words of at most six modules with their robots, forty at most."""
    grammar = program.grammars["G"]
    assert grammar.semantics is not None
    words = language(grammar, program.terminals, program.modules)
    for each in islice(structures(words, 6), 40):
        yield each.word, evaluate(each, program.modules, grammar.semantics, dimension)


# --- kits against the same written by hand ------------------------------------------------------


def compare(seed: int) -> None:
    """A random kit, what it expands to, and what an oracle writes by hand."""
    kit = RandomKit(seed)
    loaded = load_text(kit.text, "kit")
    assert loaded.program is not None, (kit.text, loaded.diagnostics)
    text = expanded(loaded)
    assert "from ports" not in text
    assert canonical(text, Sink()) == text
    again, by_hand = program_of(text), program_of(kit.by_hand)
    assert again.grammars == loaded.program.grammars
    assert words_of(loaded.program.grammars["G"], 7) == words_of(by_hand.grammars["G"], 7)
    dimension = 2 if kit.plane else 3
    mine, other = list(robots(loaded.program, dimension)), list(robots(by_hand, dimension))
    assert list(robots(again, dimension)) == mine
    assert [(word, robot_key(normalise(robot))) for word, robot in mine] == [
        (word, robot_key(normalise(robot))) for word, robot in other
    ]
    assert len({word for word, _ in mine}) == len(mine), "a word has one derivation"


@pytest.mark.parametrize("block", range(4))
def test_random_kits(block: int) -> None:
    for seed in range(10 * block, 10 * block + 10):
        compare(seed)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(15))
def test_three_hundred_random_kits(block: int) -> None:
    for seed in range(1000 + 20 * block, 1020 + 20 * block):
        compare(seed)


def test_some_kits_are_rich() -> None:
    """So that the comparison says something."""
    kits = [RandomKit(seed) for seed in range(40)]
    assert sum(kit.plane for kit in kits) > 8
    assert sum(" female" in kit.text for kit in kits) > 20
    assert sum("out1" in kit.text for kit in kits) > 20
    assert sum("dof q" in kit.text for kit in kits) > 20


# --- the grammar ----------------------------------------------------------------------------------


def test_the_productions_of_a_kit() -> None:
    """By hand: a nonterminal for each type, outputs in their order."""
    grammar = program_of(KIT).grammars["Arm"]
    rules = [
        f"{p.label}: {p.left} -> {' '.join(symbol.name for symbol in p.right)}"
        for p in grammar.productions
    ]
    assert rules == [
        "Plate: Robot -> Plate F",
        "Drive: F -> Drive F",
        "Fork: F -> Fork F G",
        "Hand: F -> Hand",
        "Cap: G -> Cap",
    ]


def test_names_that_are_taken() -> None:
    """Types have a name space of their own, nonterminals do not."""
    text = KIT.replace(": F;", ": Drive;").replace(": G;", ": Robot;").replace("Cap", "Drive_")
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    grammar = loaded.program.grammars["Arm"]
    assert set(grammar.nonterminals).isdisjoint(loaded.program.terminals)
    assert len(set(grammar.nonterminals)) == 3
    assert load_text(expanded(loaded), "t").program is not None


def test_a_start_that_others_carry_too() -> None:
    text = KIT.replace("role base; port", "role base; port in: F; port").replace(
        "with Drive", "with Plate, Drive"
    )
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    grammar = loaded.program.grammars["Arm"]
    assert [p.label for p in grammar.productions[:2]] == ["Plate_", "Plate"]
    again = load_text(expanded(loaded), "t").program
    assert again is not None
    assert again.grammars == loaded.program.grammars


@pytest.mark.parametrize(
    ("output", "input_", "fits"),
    [
        ("", "", True),
        ("male", "female", True),
        ("female", "male", True),
        ("male", "male", False),
        ("female", "female", False),
        ("", "male", False),
        ("female", "", False),
    ],
)
def test_genders(output: str, input_: str, fits: bool) -> None:
    text = f"""
    module B {{ role base; port out: F {output}; frame out = in; }}
    module H {{ role effector; port in: F {input_}; effector(frame: in); }}
    grammar G from ports {{ start B; with H; }}
    """
    codes = {code for code, _, _ in found(text)}
    assert (Code.OPEN_OUTPUT not in codes) == fits


# --- mistakes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "code", "at"),
    [
        ("frame out = in * move(z, 5 cm);", "", Code.MISSING_FRAME, "out"),
        ("port left: F;", "port in: G;", Code.DUPLICATE_NAME, "in"),
        ("port right: G;", "port right: H;", Code.OPEN_OUTPUT, "H"),
        ("Hand, Cap", "Cap", Code.ENDLESS_PORTS, "Arm"),
        ("rot(y, q) * move(z, 20 cm)", "rot(y, q) * rot(y, q)", Code.BAD_DOF_USE, "q"),
        ("rot(y, q) * move(z, 20 cm)", "move(z, 20 cm)", Code.BAD_DOF_USE, None),
        ("rot(y, q)", "rot(z, q)", Code.BAD_DOF_USE, "q"),
        ("rot(y, q)", "rot(y, Drive.q)", Code.NOT_CONSTANT, "Drive.q"),
        ("rot(y, q)", "rot(y, 2 * q)", Code.BAD_DOF_USE, "q"),
        ("in * rot(y, q)", "world * rot(y, q)", Code.LOOSE_FRAME, None),
        ("in * rot(y, q)", "rot(y, q)", Code.LOOSE_FRAME, "rot(y, q) * move(z, 20 cm)"),
        ("in * rot(y, q)", "rot(y, q) * in", Code.LOOSE_FRAME, None),
        ("in * rot(y, q)", "in * rot(y, q) * in", Code.LOOSE_FRAME, None),
        ("in * move(z, 5 cm)", "move(z, 5 cm)", Code.LOOSE_FRAME, "move(z, 5 cm)"),
        ("effector(frame: in)", "effector(frame: move(z, 1 m))", Code.LOOSE_FRAME, "move(z, 1 m)"),
        ("effector(frame: in)", "effector(frame: world)", Code.LOOSE_FRAME, "world"),
        ("point(frame: out", "point(frame: world * move(z, 1 m)", Code.LOOSE_FRAME, None),
        ("point(frame: out", "point(frame: in * out", Code.LOOSE_FRAME, "in * out"),
        ("frame left = in", "frame left = left", Code.UNKNOWN_NAME, "left"),
        (
            "role link;\n  port in: F;",
            "role link; const in = 3;\n  port in: F;",
            Code.DUPLICATE_NAME,
            "in",
        ),
        ("in * rot(y, q)", "this.in * rot(y, q)", Code.NOT_CONSTANT, "this.in"),
        ("role effector; port in: F;", "role effector;", Code.NO_INPUT, "Hand"),
        ("start Plate;", "", Code.MISSING_START, "Arm"),
        ("start Plate;", "start Plate; start Hand;", Code.REPEATED_CLAUSE, "start Hand;"),
        ("start Plate;", "start F;", Code.UNKNOWN_NAME, "F"),
        ("with Drive,", "with Drive, Drive,", Code.DUPLICATE_NAME, "Drive"),
        ("with Drive,", "with Drvie,", Code.UNKNOWN_NAME, "Drvie"),
        ("start Plate;", "start Plate; a: F -> Hand;", Code.OTHER_GRAMMAR, "a: F -> Hand;"),
        ("frame left =", "frame in =", Code.DUPLICATE_NAME, "in"),
        ("frame left = in", "frame left = right", Code.UNKNOWN_NAME, "right"),
        ("port left: F;", "port left: F; port left: F;", Code.DUPLICATE_NAME, "left"),
        ("mass: 1 kg", "mass: out", Code.SORT_MISMATCH, "out"),
        ("frame: out", "frame: outt", Code.UNKNOWN_NAME, "outt"),
        ("point(frame: out, mass: 1 kg)", "point(frame: out)", Code.BAD_EMISSION, "point"),
    ],
)
def test_one_mistake(old: str, new: str, code: Code, at: str | None) -> None:
    assert KIT.count(old) == 1
    text = KIT.replace(old, new)
    errors = [each for each in found(text) if each[0].value[3:5] != "04" or each[0] is code]
    assert (code, at) in [(each[0], each[1] if at else None) for each in errors], errors


def test_semantics_beside_ports() -> None:
    text = KIT + "semantics Arm { Plate { } }"
    assert (Code.OTHER_GRAMMAR, "Arm") in [each[:2] for each in found(text)]


def test_with_in_a_grammar_of_productions() -> None:
    text = KIT.replace(" from ports", "").replace("start Plate;", "start N; a: N -> Plate;")
    assert Code.OTHER_GRAMMAR in [each[0] for each in found(text)]


def test_modules_that_stand_in_no_robot_are_warned_of() -> None:
    spare = "module Spare { role link; port in: H; }\n"
    ring = "module Ring { role link; port in: G; port on: K; frame on = in; }\n"
    loose = "module Loose { role link; port in: K; port on: K; frame on = in; }\n"
    text = spare + ring + loose + KIT.replace("Cap; }", "Cap, Spare, Ring, Loose; }")
    told = [(code, at) for code, at, _ in found(text)]
    assert (Code.UNUSED_SYMBOL, "Spare") in told
    assert (Code.UNPRODUCTIVE, "Ring") in told
    assert (Code.UNPRODUCTIVE, "Loose") in told


def test_what_a_module_declares_for_nothing() -> None:
    text = KIT.replace("role effector;", "role effector; const c = 1; frame idle = in;")
    assert [(code, at) for code, at, _ in found(text)] == [
        (Code.UNUSED_NAME, "c"),
        (Code.UNUSED_NAME, "idle"),
    ]


# --- mounting by hand -----------------------------------------------------------------------------


def mounted(block: str, right: str = "Plate Drive Hand") -> str:
    modules = KIT.replace(
        "grammar Arm from ports { start Plate; with Drive, Fork, Hand, Cap; }", ""
    )
    grammar = f"grammar M {{ start S; all: S -> {right}; }}"
    return f"{modules} {grammar} semantics M {{ all {{ {block} }} }}"


def test_mounting_is_what_ports_stand_for() -> None:
    block = "Plate.in = world; Drive.in = Plate.out; Hand.in = Drive.out;"
    program = program_of(mounted(block))
    (derivation,) = structures(
        language(program.grammars["M"], program.terminals, program.modules), 4
    )
    semantics = program.grammars["M"].semantics
    assert semantics is not None
    one = evaluate(derivation, program.modules, semantics, 3)
    kit = program_of(KIT)
    words = language(kit.grammars["Arm"], kit.terminals, kit.modules)
    other = next(d for d in structures(words, 4) if d.word == ("Plate", "Drive", "Hand"))
    arm = kit.grammars["Arm"].semantics
    assert arm is not None
    assert robot_key(normalise(one)) == robot_key(normalise(evaluate(other, kit.modules, arm, 3)))


@pytest.mark.parametrize(
    ("block", "code", "at"),
    [
        ("Plate.in = world; Drive.in = Plate.out;", Code.NOT_MOUNTED, "all"),
        ("Plate.in = world; Hand.in = Drive.out;", Code.NOT_MOUNTED, "Drive.out"),
        (
            "Plate.in = world; Drive.in = Plate.out; Hand.in = Drive.out; Plate.in = world;",
            Code.DOUBLE_ATTRIBUTE,
            "Plate.in",
        ),
        ("Plate.in = world; Plate.out = world;", Code.WRONG_KIND, "Plate.out"),
        ("Plate.in = 2 m;", Code.SORT_MISMATCH, "2 m"),
        (
            "Plate.in = Hand.in; Drive.in = Plate.out; Hand.in = Drive.out;",
            Code.CIRCULAR_ATTRIBUTES,
            "Plate.in = Hand.in;",
        ),
        (
            "Plate.in = world; Drive.in = Plate.out * rot(y, Drive.q); Hand.in = Drive.out;",
            Code.BAD_DOF_USE,
            "q",
        ),
    ],
)
def test_mistakes_in_mounting(block: str, code: Code, at: str) -> None:
    assert (code, at) in [each[:2] for each in found(mounted(block))]


def test_two_of_a_kind_are_mounted_apart() -> None:
    block = "Plate.in = world; one.in = Plate.out; Drive2.in = one.out; Hand.in = Drive2.out;"
    program = program_of(mounted(block, "Plate one:Drive Drive Hand"))
    semantics = program.grammars["M"].semantics
    assert semantics is not None
    (derivation,) = structures(
        language(program.grammars["M"], program.terminals, program.modules), 5
    )
    assert len(evaluate(derivation, program.modules, semantics, 3).dofs) == 2


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("start Plate; with Drive", "start Plate; with Drvie"),
        ("port left: F;", "port left: F femal;"),
        ("port out: F; frame out = in * move(z, 5 cm);", "port out: f; frame out = in;"),
        ("frame left = in * rot(x, 30 deg);", "frame left = ;"),
        ("with Drive, Fork, Hand, Cap;", "with Drive, Fork Hand, Cap;"),
        ("with Drive, Fork, Hand, Cap;", "with ;"),
    ],
)
def test_one_mistake_is_told_once(old: str, new: str) -> None:
    """Through all checks: no word of nonterminals that nobody wrote, or of what only follows."""
    assert KIT.count(old) == 1
    found = check_loaded(load_text(KIT.replace(old, new), "t")).diagnostics
    assert len(found) == 1, found


def test_a_kit_without_an_effector() -> None:
    text = KIT.replace("effector(frame: in);", "sphere(frame: in, radius: 1 cm);")
    (found,) = check_loaded(load_text(text, "t")).diagnostics
    assert found.code is Code.NO_EFFECTOR
    assert "block" not in f"{found.message} {found.hint}"

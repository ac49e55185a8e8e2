"""The FRA: its runs are derivations, and their updates define the robot that the chart finds."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path

import pytest

from compiler.robots.attributes import SemanticsError, evaluate
from compiler.robots.robot import RobotModel
from compiler.views.dot import to_dot
from compiler.views.pushdown_views import functional_view, sra_view
from compiler.views.workspace_view import HighlightError
from compiler.words.derivation import Derivation, replay
from compiler.words.functional_automaton import Fra, fra, functional_run, production_labels
from compiler.words.language import Language, language
from compiler.words.pushdown_automaton import sra
from compiler.words.structures import derivations_of
from grammar_lang import ir
from grammar_lang.load import load, load_text
from tests.oracles.grammars import EVERY, arm

SPECS = Path(__file__).parents[2] / "specs"
AMBIGUOUS = """
module B { role base; }
module L { role link; param length in [1, 2] m; }
module EN { role effector; }
edge eps, up;
grammar G {
  start S;
  all: S -> B eps A;
  put: A -> first:A up second:A;
  link: A -> L;
  side: A -> L;
  none: A -> empty_part:E L;
  nothing: E -> empty;
  tool: A -> EN;
}
semantics G {
  all { A.at = this.frame; }
  put { first.at = this.at; second.at = first.tip; this.tip = second.tip; }
  link { this.tip = this.at * move(x, L.length);
         rod(frame: this.at, axis: x, length: L.length, density: 1); }
  side { this.tip = this.at * move(y, 2 * L.length);
         rod(frame: this.at, axis: y, length: L.length, density: 2); }
  none { this.tip = this.at * move(y, -L.length); E.at = this.at; point(frame: this.at, mass: 1); }
  nothing { effector(frame: this.at); }
  tool { this.tip = this.at; effector(frame: this.at); }
}
"""


def family(program: ir.Program) -> tuple[ir.Grammar, Language, Fra]:
    (grammar,) = program.grammars.values()
    found = language(grammar, program.terminals, program.modules)
    return grammar, found, fra(found.srg, found.accept, grammar.semantics or {})


@cache
def spec(name: str) -> ir.Program:
    program = load(SPECS / f"{name}.srg").program
    assert program is not None
    return program


@cache
def ambiguous() -> ir.Program:
    program = load_text(AMBIGUOUS, "g.srg").program
    assert program is not None
    return program


def robot(program: ir.Program, derivation: Derivation) -> RobotModel:
    (grammar,) = program.grammars.values()
    return evaluate(derivation, program.modules, grammar.semantics or {}, 2)


@pytest.mark.parametrize("name", ["planar_arm", "right_linear", "two_arm", "nested"])
def test_the_run_gives_the_robot_that_the_chart_gives(name: str) -> None:
    """The shipped grammars are left-linear, right-linear, branching and nested; none is
    ambiguous."""
    program = spec(name)
    grammar, found, automaton = family(program)
    for word in islice(found.words(max_modules=13), 40):
        run = functional_run(automaton, word)
        assert run is not None
        by_run = replay(grammar, production_labels(run))
        (by_chart,) = derivations_of(found, word)
        assert by_run == by_chart
        assert robot(program, by_run) == robot(program, by_chart)


@pytest.mark.parametrize("rest", ["L", "L up L", "EN up L up EN up L", "L up L up L up EN"])
def test_the_run_of_an_ambiguous_word_gives_one_of_its_robots(rest: str) -> None:
    program = ambiguous()
    grammar, found, automaton = family(program)
    word = ("B", "eps", *rest.split())
    run = functional_run(automaton, word)
    assert run is not None
    derivations = list(derivations_of(found, word))
    robots = [robot(program, derivation) for derivation in derivations]
    assert len(derivations) >= 3
    assert robots[0] != robots[-1]
    assert robot(program, replay(grammar, production_labels(run))) in robots


def test_a_run_of_the_running_example() -> None:
    _, _, automaton = family(spec("planar_arm"))
    run = functional_run(automaton, ("B", "eps", "JO", "eps", "L", "eps", "EN"))
    assert run is not None
    steps = list(run)
    assert (steps[0].transition, steps[0].updates) == (None, ())
    assert steps[0].configuration.stack == ("N", "$")
    assert steps[-1].configuration.stack == ()
    assert steps[-1].configuration.remaining == ()
    assert [(step.label, step.updates) for step in steps if step.updates] == [
        ("tool", ("this.frame = N.frame", "effector(frame: N.frame)")),
        ("link", (
            "this.frame = N.frame * move(x, L.length)",
            "rod(frame: N.frame, axis: x, length: L.length, density: 1)",
        )),
        ("joint", ("this.frame = N.frame * rot(z, JO.q)",)),
        ("base", ("this.frame = world",)),
    ]  # fmt: skip
    by_label = {step.label: step.configuration for step in steps[1:] if step.label is not None}
    assert by_label["tool"].stack == ("N", "eps", "EN", "$")
    assert by_label["base"].remaining == ("B", "eps", "JO", "eps", "L", "eps", "EN")


def test_its_pushdown_automaton_is_the_sra() -> None:
    grammar, found, automaton = family(spec("two_arm"))
    assert automaton.pda == sra(found.srg, found.accept)
    for transition in automaton.pda.transitions:
        assert bool(automaton.updates(transition)) == (transition.label is not None)
    assert list(automaton.semantics) == [p.label for p in grammar.productions]


@pytest.mark.parametrize("word", ["", "B", "B eps EN", "B eps JO eps", "B eps Q eps EN"])
def test_no_run_of_a_word_that_is_not_accepted(word: str) -> None:
    _, _, automaton = family(spec("planar_arm"))
    assert functional_run(automaton, word.split()) is None


def test_a_production_without_semantics_is_refused() -> None:
    grammar, found, _ = family(spec("planar_arm"))
    blocks = dict(grammar.semantics or {})
    del blocks["link"]
    with pytest.raises(ValueError, match="production link has no semantics"):
        fra(found.srg, found.accept, blocks)


def test_a_long_run() -> None:
    program = spec("planar_arm")
    _, _, automaton = family(program)
    word = ("B", *("eps", "JO", "eps", "L") * 1000, "eps", "EN")
    run = functional_run(automaton, word)
    assert run is not None
    assert production_labels(run) == ("tool", *("link", "joint") * 1000, "base")


# --- the picture --------------------------------------------------------------------------------


def test_the_picture_is_that_of_the_sra_with_updates() -> None:
    program = spec("two_arm")
    grammar, found, _ = family(program)
    word = next(found.words())
    picture = functional_view(program, grammar, word)
    plain = sra_view(sra(found.srg, found.accept), word)
    assert picture.nodes == plain.nodes
    assert [(e.tail, e.head, e.highlighted) for e in picture.edges] == [
        (e.tail, e.head, e.highlighted) for e in plain.edges
    ]
    lines = picture.caption
    at = lines.index("longer: ε, Arm → JO eps L eps Arm")
    assert [*lines[at + 1 : at + 4]] == [
        "↳ this.turned = this.at * rot(z, JO.q)",
        "↳ Arm.at = this.turned * move(x, L.length)",
        "↳ rod(frame: this.turned, axis: x, length: L.length, density: L.density)",
    ]
    # every production once, in the order of the grammar, and on each edge by name
    named = [line.split(":")[0] for line in lines if not line.startswith(("↳", "left out"))]
    assert named == [production.label for production in grammar.productions]
    for edge in picture.edges:
        labels = [move.label for move in edge.data["moves"] if move.label is not None]
        said = " ".join(edge.lines).removeprefix("apply ")
        assert all(label in said for label in labels)
    assert "beam: ε, Robot → B eps W eps T [ left:Arm ] [ right:Arm ]" in lines
    assert "↳ left.at = this.turned * move(y, T.reach) * rot(z, 90 deg)" in lines
    assert to_dot(picture).startswith('digraph "fra"')
    assert to_dot(picture) == to_dot(functional_view(program, grammar, word))


def test_updates_are_shown_as_they_are_written() -> None:
    """On one line, without comments, with names and units; numbers where no text is known."""
    text = AMBIGUOUS.replace(
        "this.tip = this.at * move(y, 2 * L.length);",
        """this.tip = this.at // up
            * move( y,  /* twice; */ (50 cm + 150 cm) *
              L.length / (1 m) );""",
    )
    program = load_text(text, "g.srg").program
    assert program is not None
    (grammar,) = program.grammars.values()
    shown = functional_view(program, grammar).caption
    at = shown.index("side: ε, A → L")
    assert shown[at + 1] == "↳ this.tip = this.at * move( y, (50 cm + 150 cm) * L.length / (1 m) )"
    assert "put: ε, A → first:A up second:A" in shown
    assert "nothing: ε, E → ε" in shown
    bare = replace(program, sources=())
    shown = functional_view(bare, grammar).caption
    assert shown[at] == "side: ε, A → L"
    assert shown[at + 1] == "↳ this.tip = this.at * move(y, 2 * L.length / 1)"


def test_no_picture_of_a_word_that_is_not_accepted() -> None:
    program = spec("planar_arm")
    (grammar,) = program.grammars.values()
    with pytest.raises(HighlightError):
        functional_view(program, grammar, ("B", "eps", "EN"))


def test_no_picture_without_semantics() -> None:
    with pytest.raises(SemanticsError, match="`PlanarArm` has no semantics"):
        functional_view(spec("planar_arm"), arm(EVERY))

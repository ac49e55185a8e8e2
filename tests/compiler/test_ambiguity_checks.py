from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from compiler.checks.grammar_checks import grammar_diagnostics
from compiler.words.ambiguity import ambiguity
from compiler.words.language import language, longest_word
from compiler.words.structures import derivations_of
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from grammar_lang.load import load
from tests.oracles.grammars import grammar

MODULES = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-90, 90] deg; }
module L { role link; param length in [1, 2] m; }
module E { role effector; }
edge eps;
"""
FRAME = """\
grammar Frame {
  start N;
  base:  N -> B;
  along: N -> N eps L;
  aside: N -> N eps L;
  turn:  N -> N eps J;
  tool:  N -> N eps E;
}
semantics Frame {
  base  { this.frame = world; }
  along { this.frame = N.frame * move(x, L.length); }
  aside { this.frame = N.frame * %s; }
  turn  { this.frame = N.frame * rot(z, J.q); }
  tool  { this.frame = N.frame; effector(frame: N.frame); }
}
"""
Program = Callable[[str], ir.Program]


@pytest.fixture
def program(tmp_path: Path) -> Program:
    def of(text: str) -> ir.Program:
        path = tmp_path / "spec.srg"
        path.write_text(MODULES + text, encoding="utf-8")
        loaded = load(path)
        assert loaded.program is not None, loaded.diagnostics
        return loaded.program

    return of


def found(program: ir.Program) -> list[Diagnostic]:
    sink = Sink()
    grammar_diagnostics(program, sink)
    return [d for d in sink.found if d.code in (Code.AMBIGUOUS_GRAMMAR, Code.DIFFERENT_ROBOTS)]


def placed(program: ir.Program, finding: Diagnostic) -> str:
    text = program.sources[finding.span.file].text
    return text[finding.span.start : finding.span.end]


@pytest.mark.parametrize(
    ("step", "code"),
    [
        ("move(y, L.length)", Code.DIFFERENT_ROBOTS),
        ("move(-x, L.length)", Code.DIFFERENT_ROBOTS),
        ("move(x, 2 * L.length)", Code.DIFFERENT_ROBOTS),
        ("rot(z, 1e-9) * move(x, L.length)", Code.DIFFERENT_ROBOTS),
        ("move(x, L.length)", Code.AMBIGUOUS_GRAMMAR),
        # the same length in another expression
        ("move(x, L.length / 2 + L.length / 2)", Code.AMBIGUOUS_GRAMMAR),
        ("move(x, sqrt(L.length^2))", Code.AMBIGUOUS_GRAMMAR),
    ],
)
def test_two_productions_of_one_right_side(program: Program, step: str, code: Code) -> None:
    made = program(FRAME % step)
    (finding,) = found(made)
    assert finding.code is code
    assert finding.severity is Severity.WARNING
    assert "`B eps L" in finding.message
    assert placed(made, finding) == "aside: N -> N eps L;"
    (note,) = finding.notes
    assert made.sources[0].text[note[0].start : note[0].end] == "along: N -> N eps L;"
    assert finding.hint is not None
    assert "`along` or `aside`" in finding.hint


def test_a_later_word_may_be_the_first_with_different_robots(program: Program) -> None:
    # the first ambiguous word, `B eps L eps E`, has equal robots; a tip that is turned has not
    text = """\
grammar G {
  start N;
  base: N -> B;
  link: N -> N eps T;
  tool: N -> N eps E;
  one:  T -> L;
  two:  T -> L;
  pair: T -> J T;
}
semantics G {
  base { this.frame = world; }
  link { T.frame = N.frame; T.turned = 0; this.frame = T.tip; }
  tool { this.frame = N.frame; effector(frame: N.frame); }
  one  { this.tip = this.frame * move(x, L.length); }
  two  { this.tip = this.frame * move(x, L.length) * move(y, this.turned * 1 m); }
  pair { T.frame = this.frame * rot(z, J.q); T.turned = this.turned + 1; this.tip = T.tip; }
}
"""
    made = program(text)
    grammar = made.grammars["G"]
    lang = language(grammar, made.terminals, made.modules)
    first = ambiguity(lang, longest_word(lang)).words[0]
    assert len(list(derivations_of(lang, first))) == 2
    (finding,) = found(made)
    assert finding.code is Code.DIFFERENT_ROBOTS
    assert f"`{' '.join(first)}`" not in finding.message
    assert " J L" in finding.message


def test_without_semantics_it_is_only_ambiguous(program: Program) -> None:
    (finding,) = found(program(FRAME.partition("semantics")[0]))
    assert finding.code is Code.AMBIGUOUS_GRAMMAR


def test_robots_in_space(program: Program) -> None:
    text = FRAME % "move(z, L.length)"
    space = """\
workspace W {
  space xyz;
  bounds box [0, 5] x [0, 5] x [0, 5] m;
  region S box [0, 1] x [0, 1] x [0, 1] m;
  target T box [1, 2] x [0, 1] x [0, 1] m;
}
task Do {
  robot Frame;
  workspace W;
  start in S;
  reach T;
  effort <= 1 N*m;
  horizon 10 steps of 0.1 s;
}
"""
    for made in (program(text), program(text + space)):
        (finding,) = found(made)
        assert finding.code is Code.DIFFERENT_ROBOTS


def test_nested_chains_are_one_robot(program: Program) -> None:
    text = """\
grammar Chain {
  start N;
  tip:  N -> E;
  link: N -> L;
  join: N -> left:N eps right:N;
}
semantics Chain {
  tip  { this.tip = this.frame; this.reach = 0 m; effector(frame: this.frame); }
  link { this.tip = this.frame * move(x, L.length); this.reach = L.length; }
  join { left.frame = this.frame; right.frame = left.tip; this.tip = right.tip;
         this.reach = left.reach + right.reach;
         point(frame: this.tip, mass: 1 kg/m * (left.reach + right.reach)); }
}
"""
    # bodies differ: a point for every `join`, at other places in other derivations
    (finding,) = found(program(text))
    assert finding.code is Code.DIFFERENT_ROBOTS
    without = "\n".join(line for line in text.splitlines() if "point(" not in line)
    (finding,) = found(program(without.replace("right.reach;", "right.reach; }")))
    assert finding.code is Code.AMBIGUOUS_GRAMMAR
    assert "`L eps L eps L`" in finding.message


def test_a_long_word_is_shortened() -> None:
    text = "S -> a S | T\nT -> b " + "a " * 60 + "| U\nU -> b V\nV -> a V | c | empty"
    g = grammar(text, ("a", "b", "c"), ir.StartsWith(("b",)))
    modules = {n: ir.Module(n, "effector", (), ()) for n in "abc"}
    (finding,) = found(ir.Program(modules, ("a", "b", "c"), {"G": g}, {}, {}, ()))
    assert "…` (61 symbols)" in finding.message
    assert len(finding.message) < 150

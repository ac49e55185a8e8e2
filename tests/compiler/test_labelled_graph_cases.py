"""Labelled graphs of robots whose connections were worked out by hand."""

from __future__ import annotations

from collections import Counter
from itertools import islice
from pathlib import Path

import pytest

from compiler.robots.labelled_graph import LabelledGraph, labelled_graph
from compiler.words.language import language
from compiler.words.structures import derivations_of, structures
from grammar_lang import ir
from grammar_lang.load import load, load_text

SPECS = Path(__file__).parents[2] / "specs"
MODULES = """
module B { role base; const height = 1 m; }
module W { role joint; dof q: revolute z; }
module J { role joint; dof q: revolute z; }
module K { role link; const len = 50 cm; const mass = 1 kg; }
module P { role link; param len in [40, 60] cm; }
module L { role link; param length in [1, 2] m; const density = 1 kg/m; }
module C { role link; const mass = 1 kg; }
module E { role effector; const mass = 1 kg; }
module N { role effector; }
edge eps, plug, weld, hook, a, b, c, '|', '[', ']', '(', ')';
"""


def written(grammar: str, rules: str) -> ir.Program:
    semantics = f"semantics G {{ {rules} }}" if rules else ""
    loaded = load_text(f"{MODULES} grammar G {{ start S; {grammar} }} {semantics}", "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program


def graph(grammar: str, rules: str, word: str) -> LabelledGraph:
    program = written(grammar, rules)
    family = language(program.grammars["G"], program.terminals, program.modules)
    (derivation,) = derivations_of(family, word.split())
    return labelled_graph(program, program.grammars["G"], derivation)


def edges(found: LabelledGraph) -> str:
    """The edges in the order of the upper modules: ``B-J [, J-E1``; a module that occurs several
    times has its number."""
    total = Counter(node.module for node in found.nodes)
    seen: Counter[str] = Counter()
    name: dict[int, str] = {}
    for node in found.nodes:
        seen[node.module] += 1
        number = "" if total[node.module] == 1 else str(seen[node.module])
        name[node.place] = f"{node.module}{number}"
    return ", ".join(" ".join((f"{name[e.lower]}-{name[e.upper]}", *e.label)) for e in found.edges)


JAW = "r: S -> B '[' J E ']' '[' K E ']';"
JAW_RULES = """r {
  this.l = this.frame * rot(z, J.q) * move(x, 1 m);
  effector(frame: this.l); point(frame: this.l, mass: E1.mass);
  effector(frame: this.frame * move(-y, K.len));
  point(frame: this.frame * move(-y, K.len), mass: E2.mass);
}"""
JAW_UNNAMED = """r {
  this.l = this.frame * rot(z, J.q) * move(x, 1 m);
  effector(frame: this.l); effector(frame: this.frame * move(-y, 50 cm));
}"""
GRIP = "r: S -> B '[' K J E ']' '[' K J E ']';"
GRIP_RULES = """r {
  this.l = this.frame * move(y, K1.len) * rot(z, J1.q) * move(x, 1 m);
  this.r = this.frame * move(-y, K2.len) * rot(z, J2.q) * move(x, 1 m);
  effector(frame: this.l); point(frame: this.l, mass: E1.mass);
  effector(frame: this.r); point(frame: this.r, mass: E2.mass);
}"""
BEAM = """
beam: S -> B eps W '[' left:Arm ']' K '[' right:Arm ']';
arm: Arm -> J eps E;
"""
BEAM_RULES = """
beam {
  left.at = this.w * move(y, K.len);
  this.w = this.frame * rot(z, W.q);
  right.at = this.w * move(y, -K.len);
}
arm {
  this.e = this.at * rot(z, J.q) * move(x, 1 m);
  effector(frame: this.e); point(frame: this.e, mass: E.mass);
}
"""
SPINE = """
s: S -> B eps X; n: X -> '[' Leg ']' K eps X; m: X -> K; leg: Leg -> J E;
"""
SPINE_RULES = """
s { X.at = this.frame; }
n { X.at = this.at * move(x, K.len); Leg.at = X.at; point(frame: X.at, mass: K.mass); }
m { point(frame: this.at * move(x, K.len), mass: K.mass); }
leg { this.e = this.at * rot(z, J.q) * move(y, 1 m); effector(frame: this.e);
      point(frame: this.e, mass: E.mass); }
"""
LENGTHS = """
s: S -> B a Arm; seg: Arm -> J b Link c Arm; one: Link -> L; two: Link -> L a L; tip: Arm -> E;
"""
LENGTHS_RULES = """
s { Arm.at = this.frame; }
seg { Arm.at = this.at * rot(z, J.q) * move(x, Link.len);
      rod(frame: Arm.at, axis: -x, length: Link.len, density: 1 kg/m); }
one { this.len = L.length; }
two { this.len = L1.length + L2.length; }
tip { effector(frame: this.at); }
"""
LABELS = "s: S -> B plug L weld J hook E;"
LABELS_RULES = """s {
  this.a = this.frame * rot(z, J.q);
  rod(frame: this.a, axis: x, length: L.length, density: 1 kg/m);
  effector(frame: this.a * move(x, L.length));
}"""
RIGHT = """
s: S -> B a X; lj: X -> L a J b Y; jl: X -> J a L b Y; c: Y -> C c X; e: Y -> E;
"""
RIGHT_RULES = """
s { X.at = this.frame; }
lj { Y.at = this.at * rot(z, J.q) * move(x, L.length);
     rod(frame: this.at, axis: x, length: L.length, density: L.density); }
jl { Y.at = this.at * rot(z, J.q) * move(x, L.length);
     rod(frame: this.at, axis: x, length: L.length, density: L.density); }
c { X.at = this.at; point(frame: this.at, mass: C.mass); }
e { effector(frame: this.at); }
"""
BRACKETS = "s: S -> B eps A; a: A -> '[' A ']' eps A; b: A -> J eps A; c: A -> E;"
BRACKETS_RULES = """
s { A.at = this.frame; }
a { A1.at = this.at; A2.at = this.at; }
b { A.at = this.at * rot(z, J.q) * move(x, 1 m); }
c { effector(frame: this.at); }
"""
NEST = """
t: S -> B eps X; f: X -> J '[' X ']' '[' X ']' '[' X ']'; g: X -> '[' '[' X ']' ']' eps X;
e: X -> E;
"""
TWO_BASES = "s: S -> B J E '|' J E B;"
TWO_BASES_RULES = """s {
  this.a = world * rot(z, J1.q) * move(x, 1 m);
  this.b = world * move(x, 3 m) * rot(z, J2.q) * move(x, 1 m);
  effector(frame: this.a); effector(frame: this.b);
  point(frame: this.a, mass: E1.mass); point(frame: this.b, mass: E2.mass);
}"""
MOUNT = "s: S -> B J P C L J N;"
MOUNT_RULES = """s {
  this.a = this.frame * rot(z, J1.q);
  this.b = this.a * move(x, L.length) * rot(z, J2.q);
  rod(frame: this.a, axis: -x, length: P.len, density: 1 kg/m);
  rod(frame: this.a, axis: x, length: L.length, density: 1 kg/m);
  point(frame: this.b, mass: C.mass);
  effector(frame: this.b * move(x, 1 m));
}"""
FINGERS = "B-X1 [, X1-J1, J1-E1, B-X2 [, X2-J2, J2-E2"
ARMS = "B-W eps, X-J1 [, J1-E1 eps, W-X, X-J2 [, J2-E2 eps"
BRANCHES = "B-J1 eps [, J1-E1 eps, B-J2 eps, J2-E2 eps"
BRANCHES_WORD = "B eps [ J eps E ] eps J eps E"


@pytest.mark.parametrize(
    ("grammar", "rules", "word", "wanted"),
    [
        pytest.param(
            JAW, JAW_RULES, "B [ J E ] [ K E ]", "B-J [, J-E1, B-K [, K-E2", id="jaw"
        ),
        pytest.param(
            JAW, JAW_UNNAMED, "B [ J E ] [ K E ]", "B-J [, J-E1, B-K [, K-E2", id="jaw, unnamed"
        ),
        *(
            pytest.param(
                GRIP.replace("K", link), GRIP_RULES.replace("K", link),
                f"B [ {link} J E ] [ {link} J E ]", FINGERS.replace("X", link), id=f"grip {link}",
            )
            for link in "KP"
        ),
        *(
            pytest.param(
                BEAM.replace("K", link), BEAM_RULES.replace("K", link),
                f"B eps W [ J eps E ] {link} [ J eps E ]", ARMS.replace("X", link),
                id=f"beam {link}",
            )
            for link in "KP"
        ),
        pytest.param(
            SPINE, SPINE_RULES, "B eps [ J E ] K eps [ J E ] K eps K",
            "K1-J1 eps [, J1-E1, B-K1, K2-J2 eps [, J2-E2, K1-K2, K2-K3 eps", id="spine",
        ),
        pytest.param(
            LENGTHS, LENGTHS_RULES, "B a J b L a L c J b L c E",
            "B-J1 a, J1-L1 b, L1-L2 a, L2-J2 c, J2-L3 b, L3-E c", id="lengths as attributes",
        ),
        pytest.param(
            LABELS, LABELS_RULES, "B plug L weld J hook E", "J-L weld, B-J plug, L-E hook",
            id="labels",
        ),
        pytest.param(
            RIGHT, RIGHT_RULES, "B a L a J b C c J a L b E",
            "J1-L1 a, B-J1 a, L1-C b, L1-J2 c, J2-L2 a, L2-E b", id="right-linear",
        ),
        pytest.param(BRACKETS, "", BRANCHES_WORD, BRANCHES, id="brackets alone"),
        pytest.param(BRACKETS, BRACKETS_RULES, BRANCHES_WORD, BRANCHES, id="brackets"),
        pytest.param(
            NEST, "", "B eps J [ E ] [ [ [ E ] ] eps E ] [ E ]",
            "B-J eps, J-E1 [, J-E2 [ [ [, J-E3 eps, J-E4 [", id="nested brackets",
        ),
        pytest.param(
            TWO_BASES, TWO_BASES_RULES, "B J E | J E B",
            "B1-J1, J1-E1, B1-J2 |, J2-E2", id="a base after two chains",
        ),
        pytest.param(
            MOUNT, MOUNT_RULES, "B J P C L J N",
            "B-J1, J1-P, J2-C, J1-L, L-J2, J2-N", id="dead ends",
        ),
    ],
)  # fmt: skip
def test_connections(grammar: str, rules: str, word: str, wanted: str) -> None:
    assert edges(graph(grammar, rules, word)) == wanted


def test_a_base_stands_on_nothing() -> None:
    found = graph(TWO_BASES, TWO_BASES_RULES, "B J E | J E B")
    assert found.roots == (0, 6)
    chains = "s: S -> B J N a B J N;"
    rules = """s { effector(frame: rot(z, J1.q) * move(x, 1 m));
                   effector(frame: rot(z, J2.q) * move(x, 1 m)); }"""
    for given in (rules, ""):
        found = graph(chains, given, "B J N a B J N")
        assert edges(found) == "B1-J1, J1-N1, B2-J2, J2-N2"
        assert found.roots == (0, 4)
    bridge = "s: S -> B J a B L;"
    rules = """s { effector(frame: this.frame * rot(z, J.q) * move(z, B2.height)
                                   * move(x, L.length)); }"""
    assert edges(graph(bridge, rules, "B J a B L")) == "B1-J, J-L"


def test_a_base_of_some_height_is_passed_first() -> None:
    rules = "s { effector(frame: world * move(z, B.height) * rot(z, J.q)); }"
    assert edges(graph("s: S -> J a B;", rules, "J a B")) == "B-J a"


def test_constants_count_however_they_are_written() -> None:
    for length in ("K.len", "-K.len", "2 * K.len - 1 cm", "sqrt(K.len * K.len)", "this.len"):
        rules = f"""
        s {{ this.len = K.len / 2; A.at = this.frame * rot(z, J.q) * move(x, {length}); }}
        n {{ effector(frame: this.at); }}"""
        found = graph("s: S -> B '[' A ']' a K b J; n: A -> N;", rules, "B [ N ] a K b J")
        assert edges(found) == "K-N a, J-K b, B-J ["
    for place in ("(K.len, 0 m)", "(0 m, -K.len)"):
        rules = f"s {{ effector(frame: this.frame * rot(z, J.q) * move({place})); }}"
        assert edges(graph("s: S -> B K J;", rules, "B K J")) == "J-K, B-J"


def test_a_length_that_is_handed_down() -> None:
    """The link is passed where its length is used: after the joint below."""
    grammar = "s: S -> B L a A; j: A -> J b A; n: A -> N;"
    rules = """
    s { A.at = this.frame; A.len = L.length; }
    j { A.at = this.at * rot(z, J.q); A.len = this.len; }
    n { effector(frame: this.at * move(x, this.len)); }"""
    assert edges(graph(grammar, rules, "B L a J b N")) == "J-L a, B-J, L-N b"


def test_a_body_whose_length_comes_from_below_is_a_dead_end() -> None:
    grammar = "s: S -> B a J b Rod c N; r: Rod -> L;"
    rules = """
    s { this.e = this.frame * rot(z, J.q);
        rod(frame: this.e, axis: x, length: Rod.len, density: 1 kg/m);
        effector(frame: this.e * move(x, 1 m)); }
    r { this.len = L.length; }"""
    assert edges(graph(grammar, rules, "B a J b L c N")) == "B-J a, J-L b, J-N c"


def test_a_module_in_brackets_is_not_passed_on_the_way_out() -> None:
    grammar = "s: S -> B; n: S -> S a J '[' N ']';"
    rules = "s { this.frame = world; } n { this.frame = S.frame * rot(z, J.q); }"
    assert edges(graph(grammar, rules, "B a J [ N ] a J [ N ]")) == (
        "B-J1 a, J1-N1 [, J1-J2 a, J2-N2 ["
    )


def test_brackets_that_do_not_balance_are_ignored() -> None:
    grammar = "s: S -> B '[' J '(' L ']' a N;"
    assert edges(graph(grammar, "", "B [ J ( L ] a N")) == "B-J [, J-L (, L-N ] a"
    rules = """s { effector(frame: this.frame * rot(z, J.q) * move(x, L.length)); }"""
    assert edges(graph(grammar, rules, "B [ J ( L ] a N")) == "B-J [, J-L (, L-N ] a"


@pytest.mark.parametrize("name", ["planar_arm", "two_arm", "right_linear", "nested"])
def test_in_the_shipped_families_every_symbol_but_closing_ones_labels_once(name: str) -> None:
    program = load(SPECS / f"{name}.srg").program
    assert program is not None
    (grammar,) = program.grammars.values()
    family = language(grammar, program.terminals, program.modules)
    for each in islice(structures(family, 13), 60):
        found = labelled_graph(program, grammar, each)
        used = Counter(symbol for edge in found.edges for symbol in edge.label)
        due = Counter(symbol for symbol in each.word if symbol not in program.modules)
        del due["]"]
        assert used == due


def test_long_lengths() -> None:
    """A length that comes through five thousand productions."""
    grammar = "s: S -> B a X; m: X -> L b X; e: X -> K;"
    rules = """s { effector(frame: this.frame * move(x, X.len)); }
               m { this.len = L.length + X.len; } e { this.len = K.len; }"""
    program = written(grammar, rules)
    family = language(program.grammars["G"], program.terminals, program.modules)
    word = ["B", "a", *("L", "b") * 5000, "K"]
    (derivation,) = derivations_of(family, word)
    found = labelled_graph(program, program.grammars["G"], derivation)
    assert [(e.lower, e.upper) for e in found.edges] == [(i, i + 2) for i in range(0, 10_002, 2)]

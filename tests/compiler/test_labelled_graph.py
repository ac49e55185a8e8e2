"""Labelled graphs: Figure 1c, trees written by hand, and the frames of the evaluated robot."""

from __future__ import annotations

import random
from collections.abc import Mapping
from functools import cache
from itertools import islice
from pathlib import Path

import pytest

from compiler.expressions.scalars import ParameterLeaf
from compiler.robots.attributes import evaluate
from compiler.robots.labelled_graph import LabelledGraph, labelled_graph
from compiler.robots.robot import Joint, Offset, RobotModel
from compiler.views.dot import to_dot
from compiler.views.family_views import robot_view
from compiler.words.derivation import Derivation, replay
from compiler.words.language import language
from compiler.words.structures import derivations_of, structures
from grammar_lang import ir
from grammar_lang.load import load, load_text

SPECS = Path(__file__).parents[2] / "specs"
FIGURE_1C = "B eps JO eps JO eps JO eps L eps JO eps L eps JO eps EN"
MODULES = """
module B  { role base; }
module JO { role joint; dof q: revolute z in [-1, 1]; }
module L  { role link; param length in [0.5, 5] m; }
module F  { role link; }
module EN { role effector; }
edge eps, '[', ']', up;
"""


@cache
def spec(name: str) -> ir.Program:
    program = load(SPECS / f"{name}.srg").program
    assert program is not None
    return program


def only(program: ir.Program) -> ir.Grammar:
    (grammar,) = program.grammars.values()
    return grammar


def written(grammar: str, semantics: str, modules: str = MODULES) -> ir.Program:
    blocks = f"semantics G {{ {semantics} }}" if semantics else ""
    loaded = load_text(f"{modules} grammar G {{ start S; {grammar} }} {blocks}", "g.srg")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program


def derivation(program: ir.Program, word: str) -> Derivation:
    """The only derivation of a word."""
    family = language(only(program), program.terminals, program.modules)
    (found,) = derivations_of(family, word.split())
    return found


def graph(program: ir.Program, word: str) -> LabelledGraph:
    return labelled_graph(program, only(program), derivation(program, word))


def parents(found: LabelledGraph) -> dict[int, tuple[int, str]]:
    """Per module that stands on another: that one, and the label of the edge; places counted
    among the modules of the word."""
    number = {node.place: i for i, node in enumerate(found.nodes)}
    edges = found.edges
    assert len({edge.upper for edge in edges}) == len(edges)
    return {number[e.upper]: (number[e.lower], " ".join(e.label)) for e in edges}


def modules(found: LabelledGraph) -> str:
    return " ".join(node.module for node in found.nodes)


def chain(size: int, label: str = "eps") -> dict[int, tuple[int, str]]:
    return {i: (i - 1, label) for i in range(1, size)}


# --- the paper ---------------------------------------------------------------------------------


def test_figure_1c() -> None:
    found = graph(spec("planar_arm"), FIGURE_1C)
    assert modules(found) == "B JO JO JO L JO L JO EN"
    assert [node.place for node in found.nodes] == list(range(0, 17, 2))
    assert parents(found) == chain(9)
    assert found.roots == (0,)
    assert (found.nodes[1].input_frame, found.nodes[1].output_frame) == ("JO_1", "JO_2")


def test_every_robot_of_the_running_example_is_the_chain_of_its_word() -> None:
    program, choose = spec("planar_arm"), random.Random(4)
    for size in (1, 2, 3, 5, 8, 13, 400):
        labels = (*choose.choices(("joint", "link", "tool"), k=size - 1), "base")
        found = labelled_graph(program, only(program), replay(only(program), labels))
        assert len(found.nodes) == size
        assert parents(found) == chain(size)


def test_a_robot_of_many_modules() -> None:
    program = spec("planar_arm")
    labels = ("tool", *("link", "joint") * 5000, "base")
    found = labelled_graph(program, only(program), replay(only(program), labels))
    assert parents(found) == chain(10_002)


# --- the shipped branching, right-linear and nested grammars ------------------------------------


def test_the_two_arms_are_a_tree_on_the_base() -> None:
    found = graph(
        spec("two_arm"),
        "B eps W eps T [ JO eps L eps JO eps L eps EN ] [ JO eps L eps EN ]",
    )
    assert modules(found) == "B W T JO L JO L EN JO L EN"
    assert parents(found) == {
        **chain(3), 3: (2, "["), 4: (3, "eps"), 5: (4, "eps"), 6: (5, "eps"), 7: (6, "eps"),
        8: (2, "["), 9: (8, "eps"), 10: (9, "eps"),
    }  # fmt: skip
    assert found.roots == (0,)


def test_right_linear() -> None:
    found = graph(spec("right_linear"), "B eps JO eps L eps JO eps L eps EN")
    assert parents(found) == chain(6)


def test_nested_pairs_stand_on_each_other_from_inside() -> None:
    """The innermost M turns about the base; its L carries the M of the next pair, and so on."""
    found = graph(spec("nested"), "B eps M eps M eps L eps L eps EN")
    assert modules(found) == "B M M L L EN"
    assert parents(found) == {
        2: (0, "eps"), 3: (2, "eps"), 1: (3, "eps"), 4: (1, "eps"), 5: (4, "eps")
    }  # fmt: skip


# --- grammars written for one case --------------------------------------------------------------

ARMS = """
    foot: S -> B eps T;
    fork: T -> JO '[' left:T ']' '[' right:T ']';
    link: T -> L eps T;
    tool: T -> EN;
"""
ARMS_RULES = """
    foot { T.at = this.frame; }
    fork {
      right.at = left.at * rot(z, -1);
      left.at = this.at * rot(z, JO.q);
    }
    link { T.at = this.at * move(x, L.length); rod(frame: this.at, axis: x, length: L.length,
           density: 1); }
    tool { effector(frame: this.at); }
"""
TRUNK = """
    base: S -> B;
    joint: S -> S eps JO;
    arm: S -> S '[' A ']';
    side: S -> S '[' JO eps L up EN ']';
    tool: A -> EN;
    rod: A -> L eps A;
"""
TRUNK_RULES = """
    base { this.frame = world; }
    joint { this.frame = S.frame * rot(z, JO.q); }
    arm { this.frame = S.frame; A.at = S.frame * rot(z, 0.5); }
    side { this.frame = S.frame;
           effector(frame: S.frame * rot(z, JO.q) * move(x, L.length)); }
    tool { effector(frame: this.at); }
    rod { A.at = this.at * move(x, L.length); }
"""
RELATIVE = """
    all: S -> B eps A;
    put: A -> first:A up second:A;
    joint: A -> JO;
    link: A -> L;
    tool: A -> EN;
"""
RELATIVE_RULES = """
    all { effector(frame: world * A.own); }
    put { this.own = first.own * second.own; }
    joint { this.own = rot(z, JO.q); }
    link { this.own = move(x, L.length); }
    tool { this.own = world; }
"""
AGAINST = """
    base: S -> B;
    joint: S -> JO eps S;
    link: S -> L eps S;
    tool: S -> EN eps S;
"""
AGAINST_RULES = """
    base { this.frame = world; }
    joint { this.frame = S.frame * rot(z, JO.q); }
    link { this.frame = S.frame * move(x, L.length); }
    tool { this.frame = S.frame; effector(frame: S.frame); }
"""
IDLE = """
    base: S -> B;
    joint: S -> S eps JO;
    link: S -> S eps L;
    tool: S -> S eps EN;
"""
IDLE_RULES = """
    base { this.frame = world; this.turned = world; }
    joint { this.turned = S.frame * rot(z, JO.q); this.frame = S.frame; }
    link { this.frame = S.frame * move(x, L.length); this.turned = S.turned; }
    tool { this.frame = S.frame; this.turned = S.frame; effector(frame: S.frame); }
"""
STILL = """
    base: S -> B;
    links: S -> S eps F up F eps EN;
    end: S -> '[' S ']' eps F;
"""
STILL_RULES = """
    base { this.frame = world; }
    links { this.frame = S.frame * move(x, 0.5); effector(frame: S.frame * move(x, 0.5)); }
    end { this.frame = S.frame * move(y, 0.1); }
"""
TIPS = """
    robot: S -> B eps A up EN;
    link: A -> L eps A;
    last: A -> L;
"""
TIPS_RULES = """
    robot { this.end = A.tip; A.at = world; effector(frame: A.tip); }
    link { A.at = this.at * move(x, L.length); this.tip = A.tip; }
    last { this.tip = this.at * move(x, L.length); }
"""
GROUNDS = """
    two: S -> one:R eps other:R;
    robot: R -> B up L;
    loose: R -> L;
"""
GROUNDS_RULES = """
    two { }
    robot { effector(frame: move(x, L.length)); }
    loose { effector(frame: move(y, L.length)); }
"""


@pytest.mark.parametrize(
    ("grammar", "rules", "word", "wanted"),
    [
        pytest.param(
            ARMS,
            ARMS_RULES,
            "B eps L eps JO [ L eps EN ] [ JO [ EN ] [ L eps EN ] ]",
            {
                1: (0, "eps"),
                2: (1, "eps"),
                3: (2, "["),
                4: (3, "eps"),
                5: (2, "["),
                6: (5, "["),
                7: (5, "["),
                8: (7, "eps"),
            },
            id="forks",
        ),
        pytest.param(
            TRUNK,
            TRUNK_RULES,
            "B [ L eps EN ] eps JO [ EN ] [ JO eps L up EN ] eps JO",
            {
                1: (0, "["),
                2: (1, "eps"),
                3: (0, "eps"),
                4: (3, "["),
                5: (3, "["),
                6: (5, "eps"),
                7: (6, "up"),
                8: (3, "eps"),
            },
            id="arms on a trunk",
        ),
        pytest.param(
            AGAINST,
            AGAINST_RULES,
            "EN eps L eps EN eps JO eps B",
            {0: (1, "eps"), 1: (2, "eps"), 2: (3, "eps"), 3: (4, "eps")},
            id="against the word",
        ),
        pytest.param(
            IDLE,
            IDLE_RULES,
            "B eps JO eps L eps EN eps JO",
            {1: (0, "eps"), 2: (0, "eps"), 3: (2, "eps"), 4: (3, "eps")},
            id="a joint that moves nothing",
        ),
        pytest.param(
            STILL,
            STILL_RULES,
            "[ B eps F up F eps EN ] eps F",
            {1: (0, "eps"), 2: (1, "up"), 3: (2, "eps"), 4: (3, "eps")},
            id="modules without parameters",
        ),
        pytest.param(
            TIPS,
            TIPS_RULES,
            "B eps L eps L up EN",
            {1: (0, "eps"), 2: (1, "eps"), 3: (2, "up")},
            id="a tip handed back",
        ),
        pytest.param(
            GROUNDS, GROUNDS_RULES, "B up L eps B up L", {1: (0, "up"), 3: (2, "up")}, id="two"
        ),
        pytest.param(
            GROUNDS, GROUNDS_RULES, "L eps B up L", {0: (1, "eps"), 2: (1, "up")}, id="one base"
        ),
        pytest.param(GROUNDS, GROUNDS_RULES, "L eps L", {}, id="no base"),
    ],
)
def test_semantics_say_what_stands_on_what(
    grammar: str, rules: str, word: str, wanted: dict[int, tuple[int, str]]
) -> None:
    found = graph(written(grammar, rules), word)
    assert modules(found).split() == [s for s in word.split() if s[0].isupper()]
    assert parents(found) == wanted


def test_frames_that_lead_back_through_a_module() -> None:
    """Of the two places where L could be, it has the one that does not stand on L."""
    grammar = "s: S -> B eps JO eps L eps A; a: A -> JO;"
    rules = """s { this.out = A.tip * move(x, L.length);
                   A.at = this.frame * rot(z, JO.q) * move(x, L.length); }
               a { this.tip = this.at * rot(z, JO.q); }"""
    assert parents(graph(written(grammar, rules), "B eps JO eps L eps JO")) == chain(4)
    grammar = "s: S -> B eps L eps first:A up second:C; a: A -> JO; c: C -> JO;"
    rules = """s { this.out = first.tip * move(x, L.length) * second.tip;
                   first.at = second.tip * move(x, L.length); }
               a { this.tip = this.at * rot(z, JO.q); }
               c { this.tip = rot(z, JO.q); }"""
    found = graph(written(grammar, rules), "B eps L eps JO up JO")
    assert parents(found) == {1: (0, "eps"), 2: (1, "eps"), 3: (1, "up")}


def test_frames_put_behind_each_other() -> None:
    """However an ambiguous grammar puts the parts together, the chain is that of the word."""
    program = written(RELATIVE, RELATIVE_RULES)
    family = language(only(program), program.terminals, program.modules)
    word = "B eps JO up L up EN up JO up L"
    derivations = list(derivations_of(family, word.split()))
    assert len(derivations) == 14
    for each in derivations:
        found = labelled_graph(program, only(program), each)
        assert parents(found) == {**chain(6, "up"), 1: (0, "eps")}


def test_a_frame_put_behind_itself_is_no_cycle() -> None:
    grammar = "s: S -> B eps A; a: A -> L;"
    rules = "s { effector(frame: A.own * A.own); } a { this.own = move(x, L.length); }"
    assert parents(graph(written(grammar, rules), "B eps L")) == chain(2)


def test_bases_carry_what_comes_after_them() -> None:
    grammar = "s: S -> one:R eps other:R; r: R -> B up P; p: P -> L;"
    rules = "s { } r { effector(frame: P.tip); } p { this.tip = move(x, L.length); }"
    found = graph(written(grammar, rules), "B up L eps B up L")
    assert parents(found) == {1: (0, "up"), 3: (2, "up")}
    assert found.roots == (0, 4)


def test_a_module_without_parameters_stands_at_the_place_nearest_before_it() -> None:
    """EN stands on B where frames reach it from there, and on JO where they come from JO."""
    tool = "a: A -> EN;"
    rules = "a { effector(frame: this.at); }"
    grammar = f"s: S -> B eps one:A up EN up two:A; {tool}"
    between = "s { one.at = this.frame; two.at = this.frame; effector(frame: this.frame); }"
    found = graph(written(grammar, between + rules), "B eps EN up EN up EN")
    assert parents(found) == {1: (0, "eps"), 2: (0, "up"), 3: (2, "up")}
    grammar = f"s: S -> B eps JO '[' A ']' up EN; {tool}"
    beside = "s { A.at = this.frame * rot(z, JO.q); effector(frame: this.frame); }"
    found = graph(written(grammar, beside + rules), "B eps JO [ EN ] up EN")
    assert parents(found) == {1: (0, "eps"), 2: (1, "["), 3: (0, "up")}
    onwards = """s { this.moved = this.frame * rot(z, JO.q); A.at = this.moved;
                     effector(frame: this.moved); }"""
    found = graph(written(grammar, onwards + rules), "B eps JO [ EN ] up EN")
    assert parents(found) == {1: (0, "eps"), 2: (1, "["), 3: (1, "up")}


def test_a_parameter_reaches_a_frame_through_an_attribute_of_its_production() -> None:
    grammar = "s: S -> B eps A up L; a: A -> EN;"
    rules = """s { this.size = 2 * L.length; A.at = this.frame * move(x, this.size); }
               a { effector(frame: this.at); }"""
    assert parents(graph(written(grammar, rules), "B eps EN up L")) == {
        1: (2, "up"), 2: (0, "eps")
    }  # fmt: skip


def test_a_number_may_be_called_frame() -> None:
    grammar = "s: S -> B eps A up EN; a: A -> L;"
    rules = """s { this.frame = A.k; A.at = world; effector(frame: A.tip); }
               a { this.k = 2; this.tip = this.at * move(x, L.length); }"""
    assert parents(graph(written(grammar, rules), "B eps L up EN")) == {
        1: (0, "eps"), 2: (1, "up")
    }  # fmt: skip


def test_frames_that_are_only_copied() -> None:
    grammar = "s: S -> B eps one:A up two:A; a: A -> F C; c: C -> EN; d: C -> JO;"
    rules = """s { one.at = this.frame; two.at = one.at; } a { C.at = this.at; }
               c { effector(frame: this.at); } d { effector(frame: this.at * rot(z, JO.q)); }"""
    assert parents(graph(written(grammar, rules), "B eps F EN up F JO")) == {
        1: (0, "eps"), 2: (1, ""), 3: (0, "up"), 4: (3, "")
    }  # fmt: skip


def test_labels_belong_to_what_joins_two_modules() -> None:
    grammar = "s: S -> B one:A two:A; a: A -> up L eps;"
    rules = """s { one.at = this.frame; two.at = this.frame; }
               a { effector(frame: this.at * move(x, L.length)); }"""
    found = graph(written(grammar, rules), "B up L eps up L eps")
    assert parents(found) == {1: (0, "up"), 2: (0, "eps up")}
    grammar = "s: S -> J L; j: J -> B eps;"
    rules = "s { effector(frame: J.tip * move(x, L.length)); } j { this.tip = world; }"
    assert parents(graph(written(grammar, rules), "B eps L")) == chain(2)
    grammar = "s: S -> L up '[' A ']' eps R; a: A -> EN; r: R -> B;"
    rules = """s { this.tip = R.tip * move(x, L.length); A.at = R.tip; }
               a { effector(frame: this.at); } r { this.tip = world; }"""
    found = graph(written(grammar, rules), "L up [ EN ] eps B")
    assert parents(found) == {0: (2, "up ["), 1: (2, "eps")}


def test_an_empty_branch_leaves_no_label() -> None:
    grammar = "s: S -> B up '[' one:T ']' '[' two:T ']'; t: T -> L; e: T -> empty;"
    rules = """s { one.at = this.frame; two.at = this.frame; }
               t { effector(frame: this.at * move(x, L.length)); } e { }"""
    program = written(grammar, rules)
    assert parents(graph(program, "B up [ ] [ L ]")) == {1: (0, "up [")}
    assert parents(graph(program, "B up [ L ] [ ]")) == {1: (0, "up [")}
    assert parents(graph(program, "B up [ L ] [ L ]")) == {1: (0, "up ["), 2: (0, "[")}


# --- grammars without semantics -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("grammar", "word", "wanted"),
    [
        (ARMS, "B eps JO [ L eps EN ] [ EN ]",
         {1: (0, "eps"), 2: (1, "["), 3: (2, "eps"), 4: (1, "[")}),
        (IDLE, "B eps JO eps L eps EN", chain(4)),
        (TIPS, "B eps L eps L up EN", {1: (0, "eps"), 2: (1, "eps"), 3: (2, "up")}),
        (GROUNDS, "L eps L", {1: (0, "eps")}),
    ],
)  # fmt: skip
def test_without_semantics_the_word_decides(
    grammar: str, word: str, wanted: dict[int, tuple[int, str]]
) -> None:
    assert parents(graph(written(grammar, ""), word)) == wanted


def test_a_module_that_no_frame_passes_stands_on_its_neighbour() -> None:
    grammar = "s: S -> B eps P eps EN; p: P -> L;"
    rules = "s { effector(frame: this.frame); } p { this.size = L.length; }"
    found = graph(written(grammar, rules), "B eps L eps EN")
    assert parents(found) == {1: (0, "eps"), 2: (0, "eps")}
    rules = "s { effector(frame: this.frame * move(x, P.size)); } p { this.size = L.length; }"
    assert parents(graph(written(grammar, rules), "B eps L eps EN")) == chain(3)


# --- the evaluated robot ------------------------------------------------------------------------


def movers(robot: RobotModel) -> dict[int, int | None]:
    """Per module with a degree of freedom or length in some frame: the nearest such module before
    it on the way from the world, as the robot's table of frames has it."""

    def owner(frame: int) -> int | None:
        step = robot.frames[frame].step
        if isinstance(step, Joint):
            return robot.dofs[step.dof].symbols[0]
        if isinstance(step, Offset):
            leaves = [robot.scalars[s] for s in step.vector]
            places = [
                robot.parameters[s.index].symbol for s in leaves if isinstance(s, ParameterLeaf)
            ]
            return places[0] if places else None
        return None

    found: dict[int, int | None] = {}
    for frame in range(1, len(robot.frames)):
        module = owner(frame)
        if module is not None:
            before = [owner(f) for f in robot.chain(frame)[:-1]]
            found[module] = ([None] + [m for m in before if m is not None])[-1]
    return found


def nearest(found: LabelledGraph, module: int, among: Mapping[int, object]) -> int | None:
    """The nearest of some modules that a module stands on."""
    below = {edge.upper: edge.lower for edge in found.edges}
    place = below.get(module)
    while place is not None and place not in among:
        place = below.get(place)
    return place


@pytest.mark.parametrize(
    "program",
    [
        *(pytest.param(spec(n), id=n) for n in ("planar_arm", "two_arm", "right_linear", "nested")),
        pytest.param(written(ARMS, ARMS_RULES), id="forks"),
        pytest.param(written(TRUNK, TRUNK_RULES), id="trunk"),
        pytest.param(written(RELATIVE, RELATIVE_RULES), id="relative"),
        pytest.param(written(AGAINST, AGAINST_RULES), id="against"),
        pytest.param(written(IDLE, IDLE_RULES), id="idle"),
        pytest.param(written(TIPS, TIPS_RULES), id="tips"),
    ],
)
def test_the_graph_has_the_order_of_the_frames(program: ir.Program) -> None:
    grammar = only(program)
    family = language(grammar, program.terminals, program.modules)
    compared = 0
    for each in islice(structures(family, 12), 200):
        found = labelled_graph(program, grammar, each)
        assert [n.place for n in found.nodes] == [
            i for i, symbol in enumerate(each.word) if symbol in program.modules
        ]
        moved = movers(evaluate(each, program.modules, grammar.semantics or {}, 2))
        for module, before in moved.items():
            assert nearest(found, module, moved) == before
        compared += len(moved)
    assert compared > 10


@pytest.mark.parametrize(
    ("grammar", "rules"),
    [
        pytest.param(ARMS, ARMS_RULES, id="forks"),
        pytest.param(TRUNK, TRUNK_RULES, id="trunk"),
        pytest.param(RELATIVE, RELATIVE_RULES, id="relative"),
        pytest.param(AGAINST, AGAINST_RULES, id="against"),
        pytest.param(IDLE, IDLE_RULES, id="idle"),
        pytest.param(TIPS, TIPS_RULES, id="tips"),
    ],
)
def test_a_constant_length_makes_the_graph_of_a_free_one(grammar: str, rules: str) -> None:
    fixed = MODULES.replace("param length in [0.5, 5] m", "const length = 2 m")
    free, constant = written(grammar, rules), written(grammar, rules, fixed)
    family = language(only(free), free.terminals, free.modules)
    for each in islice(structures(family, 10), 60):
        same = replay(only(constant), each.labels)
        assert labelled_graph(free, only(free), each) == labelled_graph(
            constant, only(constant), same
        )


# --- outside ------------------------------------------------------------------------------------


def test_networkx() -> None:
    networkx = pytest.importorskip("networkx")
    found = graph(spec("two_arm"), "B eps W eps T [ JO eps L eps EN ] [ JO eps L eps EN ]")
    made = networkx.DiGraph()
    made.add_nodes_from(node.place for node in found.nodes)
    made.add_edges_from((edge.lower, edge.upper, {"edge": edge.label}) for edge in found.edges)
    assert networkx.is_arborescence(made)
    assert made.edges[0, 2] == {"edge": ("eps",)}
    assert sorted(made.successors(4)) == [6, 13]
    assert {made.edges[4, upper]["edge"] for upper in (6, 13)} == {("[",)}


def test_picture() -> None:
    picture = robot_view(graph(spec("planar_arm"), "B eps JO eps L eps JO eps EN"))
    assert [node.label for node in picture.nodes] == ["B", "JO 1", "L", "JO 2", "EN"]
    assert [(e.tail, e.head, e.lines) for e in picture.edges] == [
        ("m0", "m2", ("eps",)), ("m2", "m4", ("eps",)), ("m4", "m6", ("eps",)),
        ("m6", "m8", ("eps",)),
    ]  # fmt: skip
    assert picture.edges[0].data["output_frame"] == "B_2"
    assert picture.edges[0].data["input_frame"] == "JO_1"
    assert [arrow.head for arrow in picture.initial] == ["m0"]
    assert to_dot(picture).startswith("digraph")

"""Whether robots may have several effectors, against all derivations up to a length."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.robots.effector_counts import several_effectors
from grammar_lang import ir
from grammar_lang.load import load_text
from tests.oracles.some_cases import examples

MODULES = "module B { role base; } module E { role effector; } edge c;"


def grammar_of(productions: str, accept: str = "") -> tuple[ir.Program, ir.Grammar]:
    """The grammar; every E emits an effector, and so does a production labelled ``tool…``."""
    blocks = []
    for line in productions.split(";"):
        label, _, right = line.strip().partition(":")
        if label:
            count = right.split("->")[1].split().count("E") + label.startswith("tool")
            blocks.append(f"{label} {{ {'effector(frame: world);' * count} }}")
    text = f"""{MODULES}
grammar G {{ start S; {productions} {accept} }}
semantics G {{ {" ".join(blocks)} }}"""
    loaded = load_text(text, "t")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program, loaded.program.grammars["G"]


@pytest.mark.parametrize(
    ("productions", "accept", "several"),
    [
        ("a: S -> B;", "", False),
        ("a: S -> B E;", "", False),
        ("a: S -> B E c E;", "", True),
        ("tool: S -> B E;", "", True),
        ("a: S -> B T T; b: T -> E;", "", True),
        ("a: S -> B T; b: T -> E; d: T -> c T;", "", False),
        ("a: S -> B T; b: T -> E; d: T -> c T E;", "", True),
        ("a: S -> B; b: S -> E S T; d: T -> E T;", "", False),  # T derives no word
        ("a: S -> S E; b: S -> B;", "accept count(E) <= 1;", False),
        ("a: S -> S E; b: S -> B;", "accept count(E) <= 2;", True),
        ("a: S -> S E; b: S -> B;", "accept contains E and not contains E E;", False),
        ("a: S -> S E; b: S -> S c; d: S -> B;", "accept not contains E E;", True),
        ("a: S -> S T; b: S -> B; tool: T -> empty;", "accept length == 1;", True),
        ("a: S -> T T; tool: T -> empty;", "", False),  # the empty word is not a robot
    ],
)
def test_several(productions: str, accept: str, several: bool) -> None:
    program, grammar = grammar_of(productions, accept)
    assert several_effectors(program, grammar) is several


def test_without_semantics_nothing_is_known() -> None:
    loaded = load_text(f"{MODULES} grammar G {{ start S; a: S -> B E c; }}", "t")
    assert loaded.program is not None
    assert several_effectors(loaded.program, loaded.program.grammars["G"]) is None


RIGHT = st.lists(st.sampled_from(["B", "E", "c", "S", "T"]), max_size=3)


@settings(max_examples=examples(75, 150), deadline=None)
@given(st.lists(st.tuples(st.sampled_from("ST"), RIGHT), min_size=2, max_size=5), st.integers(0, 3))
def test_all_small_derivations(rules: list[tuple[str, list[str]]], most: int) -> None:
    rules = [("S", ["B", "E", "c"]), ("T", ["c"]), *rules]
    productions = " ".join(
        f"p{k}: {left} -> {' '.join(right) or 'empty'};" for k, (left, right) in enumerate(rules)
    )
    program, grammar = grammar_of(productions, f"accept length <= {most};")
    found = any(word.count("E") > 1 for word in words(rules, most))
    assert several_effectors(program, grammar) is found


def words(rules: list[tuple[str, list[str]]], longest: int) -> Iterator[tuple[str, ...]]:
    """All words up to a length, by the least fixpoint of the sets of words of S and of T."""
    known: dict[str, set[tuple[str, ...]]] = {"S": set(), "T": set()}
    while True:
        before = sum(map(len, known.values()))
        for left, right in rules:
            made: set[tuple[str, ...]] = {()}
            for symbol in right:
                options = known.get(symbol, {(symbol,)})
                made = {a + b for a in made for b in options if len(a + b) <= longest}
            known[left] |= made
        if sum(map(len, known.values())) == before:
            return iter(known["S"])

from __future__ import annotations

import re
from itertools import islice

import pytest

from compiler.automata.pushdown_automaton import linear_automaton, sra
from compiler.languages.language import language
from compiler.views.automaton_dot import dfa_dot, grammar_dot, sra_dot, words_dot
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    TRAPS,
    arm,
    grammar,
)


def labels(dot: str) -> dict[str, str]:
    return dict(re.findall(r'^  (\w+) \[label="((?:[^"\\]|\\.)*)"', dot, re.MULTILINE))


def edges(dot: str) -> list[tuple[str, str, str]]:
    names = labels(dot)
    return [
        (names.get(tail, ""), names.get(head, ""), label)
        for tail, head, label in re.findall(
            r'^  (\w+) -> (\w+)(?: \[label="((?:[^"\\]|\\.)*)"\])?;$', dot, re.MULTILINE
        )
    ]


def test_words_view_is_figure_two() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    dot = words_dot(lang, 3)
    states = {label for key, label in labels(dot).items() if key != "init"}
    grown = ["B"]
    for word in grown:
        if word.count("eps") < 2:
            grown += [f"{word} eps {module}" for module in ("JO", "L", "EN")]
    assert states == set(grown)
    assert len(edges(dot)) == 1 + 12
    assert ("", "B", "") in edges(dot)
    assert ("B eps JO", "B eps JO eps EN", "eps EN") in edges(dot)
    double = set(re.findall(r'label="([^"]*)", peripheries=2', dot))
    assert double == {"B eps JO eps EN"}


def test_words_view_of_other_shapes() -> None:
    nested = language(grammar(TRAPS["counted"], ALPHABET), ALPHABET, frozenset("a"))
    assert edges(words_dot(nested, 2)) == [("", "a b", ""), ("a b", "a a b b", "a b")]
    right = language(grammar("N -> b N | c N | a", ALPHABET), ALPHABET, frozenset(ALPHABET))
    found = edges(words_dot(right, 3))
    assert ("b a", "b c a", "c") in found
    assert ("c a", "b c a", "b") in found
    assert ("a", "b c a", "b c") not in found
    unbounded = language(grammar("N -> a | N b", ALPHABET), ALPHABET, frozenset("a"))
    assert [e[1] for e in edges(words_dot(unbounded, 1))] == ["a", "a b", "a b b"]


def test_automata_views() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    dot = sra_dot(sra(lang.srg, lang.accept))
    assert labels(dot)["s0"] == "q0"
    assert ("", "q0", "N $") in edges(dot)
    assert ("q5", "f", "ε, $ → ε") in edges(dot)
    assert any("ε, N → N eps JO" in label for _, _, label in edges(dot))
    finite = linear_automaton(lang.srg, lang.accept)
    assert finite is not None
    drawn = dfa_dot(finite)
    assert len(labels(drawn)) == 1 + 7
    assert drawn.count("peripheries=2") == 1


def test_quoting() -> None:
    terminals = ('"', "\\", "[", "\\n")
    g = grammar('S -> " S \\ | [ \\n', terminals)
    lang = language(g, terminals, frozenset(terminals))
    assert 'label="[ \\\\n"' in words_dot(lang, 2)
    for dot in (
        words_dot(lang, 4),
        sra_dot(sra(lang.srg, lang.accept)),
        dfa_dot(lang.accept),
        grammar_dot(lang.srg),
    ):
        # Every line is one statement with properly closed strings.
        for line in dot.splitlines():
            assert line.count('"') - line.count('\\"') in (0, 2) or "\\\\" in line
        assert dot.startswith("digraph ")
        assert dot.endswith("}\n")


def test_grammar_view() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    found = edges(grammar_dot(lang.srg))
    assert ("N", "p1", "") in found
    assert [e for e in found if e[0] == "p1"] == [
        ("p1", "N", "1"),
        ("p1", "eps", "2"),
        ("p1", "JO", "3"),
    ]


@pytest.mark.parametrize("name", TRAPS)
def test_views_of_all_shapes(name: str) -> None:
    lang = language(grammar(TRAPS[name], ALPHABET), ALPHABET, frozenset("ab"))
    dot = words_dot(lang, 3)
    states = {label for key, label in labels(dot).items() if key != "init"}
    finite = lang.is_finite(max_modules=3)
    words = lang.words(max_modules=3, max_length=None if finite else 7)
    assert states == {" ".join(w) for w in islice(words, 10_000) if w}
    entered = {e[1] for e in edges(dot)}
    assert entered == states

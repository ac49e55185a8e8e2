from __future__ import annotations

import pytest

from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import srg, trimmed
from compiler.words.regular_ambiguity import STEP_LIMIT, Decision, decide_ambiguity
from compiler.words.regular_automaton import transition_network
from grammar_lang import ir
from tests.oracles.grammars import ALPHABET, EVERY, grammar


def decided(
    text: str, accept: ir.Accept = EVERY, terminals: tuple[str, ...] = ALPHABET
) -> str | None:
    """The first ambiguous word, None where there is none."""
    cfg = trimmed(srg(grammar(text, terminals), terminals, terminals).cfg)
    network = transition_network(cfg)
    assert network is not None
    decision = decide_ambiguity(network, accept_dfa(accept, terminals))
    assert decision is not None
    return None if decision.word is None else " ".join(terminals[s] for s in decision.word)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("S -> a", None),
        ("S -> a | a", "a"),
        ("S -> a S | b S | c", None),
        ("S -> a S | T | b\nT -> a b | c", "a b"),
        ("S -> c S | b | T\nT -> c b | b c", "c b"),
        # the first of several of one length, by the order of the symbols
        ("S -> b a | b a | a c | a c", "a c"),
        # two ways through the empty word only
        ("S -> a X\nX -> empty | Y\nY -> empty", "a"),
        ("S -> X a\nX -> Y | Z\nY -> empty\nZ -> b", None),
        # they part early and meet late
        ("S -> a T | a U\nT -> b T | c\nU -> b V\nV -> b V | c", "a b c"),
        ("S -> T T\nT -> a T | b", None),
        ("S -> T T\nT -> a T | empty", "a"),
    ],
)
def test_the_first_ambiguous_word(text: str, word: str | None) -> None:
    assert decided(text) == word


def test_the_accept_condition_is_respected() -> None:
    text = "S -> a S | T | b\nT -> a b | c"
    assert decided(text, ir.EndsWith(("c",))) is None
    assert decided(text, ir.StartsWith(("a", "a", "a"))) == "a a a b"
    assert decided(text, ir.Count(None, ">", 5)) == "a a a a a b"


def test_long_rivals_are_no_trouble() -> None:
    # two loops of coprime lengths agree first at length 7 * 11
    text = "S -> T | U\nT -> " + "a " * 7 + "T | b\nU -> " + "a " * 11 + "U | c a | b b"
    assert decided(text) is None
    assert decided(text.replace("c a | b b", "b"), ir.Count("a", ">", 0)) == "a " * 77 + "b"


def test_too_many_steps_decide_nothing() -> None:
    size = 200
    assert size**2 > STEP_LIMIT
    one = "a " * size
    text = f"S -> a S | T | U\nT -> {one} T | b\nU -> {one} a U | c"
    cfg = trimmed(srg(grammar(text, ALPHABET), ALPHABET, ALPHABET).cfg)
    network = transition_network(cfg)
    assert network is not None
    assert decide_ambiguity(network, accept_dfa(EVERY, ALPHABET)) is None
    assert Decision(None).word is None

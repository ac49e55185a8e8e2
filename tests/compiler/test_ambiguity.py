from __future__ import annotations

import pytest
from hypothesis import given, settings

from compiler.words.ambiguity import LENGTH_LIMIT, Ambiguity
from compiler.words.ambiguity import ambiguity as ambiguity_of
from compiler.words.grammar import cyclic, trimmed
from compiler.words.language import Language, language, longest_word
from grammar_lang import ir
from tests.oracles.brute_force_grammar import derivations, satisfies, words_of
from tests.oracles.grammars import ALPHABET, EVERY, TRAPS, arm, grammar, random_grammars
from tests.oracles.some_cases import examples

LENGTH = 5


def ambiguity(lang: Language) -> Ambiguity:
    return ambiguity_of(lang, longest_word(lang))


def language_over(g: ir.Grammar, terminals: tuple[str, ...] = ALPHABET) -> Language:
    return language(g, terminals, frozenset(terminals))


def found(text: str, accept: ir.Accept = EVERY) -> Ambiguity:
    return ambiguity(language_over(grammar(text, ALPHABET, accept)))


def several(g: ir.Grammar, word: tuple[str, ...]) -> bool:
    search = derivations(g, word)
    return next(search, None) is not None and next(search, None) is not None


def ambiguous_words(g: ir.Grammar, length: int) -> list[tuple[str, ...]]:
    """Brute force: the accepted ambiguous words up to a length, in order."""
    words = sorted(words_of(g, length) - {()}, key=lambda word: (len(word), word))
    return [word for word in words if satisfies(g.accept, word) and several(g, word)]


@settings(max_examples=examples(30, 150), deadline=None)
@given(random_grammars())
def test_it_agrees_with_brute_force(g: ir.Grammar) -> None:
    lang = language_over(g, ("a", "b"))
    if cyclic(trimmed(lang.srg.cfg)):
        return
    result = ambiguity(lang)
    expected = ambiguous_words(g, LENGTH)
    assert [word for word in result.words if len(word) <= LENGTH] in (expected, expected[:1])
    if expected:
        assert result.words[0] == expected[0]
    for word in result.words[:3]:
        assert satisfies(g.accept, word)
        assert len(word) > 9 or several(g, word)


@pytest.mark.parametrize("name", ["left linear", "odd palindromes", "counted", "not LALR"])
def test_unambiguous_grammars(name: str) -> None:
    assert found(TRAPS[name]).words == ()


def test_without_self_embedding_it_is_decided() -> None:
    assert found(TRAPS["left linear"]) == Ambiguity((), decided=True)
    assert ambiguity(language(arm(), ("B", "JO", "L", "EN", "eps"), "BL")).decided
    # nested but not recursive nonterminals, and both directions in one grammar
    assert found("S -> S b T | T\nT -> a U | a\nU -> c") == Ambiguity((), decided=True)
    assert found("S -> S b T | T\nT -> a T | c").decided
    assert not found(TRAPS["odd palindromes"]).decided


def test_a_finite_language_is_decided_by_its_words() -> None:
    result = found("S -> a S b | a b", ir.Count(None, "<=", 8))
    assert result == Ambiguity((), decided=True)


def test_the_running_example_of_ambiguity() -> None:
    assert found(TRAPS["ambiguous"]).words[0] == ("a", "b", "a", "b", "a")


def test_a_long_ambiguous_word_is_found_where_there_is_no_self_embedding() -> None:
    # a^60 from S itself and from the loop of length 60 in T
    text = "S -> a S | T\nT -> b " + "a " * 60 + "| U\nU -> b V\nV -> a V | c | empty"
    (word,) = found(text, ir.StartsWith(("b",))).words
    assert word == ("b", *"a" * 60)
    assert len(word) > LENGTH_LIMIT


def test_parallel_productions_and_empty_ones() -> None:
    assert found("S -> a | a").words == (("a",),)
    assert found("S -> a X\nX -> empty | Y\nY -> empty").words == (("a",),)
    assert found("S -> X a | b\nX -> empty").words == ()


def test_the_empty_word_is_no_robot() -> None:
    assert found("S -> X | Y | a\nX -> empty\nY -> empty").words == ()


def test_the_accept_condition_hides_ambiguity() -> None:
    assert found("S -> a S | b | c T | c U\nT -> a\nU -> a", ir.Count("c", "==", 0)).words == ()


def test_long_accepted_words_of_an_embedding_grammar_are_looked_at() -> None:
    # no accepted word is short enough for the table of all words
    accept = ir.Count(None, ">=", 25)
    assert found("S -> a S a | b S b | c | a", accept) == Ambiguity((), decided=False)


def test_a_grammar_that_is_lr_is_unambiguous() -> None:
    assert found("S -> a S b S | c | a") == Ambiguity((), decided=True)
    assert found("E -> E b T | T\nT -> a | c E c") == Ambiguity((), decided=True)


def test_many_modules_in_one_place_cost_little() -> None:
    terminals = tuple(f"m{i}" for i in range(300))
    g = grammar("N -> N eps M | M\nM -> " + " | ".join(terminals), (*terminals, "eps"))
    assert ambiguity(language_over(g, (*terminals, "eps"))) == Ambiguity((), decided=True)
    twice = grammar("N -> N eps M | M\nM -> m7 | " + " | ".join(terminals), (*terminals, "eps"))
    result = ambiguity(language_over(twice, (*terminals, "eps")))
    assert result.words[0] == ("m7",)
    assert result.decided

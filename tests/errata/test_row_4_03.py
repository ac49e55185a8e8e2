"""Row 4.3: every word is accepted (A = Z*), or those with an end effector, but not by the rules."""

from __future__ import annotations

from compiler.words.acceptance import accept_dfa
from compiler.words.language import language
from compiler.words.pushdown_automaton import accepts, sra
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, words_of
from tests.oracles.grammars import ARM_MODULES, ARM_TERMINALS, EVERY, arm

MOST = 5
DERIVED = words_of(arm(EVERY), MOST)
WITH_TOOL = {word for word in DERIVED if "EN" in word}


def test_as_printed_grammar_and_automaton_accept_different_words() -> None:
    """Of the 13 words of up to three modules that the rules derive, 6 have an end effector."""
    assert len(DERIVED) == 1 + 3 + 9
    assert len(WITH_TOOL) == 1 + 5
    assert ("B",) in DERIVED - WITH_TOOL


def test_a_condition_binds_both() -> None:
    lang = language(arm(ir.Contains(("EN",))), ARM_TERMINALS, ARM_MODULES)
    assert set(lang.words(max_length=MOST)) == WITH_TOOL
    pda = sra(lang.srg, accept_dfa(ir.Contains(("EN",)), ARM_TERMINALS))
    for word in all_words(ARM_TERMINALS, MOST):
        assert accepts(pda, word) == (word in WITH_TOOL)


def test_without_a_condition_all_words_are_accepted() -> None:
    lang = language(arm(EVERY), ARM_TERMINALS, ARM_MODULES)
    pda = sra(lang.srg, accept_dfa(EVERY, ARM_TERMINALS))
    assert set(lang.words(max_length=MOST)) == DERIVED
    assert all(accepts(pda, word) for word in DERIVED)

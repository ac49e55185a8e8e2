"""One language, read in every way there is: each must say the same of every word."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice
from unittest.mock import patch

import pytest
from hypothesis import given, settings

from compiler.words import lr_automaton as lr
from compiler.words import pushdown_automaton as pushdown_runs
from compiler.words import recogniser as pushdown_reader
from compiler.words import residuals
from compiler.words.deterministic_pushdown import deterministic_pushdown, is_deterministic
from compiler.words.grammar import cyclic, trimmed
from compiler.words.intersection import BinaryGrammar
from compiler.words.language import Language, language
from compiler.words.lr_automaton import LrAutomaton
from compiler.words.pushdown_automaton import Pda, sra
from compiler.words.recogniser import FiniteMembership, PushdownMembership
from compiler.words.residuals import Residuals
from compiler.words.structures import derivations_of
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies, words_of
from tests.oracles.grammars import ALPHABET, ARM_MODULES, ARM_TERMINALS, TRAPS, arm, grammar
from tests.oracles.other_recognisers import NltkChart, PyformlangCyk
from tests.oracles.shaped_grammars import LETTERS, SHAPES
from tests.oracles.some_cases import examples

Word = tuple[str, ...]
MembershipTest = Callable[[Word], bool]
LONGEST = 7
"""Words up to this length are listed, counted and read in the ways that are fast."""
SHORT = 5
"""Words up to this length are read in all ways."""


# --- the ways to read --------------------------------------------------------------------------


def by_residuals(grammar: BinaryGrammar, names: Word) -> MembershipTest:
    """Residual by residual, without a stack."""
    found = Residuals(grammar, names)

    def accepts(word: Word) -> bool:
        residual = found.root
        for name in word:
            try:
                residual = residual[name]
            except KeyError:
                return False
        return residual.accepting

    return accepts


def exact_readers(lang: Language) -> dict[str, MembershipTest]:
    """The readers of the language with its accept condition inside."""
    found: dict[str, MembershipTest] = {
        "itself": lang.accepts,
        "grammar of the product": by_residuals(lang.product, lang.srg.terminals),
    }
    if lang.finite_automaton is not None:
        found["finite automaton by steps"] = lang.finite_automaton.accepts
        found["finite automaton"] = FiniteMembership(lang.finite_automaton).accepts
    return found


def pushdown_readers(lang: Language) -> dict[str, MembershipTest]:
    """The automata with a stack, run by their definition."""
    nondeterministic = sra(lang.srg, lang.accept)
    found: dict[str, MembershipTest] = {"SRA": lambda w: pushdown_runs.accepts(nondeterministic, w)}
    automaton = lang.lr_automaton
    if isinstance(automaton, LrAutomaton):
        pda = deterministic_pushdown(lang.srg, automaton, lang.accept)
        assert isinstance(pda, Pda)
        assert is_deterministic(pda)
        end = pda.alphabet[-1]
        found["deterministic"] = lambda w: pushdown_runs.accepts(pda, (*w, end))
    return found


def grammar_readers(lang: Language) -> dict[str, MembershipTest]:
    """The readers of the grammar alone."""
    names = lang.srg.terminals
    found: dict[str, MembershipTest] = {
        "residuals": by_residuals(lang.normal, names),
        "residuals with unit rules": by_residuals(lang.binary, names),
        "pushdown": PushdownMembership(lang.binary, names).accepts,
        "pushdown without unit rules": PushdownMembership(lang.normal, names).accepts,
    }
    automaton = lang.lr_automaton
    if isinstance(automaton, LrAutomaton):
        found["LR tables"] = lambda w: lr.accepts(automaton, lang.srg.encode(w) or ())
    return found


def check_settings(lang: Language, words: list[Word], derived: set[Word]) -> None:
    """What is remembered, and what is put on the stack, changes no answer."""
    names = lang.srg.terminals
    expected = [w for w in words if w in derived]
    with patch.object(residuals, "CACHE_LIMIT", 3):
        reader = by_residuals(lang.normal, names)
        assert [w for w in words if reader(w)] == expected
        stacked = PushdownMembership(lang.binary, names)
        assert [w for w in words if stacked.accepts(w)] == expected
    for height, limit in ((1, 50_000), (2, 50_000), (3, 50_000), (4, 2), (1, 2)):
        with patch.multiple(pushdown_reader, HEIGHT=height, CACHE_LIMIT=limit):
            stacked = PushdownMembership(lang.binary, names)
            assert [w for w in words if stacked.accepts(w)] == expected, (height, limit)


# --- what is compared --------------------------------------------------------------------------


def of(g: ir.Grammar, terminals: Word = LETTERS, modules: frozenset[str] | None = None) -> Language:
    return language(g, terminals, frozenset(terminals) if modules is None else modules)


def check_agreement(g: ir.Grammar, terminals: Word, longest: int, short: int) -> Language:
    """All readings of a grammar against brute force; the language, for what else is asked."""
    lang = of(g, terminals)
    every = all_words(terminals, longest)
    derived = words_of(g, longest)
    members = [w for w in every if w in derived and satisfies(g.accept, w)]
    for name, reader in exact_readers(lang).items():
        assert [w for w in every if reader(w)] == members, name
    for name, reader in grammar_readers(lang).items():
        assert [w for w in every if reader(w)] == [w for w in every if w in derived], name
    few = [w for w in every if len(w) <= short]
    check_settings(lang, few, derived)
    for name, reader in pushdown_readers(lang).items():
        assert [w for w in few if reader(w)] == [w for w in members if len(w) <= short], name
    # The condition alone, and so the product, is the "and" of both.
    assert [w for w in every if lang.accept.accepts(w)] == [
        w for w in every if satisfies(g.accept, w)
    ]
    # ``all_words`` is in length-lexicographic order.
    assert list(lang.words(max_length=longest)) == members
    by_length = [sum(len(w) == n for w in members) for n in range(longest + 1)]
    assert list(lang.count_words(longest)) == by_length
    if not cyclic(trimmed(lang.srg.cfg)):
        assert [w for w in few if any(True for _ in islice(derivations_of(lang, w), 1))] == [
            w for w in members if len(w) <= short
        ]
    return lang


def check_libraries(g: ir.Grammar, terminals: Word, longest: int) -> None:
    """The same words told by the libraries, by brute force and by ours."""
    lang = of(g, terminals)
    ours = PushdownMembership(lang.binary, terminals)
    chart, table = NltkChart(g), PyformlangCyk(g)
    pda = sra(lang.srg, lang.accept)
    derived = words_of(g, longest)
    for word in all_words(terminals, longest):
        inside = word in derived
        verdicts = {
            "ours": ours.accepts(word),
            "nltk": chart.accepts(word),
            "pyformlang": table.accepts(word),
        }
        assert verdicts == dict.fromkeys(verdicts, inside), word
        both = inside and satisfies(g.accept, word)
        assert lang.accepts(word) == pushdown_runs.accepts(pda, word) == both, word


def check_shape(shape: str, lang: Language) -> None:
    """Grammars made for one way of reading are read in that way."""
    if shape in ("left linear", "right linear"):
        assert lang.finite_automaton is not None
    if shape == "announced":
        assert lang.is_lr


# --- random grammars ---------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES)
def test_all_readings_agree(shape: str) -> None:
    @settings(deadline=None, max_examples=examples(5, 15))
    @given(SHAPES[shape])
    def check(g: ir.Grammar) -> None:
        check_shape(shape, check_agreement(g, LETTERS, LONGEST, SHORT))

    check()


@pytest.mark.parametrize("shape", SHAPES)
def test_libraries_agree(shape: str) -> None:
    @settings(deadline=None, max_examples=examples(3, 6))
    @given(SHAPES[shape])
    def check(g: ir.Grammar) -> None:
        check_libraries(g, LETTERS, 4)

    check()


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_all_readings_agree_at_length(shape: str) -> None:
    @settings(deadline=None, max_examples=200)
    @given(SHAPES[shape])
    def check(g: ir.Grammar) -> None:
        check_shape(shape, check_agreement(g, LETTERS, 9, LONGEST))

    check()


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
def test_libraries_agree_at_length(shape: str) -> None:
    @settings(deadline=None, max_examples=60)
    @given(SHAPES[shape])
    def check(g: ir.Grammar) -> None:
        check_libraries(g, LETTERS, 6)

    check()


# --- chosen grammars ---------------------------------------------------------------------------

CONDITION = ir.AllOf((ir.Count("a", "<=", 3), ir.NotAccept(ir.EndsWith(("c", "c")))))


@pytest.mark.parametrize("name", TRAPS)
def test_all_readings_of_the_traps_agree(name: str) -> None:
    check_agreement(grammar(TRAPS[name], ALPHABET, CONDITION), ALPHABET, 5, 4)


def test_libraries_agree_on_the_traps() -> None:
    for text in TRAPS.values():
        check_libraries(grammar(text, ALPHABET, CONDITION), ALPHABET, 3)


def test_the_running_example() -> None:
    check_agreement(arm(), ARM_TERMINALS, 5, 4)
    lang = of(arm(), ARM_TERMINALS, ARM_MODULES)
    chart, table = NltkChart(arm()), PyformlangCyk(arm())
    for word in islice(lang.words(), 8):
        assert chart.accepts(word)
        assert table.accepts(word)
        assert not chart.accepts(word[:-1])
        assert not table.accepts(word[:-1])

"""What grammar libraries get wrong or cannot do, one test each: here it is right.

Where a library of the tests gives its wrong answer cheaply, the test shows that too.
"""

from __future__ import annotations

import gc
import random
import tracemalloc
from itertools import islice

import lark
import pytest

from compiler.words import recogniser as pushdown_reader
from compiler.words import residuals
from compiler.words.budget import BudgetExceededError
from compiler.words.counting import DerivationCounts
from compiler.words.derivation import replay
from compiler.words.language import Language, language
from compiler.words.lr_automaton import LrConflict
from compiler.words.pushdown_automaton import accepting_run, configurations, sra
from compiler.words.pushdown_automaton import accepts as some_run_accepts
from compiler.words.recogniser import Membership, PushdownMembership
from compiler.words.structures import InfiniteAmbiguityError, derivations_of
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, derivations, satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_TERMINALS,
    EVERY,
    TRAPS,
    grammar,
)

Word = tuple[str, ...]
ARITHMETIC = ("+", "*", "(", ")", "id")
SUMS = "E -> E + E | E * E | ( E ) | id"
BRANCHING = "T -> EN | L T | [ T T ]"
MATCHED = "S -> JO S L | empty"


def of(text: str, terminals: Word = ALPHABET, accept: ir.Accept = EVERY) -> Language:
    return language(grammar(text, terminals, accept), terminals, frozenset(terminals))


def chain(size: int) -> str:
    """Each nonterminal once more or the next one; any may end the word."""
    lines = [f"N{i} -> {ALPHABET[i % 3]} N{i} | N{i + 1} | empty" for i in range(size)]
    return "\n".join([*lines, f"N{size} -> empty"])


def lark_accepts(rules: str, word: str) -> bool:
    try:
        lark.Lark(rules, start="s", parser="lalr").parse(word)
    except lark.exceptions.UnexpectedInput:
        return False
    return True


def all_answers(lang: Language, word: Word) -> tuple[bool, ...]:
    """As the language tells it, by a grammar with the condition inside, and by the SRA."""
    return (
        lang.accepts(word),
        PushdownMembership(lang.product, lang.srg.terminals).accepts(word),
        some_run_accepts(sra(lang.srg, lang.accept), word),
    )


# --- 1 -----------------------------------------------------------------------------------------

SIX = {
    "the arm": ("N -> B | N eps JO | N eps L | N eps EN", ARM_TERMINALS, "finite automaton", 7),
    "right-linear": (
        "N -> B eps J | B\nJ -> JO eps L | JO\nL -> L eps J | L",
        ("B", "JO", "L", "eps"),
        "finite automaton",
        7,
    ),
    "branching": (BRANCHING, ("[", "]", "L", "EN"), "pushdown automaton", 7),
    "matched pairs": (MATCHED, ("JO", "L"), "pushdown automaton", 9),
    "ambiguous": (SUMS, ARITHMETIC, "pushdown automaton", 6),
    "chain": (chain(60), ALPHABET, "finite automaton", 5),
}


@pytest.mark.parametrize("name", SIX)
def test_every_word_is_decided(name: str) -> None:
    """A reader that decides only some words, or gives up on some grammars, is of no use."""
    text, terminals, kind, longest = SIX[name]
    lang = of(text, terminals)
    assert lang.membership.kind == kind
    general = PushdownMembership(lang.binary, terminals)
    members = words_of(grammar(text, terminals), longest)
    rng = random.Random(name)
    drawn = [tuple(rng.choices(terminals, k=rng.randrange(longest + 1))) for _ in range(1000)]
    for word in (*sorted(members)[:1000], *drawn):
        assert lang.accepts(word) == general.accepts(word) == (word in members)


# --- 2 -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "rules", "lost"),
    [
        ("S -> a S a | a", 's: "a" s "a" | "a"', "aaa"),
        ("S -> a S a | b S b | empty", 's: "a" s "a" | "b" s "b" | ', "abba"),
        ("S -> E S a | b\nE -> empty | c", 's: e s "a" | "b"\ne: | "c"', "baa"),
    ],
)
def test_conflicts_are_not_resolved_by_shifting(text: str, rules: str, lost: str) -> None:
    """A table with conflicts that prefers one action refuses words of the language."""
    lang = of(text)
    assert tuple(lost) in words_of(grammar(text, ALPHABET), len(lost))
    assert not lark_accepts(rules, lost)
    assert isinstance(lang.lr_automaton, LrConflict)
    members = words_of(grammar(text, ALPHABET), 7)
    for word in all_words(("a", "b"), 7):
        assert all_answers(lang, word) == (word in members,) * 3


# --- 3 -----------------------------------------------------------------------------------------


def test_an_emptied_stack_is_not_enough() -> None:
    """An intersection that accepts when the stack is empty forgets the condition's states."""
    from pyformlang.cfg import CFG, Production, Terminal, Variable
    from pyformlang.finite_automaton import DeterministicFiniteAutomaton

    s, a, b = Variable("S"), Terminal("a"), Terminal("b")
    theirs = CFG(start_symbol=s, productions={Production(s, [a]), Production(s, [s, b])})
    contains_b = DeterministicFiniteAutomaton()
    contains_b.add_start_state(0)
    contains_b.add_final_state(1)
    contains_b.add_transitions([(0, "a", 0), (0, "b", 1), (1, "a", 1), (1, "b", 1)])
    assert (theirs.to_pda() & contains_b).to_cfg().contains([a])

    g = grammar("S -> a | S b", ALPHABET)
    for accept in (ir.Contains(("b",)), ir.EndsWith(("b", "b")), ir.Count("b", "<=", 2)):
        lang = of("S -> a | S b", ALPHABET, accept)
        for word in all_words(("a", "b"), 5):
            inside = word in words_of(g, 5) and satisfies(accept, word)
            assert all_answers(lang, word) == (inside,) * 3


# --- 4 -----------------------------------------------------------------------------------------


def test_the_pushdown_automaton_itself_runs() -> None:
    """That the automaton has the grammar's language cannot be tested without running it."""
    from pyformlang.pda import PDA

    assert not {"accepts", "contains"} & set(dir(PDA))
    for text in (SUMS, "S -> ( S ) S | empty"):
        lang = of(text, ARITHMETIC)
        pda = sra(lang.srg, lang.accept)
        members = words_of(grammar(text, ARITHMETIC), 6)
        for word in sorted(members, key=len)[:60]:
            run = accepting_run(pda, word)
            assert run is not None
            met = list(configurations(pda, word, run))
            assert (met[0].state, met[0].remaining) == ("q0", word)
            assert (met[-1].state, met[-1].remaining, met[-1].stack) == ("f", (), ())
            labels = [t.label for t in run if t.label is not None]
            assert replay(grammar(text, ARITHMETIC), labels).word == word
            changed = (*word, "*")
            assert (accepting_run(pda, changed) is not None) == (changed in members)


# --- 5 -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("S -> S a | b", ("b",) + ("a",) * 300),
        ("S -> T a | b\nT -> S c | T b | empty", ("b",) + ("c", "b", "a") * 100),
        ("S -> S S | a | empty", ("a",) * 40),
        ("S -> E S E a | b\nE -> E E | empty", ("b",) + ("a",) * 60),
        ("S -> A B\nA -> B A | B | empty\nB -> A | a | S", ("a",) * 30),
    ],
)
def test_left_recursion_and_empty_cycles_end(text: str, word: Word) -> None:
    """A pushdown automaton that follows left recursion or empty cycles stack by stack hangs."""
    lang = of(text)
    assert all_answers(lang, word) == (True,) * 3
    assert all_answers(lang, (*word, "c")) == (False,) * 3
    assert all_answers(lang, ("c", *word)) == (False,) * 3


# --- 6 -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "S -> empty",
        "S -> T T\nT -> empty",
        "S -> a S b | empty",
        "S -> S a | empty",
        "S -> a S | empty",
        "S -> A B\nA -> a | empty\nB -> b | A",
        "S -> E S E | empty\nE -> empty",
    ],
)
def test_the_empty_word_is_a_word(text: str) -> None:
    """Readers that do not take empty productions, or raise errors on the empty word."""
    with pytest.raises(lark.exceptions.ParseError, match="empty"):
        lark.Lark('s: "a" s "b" | ', start="s", parser="cyk")
    lang = of(text)
    assert () in words_of(grammar(text, ALPHABET), 0)
    assert all_answers(lang, ()) == (True,) * 3
    assert not lang.is_empty()
    assert lang.shortest_word() == ()
    assert list(lang.words(max_length=0)) == [()]
    assert lang.count_words(0) == (1,)
    refusing = of(text, ALPHABET, ir.Count(None, ">", 0))
    assert all_answers(refusing, ()) == (False,) * 3
    assert refusing.count_words(0) == (0,)
    without = of(f"Q -> S c\n{text}")
    assert all_answers(without, ()) == (False,) * 3
    assert without.shortest_word() == ("c",)


# --- 7 -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["A -> A | a", "A -> B | a\nB -> A | b", TRAPS["empty cycle"]])
def test_unit_cycles(text: str) -> None:
    """A nonterminal that derives itself: words are told and counted, derivations are infinite."""
    lang = of(text)
    members = words_of(grammar(text, ALPHABET), 6)
    for word in all_words(ALPHABET, 4):
        assert all_answers(lang, word) == (word in members,) * 3
    expected = [sum(len(w) == n for w in members) for n in range(7)]
    assert list(lang.count_words(6)) == expected
    with pytest.raises(InfiniteAmbiguityError, match="A derives itself"):
        derivations_of(lang, ("a",))


# --- 8 -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["S -> a S", "S -> T | S S\nT -> a T b | S", "S -> a X\nX -> X"])
def test_useless_symbols_of_an_empty_language(text: str) -> None:
    """Trimming that leaves rules which derive nothing."""
    lang = of(text)
    assert lang.is_empty()
    assert lang.is_finite()
    assert lang.longest() == 0
    assert lang.product.rules == ()
    assert list(lang.words()) == []
    assert lang.shortest_word() is None
    assert lang.count_words(4) == (0,) * 5
    assert not any(any(all_answers(lang, word)) for word in all_words(ALPHABET, 3))
    assert list(derivations_of(lang, ("a",))) == []


def test_useless_symbols_beside_useful_ones() -> None:
    """Grammars refused for an unproductive symbol; errors on tokens whose rules were removed."""
    text = "S -> a | U c | S b\nU -> U a | b U\nR -> c"
    lang = of(text)
    assert not lang.is_empty()
    assert lang.count_words(3) == (0, 1, 1, 1)
    for word in all_words(ALPHABET, 4):
        inside = word in words_of(grammar(text, ALPHABET), 4)
        assert all_answers(lang, word) == (inside,) * 3
        assert len(list(derivations_of(lang, word))) == inside


# --- 9 -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SIX)
def test_unknown_tokens_mean_no(name: str) -> None:
    """A token that no rule has raises an error in place of a refusal."""
    text, terminals, _, _ = SIX[name]
    lang = of(text, terminals)
    word = lang.shortest_word() or next(islice(lang.words(), 1, None))
    for token in ("unknown", "", "N", "S", "E", "eps eps", " ".join(word)):
        if token in terminals:
            continue
        for wrong in ((token,), (token, *word), (*word, token), (*word[:-1], token)):
            assert all_answers(lang, wrong) == (False,) * 3
    assert not any(True for _ in islice(derivations_of(of(SUMS, ARITHMETIC), ("x",)), 1))


def test_unknown_tokens_in_nltk() -> None:
    """nltk raises an error for a token that no production has."""
    from nltk.grammar import CFG, Nonterminal, Production
    from nltk.parse.chart import ChartParser

    start = Nonterminal("S")
    theirs = ChartParser(CFG(start, [Production(start, ["a"])]))
    with pytest.raises(ValueError, match="does not cover"):
        list(theirs.parse(["b"]))
    assert not of("S -> a").accepts(("b",))


# --- 10 ----------------------------------------------------------------------------------------


def test_spelling_of_tokens_means_nothing() -> None:
    """Tokens read as variables, as the empty word, as quotes or as marks of a notation."""
    from pyformlang.cfg import CFG, Production, Terminal, Variable

    assert CFG.from_text("S -> B JO | S JO").is_empty()
    epsilon = Terminal("epsilon")
    theirs = CFG(
        start_symbol=Variable("S"),
        productions={Production(Variable("S"), [epsilon, Terminal("a")])},
    )
    assert not theirs.contains([epsilon, Terminal("a")])

    names = ("B", "JO", "epsilon", "eps", "$", "#", "'a'", '"a"', "->", "S'", "\\", "ε", "None")
    text = "S -> " + " | ".join(f"S {name}" for name in names) + " | B"
    middle = "S -> " + " | ".join(f"{name} S {name}" for name in names) + " | B"
    for rules in (text, middle):
        lang = of(rules, names)
        members = words_of(grammar(rules, names), 3)
        assert len(members) > len(names)
        for word in (*members, *all_words(names, 2)):
            assert all_answers(lang, word) == (word in members,) * 3
        assert set(lang.words(max_length=3)) == members


def test_a_terminal_spelt_like_a_nonterminal() -> None:
    """One spelling for two symbols hangs or confuses what goes by names."""
    nonterminal, terminal = ir.Symbol("S", "nonterminal"), ir.Symbol("S", "module")
    productions = (
        ir.Production("p0", "S", (terminal, nonterminal)),
        ir.Production("p1", "S", (ir.Symbol("a", "module"),)),
    )
    lang = language(ir.Grammar("G", "S", ("S",), productions, EVERY, None), ("S", "a"), ())
    assert list(lang.words(max_length=3)) == [("a",), ("S", "a"), ("S", "S", "a")]
    for word in all_words(("S", "a"), 5):
        inside = word[-1:] == ("a",) and set(word[:-1]) <= {"S"}
        assert all_answers(lang, word) == (inside,) * 3


# --- 11 ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["N -> JO | J M\nM -> O", "N -> J N O | JO N | J O | JO"])
def test_tokens_of_several_characters(text: str) -> None:
    """Words joined to strings, in which J O and JO are the same."""
    names = ("J", "O", "JO")
    lang = of(text, names)
    words = list(lang.words(max_length=6))
    assert words[:2] == [("JO",), ("J", "O")]
    assert len(words) == len(set(words)) == sum(lang.count_words(6))
    assert set(words) == words_of(grammar(text, names), 6)
    assert all_answers(lang, ("JO",)) == all_answers(lang, ("J", "O")) == (True,) * 3
    for wrong in (("J",), ("O",), ("J", "JO"), ("JO", "O"), ("J O",), ("J", "", "O")):
        assert all_answers(lang, wrong) == (False,) * 3


# --- 12: long words are in test_long_words --------------------------------------------------------


# --- 13 ----------------------------------------------------------------------------------------


def test_one_derivation_of_a_highly_ambiguous_word() -> None:
    """Parsers that refuse ambiguous words, or stop after some seconds, for one tree of many."""
    lang = of(SUMS, ARITHMETIC)
    word = ("id", *("+", "id", "*", "id") * 50)
    first, second = islice(derivations_of(lang, word), 2)
    assert first.word == second.word == word
    assert first.labels != second.labels
    for found in (first, second):
        assert found == replay(grammar(SUMS, ARITHMETIC), found.labels)


def test_a_limit_is_a_number_and_said() -> None:
    """A bound is on steps that are the same everywhere, and what passes it is an error."""
    lang = of(SUMS, ARITHMETIC)
    assert sum(lang.count_words(9, budget=10_000)) == 1 + 3 + 11 + 45 + 197
    with pytest.raises(BudgetExceededError, match="10"):
        lang.count_words(9, budget=10)


# --- 14 ----------------------------------------------------------------------------------------


def test_words_are_counted_not_derivations() -> None:
    """The ambiguous sums have 15 derivations but 11 words of 5 symbols, 37275 and 4279 of 13."""
    lang = of(SUMS, ARITHMETIC)
    # A word is a term, or a term, one of two operators and a word; a term is id or ( word ).
    words, terms, trees = {1: 1}, {1: 1}, {1: 1}
    for n in range(3, 14, 2):
        terms[n] = words[n - 2]
        words[n] = terms[n] + 2 * sum(terms[k] * words[n - 1 - k] for k in range(1, n - 1, 2))
        trees[n] = trees[n - 2] + 2 * sum(trees[k] * trees[n - 1 - k] for k in range(1, n - 1, 2))
    assert list(words.values()) == [1, 3, 11, 45, 197, 903, 4279]
    assert (trees[5], trees[13]) == (15, 37275)
    counts = lang.count_words(13)
    assert counts == tuple(words.get(n, 0) for n in range(14))
    tabulated = DerivationCounts(lang.normal, 13)
    assert [tabulated.total(n) for n in range(14)] == [trees.get(n, 0) for n in range(14)]
    for n in (1, 3, 5, 7):
        listed = [w for w in lang.words(max_length=n) if len(w) == n]
        assert len(listed) == words[n]
        assert sum(1 for w in listed for _ in derivations_of(lang, w)) == trees[n]
    assert len(set(derivations(grammar(SUMS, ARITHMETIC), ("id", "+") * 3 + ("id",)))) == 5


# --- 15 ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in SIX if name != "chain"])
def test_words_come_by_length_then_by_symbols_and_once(name: str) -> None:
    """Listings that are depth-first, repeat words or leave words out."""
    text, terminals, _, longest = SIX[name]
    lang = of(text, terminals)
    words = list(lang.words(max_length=longest))
    assert words == sorted(
        words_of(grammar(text, terminals), longest),
        key=lambda w: (len(w), [terminals.index(s) for s in w]),
    )
    assert list(islice(lang.words(), len(words))) == words


def test_nltk_repeats_words() -> None:
    """nltk lists 37 words of the ambiguous sums of depth 4; 33 of them differ."""
    from nltk.grammar import CFG, Nonterminal, Production
    from nltk.parse.generate import generate

    e = Nonterminal("E")
    rights = ([e, "+", e], [e, "*", e], ["(", e, ")"], ["id"])
    theirs = [tuple(w) for w in generate(CFG(e, [Production(e, r) for r in rights]), depth=4)]
    assert (len(theirs), len(set(theirs))) == (37, 33)
    assert len(theirs[0]) > len(theirs[-1])
    ours = list(of(SUMS, ARITHMETIC).words(max_length=7))
    assert set(theirs) <= set(ours)
    assert len(ours) == len(set(ours))


# --- 16 ----------------------------------------------------------------------------------------


def palindromes(middle: Word, count: int = 200) -> list[Word]:
    """Palindromes of which no two begin in the same way for long."""
    rng = random.Random(16)
    halves = (tuple(rng.choices("ab", k=20)) for _ in range(count))
    return [(*half, *middle, *reversed(half)) for half in halves]


def memory_held(reader: Membership, words: list[Word]) -> int:
    """What a reader holds in memory, in bytes, once it has read the words."""
    gc.collect()
    tracemalloc.start()
    try:
        for word in words:
            assert reader.accepts(word)
            assert not reader.accepts((*word, "a"))
        gc.collect()
        return tracemalloc.get_traced_memory()[0]
    finally:
        tracemalloc.stop()


@pytest.mark.slow
def test_what_is_remembered_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Caches that keep what every prefix led to, for as long as the reader lives."""
    text = TRAPS["even palindromes"]
    words = palindromes((), 100)
    unbounded = memory_held(of(text).membership, words)
    for module in (residuals, pushdown_reader):
        monkeypatch.setattr(module, "CACHE_LIMIT", 30)
    some = memory_held(of(text).membership, words[:20])
    bounded = memory_held(of(text).membership, words)
    assert unbounded > 20 * bounded
    assert bounded < some + 50_000


def test_prefixes_are_not_remembered_where_a_stack_does() -> None:
    """The same where the middle is marked: no limit is needed, few states tell all words."""
    lang = of("S -> a S a | b S b | c")
    assert memory_held(lang.membership, palindromes(("c",))) < 300_000


# --- 17 ----------------------------------------------------------------------------------------


def test_lr1_grammars_that_are_not_lalr() -> None:
    """Merged lookaheads make conflicts that the grammar does not have."""
    rules = 's: "a" x "a" | "b" x "b" | "a" y "b" | "b" y "a"\nx: "c"\ny: "c"'
    with pytest.raises(lark.exceptions.GrammarError, match="Reduce/Reduce"):
        lark.Lark(rules, start="s", parser="lalr")
    lang = of(TRAPS["not LALR"])
    assert lang.is_lr
    words = [("a", "c", "a"), ("a", "c", "b"), ("b", "c", "a"), ("b", "c", "b")]
    assert list(lang.words()) == words
    assert [w for w in all_words(ALPHABET, 5) if lang.accepts(w)] == words
    # The same around a recursion, so that no finite automaton reads it.
    text = "S -> c S c | a A a | b A b | a B b | b B a\nA -> c\nB -> c"
    around = of(text)
    assert around.is_lr
    assert around.finite_automaton is None
    members = words_of(grammar(text, ALPHABET), 7)
    assert len(members) == 12
    for word in (*members, *all_words(ALPHABET, 5)):
        assert all_answers(around, word) == (word in members,) * 3

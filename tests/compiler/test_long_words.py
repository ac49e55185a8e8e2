"""Long words: nothing recurses in the length of a word, whatever nests in it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import islice

import pytest

from compiler.words.counting import words_of_length
from compiler.words.derivation import replay
from compiler.words.language import Language, language
from compiler.words.lr_automaton import LrAutomaton, right_parse
from compiler.words.pushdown_automaton import accepting_run, sra
from compiler.words.pushdown_automaton import accepts as some_run_accepts
from compiler.words.structures import derivations_of
from tests.oracles.grammars import ALPHABET, ARM_TERMINALS, grammar
from tests.oracles.some_cases import examples

Word = tuple[str, ...]
ARM = "N -> B | N eps JO | N eps L | N eps EN"
ARITHMETIC = ("+", "*", "(", ")", "id")
SUMS = "E -> E + E | E * E | ( E ) | id"
BRANCHING = "T -> EN | L T | [ T T ]"
MATCHED = "S -> JO S L | empty"
LONG = 100_000


def of(text: str, terminals: Word) -> Language:
    return language(grammar(text, terminals), terminals, frozenset(terminals))


@contextmanager
def few_frames() -> Iterator[None]:
    """Leave only so many frames of the interpreter's stack as short words need."""
    depth, frame = 0, sys._getframe()
    while frame.f_back is not None:
        depth, frame = depth + 1, frame.f_back
    known = sys.getrecursionlimit()
    sys.setrecursionlimit(depth + 100)
    try:
        yield
    finally:
        sys.setrecursionlimit(known)


# A grammar, its symbols, a word of about so many symbols, and a symbol that cannot come last.
LONG_WORDS: dict[str, tuple[str, Word, Callable[[int], Word], str]] = {
    "the arm": (
        ARM,
        ARM_TERMINALS,
        lambda n: ("B", "eps", "JO") + ("eps", "L") * (n // 2 - 2) + ("eps", "EN"),
        "eps",
    ),
    "right-linear": ("N -> b N | a", ALPHABET, lambda n: ("b",) * n + ("a",), "b"),
    "branching": (
        BRANCHING,
        ("[", "]", "L", "EN"),
        lambda n: ("[",) * (n // 3 + 1) + ("EN",) + ("EN", "]") * (n // 3 + 1),
        "[",
    ),
    "matched pairs": (
        MATCHED,
        ("JO", "L"),
        lambda n: ("JO",) * (n // 2) + ("L",) * (n // 2),
        "L",
    ),
    "left recursion": (
        "S -> T a | b\nT -> S c | T b",
        ALPHABET,
        lambda n: ("b",) + ("c", "b", "a") * (n // 3 + 1),
        "c",
    ),
    "nullable": (
        "S -> A B C S | b\nA -> a | empty\nB -> b A | A | empty\nC -> c B | empty",
        ALPHABET,
        lambda n: ("a", "b", "c", "c") * (n // 4) + ("b",),
        "c",
    ),
    "sums": (
        SUMS,
        ARITHMETIC,
        lambda n: ("id", "+", "(", "id", ")", "*") * (n // 6 + 1) + ("id",),
        "+",
    ),
    "nested sums": (
        SUMS,
        ARITHMETIC,
        lambda n: ("(",) * (n // 2) + ("id",) + (")",) * (n // 2),
        "id",
    ),
}


@pytest.mark.parametrize("name", LONG_WORDS)
def test_words_of_a_hundred_thousand_symbols(name: str) -> None:
    """Recursion in the length of the word ends in an error from some hundred symbols on."""
    text, terminals, make, more = LONG_WORDS[name]
    lang = of(text, terminals)
    word = make(LONG)
    assert len(word) >= LONG
    # Remembering deep nesting takes longest; to be refused in the middle is enough there.
    place = len(word) // 2 + 1 if name == "nested sums" else len(word)
    wrong = (*word[:place], more, *word[place:])
    with few_frames():
        assert lang.accepts(word)
        assert not lang.accepts(wrong)


@pytest.mark.parametrize(
    ("name", "length"),
    [
        ("the arm", examples(10_000, 30_000)),
        ("right-linear", examples(4_000, 10_000)),
        ("branching", examples(4_000, 10_000)),
        ("matched pairs", examples(4_000, 10_000)),
        ("left recursion", examples(4_000, 10_000)),
        ("nested sums", examples(4_000, 10_000)),
    ],
)
def test_the_automaton_reads_long_words(name: str, length: int) -> None:
    """The same of the automaton with its stack, and of its run."""
    text, terminals, make, more = LONG_WORDS[name]
    lang = of(text, terminals)
    pda = sra(lang.srg, lang.accept)
    word = make(length)
    with few_frames():
        run = accepting_run(pda, word)
        assert not some_run_accepts(pda, (*word, more))
    assert run is not None
    assert tuple(pda.alphabet[t.read] for t in run if t.read is not None) == word


@pytest.mark.parametrize("name", [n for n in LONG_WORDS if n not in ("nullable", "sums")])
def test_derivations_of_long_words(name: str) -> None:
    """Trees as deep as the word is long."""
    text, terminals, make, _ = LONG_WORDS[name]
    lang = of(text, terminals)
    word = make(3_000)
    with few_frames():
        found = list(islice(derivations_of(lang, word), 2))
        assert [d.word for d in found] == [word]
        assert found[0] == replay(grammar(text, terminals), found[0].labels)
        if isinstance(lang.lr_automaton, LrAutomaton):
            parse = right_parse(lang.lr_automaton, lang.srg.encode(word) or ())
            assert parse is not None
            assert sorted(parse) == sorted(
                next(i for i, p in enumerate(lang.srg.productions) if p.label == label)
                for label in found[0].labels
            )


@pytest.mark.parametrize(
    ("name", "length", "letters"),
    [
        ("the arm", 2_001, None),
        ("right-linear", 2_001, {"b": 2_000, "a": 1}),
        ("matched pairs", 2_000, {"JO": 1_000, "L": 1_000}),
        ("branching", 601, None),
        ("sums", 301, None),
    ],
)
def test_listing_long_words(name: str, length: int, letters: dict[str, int] | None) -> None:
    """Enumeration that calls itself once per symbol."""
    text, terminals, _, _ = LONG_WORDS[name]
    lang = of(text, terminals)
    with few_frames():
        codes = list(islice(words_of_length(lang.recogniser(length), length), 3))
    words = [lang.srg.decode(word) for word in codes]
    assert words == sorted(set(words), key=lambda w: [terminals.index(s) for s in w])
    assert words
    for word in words:
        assert len(word) == length
        assert lang.accepts(word)
        if letters is not None:
            assert {s: word.count(s) for s in letters} == letters


def test_few_frames_are_too_few_for_recursion() -> None:
    def depth(word: Word) -> int:
        return 1 + depth(word[1:]) if word else 0

    assert depth(("a",) * 200) == 200
    with few_frames(), pytest.raises(RecursionError):
        depth(("a",) * 200)

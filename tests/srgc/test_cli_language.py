from __future__ import annotations

import re
from collections import Counter
from functools import partial, partialmethod

import pytest

from compiler.words.equivalence import compare
from compiler.words.language import Language
from compiler.words.sampling import WordSampler
from grammar_lang.load import load
from srgc.text_reports.language_report import language_text

LETTERS = ("a", "b", "c", "d", "e")
MODULES = "".join(f"module {x} {{ role link; const mass = 1 kg; }}\n" for x in LETTERS)

PAIRS = ("Pairs", "outer: S -> a S b; inner: S -> a b")
PAIRS_AGAIN = ("PairsAgain", "one: S -> a T; two: T -> b; more: T -> S b")
SUMS = ("Sums", "sum: E -> E b E; product: E -> E c E; group: E -> d E e; leaf: E -> a")
LAYERED = (
    "Layered",
    "s: E -> E b T; t: E -> T; p: T -> T c F; unit: T -> F; group: F -> d E e; leaf: F -> a",
)
RIGHT = ("Right", "first: S -> a T; last: S -> a; second: T -> b S")
LEFT = ("Left", "first: S -> T a; last: S -> a; second: T -> S b")
LONGER = ("Longer", "first: S -> a T; last: S -> a; second: T -> b S; accept not length == 41")
FINITE = ("Finite", "first: S -> a T; second: S -> c; third: T -> b; fourth: T -> empty")
LOOP = ("Loop", "loop: A -> A; one: A -> a")
NONE = ("Nothing", "more: A -> a A")
LOOPED_NONE = ("Neither", "loop: A -> A; one: A -> a; accept contains b")
MIRROR = ("Mirror", "x1: S -> a S a; x2: S -> b S b; x3: S -> a; x4: S -> b")
MIRROR_AGAIN = ("MirrorAgain", "y0: S -> T; x1: T -> a S a; x2: T -> b S b; x3: T -> a; x4: T -> b")


def text_of(*grammars):
    """A file with these grammars; the left side of the first production is the start symbol."""
    parts = [MODULES]
    for name, body in grammars:
        items = [item.strip() for item in body.split(";")]
        rules = [item for item in items if "->" in item]
        labels = [rule.split(":")[0] for rule in rules]
        start = rules[0].split(":")[1].split("->")[0].strip()
        parts.append(f"grammar {name} {{ start {start}; {'; '.join(items)}; }}\n")
        parts.append(f"semantics {name} {{ {' '.join(f'{label} {{ }}' for label in labels)} }}\n")
    return "".join(parts)


@pytest.fixture
def file_of(spec):
    return lambda *grammars: spec(text_of(*grammars))


def rows(out):
    """The lines of ``srgc language`` by name; `derived by` lines in a list."""
    found = {}
    for line in out.splitlines():
        name, value = re.fullmatch(r" *([^:]+): +(.+)", line).groups()
        found.setdefault(name, []).append(value)
    return {name: values if name == "derived by" else values[0] for name, values in found.items()}


# --- samples -------------------------------------------------------------------------------------


def test_a_sample_of_the_running_example(srgc, arm_file):
    arguments = ("words", arm_file, "--sample", "40", "--length", "13")
    ran = srgc(*arguments)
    words = ran.out.splitlines()
    assert (ran.status, ran.err, len(words)) == (0, "", 40)
    for word in words:
        assert re.fullmatch(r"B eps JO( eps (JO|L|EN)){5}", word)
        assert "EN" in word
    assert srgc(*arguments, "--seed", "0").out == ran.out == srgc(*arguments).out
    assert srgc(*arguments, "--seed", "1").out != ran.out
    assert srgc("words", arm_file, "--sample", "7", "--length", "13").out.splitlines() == words[:7]


def test_a_sample_holds_all_words_of_a_short_length(srgc, file_of):
    out = srgc("words", file_of(SUMS), "--sample", "400", "--length", "5").out
    drawn = Counter(out.splitlines())
    expected = {f"a {x} a {y} a" for x in "bc" for y in "bc"} | {"d a b a e", "d a c a e"}
    expected |= {"d d a e e", "a b d a e", "a c d a e", "d a e b a", "d a e c a"}
    assert set(drawn) == expected
    # two derivations make no word more likely
    assert max(drawn.values()) < 2 * min(drawn.values()) + 40


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--sample", "3"], "--length"),
        (["--length", "3"], "--sample"),
        (["--sample", "3", "--length", "3", "--count"], "--count"),
        (["--sample", "3", "--length", "3", "--max-length", "5"], "--max-length"),
        (["--sample", "0", "--length", "3"], "--sample"),
        (["--sample", "1", "--length", "-1"], "--length"),
        (["--sample", "1", "--length", "3", "--seed", "-1"], "--seed"),
        (["--sample", "1", "--length", "4"], "no word of 4 symbols"),
    ],
)
def test_a_sample_that_cannot_be(srgc, arm_file, arguments, word):
    ran = srgc("words", arm_file, *arguments)
    assert (ran.status, ran.out) == (2, "")
    assert word in ran.err
    assert len(re.findall("(?i)error", ran.err)) == 1


def test_a_budget_that_is_used_up(srgc, file_of, monkeypatch):
    path = file_of(MIRROR)
    monkeypatch.setattr(
        "srgc.text_reports.language_report.WordSampler", partial(WordSampler, budget=500)
    )
    ran = srgc("words", path, "--sample", "2", "--length", "41")
    assert (ran.status, ran.out) == (4, "")
    assert re.fullmatch("unknown: counting the words needs more than 500 moves: .*\n", ran.err)
    assert srgc("words", path, "--sample", "2", "--length", "5").status == 0
    counting = partialmethod(Language.count_words, budget=500)
    monkeypatch.setattr("compiler.words.language.Language.count_words", counting)
    ran = srgc("words", path, "--count", "--max-length", "41")
    assert (ran.status, ran.out) == (4, "")
    assert ran.err.startswith("unknown: ")
    assert srgc("words", path, "--count", "--max-length", "5").out.split()[1::2] == list("020408")


# --- what kind of language -----------------------------------------------------------------------


def test_the_running_example(srgc, arm_file):
    ran = srgc("language", arm_file)
    assert (ran.status, ran.err) == (0, "")
    found = rows(ran.out)
    assert found["productions"] == "4"
    assert found["nonterminals"] == "1"
    assert found["form"] == "left-linear"
    # after nothing, B, B eps; then after a module or an edge, with an effector or without; the sink
    assert found["finite automaton"] == "7 states, minimal, and a dead one"
    assert ", no conflict; " in found["LR(1) automaton"]
    assert found["words"] == "infinitely many"
    assert found["shortest word"] == "B eps JO eps EN"
    assert found["ambiguous"] == "no"
    assert found["read by"] == "a finite automaton"


def test_matched_pairs(srgc, file_of):
    found = rows(srgc("language", file_of(PAIRS)).out)
    assert (found["productions"], found["nonterminals"]) == ("2", "1")
    assert found["form"] == "context-free, not linear"
    assert found["finite automaton"].startswith("none: the form of the grammar does not show")
    # start, S, a; S, a, b after the first a; b after a S; S, b within, b after S within
    assert found["LR(1) automaton"].startswith("10 states, no conflict; ")
    assert found["words"] == "infinitely many"
    assert found["shortest word"] == "a b"
    assert found["ambiguous"] == "no"
    assert found["read by"] == "a pushdown automaton whose states are sets of what may follow"


def test_ambiguous_sums(srgc, file_of):
    found = rows(srgc("language", file_of(SUMS)).out)
    assert found["form"] == "context-free, not linear"
    assert found["LR(1) automaton"] == (
        "none: after `E b E`, before `b`, it is open whether to read on or to finish `sum`"
    )
    assert found["ambiguous"] == "yes: a b a b a"
    assert sorted(found["derived by"]) == [
        "sum leaf sum leaf leaf",
        "sum sum leaf leaf leaf",
    ]
    assert found["read by"].startswith("a pushdown automaton")


def test_a_conflict_at_the_end(srgc, file_of):
    two = ("Two", "one: S -> U; two: S -> V; tri: U -> a; four: V -> a")
    found = rows(srgc("language", file_of(two)).out)
    assert found["LR(1) automaton"] == (
        "none: after `a`, before the end, it is open whether to finish `tri` or to finish `four`"
    )
    assert found["ambiguous"] == "yes: a"


def test_a_finite_language(srgc, file_of):
    found = rows(srgc("language", file_of(FINITE)).out)
    assert found["form"] == "right-linear"
    assert found["words"] == "finitely many, the longest of 2 symbols"
    assert found["shortest word"] == "a"
    # start, a, the end; the sink
    assert found["finite automaton"] == "3 states, minimal, and a dead one"


def test_a_nonterminal_that_derives_itself(srgc, file_of):
    found = rows(srgc("language", file_of(LOOP)).out)
    assert found["ambiguous"] == "yes, without end: A derives itself"
    assert found["words"] == "finitely many, the longest of 1 symbol"
    assert found["shortest word"] == "a"


@pytest.mark.parametrize("grammar", [NONE, LOOPED_NONE])
def test_an_empty_language(srgc, spec, grammar):
    path = spec(text_of(grammar))
    ran = srgc("language", path)
    assert (ran.status, ran.out) == (5, "")
    assert "SRG0404" in ran.err
    # The check of the file is what refuses it: the report itself can say what it is.
    program = load(path).program
    found = rows(language_text(program, program.grammars[grammar[0]]))
    assert found["words"] == found["shortest word"] == "none"
    assert found["ambiguous"] == "no"


def test_an_automaton_that_would_be_too_large(srgc, file_of):
    steps = "; ".join(f"a{i}: X{i} -> a X{i + 1}; b{i}: X{i} -> b X{i + 1}" for i in range(14))
    far = ("Far", f"s: S -> a S; t: S -> b S; u: S -> a X0; {steps}; v: X14 -> c")
    found = rows(srgc("language", file_of(far)).out)
    assert found["form"] == "right-linear"
    assert found["finite automaton"] == "not made: its construction takes too many states"


def test_the_grammar_is_chosen(srgc, file_of):
    path = file_of(PAIRS, RIGHT)
    ran = srgc("language", path)
    assert (ran.status, ran.out) == (2, "")
    assert "Pairs, Right" in ran.err
    assert rows(srgc("language", path, "--grammar", "Right").out)["form"] == "right-linear"
    assert srgc("language", path, "--grammar", "Wrong").status == 2


# --- comparison ----------------------------------------------------------------------------------


def test_the_same_words(srgc, file_of):
    path = file_of(RIGHT, LEFT, PAIRS, PAIRS_AGAIN, SUMS, LAYERED)
    ran = srgc("compare", path, "Right", "Left", "--max-length", "0")
    assert (ran.status, ran.out, ran.err) == (0, "Right and Left have the same words\n", "")
    ran = srgc("compare", path, "Pairs", "PairsAgain")
    assert ran.status == 0
    assert "the same words of at most 20 symbols" in ran.out
    assert "not compared" in ran.out
    ran = srgc("compare", path, "Sums", "Layered", "--max-length", "7")
    assert ran.status == 0
    assert "at most 7 symbols" in ran.out
    assert srgc("compare", path, "Sums", "Sums", "--max-length", "7").status == 0


def test_different_words(srgc, file_of):
    path = file_of(RIGHT, LONGER, PAIRS, SUMS)
    ran = srgc("compare", path, "Pairs", "Sums")
    assert (ran.status, ran.err) == (1, "")
    assert ran.out == "different: Sums has a word that Pairs has not:\na\n"
    assert srgc("compare", path, "Sums", "Pairs").out == ran.out
    # regular ones are compared beyond the length
    ran = srgc("compare", path, "Longer", "Right", "--max-length", "3")
    assert ran.status == 1
    word = " ".join(["a", *["b", "a"] * 20])
    assert ran.out == f"different: Right has a word that Longer has not:\n{word}\n"
    # a difference that is too long
    assert srgc("compare", path, "Pairs", "Sums", "--max-length", "0").status == 0


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["Pairs"], "name both"),
        ([], "name both"),
        (["Pairs", "Wrong"], "`Wrong`"),
        (["Pairs", "Sums", "--max-length", "-1"], "--max-length"),
        (["Pairs", "Sums", "Right"], "name both"),
    ],
)
def test_a_comparison_that_cannot_be(srgc, file_of, arguments, word):
    ran = srgc("compare", file_of(PAIRS, SUMS, RIGHT), *arguments)
    assert (ran.status, ran.out) == (2, "")
    assert word in ran.err
    assert len(re.findall("(?i)error", ran.err)) == 1


def test_a_comparison_that_takes_too_long(srgc, file_of, monkeypatch):
    monkeypatch.setattr("srgc.text_reports.language_report.compare", partial(compare, budget=500))
    path = file_of(MIRROR, MIRROR_AGAIN)
    ran = srgc("compare", path, "Mirror", "MirrorAgain", "--max-length", "41")
    assert (ran.status, ran.out) == (4, "")
    assert re.fullmatch("unknown: comparing the languages needs more than 500 .*\n", ran.err)
    assert srgc("compare", path, "Mirror", "MirrorAgain", "--max-length", "5").status == 0

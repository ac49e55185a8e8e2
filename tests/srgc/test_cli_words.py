from __future__ import annotations

import re
from itertools import pairwise, product

import pytest

from srgc.text_reports.language_report import nothing_listed
from tests.oracles.grammars import arm

SYMBOLS = ["JO", "L", "EN"]


def brute_force(modules):
    """The example's words with this many modules: anything attached, an effector somewhere."""
    for rest in product(SYMBOLS, repeat=modules - 2):
        if "EN" in rest:
            yield " eps ".join(["B", "JO", *rest])


def expected(most):
    return [word for modules in range(2, most + 1) for word in brute_force(modules)]


def test_words_in_order_of_length_then_declaration(srgc, arm_file):
    ran = srgc("words", arm_file, "--max-length", "11")
    assert ran.status == 0
    assert ran.out.splitlines() == expected(6)[:100]


def test_a_hundred_unless_told_otherwise(srgc, arm_file):
    assert len(srgc("words", arm_file).out.splitlines()) == 100
    assert srgc("words", arm_file, "--limit", "150").out.splitlines() == expected(7)[:150]
    assert srgc("words", arm_file, "--limit", "0").out == ""


def test_counts(srgc, arm_file):
    ran = srgc("words", arm_file, "--count", "--max-length", "11")
    counted = dict(map(int, line.split()) for line in ran.out.splitlines())
    for length in range(12):
        words = [word for word in expected(6) if len(word.split()) == length]
        assert counted[length] == len(words)


def test_an_infinite_language_is_not_counted_without_a_length(srgc, arm_file):
    ran = srgc("words", arm_file, "--count")
    assert (ran.status, ran.out) == (2, "")
    assert "--max-length" in ran.err


def test_a_finite_language_is(srgc, spec, arm_file):
    text = arm_file.read_text(encoding="utf-8")
    path = spec(text.replace("accept contains EN", "accept length <= 7 and contains EN"))
    ran = srgc("words", path, "--count")
    assert [line.split()[1] for line in ran.out.splitlines()] == list("00000105")


def test_the_grammar_has_to_be_chosen_among_several(srgc, spec, arm_file):
    text = arm_file.read_text(encoding="utf-8")
    path = spec(text + "\ngrammar Lone { start M; only: M -> B; }\nsemantics Lone { only { } }\n")
    assert srgc("words", path).status == 2
    assert "PlanarArm, Lone" in srgc("words", path).err
    assert srgc("words", path, "--grammar", "Lone").out == "B\n"
    ran = srgc("words", path, "--grammar", "None")
    assert (ran.status, ran.out) == (2, "")
    assert "`None`" in ran.err


@pytest.mark.parametrize(
    ("word", "accepted"),
    [
        ("B eps JO eps L eps JO eps L eps EN", True),
        ("B eps JO eps EN eps L", True),
        ("B eps JO eps L", False),
        ("B eps L eps EN", False),
        ("B JO EN", False),
        ("B eps JO eps EN eps", False),
        ("B eps JO eps Claw", False),
        ("", False),
    ],
)
def test_membership(srgc, arm_file, word, accepted):
    for trace in ([], ["--trace"]):
        ran = srgc("accepts", arm_file, *trace, "--", *word.split())
        assert ran.status == (0 if accepted else 1)
        assert ran.out.startswith("accepted" if accepted else "not accepted")
        assert ran.err == ""
        if "Claw" in word:
            assert "`Claw`" in ran.out


def test_a_symbol_that_looks_like_an_option(srgc, arm_file):
    assert srgc("accepts", arm_file, "--", "--trace").status == 1


def test_the_trace_has_a_run_and_a_derivation(srgc, arm_file):
    word = "B eps JO eps EN"
    lines = srgc("accepts", arm_file, "--trace", "--", *word.split()).out.splitlines()
    run = [re.split("  +", line.strip()) for line in lines if re.match(r"  \d", line)]
    assert run[0] == ["0", "q0", "N $", "tool: N -> N eps EN"]
    assert run[-1][2:] == ["empty", "accepted"]
    # Every step reads the top of the stack or replaces it.
    for (place, _, stack, step), (after, _, following, _) in pairwise(run):
        top, *below = stack.split()
        if step.startswith("read "):
            assert (step, int(after)) == (f"read {top}", int(place) + 1)
            assert following.split() == below
        elif step != "end":
            left, right = step.split(": ")[1].split(" -> ")
            assert (left, after) == (top, place)
            assert following.split() == right.split() + below
    assert " ".join(row[3][5:] for row in run if row[3].startswith("read ")) == word
    table = [re.split("  +", line.strip()) for line in lines[lines.index("") + 2 :]]
    assert [row for row in table if len(row) == 3] == [
        ["tool", "1..5", "N -> N eps EN"],
        ["joint", "1..3", "N -> N eps JO"],
        ["base", "1..1", "N -> B"],
    ]


def test_a_refusal_says_why(srgc, arm_file):
    reasons = {
        "B eps JO JO": "begins with `B eps JO JO` (4 symbols)",
        "B eps JO eps": "only the beginning",
        "B eps JO": "accept condition",
        "": "does not derive",
        "B Claw": "`Claw` is not a symbol",
    }
    for word, reason in reasons.items():
        ran = srgc("accepts", arm_file, "--", *word.split())
        assert ran.status == 1
        assert reason in ran.out


def test_a_long_word_is_traced(srgc, arm_file):
    word = ["B", "eps", "JO", *["eps", "L"] * 5000, "eps", "EN"]
    ran = srgc("accepts", arm_file, "--trace", "--", *word)
    assert ran.status == 0
    assert "more" in ran.out
    assert len(ran.out) < 120 * 3 * len(word)


EMPTY = """
module B {{ role base; }}
edge eps;
grammar Maybe {{ start N; bare: N -> {right}; more: N -> N eps B; accept {accept}; }}
"""


@pytest.mark.parametrize("sample", [(), ("--sample", "1", "--length", "0")])
def test_the_word_without_symbols_is_no_blank_line(srgc, spec, sample):
    path = spec(EMPTY.format(right="empty", accept="length <= 2 or length >= 0"))
    ran = srgc("words", path, *sample, *(() if sample else ("--limit", "2")))
    expected = ["(empty word)"] if sample else ["(empty word)", "eps B"]
    assert (ran.status, ran.out.splitlines()) == (0, expected)
    assert "(empty word)" not in srgc("words", path, "--count", "--max-length", "3").out


@pytest.mark.parametrize(
    ("accept", "options", "said"),
    [
        ("contains eps", ("--max-length", "2"),
         "the shortest word of grammar `Maybe` has 3 symbols: `B eps B`"),
        ("contains eps", ("--limit", "0"), "no word was asked for"),
    ],
)  # fmt: skip
def test_no_list_is_empty_without_a_reason(srgc, spec, accept, options, said):
    ran = srgc("words", spec(EMPTY.format(right="B", accept=accept)), *options)
    assert (ran.status, ran.out) == (0, "")
    assert ran.err == f"note: {said}\n"


def test_a_family_without_words_has_a_reason_too():
    """`srgc check` refuses it; where it cannot decide that, the list says so."""
    assert nothing_listed(arm(), None, None) == "grammar `PlanarArm` has no words"

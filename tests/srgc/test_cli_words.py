from __future__ import annotations

from itertools import pairwise, product

import pytest

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
    run = [line.strip(" ()").split(", ") for line in lines if line.startswith("  (")]
    assert run[0][1] == word
    assert run[-1][1] == "empty"
    # The remaining word only ever loses its first symbol.
    for (_, before, _), (_, after, _) in pairwise(run):
        left, right = before.split(), [s for s in after.split() if s != "empty"]
        assert right in (left, left[1:])
    derivation = [line.strip() for line in lines if line.startswith("  =>")]
    assert derivation == [
        "=> N eps EN    [tool]",
        "=> N eps JO eps EN    [joint]",
        "=> B eps JO eps EN    [base]",
    ]

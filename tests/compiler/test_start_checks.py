"""Starts that no robot of a family can take, against all words up to a length."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.checks.task_checks import start_diagnostics
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from tests.oracles.brute_force_grammar import satisfies, words_of
from tests.oracles.formulas import program
from tests.oracles.grammars import grammar, random_grammars
from tests.oracles.joint_chains import chain_spec
from tests.oracles.some_cases import examples

R, P = "revolute z in [-3, 3]", "prismatic x in [0, 2] m"


def findings(text: str) -> list[Diagnostic]:
    sink = Sink()
    start_diagnostics(program(text), sink)
    return sink.found


def said(text: str) -> list[tuple[Code, Severity, str, str]]:
    return [
        (d.code, d.severity, d.message, text[d.span.start : d.span.end]) for d in findings(text)
    ]


def turn_and_slide(word: str, start: str, **more: int) -> str:
    return chain_spec({"J": R, "K": P}, word, start, **more)


# --- what is said --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("word", "start"),
    [
        ("B eps J eps L eps E", "0.1"),
        ("B eps J eps J eps L eps E", "0.1 rad, 20 deg"),  # they merge, and count as two
        ("B eps J eps L eps E eps J", "0, 0"),
        ("B eps J eps K eps L eps E", "0.1 rad, 0.5 m"),
        ("B eps J eps K eps L eps E", "0.1, 0.5 m"),
        ("B (eps (J | K))+ eps L eps E", "0.5 m, 1 rad, 0.5 m"),
    ],
)
def test_starts_that_some_robot_has(word: str, start: str) -> None:
    assert findings(turn_and_slide(word, start)) == []


@pytest.mark.parametrize(
    ("word", "start", "count", "hint"),
    [
        ("B eps J eps J eps L eps E", "0.1", "1 degree of freedom", "every robot has 2 or more"),
        ("B eps J eps L eps E eps J", "0, 0, 0", "3 degrees of freedom", "degree of freedom of"),
        ("B (eps J eps K)+ eps L eps E", "0, 0, 0", "3 degrees of freedom", "of the word;"),
        ("B eps L eps E", "0", "1 degree of freedom", "as it is, `synth` finds none"),
    ],
)
def test_no_robot_has_so_many(word: str, start: str, count: str, hint: str) -> None:
    text = turn_and_slide(word, start)
    (found,) = findings(text)
    assert said(text) == [
        (
            Code.START_OF_NO_ROBOT,
            Severity.WARNING,
            f"no robot of `G` has {count}",
            f"start at ({start});",
        )
    ]
    assert hint in (found.hint or "")


@pytest.mark.parametrize(
    ("word", "start", "number", "marked", "written", "met", "which"),
    [
        ("B eps J eps K eps L eps E", "0.5 m, 0.5 m", 1, "0.5 m", "a length", "revolute", ""),
        ("B eps J eps K eps L eps E", "0, 30 deg", 2, "30 deg", "an angle", "prismatic", ""),
        # Each value fits some robot, but both together none.
        ("B eps (J eps J | K eps K) eps L eps E", "0.1 rad, 1 m", 2, "1 m", "a length", "revolute",
         " that the values before it fit"),
        # Of three degrees of freedom the second always turns; those with two do not matter.
        ("B eps (K eps K | J eps J eps K | K eps J eps K) eps L eps E", "1 m, 2 m, 3 m", 2, "2 m",
         "a length", "revolute", ""),
    ],
)  # fmt: skip
def test_values_of_the_wrong_kind(
    word: str, start: str, number: int, marked: str, written: str, met: str, which: str
) -> None:
    count = start.count(",") + 1
    message = (
        f"value {number} is {written}, but that degree of freedom is {met} in every robot of "
        f"`G` with {count} degrees of freedom{which}"
    )
    assert said(turn_and_slide(word, start)) == [
        (
            Code.UNIT_MISMATCH,
            Severity.ERROR,
            message,
            marked,
        )
    ]


def test_robots_that_fit_and_are_too_large() -> None:
    word = "B (eps J)+ (eps L)+ eps E"
    assert findings(turn_and_slide(word, "0, 0, 0", modules=6)) == []
    (found,) = findings(turn_and_slide(word, "0, 0, 0", modules=5))
    message = "no robot of `G` that can start so has at most 5 modules"
    assert (found.code, found.message) == (Code.START_OF_NO_ROBOT, message)
    assert "write `modules <= 6`" in (found.hint or "")
    # That no robot whatever has so few is said of the bound (SRG0706).
    assert findings(turn_and_slide(word, "0, 0, 0", modules=3)) == []


def test_a_family_without_a_word_is_no_matter_of_the_start() -> None:
    text = turn_and_slide("B eps E", "0").replace(
        "accept matches", "accept not contains B and matches"
    )
    assert findings(text) == []


def test_a_long_start_of_a_family_that_nests_is_decided_at_once() -> None:
    """J as often to the left as K to the right: a pair of kinds that no finite automaton counts."""
    text = turn_and_slide("B eps J eps L eps E", "0")
    base = program(text)
    names = tuple(base.terminals)
    nested = replace(
        grammar("S -> B M E\nM -> J M K | L", names), semantics=base.grammars["G"].semantics
    )
    for left, right, fits in ((20, 20, True), (20, 22, False)):
        kinds = ("revolute",) * left + ("prismatic",) * right
        start = ir.StartAt((ir.Num(Fraction(0)),) * len(kinds), kinds=kinds)
        task = replace(base.tasks["Go"], start=start, modules=None)
        changed = replace(base, grammars={"G": nested}, tasks={"Go": task})
        sink = Sink()
        start_diagnostics(changed, sink)
        assert [d.code for d in sink.found] == ([] if fits else [Code.UNIT_MISMATCH])


# --- against all words ---------------------------------------------------------------------------

BASE = """\
module a { role base; dof p: prismatic x in [0, 1] m; dof q: revolute z; }
module b { role joint; dof q: revolute z; }
module B { role base; } module E { role effector; }
grammar G { start N; one: N -> B E; }
semantics G { one { point(frame: world, mass: 1 kg); effector(frame: world); } }
workspace W { plane xy; bounds box [0, 1] x [0, 1] m; target T box [0, 1] x [0, 1] m; }
task Go { robot G; workspace W; start at (0); reach T; horizon 1 steps of 1 s; }
"""
DOFS: dict[str, list[ir.DofKind]] = {"a": ["prismatic", "revolute"], "b": ["revolute"]}
LONGEST = 4
"""No longer word has as few degrees of freedom as the starts that are asked about."""
KINDS = st.lists(st.sampled_from([None, "revolute", "prismatic"]), min_size=1, max_size=LONGEST)


@settings(max_examples=examples(30, 150), deadline=None)
@given(random_grammars(), KINDS)
def test_all_short_words(rules: ir.Grammar, kinds: list[ir.DofKind | None]) -> None:
    base = program(BASE)
    start = ir.StartAt((ir.Num(Fraction(0)),) * len(kinds), kinds=tuple(kinds))
    task = replace(base.tasks["Go"], start=start, grammar=rules.name)
    changed = replace(base, grammars={rules.name: rules}, tasks={"Go": task})
    dofs = [
        [kind for symbol in word for kind in DOFS[symbol]]
        for word in words_of(rules, LONGEST)
        if word and satisfies(rules.accept, word)
    ]
    counted = [each for each in dofs if len(each) == len(kinds)]
    fits = any(
        all(want in (None, kind) for want, kind in zip(kinds, each, strict=True))
        for each in counted
    )
    sink = Sink()
    start_diagnostics(changed, sink)
    codes = [(d.code, d.severity) for d in sink.found]
    if fits:
        assert codes == []
    elif counted:
        assert codes == [(Code.UNIT_MISMATCH, Severity.ERROR)]
    else:
        assert codes in ([], [(Code.START_OF_NO_ROBOT, Severity.WARNING)])
        assert codes or not dofs  # nothing is said only of families without words

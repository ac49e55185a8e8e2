"""Bounds on changes that no robot keeps: what is found, and what not."""

from __future__ import annotations

import time
from fractions import Fraction
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.checks.mission_checks import least_cost
from compiler.words.acceptance import at_most
from compiler.words.finite_automaton import intersection
from compiler.words.language import language
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.load import load_text
from srgc.session import check_loaded
from tests.oracles.brute_force_grammar import satisfies, words_of
from tests.oracles.shaped_grammars import right_linear
from tests.oracles.some_cases import examples

TEXT = """\
module B { role base; const price = 0; }
module J { role joint; dof q: revolute z in [-150, 150] deg; const price = 0; }
module L { role link; param length in [0.5, 1.5] m; const price = 1; }
module E { role effector; const price = 1; }
edge eps;
grammar Arm {
  start N;
  base: N -> B;
  joint: N -> N eps J;
  link: N -> N eps L;
  tool: N -> N eps E;
  accept matches B (eps J eps L)+ eps E and count(J) >= 3;
}
semantics Arm {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  link { this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
workspace W { plane xy; bounds box [-9, 9] x [-9, 9] m; region S box [1, 2] x [0, 1] m; }
task First { robot Arm; workspace W; start in S; reach S; effort <= 10 N*m;
  horizon 20 steps of 0.1 s; from B eps J eps L eps E; }
task Second { robot Arm; workspace W; start in S; reach S; effort <= 10 N*m;
  horizon 20 steps of 0.1 s; }
"""
FAR = "every robot of `Arm` costs more than"


def found(clauses: str, text: str = TEXT) -> list[tuple[str, str]]:
    """Message and hint of each finding about a mission."""
    whole = f"{text}mission Day {{ tasks First, Second; {clauses} }}\n"
    checked = check_loaded(load_text(whole, "spec.srg"))
    told = [
        each
        for each in checked.diagnostics
        if each.code in {Code.CONTRADICTORY_MISSION, Code.ENDLESS_OBJECTIVE}
    ]
    kinds = {Code.CONTRADICTORY_MISSION: "warning", Code.ENDLESS_OBJECTIVE: "error"}
    assert all(each.severity.value == kinds[each.code] for each in told)
    return [(each.message, each.hint or "") for each in told]


# --- what no robot keeps -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("prices", "least"),
    [("", 4), ("add 2", 8), ("add 1/2, remove 7", 2), ("remove 0", 4), ("add 3/4", 3)],
)
def test_four_modules_are_to_be_added(prices: str, least: int) -> None:
    """The robot has one joint and one link, and is to have three of each."""
    below = Fraction(least) - Fraction(1, 1000)
    (message, hint), = found(f"reconfigure {prices}; changes <= {below};")  # fmt: skip
    assert message.startswith(f"{FAR} ")
    assert hint == (f"write `changes <= {least};` or more; no robot is within this bound")
    assert found(f"reconfigure {prices}; changes <= {least};") == []


def test_no_changes_at_all() -> None:
    (message, _), = found("reconfigure; changes <= 0;")  # fmt: skip
    assert message == f"{FAR} 0 to build from the existing robot"
    robot = "from B eps J eps L eps J eps L eps J eps L eps E"
    whole = TEXT.replace("from B eps J eps L eps E", robot)
    assert found("reconfigure; changes <= 0;", whole) == []


def test_place_and_note() -> None:
    text = f"{TEXT}mission Day {{ tasks First, Second; reconfigure; changes <= 1; }}\n"
    checked = check_loaded(load_text(text, "spec.srg"))
    (one,) = (d for d in checked.diagnostics if d.code is Code.CONTRADICTORY_MISSION)
    assert text[one.span.start : one.span.end] == "changes <= 1;"
    ((span, _),) = one.notes
    assert text[span.start : span.end] == "from B eps J eps L eps E;"


def test_the_least_bound_on_modules_counts() -> None:
    """From three joints and links back to two, where a task wants no more."""
    text = TEXT.replace("count(J) >= 3", "count(J) >= 2")
    text = text.replace(
        "from B eps J eps L eps E", "from B eps J eps L eps J eps L eps J eps L eps E"
    )
    bound = text.replace("0.1 s; }", "0.1 s; modules <= 7; }")
    assert found("reconfigure remove 3; changes <= 5;", text) == []
    message = (
        "every robot of `Arm` with at most 7 modules costs more than 5 "
        "to build from the existing robot"
    )
    hint = "write `changes <= 6;` or more; no robot is within this bound"
    assert found("reconfigure remove 3; changes <= 5;", bound) == [(message, hint)]
    assert found("reconfigure remove 3; changes <= 6;", bound) == []


def test_what_is_free_of_charge() -> None:
    assert found("reconfigure add 0, remove 0; changes <= 0;") == []
    assert found("reconfigure add 0; changes <= 0;") == []


def test_missions_of_which_nothing_is_said() -> None:
    assert found("reconfigure;") == []
    assert found("reconfigure; changes <= 0;", TEXT.replace("from B eps J eps L eps E;", "")) == []
    # An empty family, and a robot that is none of the family, are reported as that.
    assert found("reconfigure; changes <= 0;", TEXT.replace(">= 3", ">= 3 and count(J) < 2")) == []
    assert (
        found("reconfigure; changes <= 0;", TEXT.replace("from B eps J eps L eps E", "from E"))
        == []
    )


def test_long_robots_take_no_time() -> None:
    links = " ".join(["eps J eps L"] * 40)
    text = TEXT.replace("from B eps J eps L eps E", f"from B {links} eps E")
    text = text.replace("0.1 s; }", "0.1 s; modules <= 8; }")
    begun = time.perf_counter()
    (message, _), = found("reconfigure; changes <= 71;", text)  # fmt: skip
    assert "with at most 8 modules" in message
    assert time.perf_counter() - begun < 5


# --- the cheapest word, against all words ------------------------------------------------------

AB = ("a", "b")
MODULES = frozenset("a")
MOST = 5


def cost(
    word: tuple[str, ...], other: tuple[str, ...], prices: ir.Prices, modules: frozenset[str]
) -> Fraction:
    """The least cost of changing one into another, by trying everything."""

    @cache
    def rest(i: int, j: int) -> Fraction:
        if i == len(word) and j == len(other):
            return Fraction(0)
        ways: list[Fraction] = []
        if i < len(word):
            ways.append(prices.remove * (word[i] in modules) + rest(i + 1, j))
        if j < len(other):
            ways.append(prices.add * (other[j] in modules) + rest(i, j + 1))
        if i < len(word) and j < len(other) and word[i] == other[j]:
            ways.append(rest(i + 1, j + 1))
        return min(ways)

    return rest(0, 0)


amounts = st.sampled_from([Fraction(0), Fraction(1, 3), Fraction(1), Fraction(5, 2)])


@settings(deadline=None, max_examples=examples(30, 200))
@given(right_linear(), st.lists(st.sampled_from(AB), max_size=4).map(tuple), amounts, amounts)
def test_the_cheapest_word(
    g: ir.Grammar, word: tuple[str, ...], add: Fraction, remove: Fraction
) -> None:
    """Of at most so many symbols, which the oracle lists; each of them may be a module."""
    for modules in (MODULES, frozenset(AB)):
        prices = ir.Prices(add, remove)
        words = [other for other in words_of(g, MOST) if satisfies(g.accept, other)]
        costs = [cost(word, other, prices, modules) for other in words]
        automaton = language(g, AB, modules).condition(None)
        assert language(g, AB, modules).finite_automaton is not None
        found = least_cost(intersection(automaton, at_most(AB, AB, MOST)), modules, word, prices)
        assert found == min(costs, default=None)


# --- infinitely many robots of one value -------------------------------------------------------


def test_missions_whose_first_objective_leaves_infinitely_many() -> None:
    text = TEXT.replace("count(J) >= 3", "count(L) >= 3").replace(
        " (eps J eps L)+", " (eps J | eps L)+"
    )
    text = text.replace("from B eps J eps L eps E;", "")
    message = "infinitely many words of grammar `Arm` have the same sum of `price`"
    (told, hint), = found("one robot; minimize sum(price);", text)  # fmt: skip
    assert told == message
    assert hint == "write `modules <= n;` in a task, or give `price` of `J` a value above zero"
    assert found("one robot; minimize modules;", text) == []
    bound = text.replace("0.1 s; }", "0.1 s; modules <= 9; }", 1)
    assert found("one robot; minimize sum(price);", bound) == []

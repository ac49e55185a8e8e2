from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]

TASK = """
task P {{
  robot G; workspace W; start in S; effort <= 10 N*m; horizon 80 steps of 0.125 s;
  satisfy {};
}}
"""


@pytest.fixture(scope="session")
def formula(build: Build) -> Callable[[str], ir.Formula]:
    def make(text: str) -> ir.Formula:
        loaded = load_text(build(task=TASK.format(text)), "t")
        assert loaded.program is not None, loaded.diagnostics
        [clause] = loaded.program.tasks["P"].satisfy
        return clause.formula

    return make


S, T = ir.Atom("S", 1), ir.Atom("T", 1)
ALWAYS = ir.Window(Fraction(0), None)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("S", S),
        ("S by effector 1 + 1", ir.Atom("S", 2)),
        ("not S", ir.Not(S)),
        ("S and T and S", ir.And((S, T, S))),
        ("S or T and S", ir.Or((S, ir.And((T, S))))),
        ("S implies T implies S", ir.Implies(S, ir.Implies(T, S))),
        ("S until T until S", ir.Until(S, ir.Until(T, S))),
        ("S and T until S", ir.And((S, ir.Until(T, S)))),
        ("not S until T", ir.Until(ir.Not(S), T)),
        ("S or T implies S", ir.Implies(ir.Or((S, T)), S)),
        ("always not S", ir.Always(ir.Not(S), ALWAYS)),
        ("eventually[0 s, 2.5 s] S", ir.Eventually(S, ir.Window(Fraction(0), Fraction(5, 2)))),
        ("always[500 ms, 1 min] S", ir.Always(S, ir.Window(Fraction(1, 2), Fraction(60)))),
        ("eventually[1/3, 2 * 1 s] S", ir.Eventually(S, ir.Window(Fraction(1, 3), Fraction(2)))),
        ("eventually[1, 1] S", ir.Eventually(S, ir.Window(Fraction(1), Fraction(1)))),
        ("next next S", ir.Next(ir.Next(S))),
        ("last[(10/81) s] S", ir.Last(Fraction(10, 81), S)),
        ("last[0] not T", ir.Last(Fraction(0), ir.Not(T))),
        ("always (S implies next T)", ir.Always(ir.Implies(S, ir.Next(T)), ALWAYS)),
    ],
)
def test_meaning(text: str, expected: ir.Formula, formula: Callable[[str], ir.Formula]) -> None:
    assert formula(text) == expected


def test_a_plain_region_is_told_from_a_numbered_one(
    formula: Callable[[str], ir.Formula],
) -> None:
    plain, numbered = formula("S"), formula("S by effector 1")
    assert isinstance(plain, ir.Atom)
    assert isinstance(numbered, ir.Atom)
    assert plain == numbered
    assert (plain.numbered, numbered.numbered) == (False, True)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("always U", [("UNKNOWN_NAME", "U")]),
        ("U until V", [("UNKNOWN_NAME", "U"), ("UNKNOWN_NAME", "V")]),
        ("eventually W", [("WRONG_KIND", "W")]),
        ("S by effector 0", [("BAD_VALUE", "0")]),
        ("S by effector 1.5", [("BAD_VALUE", "1.5")]),
        ("S by effector 1 m", [("UNIT_MISMATCH", "1 m")]),
        ("always[2 s, 1 s] S", [("EMPTY_INTERVAL", "[2 s, 1 s]")]),
        ("always[-1 s, 1 s] S", [("BAD_VALUE", "-1 s")]),
        ("always[-2 s, -1 s] S", [("BAD_VALUE", "-2 s"), ("BAD_VALUE", "-1 s")]),
        ("eventually[0, 1 m] S", [("UNIT_MISMATCH", "1 m")]),
        ("eventually[0, pi] S", [("NOT_RATIONAL", "pi")]),
        ("last[-1] S", [("BAD_VALUE", "-1")]),
        ("last[1 kg] S", [("UNIT_MISMATCH", "1 kg")]),
        ("not " * 5 + "U", [("UNKNOWN_NAME", "U")]),
    ],
)
def test_findings(
    text: str, found: list[tuple[str, str]], check_fragment: Check, build: Build
) -> None:
    assert check_fragment(build(task=TASK.format(text))) == found


def test_a_deep_formula(check_fragment: Check, build: Build) -> None:
    for text in ("not " * 3000 + "S", "S until " * 3000 + "S"):
        found = check_fragment(build(task=TASK.format(text)))
        assert [code for code, _ in found] == ["TOO_DEEP"]
    assert check_fragment(build(task=TASK.format("(" * 3000 + "S" + ")" * 3000))) == []
    assert check_fragment(build(task=TASK.format("not " * 90 + "S"))) == []


def test_a_wide_formula(formula: Callable[[str], ir.Formula]) -> None:
    found = formula(" and ".join(["S"] * 5000))
    assert isinstance(found, ir.And)
    assert len(found.operands) == 5000

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]

PLANE = "plane xy; bounds box [0, 5] x [0, 5];"


def shape(text: str, head: str = PLANE) -> ir.Inequalities | ir.Hull:
    loaded = load_text(f"workspace W {{ {head} region R {text}; }}", "t")
    assert loaded.program is not None, loaded.diagnostics
    return loaded.program.workspaces["W"].region("R").shape


def rows(*values: tuple[str, ...]) -> ir.Inequalities:
    """Rows of (normal..., offset)."""
    numbers = [tuple(Fraction(v) for v in row) for row in values]
    return ir.Inequalities(tuple(ir.HalfSpace(n[:-1], n[-1]) for n in numbers))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "box [0, 1] x [-2, 3]",
            (("-1", "0", "0"), ("1", "0", "1"), ("0", "-1", "2"), ("0", "1", "3")),
        ),
        (
            "box [0, 50] cm x [0.1, 2] m",
            (("-1", "0", "0"), ("1", "0", "1/2"), ("0", "-1", "-1/10"), ("0", "1", "2")),
        ),
        (
            "box [0, 50] x [0.1, 200] cm",
            (("-1", "0", "0"), ("1", "0", "1/2"), ("0", "-1", "-1/1000"), ("0", "1", "2")),
        ),
        (
            "box [0, 50 cm] x [1/3, 2] m",
            (("-1", "0", "0"), ("1", "0", "1/2"), ("0", "-1", "-1/3"), ("0", "1", "2")),
        ),
        ("polytope { 2*x + 3*(y - 1) <= 4 }", (("2", "3", "7"),)),
        ("polytope { 2*x + 3*(y - 1) <= 4; } cm", (("2", "3", "7/100"),)),
        ("polytope { x >= 2; 1 <= y }", (("-1", "0", "-2"), ("0", "-1", "-1"))),
        ("polytope { -(x - y)/2 <= 10 cm }", (("-1/2", "1/2", "1/10"),)),
        ("polytope { x + 1 <= 2*(x - y) - 0.1 }", (("-1", "2", "-11/10"),)),
        ("polytope { x*0.1 + 0.2*y <= sqrt(4) * cos(60 deg) * 1 m }", (("1/10", "1/5", "1"),)),
        ("polytope { 2 m * x <= 4 m^2 }", (("2", "0", "4"),)),
    ],
)
def test_rows(text: str, expected: tuple[tuple[str, ...], ...]) -> None:
    assert shape(text) == rows(*expected)


def test_hull_and_space() -> None:
    assert shape("hull (0, 0), (50, 0), (0, 1 m) cm") == ir.Hull(
        ((Fraction(0), Fraction(0)), (Fraction(1, 2), Fraction(0)), (Fraction(0), Fraction(1)))
    )
    space = "space xyz; bounds box [0, 1] x [0, 1] x [0, 1];"
    assert shape("polytope { z - x <= 1 }", space) == rows(("-1", "0", "1", "1"))
    assert shape("hull (1, 2, 3)", space) == ir.Hull(((Fraction(1), Fraction(2), Fraction(3)),))


SMALL = st.fractions(min_value=-9, max_value=9, max_denominator=9)


@given(SMALL, SMALL, SMALL, SMALL, st.sampled_from(["<=", ">="]), SMALL, SMALL)
def test_rows_have_the_points_of_the_text(
    a: Fraction, b: Fraction, c: Fraction, d: Fraction, sign: str, x: Fraction, y: Fraction
) -> None:
    """The half-space holds a point exactly if the inequality as written does."""
    if a - d == 0 and b == 0:
        return
    text = f"polytope {{ ({a})*x + ({b})*(y - ({c})) {sign} ({d})*(x + 1) }}"
    found = shape(text)
    assert isinstance(found, ir.Inequalities)
    (row,) = found.rows
    left, right = a * x + b * (y - c), d * (x + 1)
    inside = row.normal[0] * x + row.normal[1] * y <= row.offset
    assert inside == (left <= right if sign == "<=" else left >= right)


@pytest.mark.parametrize(
    ("items", "found"),
    [
        ("plane xy;", [("MISSING_CLAUSE", "W")]),
        ("bounds box [0, 1] x [0, 1];", [("MISSING_CLAUSE", "W")]),
        (PLANE + "space xyz;", [("REPEATED_CLAUSE", "space xyz;")]),
        (
            PLANE + "bounds box [0, 1] x [0, 1];",
            [("REPEATED_CLAUSE", "bounds box [0, 1] x [0, 1];")],
        ),
        (PLANE + "region R hull (0, 0); target R hull (0, 0);", [("DUPLICATE_NAME", "R")]),
        (PLANE + "region R box [5, 0.5] x [0, 1];", [("EMPTY_INTERVAL", "[5, 0.5]")]),
        (PLANE + "region R box [0, 1];", [("OUT_OF_PLANE", "box [0, 1]")]),
        (
            PLANE + "region R box [0, 1] x [0, 1] x [0, 1];",
            [("OUT_OF_PLANE", "box [0, 1] x [0, 1] x [0, 1]")],
        ),
        (PLANE + "region R box [0, 1] x [0, 1] kg;", [("UNIT_MISMATCH", "kg")]),
        (PLANE + "region R box [0, pi] x [0, 1];", [("NOT_RATIONAL", "pi")]),
        (PLANE + "region R box [0, c] x [0, 1];", [("UNKNOWN_NAME", "c")]),
        (PLANE + "region R hull (0, 0, 0);", [("OUT_OF_PLANE", "(0, 0, 0)")]),
        (PLANE + "region R polytope { x < 1 };", [("STRICT_INEQUALITY", "x < 1")]),
        (PLANE + "region R polytope { x == 1 };", [("NOT_LINEAR", "x == 1")]),
        (PLANE + "region R polytope { 0 <= 1 };", [("NOT_LINEAR", "0 <= 1")]),
        (PLANE + "region R polytope { x - x <= 1 };", [("NOT_LINEAR", "x - x <= 1")]),
        (PLANE + "region R polytope { x*y <= 1 };", [("NOT_LINEAR", "x*y")]),
        (PLANE + "region R polytope { 1/x <= 1 };", [("NOT_LINEAR", "1/x")]),
        (PLANE + "region R polytope { sin(x) <= 1 };", [("NOT_LINEAR", "sin(x)")]),
        (PLANE + "region R polytope { x^2 <= 1 };", [("NOT_LINEAR", "x^2")]),
        (PLANE + "region R polytope { x/0 <= 1 };", [("BAD_NUMBER", "0")]),
        (PLANE + "region R polytope { z <= 1 };", [("OUT_OF_PLANE", "z")]),
        (PLANE + "region R polytope { x <= 3 kg };", [("UNIT_MISMATCH", "3 kg")]),
        (PLANE + "region R polytope { x <= 3 deg };", [("UNIT_MISMATCH", "3 deg")]),
        (PLANE + "region R polytope { x <= pi };", [("NOT_RATIONAL", "pi")]),
        (PLANE + 'obstacles from "map.yaml";', [("UNREADABLE_REFERENCE", '"map.yaml"')]),
    ],
)
def test_findings(items: str, found: list[tuple[str, str]], check: Check) -> None:
    assert check(f"workspace W {{ {items} }}") == found

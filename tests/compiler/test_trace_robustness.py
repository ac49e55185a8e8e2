"""Bounds of robustness against the definitions at every level, and against rtamt."""

from __future__ import annotations

import re
import warnings
from fractions import Fraction
from itertools import pairwise
from math import inf
from typing import Any

from hypothesis import example, given, settings
from hypothesis import strategies as st

from compiler.tasks.monitor import AtomKey, Monitored, Piece
from grammar_lang import ir
from grammar_lang.ir.formula_parts import operands
from tests.compiler.test_monitor import by_sign
from tests.oracles.formula_semantics import Meaning
from tests.oracles.formulas import formulas
from tests.oracles.some_cases import examples

with warnings.catch_warnings():
    # Its parser's runtime imports names that Python has since moved.
    warnings.simplefilter("ignore", DeprecationWarning)
    import rtamt

F = Fraction
SECONDS = 4
KEYS = [AtomKey("A", 1), AtomKey("C", 1)]
DEPTHS = [-3, -2, -1, 0, 1, 2, 3]
TRACES = st.lists(
    st.lists(st.sampled_from(DEPTHS), min_size=SECONDS, max_size=SECONDS), min_size=2, max_size=2
)


def pieces(depths: list[int]) -> list[Piece]:
    """One piece a second; at zero nothing is known."""
    return [
        Piece(F(k), F(k + 1), float(max(depth, 0)), float(max(-depth, 0)))
        for k, depth in enumerate(depths)
    ]


def marked(depths: list[int], level: float, sign: int) -> list[bool]:
    """The parts of the grid at which some piece shows a depth or distance of a level."""
    within = [sign * depth >= level for depth in depths]
    ends = [within[0], *(a or b for a, b in pairwise(within)), within[-1]]
    return [
        ends[part // 2] if part % 2 == 0 else within[part // 2] for part in range(2 * SECONDS + 1)
    ]


def certain(formula: ir.Formula, trace: list[list[int]], level: float) -> bool:
    inside = [marked(depths, level, 1) for depths in trace]
    outside = [marked(depths, level, -1) for depths in trace]
    signal = [
        {
            1: frozenset(
                [name for (name, *_), values in zip(KEYS, inside, strict=True) if values[part]]
                + [
                    f"{n}?"
                    for (n, *_), values in zip(KEYS, outside, strict=True)
                    if not values[part]
                ]
            )
        }
        for part in range(2 * SECONDS + 1)
    ]
    return Meaning(signal, F(1), F(1)).holds(by_sign(formula))


@settings(max_examples=examples(100, 200), deadline=None)
@given(formulas(SECONDS, 1, deep=7), TRACES)
def test_the_largest_level_at_which_a_formula_is_certain(
    formula: ir.Formula, trace: list[list[int]]
) -> None:
    known = dict(zip(KEYS, map(pieces, trace), strict=True))
    levels = [level for level in (1, 2, 3, inf) if certain(formula, trace, level)]
    found = Monitored(formula, F(SECONDS), F(1)).robustness(known)
    assert found == max(levels, default=None)


def upright(formula: ir.Formula) -> ir.Formula:
    """A formula like it in which A is never negated and C always, without what rtamt lacks."""
    match formula:
        case ir.Atom(region=region):
            return ir.Not(formula) if region == "C" else formula
        case ir.Not(operand=part):
            return upright(part)
        case ir.Last(operand=part):
            return ir.Always(upright(part), ir.Window(F(1), F(2)))
        case ir.Next(operand=part):
            return ir.Eventually(upright(part), ir.Window(F(1), F(1)))
        case ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window):
            return type(formula)(upright(part), window)
        case ir.Until(left=left, right=right):
            return ir.Until(upright(left), closed(upright(right)))
        case _:
            both = operands(formula)
            kind = ir.And if isinstance(formula, ir.And) else ir.Or
            return kind(tuple(upright(part) for part in both))


def closed(formula: ir.Formula) -> ir.Formula:
    """A formula like it that holds on closed sets: no window of an `always` gets empty.

    Where one does, it holds on an open set of instants, of which the grid knows no first one.
    """
    match formula:
        case ir.Atom() | ir.Not():
            return formula
        case ir.Always(operand=part, window=window):
            return ir.Always(closed(part), ir.Window(F(0), window.upper))
        case ir.Eventually(operand=part, window=window):
            return ir.Eventually(closed(part), window)
        case ir.Until(left=left, right=right):
            return ir.Until(closed(left), closed(right))
        case _:
            both = operands(formula)
            kind = ir.And if isinstance(formula, ir.And) else ir.Or
            return kind(tuple(closed(part) for part in both))


def text(formula: ir.Formula) -> str:
    """A formula for rtamt on the parts of the grid, of which a second has two."""
    parts = [text(part) for part in operands(formula)]
    match formula:
        case ir.Atom(region=region):
            return region.lower()
        case ir.Not():
            return f"(not {parts[0]})"
        case ir.Always(window=window):
            return f"(always{span(window)} {parts[0]})"
        case ir.Eventually(window=window):
            return f"(eventually{span(window)} {parts[0]})"
        case ir.Until():
            return f"({' until '.join(parts)})"
        case ir.And():
            return f"({' and '.join(parts)})"
        case ir.Or():
            return f"({' or '.join(parts)})"
        case _:
            raise TypeError(formula)


def span(window: ir.Window) -> str:
    upper = SECONDS if window.upper is None else window.upper
    return f"[{2 * window.lower}:{2 * max(upper, window.lower)}]"


def by_rtamt(formula: ir.Formula, series: dict[str, list[float]]) -> float:
    """Every occurrence of an atom has a signal of its own, as rtamt shortens lists in place."""
    spec: Any = rtamt.StlDiscreteTimeSpecification()
    own: dict[str, list[float]] = {}

    def renamed(match: re.Match[str]) -> str:
        name = f"{match[0]}{len(own)}"
        own[name] = list(series[match[0]])
        return name

    written = re.sub(r"\b[ac]\b", renamed, text(formula))
    for name in (*own, "out"):
        spec.declare_var(name, "float")
    spec.spec = f"out = {written}"
    spec.parse()
    count = len(next(iter(series.values())))
    found: float = spec.evaluate({"time": list(range(count)), **own})[0][1]
    return found


@example(
    ir.And(
        (
            ir.Always(ir.Atom("A", 1), ir.Window(F(5), None)),
            ir.Until(ir.Atom("A", 1), ir.Not(ir.Atom("C", 1))),
        )
    ),
    [[-3] * SECONDS, [-3] * SECONDS],
)
@settings(max_examples=examples(75, 150), deadline=None)
@given(formulas(SECONDS, 1, deep=6).map(upright), TRACES)
def test_of_signals_known_exactly_it_is_what_rtamt_says(
    formula: ir.Formula, trace: list[list[int]]
) -> None:
    """Pieces are closed: at an instant between two the one that says more counts.

    That is the larger depth for A, never negated, and the larger distance for C, always negated.
    On the parts of the grid dense time is then discrete: as pieces are closed, the right side of an
    `until` that holds somewhere after an instant without the left one holds at that instant too.
    """
    series: dict[str, list[float]] = {}
    for name, depths, more in zip("ac", trace, (max, min), strict=True):
        values = [float(depths[0])]
        for before, after in pairwise(depths):
            values += [float(before), float(more(before, after))]
        series[name] = [*values, float(depths[-1]), float(depths[-1])]
    known = dict(zip(KEYS, map(pieces, trace), strict=True))
    found = Monitored(formula, F(SECONDS), F(1)).robustness(known)
    true = by_rtamt(formula, series)
    assert found == (true if true > 0 else None)


def test_right_after_an_instant_counts_what_holds_right_after() -> None:
    """`always[2, inf)` gets empty right after 2 s, until when C is 3 m away, and then 2 m."""
    formula = ir.Until(ir.Not(ir.Atom("C", 1)), ir.Always(ir.Atom("A", 1), ir.Window(F(2), None)))
    trace = [[-3, -3, -3, -3], [-3, -3, -2, -3]]
    known = dict(zip(KEYS, map(pieces, trace), strict=True))
    assert Monitored(formula, F(SECONDS), F(1)).robustness(known) == 2

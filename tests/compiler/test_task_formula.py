"""The one formula of a task, and the effectors that it binds."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from compiler.tasks.monitor import AtomKey, satisfied
from compiler.tasks.specification import (
    missing_effector,
    recorded_effector,
    task_formula,
)
from compiler.tasks.time_set import TimeSet
from grammar_lang import ir
from grammar_lang.ir.formula_parts import attained
from tests.oracles.tasks import avoid, task

F = Fraction
A1, A2, C1, C2 = (ir.Atom(r, e) for r in "AC" for e in (1, 2))
ALL = ir.Window(F(0), None)


def free(*formulas: ir.Formula, start: ir.StartIn | ir.StartAt | None = None) -> ir.Task:
    """A task without ``reach``."""
    clauses = tuple(ir.Satisfy(formula) for formula in formulas)
    given = task() if start is None else task(start=start)
    return replace(given, reach=None, satisfy=clauses)


def test_reach_and_avoid_are_sugar() -> None:
    given = replace(task(avoid("C"), reach="A"), satisfy=(ir.Satisfy(ir.Eventually(C2, ALL)),))
    never = [ir.Always(ir.Not(atom), ALL) for atom in (C1, C2)]
    assert task_formula(given, 2, 1) == ir.And((ir.Eventually(C2, ALL), ir.Last(F(0), A2), *never))
    assert task_formula(task(reach="A"), 1, 0) == ir.Last(F(0), A1)
    assert task_formula(free(C1), 1, 0) == C1


def test_bodies_have_no_formula() -> None:
    assert task_formula(task(avoid("C", subject="body"), reach="A"), 1, 0) == ir.Last(F(0), A1)
    assert task_formula(replace(task(avoid("C", subject="body")), reach=None), 1, 0) is None


START_IN, START_BY = ir.StartIn("A", None, F(0)), ir.StartIn("A", 2, F(0))
AT = ir.StartAt((ir.Num(F(0)),))


@pytest.mark.parametrize(
    ("given", "recorded"),
    [
        (task(), None),
        (replace(task(), reach=ir.Reach("A", 3)), 2),
        (task(start=START_BY), None),
        (free(A1, start=START_IN), None),
        (free(A1, start=START_BY), 1),
        (free(A1, start=AT), 0),
        (task(start=AT), None),
    ],
)
def test_the_recorded_effector(given: ir.Task, recorded: int | None) -> None:
    """It reaches; where nothing is to be reached it is the one that starts."""
    assert recorded_effector(given) == recorded


@pytest.mark.parametrize(
    ("given", "lacking"),
    [
        (free(ir.And((A1, ir.Not(ir.Next(C2))))), {0: 2, 1: 2, 2: None}),
        (task(start=START_BY), {1: 2, 2: None}),
        (replace(task(), reach=ir.Reach("A", 3)), {2: 3, 3: None}),
        (task(), {1: None}),
    ],
)
def test_robots_that_lack_a_named_effector(given: ir.Task, lacking: dict[int, int | None]) -> None:
    assert {count: missing_effector(given, count) for count in lacking} == lacking


def test_until_may_be_widened_by_a_closed_right_side() -> None:
    """Equal on every pair of closed sets with ends on a grid, whatever the left one is."""
    until, wide = ir.Until(A1, C1), attained(ir.Until(A1, C1))
    assert wide == ir.Until(ir.Or((A1, C1)), C1)
    end = F(4)
    intervals = [(F(a, 2), F(b, 2)) for a in range(9) for b in range(a, 9)]
    for left in intervals:
        for right in intervals:
            closed = TimeSet.closed(end, [right])
            for one in (TimeSet.closed(end, [left]), TimeSet.closed(end, [left]).complement):
                signals = {AtomKey("A", 1): one, AtomKey("C", 1): closed}
                found = satisfied(until, signals, end, F(1))
                assert found == satisfied(wide, signals, end, F(1))


def test_until_is_not_widened_by_a_right_side_that_is_open() -> None:
    kept = ir.Until(A1, ir.Not(C1))
    assert attained(kept) == kept
    assert attained(ir.Until(A1, ir.Next(C1))) == ir.Until(A1, ir.Next(C1))

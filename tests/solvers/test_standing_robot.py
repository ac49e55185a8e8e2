"""Robots that cannot move, for tasks with formulas: a rod along x whose length is free."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import WORLD
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from solvers.search.sampled_cells import standing_configurations
from tests.oracles.robots import Builder
from tests.oracles.tasks import task

F = Fraction
ALL = ir.Window(F(0), None)
A, C = ir.Atom("A", 1), ir.Atom("C", 1)


def strip(name: str, low: str, high: str) -> ir.Region:
    corners = tuple((F(x), F(y)) for x, y in ((low, -1), (high, -1), (high, 1), (low, 1)))
    return ir.Region(name, "region", ir.Hull(corners))


WORKSPACE = ir.Workspace(
    "W", 2, replace(strip("bounds", "-3", "3"), kind="bounds"),
    (strip("S", "1.0", "1.7"), strip("A", "1.2", "2.0"), strip("C", "1.4", "3.0")),
)  # fmt: skip


def lengths(*formulas: ir.Formula, reach: str | None = None) -> list[float]:
    builder = Builder()
    builder.effector(builder.link(WORLD, builder.parameter(F(1, 2), 2)))
    numeric = NumericRobot(robot_graph(builder.build(), (F(0), F(0))))
    given = task(reach=reach or "A")
    if reach is None:
        given = replace(given, reach=None)
    given = replace(given, satisfy=tuple(ir.Satisfy(formula) for formula in formulas))
    found = standing_configurations(numeric, WORKSPACE, given, abstract(WORKSPACE), 0, 1)
    return [float(configuration.outcome.trajectory.theta[0]) for _, configuration in found]


@pytest.mark.parametrize(
    ("formula", "best"),
    [
        (ir.Always(A, ALL), 1.45),
        (ir.And((ir.Eventually(A, ALL), ir.Not(C))), 1.3),
        (ir.Last(F(1, 2), ir.Not(A)), 1.1),
        (ir.Always(ir.Implies(A, ir.Eventually(C, ALL)), ALL), 1.55),
    ],
)
def test_the_best_place_to_stand(formula: ir.Formula, best: float) -> None:
    """In S = [1, 1.7] with A = [1.2, 2] and C = [1.4, 3]: the middle of what is left."""
    assert lengths(formula)[0] == pytest.approx(best, abs=0.01)


def test_none_where_the_formula_cannot_hold() -> None:
    assert lengths(ir.Until(A, ir.Not(A)), reach="C") == []
    assert lengths(ir.Always(C, ALL), ir.Always(ir.Not(A), ALL)) == []


def test_a_target_counts_besides() -> None:
    assert lengths(ir.Always(A, ALL), reach="C")[0] == pytest.approx(1.55, abs=0.01)

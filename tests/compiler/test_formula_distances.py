"""How many changes a formula needs at least, against shortest walks."""

from __future__ import annotations

from fractions import Fraction

import networkx as nx
import numpy as np
import pytest

from compiler.tasks.effector_distances import formula_distances
from compiler.tasks.places import UNREACHABLE
from compiler.tasks.sampled_formula import Literal, sampled
from grammar_lang import ir

A, C = ir.Atom("A", 1), ir.Atom("C", 1)
ELSE = ir.Atom("A", 2)
EVER = ir.Window(Fraction(0), None)
GRAPH = nx.convert_node_labels_to_integers(nx.grid_2d_graph(4, 5))
CELLS = {"A": {3, 4}, "C": {10, 17}}


def needed(formula: ir.Formula) -> list[int | None]:
    def inside(literal: Literal) -> np.ndarray | None:
        if literal.effector != 1:
            return None
        here = np.array([cell in CELLS[literal.region] for cell in range(20)])
        return here == literal.positive

    near = [sorted(GRAPH[cell]) for cell in range(20)]
    allowed = np.ones(20, dtype=bool)
    found = formula_distances(sampled(formula, Fraction(1), 9), near, allowed, inside)
    return [None if bound >= UNREACHABLE else bound for bound in found.tolist()]


def apart(one: int, other: int) -> int:
    return nx.shortest_path_length(GRAPH, one, other)


def eventually(part: ir.Formula) -> ir.Formula:
    return ir.Eventually(part, EVER)


@pytest.mark.parametrize("cell", range(20))
def test_visits_one_after_the_other(cell: int) -> None:
    to_a, to_c = (min(apart(cell, end) for end in CELLS[name]) for name in "AC")
    both = min(apart(cell, a) + apart(a, c) for a in CELLS["A"] for c in CELLS["C"])
    assert needed(eventually(A))[cell] == to_a
    assert needed(ir.Or((eventually(A), eventually(C))))[cell] == min(to_a, to_c)
    assert needed(ir.And((eventually(A), eventually(C))))[cell] == max(to_a, to_c)
    assert needed(eventually(ir.And((A, eventually(C)))))[cell] == both
    assert needed(ir.And((eventually(C), eventually(ELSE))))[cell] == to_c


def test_what_cannot_be() -> None:
    assert set(needed(eventually(ir.And((A, ir.Not(A)))))) == {None}
    inside = needed(ir.Always(A, EVER))
    assert [bound is not None for bound in inside] == [cell in CELLS["A"] for cell in range(20)]
    soon = needed(ir.Eventually(C, ir.Window(Fraction(0), Fraction(2))))
    to_c = [min(apart(cell, end) for end in CELLS["C"]) for cell in range(20)]
    assert soon == [bound if bound <= 2 else None for bound in to_c]
    # Through nothing but A to C: they are apart.
    assert needed(ir.Until(A, C)) == [0 if cell in CELLS["C"] else None for cell in range(20)]

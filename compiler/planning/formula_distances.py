"""How many changes of cell an effector needs at least for a formula to hold, from every cell.

Times and other effectors are left out, so that the numbers are lower bounds; they are exact for
visits one after the other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from heapq import heapify, heappop, heappush
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.planning.cell_graph import UNREACHABLE
from compiler.planning.clauses import Ints
from compiler.specifications.sampled_formula import (
    Eventually,
    Every,
    Literal,
    SampledFormula,
    Some,
    Throughout,
    ThroughoutFrom,
    Until,
    nodes,
    parts_of,
)

Mask: TypeAlias = NDArray[np.bool_]
NEAR = 4
"""Windows of so few samples bound the changes until they end."""


def formula_distances(
    formula: SampledFormula,
    neighbours: Sequence[Sequence[int]],
    allowed: Mask,
    inside: Callable[[Literal], Mask | None],
) -> Ints:
    """Per cell a lower bound, ``UNREACHABLE`` where the formula cannot hold; shape (n,).

    Args:
        formula: what is to hold.
        neighbours: per cell its neighbours.
        allowed: the cells that may be entered.
        inside: where a literal holds; None for one about another effector.
    """
    of: dict[int, Ints] = {}
    for node in nodes(formula):
        of[id(node)] = _bounds(node, of, neighbours, allowed, inside)
    return of[id(formula)]


def _bounds(
    node: SampledFormula,
    of: Mapping[int, Ints],
    neighbours: Sequence[Sequence[int]],
    allowed: Mask,
    inside: Callable[[Literal], Mask | None],
) -> Ints:
    none = np.zeros(len(neighbours), dtype=np.int64)
    parts = [of[id(part)] for part in parts_of(node)]
    match node:
        case Literal():
            holds = inside(node)
            return none if holds is None else np.where(holds, none, UNREACHABLE)
        case Every():
            return np.asarray(np.max([none, *parts], axis=0), dtype=np.int64)
        case Some():
            return np.asarray(np.min([none + UNREACHABLE, *parts], axis=0), dtype=np.int64)
        case Eventually(last=int() as last) if last <= NEAR:
            return _within(parts[0], neighbours, allowed, last)
        case Eventually() | ThroughoutFrom():
            return _on_the_way(parts[0], neighbours, allowed)
        case Until():
            return _on_the_way(parts[1], neighbours, allowed & (parts[0] < UNREACHABLE))
        case Throughout(first=0):
            return parts[0]
        case _:
            return none


def _within(goal: Ints, neighbours: Sequence[Sequence[int]], through: Mask, most: int) -> Ints:
    """As ``_on_the_way``, with so many changes at most; from sample to sample there is one."""
    found = goal.tolist()
    passable = np.flatnonzero(through).tolist()
    for _ in range(most):
        before = list(found)
        for cell in passable:
            nearest = min((before[other] for other in neighbours[cell]), default=UNREACHABLE)
            found[cell] = min(found[cell], nearest + 1)
    return np.minimum(np.array(found, dtype=np.int64), UNREACHABLE)


def _on_the_way(goal: Ints, neighbours: Sequence[Sequence[int]], through: Mask) -> Ints:
    """The least changes to a cell, through some cells, and from there as ``goal`` says."""
    if not goal.any():
        return goal
    found, passable = goal.tolist(), through.tolist()
    waiting = [(bound, cell) for cell, bound in enumerate(found) if bound < UNREACHABLE]
    heapify(waiting)
    while waiting:
        bound, cell = heappop(waiting)
        if bound > found[cell]:
            continue
        for other in neighbours[cell]:
            if passable[other] and found[other] > bound + 1:
                found[other] = bound + 1
                heappush(waiting, (bound + 1, other))
    return np.array(found, dtype=np.int64)

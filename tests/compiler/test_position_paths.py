"""Clauses of paths: their variables, their models, and what is added when the bound grows."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.formula_clauses import Clauses
from compiler.tasks.places import distances, edges
from compiler.tasks.plan_encoding import EntrySamples, TotalChanges
from compiler.tasks.position_paths import Ladders, PositionPaths


def line(count: int) -> tuple[tuple[int, ...], ...]:
    return tuple(tuple(j for j in (i - 1, i + 1) if 0 <= j < count) for i in range(count))


def satisfiable(clauses: list[list[int]], variables: int, fixed: dict[int, bool]) -> bool:
    """By trying all values of the variables that are not fixed."""
    free = [v for v in range(1, variables + 1) if v not in fixed]
    for bits in product([False, True], repeat=len(free)):
        value = fixed | dict(zip(free, bits, strict=True))
        if all(any(value[abs(lit)] == (lit > 0) for lit in c) for c in clauses):
            return True
    return False


def listed(clauses: Clauses) -> list[list[int]]:
    return [row for array in clauses.taken() for row in array.tolist()]


def test_at_most_one_of_a_group_that_grows() -> None:
    clauses = Clauses()
    own = clauses.fresh(5, lambda i: f"x{i}")
    ladders = Ladders(clauses, "group")
    ladders.extend(np.array([3, 0, 3]), own[:3])
    ladders.extend(np.array([3, 0]), own[3:])
    found = listed(clauses)
    for bits in product([False, True], repeat=5):
        fixed = dict(zip(own.tolist(), bits, strict=True))
        expected = bits[0] + bits[2] + bits[3] <= 1 and bits[1] + bits[4] <= 1
        assert satisfiable(found, clauses.variables, fixed) is expected


def paths(count: int, start: list[int], end: list[int]) -> tuple[Clauses, PositionPaths]:
    near, allowed = line(count), np.ones(count, dtype=bool)
    clauses = Clauses()
    return clauses, PositionPaths(
        clauses,
        edges(near),
        distances(near, start, allowed),
        distances(near, end, allowed),
        who="effector 1",
        cell_name=str,
        simple=True,
    )


def table(of: PositionPaths, cells: int, layers: int) -> NDArray[np.bool_]:
    return np.array([[of.variable(c, j) > 0 for c in range(cells)] for j in range(layers)])


def test_variables_exist_only_where_the_cell_can_be() -> None:
    """A line of four cells from the first two to the last, in 2, 3 and 4 changes."""
    _, found = paths(4, [0, 1], [3])
    assert (found.shortest, found.bound) == (2, 1)
    found.extend()
    assert table(found, 4, 4).tolist() == [
        [False, True, False, False],
        [False, False, True, False],
        [False, False, False, True],
        [False, False, False, False],
    ]
    found.extend()
    assert found.bound == 3
    # With three changes cell 0 is a start too, and all cells can be one position later.
    assert table(found, 4, 4).tolist() == [
        [True, True, False, False],
        [False, True, True, False],
        [False, False, True, True],
        [False, False, False, True],
    ]
    before = found.places
    new = found.extend()
    assert len(found.places.cells) == len(before.cells) + len(new.cells) == 3 + 4 + 4
    assert sorted(new.layers.tolist()) == [1, 2, 3, 4]


def test_positions_are_entered_one_after_the_other() -> None:
    """Three positions, of which the last need not exist, within samples 0 to 3."""
    clauses, found = paths(3, [0], [1])
    found.extend()
    found.extend()
    clauses.taken()
    entries = EntrySamples(clauses, found, 3, "effector 1")
    rows = [entries.row(position) for position in range(3)]
    there = found.exists(2)
    given = listed(clauses)
    free = [int(v) for row in rows for v in row if v > 1]
    entered = set()
    for bits in product([False, True], repeat=len(free) + 1):
        value = dict(zip([*free, there], bits, strict=True)) | {1: True}
        own = [c for c in given if all(abs(lit) in value for lit in c)]
        if all(any(value[abs(lit)] == (lit > 0) for lit in c) for c in own):
            true = np.zeros(clauses.variables + 1, dtype=bool)
            true[[v for v, holds in value.items() if holds]] = True
            count = 2 + value[there]
            entered.add(entries.entries(count, true))
    assert entered == {(0, *rest) for count in (1, 2) for rest in combinations(range(1, 4), count)}


def test_the_sum_of_changes_is_bounded() -> None:
    """Two paths of 1 to 3 changes: what is left when both have so many and the sum is bounded."""
    for first, second, bound in product((1, 2, 3), (1, 2, 3), (2, 3, 4, 5)):
        clauses = Clauses()
        both = []
        for _ in range(2):
            near, allowed = line(2), np.ones(2, dtype=bool)
            start, end = (distances(near, [cell], allowed) for cell in (0, 1))
            both.append(
                PositionPaths(
                    clauses, edges(near), start, end, who="e", cell_name=str, simple=False
                )
            )
        above = TotalChanges(clauses, both).above(bound)
        fixed = {1: True, above: False}
        for path, length in zip(both, (first, second), strict=True):
            fixed |= {path.exists(p): p <= length for p in range(2, 6)}
        given = listed(clauses)
        assert satisfiable(given, clauses.variables, fixed) is (first + second <= bound)


def test_nothing_to_find() -> None:
    assert paths(3, [], [2])[1].shortest is None
    assert paths(3, [1], [])[1].shortest is None

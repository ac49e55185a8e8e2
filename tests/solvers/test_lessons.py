"""What attempts teach about paths: found ones stay allowed, also where cells are cut."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from solvers.planner import CounterExample, EffectorPath, Plan
from solvers.search.search_state import Blocked, Cause, PathAttempt
from solvers.search.structure_search import Lessons


def path(*cells: int) -> EffectorPath:
    return EffectorPath(0, cells, None)


def attempt(core: tuple[int, ...] | None, *, ordered: bool = True) -> PathAttempt:
    """One that found a motion, or none through the cells of a core."""
    nearest: Any = SimpleNamespace(feasible=core is None)
    excluded = None if core is None else CounterExample(0, core, "", ordered=ordered)
    return PathAttempt(Blocked(Cause.UNPROVED), excluded=excluded, nearest=nearest)


FOUND = Lessons().after(attempt(None), path(1, 2, 3))


@pytest.mark.parametrize(
    ("tried", "core", "blocked"),
    [
        ((1, 4, 3), (1, 4), (1, 4)),
        ((1, 4, 3), (4,), (4,)),
        ((1, 2, 4), (1, 2), (1, 2, 4)),
        ((1, 2, 4, 3), (1,), (1, 2, 4)),
        ((1, 4, 2, 3), (2, 3), (1, 4, 2, 3)),
        ((1, 2), (1, 2), None),
        ((1, 2), (), None),
        ((1, 4), (), (1, 4)),
    ],
)
def test_a_core_grows_until_it_spares_what_was_found(
    tried: tuple[int, ...], core: tuple[int, ...], blocked: tuple[int, ...] | None
) -> None:
    lessons = FOUND.after(attempt(core), path(*tried))
    assert [item.cells for item in lessons.blocked] == ([] if blocked is None else [blocked])
    assert not lessons.excludes(Plan((path(1, 2, 3),)))
    assert lessons.excludes(Plan((path(*tried),))) == (blocked is not None)


def test_without_order_both_orders_are_meant() -> None:
    lessons = Lessons().after(attempt((2, 5), ordered=False), path(1, 2, 5, 3))
    assert lessons.excludes(Plan((path(5, 4, 2),)))
    assert not lessons.excludes(Plan((path(1, 2, 4),)))
    ordered = Lessons().after(attempt((2, 5)), path(1, 2, 5, 3))
    assert not ordered.excludes(Plan((path(5, 4, 2),)))
    assert ordered.excludes(Plan((path(2, 4, 5),)))


def test_another_effector_is_not_meant() -> None:
    lessons = FOUND.after(attempt((1, 2)), path(1, 2, 4))
    assert not lessons.excludes(Plan((EffectorPath(1, (1, 2, 4), None),)))


def test_what_is_said_of_a_cell_that_is_cut_is_forgotten() -> None:
    lessons = FOUND.after(attempt((1, 4)), path(1, 4, 3)).after(attempt((1, 5)), path(1, 5, 3))
    finer = lessons.in_finer_cells({1: 10, 2: 20, 3: 30, 5: 50})
    assert [item.cells for item in finer.blocked] == [(10, 50)]
    assert finer.followed == ((0, (10, 20, 30)),)
    assert finer.after(attempt((10, 20)), path(10, 20, 50)).blocked[-1].cells == (10, 20, 50)
    assert lessons.in_finer_cells({1: 10, 3: 30}).followed == ()

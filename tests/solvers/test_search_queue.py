"""Whose turn it is, and that what was found is never excluded."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from solvers.planner import CounterExample
from solvers.search.search_queue import SearchQueue, StructureUnderWay
from solvers.search.search_state import Blocked, Cause, PathAttempt, StructureState


def nearest(robustness: float, *, feasible: bool = False) -> Any:
    return SimpleNamespace(
        feasible=feasible, robustness=robustness, rank=(feasible, robustness), text=""
    )


def states(worths: list[float]) -> Iterator[StructureState]:
    attempts: tuple[PathAttempt, ...] = ()
    for worth in worths:
        attempt = PathAttempt(Blocked(Cause.NOT_FOLLOWED), worth, nearest=nearest(worth))
        attempts = (*attempts, attempt)
        yield StructureState(attempts)
    yield StructureState(attempts, "no path is left")


def turns(worths: list[list[float]], *, every: bool) -> list[int]:
    """The numbers of the structures as they have their turns, until nothing is left."""
    queue, left, found = SearchQueue(every), list(enumerate(worths)), list[int]()
    while left or queue.under_way:
        if left and queue.wants_another():
            number, own = left.pop(0)
            candidate: Any = SimpleNamespace(number=number)
            entered = StructureUnderWay(queue.entered, candidate, 0, lambda: None)
            queue.enter(entered, states(own))
            continue
        structure = queue.turn()
        found.append(structure.number)
        if structure.state.is_over:
            queue.leave(structure)
    return found


def test_smaller_structures_are_ahead_and_keep_nobody_waiting() -> None:
    equal = [[-1.0] * 9 for _ in range(3)]
    assert turns(equal, every=False)[:9] == [0, 0, 1, 0, 1, 2, 0, 1, 2]


def test_the_most_promising_goes_first_within_a_round() -> None:
    assert turns([[-5.0] * 9, [-1.0] * 9], every=False)[:6] == [0, 0, 1, 1, 0, 1]


def test_what_no_motion_is_expected_for_comes_later() -> None:
    """The first one has a counterexample without cells: others have turns before its second."""
    excluded = CounterExample(0, (), "")
    first = PathAttempt(Blocked(Cause.NOT_FOLLOWED), -1.0, excluded=excluded, nearest=nearest(-1.0))
    queue = SearchQueue(every=False)
    for number, own in ((0, (first,)), (1, ())):
        candidate: Any = SimpleNamespace(number=number)
        structure = StructureUnderWay(queue.entered, candidate, 0, lambda: None)
        queue.enter(structure, states([-5.0] * 9))
        structure.state = StructureState(own)
    assert [queue.turn().number for _ in range(3)] == [1, 1, 1]


def test_with_all_each_is_searched_to_its_end() -> None:
    assert turns([[-1.0] * 2, [-1.0]], every=True) == [0, 0, 0, 1, 1]


def test_no_path_is_excluded_along_which_a_motion_was_found() -> None:
    excluded = CounterExample(0, (1, 2), "")
    answer = Blocked(Cause.UNPROVED)
    PathAttempt(answer, -1.0, excluded=excluded, nearest=nearest(-1.0))
    with pytest.raises(ValueError, match="no motion along it was found"):
        PathAttempt(answer, 1.0, excluded=excluded, nearest=nearest(1.0, feasible=True))


def test_a_state_is_read_off_its_attempts() -> None:
    attempts = (
        PathAttempt(Blocked(Cause.UNPROVED, "; proof"), 2.0, nearest=nearest(2.0, feasible=True)),
        PathAttempt(Blocked(Cause.NOT_FOLLOWED), 3.0, nearest=nearest(3.0)),
    )
    state = StructureState(attempts)
    assert (state.best, state.obstacle, state.design, state.is_over) == (
        3.0,
        "; proof",
        None,
        False,
    )
    assert state.nearest is attempts[0].nearest

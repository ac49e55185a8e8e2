"""Row 4.18: the formula phi (Eqn. 6) forbids to stay, and to be in the target early."""

from __future__ import annotations

from itertools import pairwise, product

from compiler.tasks.specification import PlannedEffector, PlanningProblem
from solvers.planner import Planner
from solvers.verdict import Holds

S, F, T = range(3)
NEIGHBOURS = ((F,), (S, T), (F,))
"""Three cells in a row: the start and the middle one are free, the last one is the target."""


def paths(steps: int, *, staying: bool) -> list[tuple[int, ...]]:
    """All cell sequences from the start that satisfy phi; ``staying``: N_ii = 1."""

    def adjacent(a: int, b: int) -> bool:
        return b in NEIGHBOURS[a] or (staying and a == b)

    return [
        path
        for path in product((S, F, T), repeat=steps + 1)
        if path[0] == S and path[-1] == T and T not in path[:-1]
        if all(adjacent(a, b) for a, b in pairwise(path))
    ]


def planned(steps: int) -> tuple[int, ...]:
    problem = PlanningProblem(
        NEIGHBOURS, (frozenset(),) * 3, (PlannedEffector(0, (S,), (), (T,)),), None, False,
        steps, steps, ("S", "free", "T"),
    )  # fmt: skip
    match Planner(problem).next_plan():
        case Holds(witness=plan):
            return plan.paths[0].cells
    raise AssertionError


def test_as_printed_the_number_of_steps_has_to_be_even() -> None:
    assert paths(2, staying=False) == [(S, F, T)]
    assert [len(paths(steps, staying=False)) for steps in (1, 3, 5, 7)] == [0, 0, 0, 0]


def test_who_may_stay_may_not_be_early() -> None:
    found = paths(3, staying=True)
    assert found == [(S, S, F, T), (S, F, F, T)]
    assert (S, F, T, T) not in found


def test_a_plan_lists_changes_of_cell_for_any_number_of_steps() -> None:
    assert [planned(steps) for steps in (2, 3, 5, 81)] == [(S, F, T)] * 4

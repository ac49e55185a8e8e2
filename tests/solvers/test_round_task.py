"""Planning problems of loops, against all words by brute force."""

from __future__ import annotations

from itertools import pairwise, product

import pytest

from compiler.tasks.specification import PlannedEffector, PlanningProblem
from compiler.tasks.word_formula import Literal, SampledFormula, eventually
from grammar_lang import ir
from solvers.planner import Planner
from solvers.search.round_task import RoundTask, closing
from solvers.verdict import Holds

STEPS = 5
NEIGHBOURS = ((1,), (0, 2, 3), (1, 3), (1, 2))
GOAL = eventually(Literal("goal", 1, positive=True), 0, None)


def task() -> ir.Task:
    """One of which nothing is read."""
    return ir.Task.__new__(ir.Task)


def words(shape: RoundTask, formula: SampledFormula | None) -> set[tuple[int, ...]]:
    """All that the planner gives, as one cell per sample."""
    regions = (frozenset[str](), frozenset[str](), frozenset({"goal"}), frozenset[str]())
    problem = PlanningProblem(
        NEIGHBOURS, regions, (PlannedEffector(0, (0,)),), formula, False, STEPS, STEPS
    )
    (closed,) = closing(problem, shape)
    planner, found = Planner(closed), set[tuple[int, ...]]()
    while isinstance(answer := planner.next_plan(), Holds):
        (path,) = answer.witness.paths
        assert path.entries is not None
        ends = [*path.entries[1:], STEPS + 1]
        found.add(
            tuple(
                cell
                for cell, first, last in zip(path.cells, path.entries, ends, strict=True)
                for _ in range(first, last)
            )
        )
    return found


@pytest.mark.parametrize("loop", [1, 2, 4])
@pytest.mark.parametrize("stays", [False, True])
@pytest.mark.parametrize("formula", [None, GOAL])
def test_paths_that_close(loop: int, stays: bool, formula: SampledFormula | None) -> None:
    expected = {
        word
        for word in product(range(4), repeat=STEPS + 1)
        if word[0] == 0
        and all(a == b or b in NEIGHBOURS[a] for a, b in pairwise(word))
        and (len(set(word[loop:])) == 1 if stays else word[loop] == word[STEPS])
        and (formula is None or 2 in word)
    }
    assert words(RoundTask(task(), loop, stays), formula) == expected
    assert expected or loop == 1


def test_all_effectors_of_a_tour_come_back() -> None:
    """Two effectors on three cells in a row; the second one begins anywhere."""
    line, steps = ((1,), (0, 2), (1,)), 3
    effectors = PlannedEffector(0, (0,)), PlannedEffector(1, (0, 1, 2))
    problem = PlanningProblem(line, (frozenset[str](),) * 3, effectors, None, True, steps, 6)
    (closed,) = closing(problem, RoundTask(task(), 0))
    planner, found = Planner(closed), set[tuple[tuple[int, ...], ...]]()
    while isinstance(answer := planner.next_plan(), Holds):
        found.add(
            tuple(
                tuple(
                    path.cells[sum(entry <= sample for entry in path.entries or ()) - 1]
                    for sample in range(steps + 1)
                )
                for path in answer.witness.paths
            )
        )
    tours = [
        word
        for word in product(range(3), repeat=steps + 1)
        if word[0] == word[-1] and all(a == b or b in line[a] for a, b in pairwise(word))
    ]
    assert found == {(one, other) for one in tours if one[0] == 0 for other in tours}

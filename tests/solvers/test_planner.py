"""The planner against trying everything."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import networkx as nx
import pytest
from hypothesis import assume, event, given, settings
from hypothesis import strategies as st

from compiler.tasks.sampled_formula import sampled
from compiler.tasks.specification import (
    PlannedEffector,
    PlanningProblem,
    planning_problem,
)
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from solvers.planner import CounterExample, Exhausted, Exhaustion, Plan, Planner
from solvers.verdict import Fails, Holds, Reason, Unknown
from tests.oracles.planes import bench, cuts_of_the_bench, workspaces
from tests.oracles.plans import Case, Cells, brute_force, cases, changes, without_stays
from tests.oracles.some_cases import examples
from tests.oracles.tasks import avoid, task

MOST = 150
"""So many plans of a case are listed."""

A, C = ir.Atom("A", 1), ir.Atom("C", 1)
EVER = ir.Window(Fraction(0), None)


def drain(planner: Planner, most: int = 10**6) -> tuple[list[Plan], Exhausted | None]:
    plans: list[Plan] = []
    while len(plans) < most:
        match planner.next_plan():
            case Holds(witness=plan):
                plans.append(plan)
            case Fails(counterexample=end):
                return plans, end
            case Unknown():
                pytest.fail("a small problem needs no budget")
    return plans, None


def word(case: Case, cells: Cells, entries: Cells | None) -> Cells:
    """A path as a cell per sample, or per position."""
    if entries is None:
        return cells
    ends = (*entries[1:], case.problem.steps + 1)
    return tuple(
        cell for cell, first, end in zip(cells, entries, ends, strict=True)
        for _ in range(first, end)
    )  # fmt: skip


def words(case: Case, plan: Plan) -> tuple[Cells, ...]:
    assert [p.effector for p in plan.paths] == [e.effector for e in case.problem.effectors]
    for path in plan.paths:
        assert all(a != b for a, b in zip(path.cells, path.cells[1:], strict=False))
        assert (path.entries is not None) is case.problem.by_samples
    return tuple(word(case, path.cells, path.entries) for path in plan.paths)


def sequences(plan: Plan) -> tuple[Cells, ...]:
    return tuple(path.cells for path in plan.paths)


KINDS = st.sampled_from([(1, False), (1, True), (2, True)]).flatmap(
    lambda kind: cases(effectors=kind[0], by_samples=kind[1])
)


@settings(max_examples=examples(10, 60), deadline=None)
@given(KINDS)
def test_all_plans_and_no_others_the_fewest_changes_first(case: Case) -> None:
    everything = brute_force(case)
    plans, end = drain(Planner(case.problem), MOST)
    event(f"{case.problem.by_samples}, {case.formula is not None}: {bool(everything)}")
    found = [words(case, plan) for plan in plans]
    assert set(found) <= set(everything)
    assert max(Counter(found).values(), default=1) == 1
    assert [plan.changes for plan in plans] == [changes(each) for each in found]
    # First every sequence of cells once, in order; then the same with other samples of entry.
    different = {tuple(map(without_stays, each)) for each in everything}
    first = plans[: len(different)]
    assert len({sequences(plan) for plan in first}) == len(first) == min(len(different), MOST)
    assert [plan.changes for plan in first] == sorted(plan.changes for plan in first)
    if first:
        assert first[0].changes == min(map(changes, everything))
    rest = [plan.changes for plan in plans[len(different) :]]
    assert rest == sorted(rest)
    if end is None:
        return
    assert len(found) == len(everything)
    assert (end.plans, end.changes, end.blocked) == (len(plans), case.problem.changes, ())
    assert (end.why is Exhaustion.SPENT) is bool(plans)
    if end.complete and not case.problem.by_samples:
        wider = replace(case.problem, changes=case.problem.changes + 3)
        assert len(brute_force(Case(wider, case.formula))) == len(everything)
    if end.complete and case.problem.by_samples:
        wider = replace(case.problem, changes=10**3)
        assert len(brute_force(Case(wider, case.formula))) == len(everything)


def visits(path: Cells, cells: Cells, *, ordered: bool) -> bool:
    """Whether a path has some cells, where ordered as a subsequence; by trying all choices."""
    if not ordered:
        return set(cells) <= set(path)
    return any(chosen == cells for chosen in combinations(path, len(cells)))


def is_blocked(plan: Sequence[tuple[int, Cells]], blocked: Sequence[CounterExample]) -> bool:
    return any(
        effector == example.effector and visits(cells, example.cells, ordered=example.ordered)
        for effector, cells in plan
        for example in blocked
    )


@settings(max_examples=examples(10, 30), deadline=None)
@given(KINDS, st.data())
def test_blocked_cells_are_respected(case: Case, data: st.DataObject) -> None:
    numbers = [one.effector for one in case.problem.effectors]
    different = {tuple(map(without_stays, each)) for each in brute_force(case)}
    everything = sorted(different)
    planner = Planner(case.problem)
    blocked: list[CounterExample] = []

    def block(paths: Sequence[Cells], reason: str) -> None:
        which = data.draw(st.sampled_from(numbers))
        path = paths[numbers.index(which)]
        kept = data.draw(st.lists(st.booleans(), min_size=len(path), max_size=len(path)))
        cells = tuple(cell for cell, chosen in zip(path, kept, strict=True) if chosen)
        ordered = data.draw(st.booleans())
        assume(cells or data.draw(st.integers(0, 9)) == 0)
        blocked.append(CounterExample(which, cells, reason, "robot", ordered=ordered))
        planner.block(blocked[-1])

    # Before anything is laid out.
    for cells in data.draw(st.lists(st.sampled_from(everything), max_size=2)) if everything else []:
        block(cells, "early")
    given_out: list[tuple[Cells, ...]] = []
    while isinstance(verdict := planner.next_plan(), Holds) and len(given_out) < 30:
        cells = sequences(verdict.witness)
        if cells in given_out:
            break
        plan = list(zip(numbers, cells, strict=True))
        assert not is_blocked(plan, blocked)
        assert not any(each.meets(*path) for path in plan for each in blocked)
        given_out.append(cells)
        if data.draw(st.booleans()):
            block(cells, f"after {len(given_out)}")
    if len(given_out) < 30:
        missing = different - set(given_out)
        assert all(is_blocked(list(zip(numbers, m, strict=True)), blocked) for m in missing)
    assert planner.blocked == tuple(blocked)
    if isinstance(verdict, Fails):
        assert verdict.counterexample.blocked == tuple(blocked)


@settings(max_examples=examples(10, 40), deadline=None)
@given(KINDS, st.data())
def test_extended_is_as_made_anew(case: Case, data: st.DataObject) -> None:
    """What remains has as few changes as with a planner that was never asked before."""
    planner = Planner(case.problem)
    for _ in range(6):
        anew = Planner(case.problem)
        for known in planner.blocked:
            anew.block(known)
        both = planner.next_plan(), anew.next_plan()
        if isinstance(both[0], Fails):
            assert isinstance(both[1], Fails)
            return
        assert isinstance(both[0], Holds)
        assert isinstance(both[1], Holds)
        assert both[0].witness.changes == both[1].witness.changes
        # All that was given out is blocked, so that both know the same.
        path = data.draw(st.sampled_from(both[0].witness.paths))
        first = data.draw(st.integers(0, len(path.cells) - 1))
        cells = path.cells[first : data.draw(st.integers(first + 1, len(path.cells)))]
        planner.block(CounterExample(path.effector, cells, "tried"))


# --- simple paths --------------------------------------------------------------------------------


def simple(
    neighbours: tuple[Cells, ...],
    start: Sequence[int],
    target: Sequence[int],
    forbidden: Sequence[int],
    most: int,
) -> PlanningProblem:
    none = (frozenset[str](),) * len(neighbours)
    planned = PlannedEffector(0, tuple(start), tuple(forbidden), tuple(target))
    return PlanningProblem(neighbours, none, (planned,), None, False, most, most)


def paths_of(problem: PlanningProblem) -> tuple[list[Cells], Exhausted]:
    plans, end = drain(Planner(problem))
    assert end is not None
    return [plan.paths[0].cells for plan in plans], end


def by_networkx(problem: PlanningProblem) -> list[Cells]:
    (one,) = problem.effectors
    graph = nx.Graph((i, j) for i, near in enumerate(problem.neighbours) for j in near)
    graph.add_nodes_from(range(len(problem.neighbours)))
    graph.remove_nodes_from(one.forbidden)
    start, target = set(one.start) & set(graph), set(one.end or ()) & set(graph)
    paths: list[Cells] = [(cell,) for cell in start & target]
    for s in start:
        for t in target - {s}:
            if problem.changes:
                paths += map(tuple, nx.all_simple_paths(graph, s, t, cutoff=problem.changes))
    return sorted(paths)


@settings(max_examples=12, deadline=None)
@given(workspaces(max_regions=3), st.data())
def test_paths_through_random_workspaces(workspace: ir.Workspace, data: st.DataObject) -> None:
    neighbours = abstract(workspace).neighbours
    cells = st.sets(st.integers(0, len(neighbours) - 1), max_size=2).map(sorted)
    problem = simple(neighbours, data.draw(cells), data.draw(cells), data.draw(cells), 4)
    assert sorted(paths_of(problem)[0]) == by_networkx(problem)


def test_the_running_example_goes_round_both_ways() -> None:
    abstraction = abstract(bench())
    problem = planning_problem(abstraction, task(avoid("O"), workspace="Bench"), 0)
    problem = replace(problem, changes=80)
    paths, end = paths_of(problem)
    assert sorted(paths) == by_networkx(problem)
    assert end.complete
    # some path crosses nothing below the obstacle, some path nothing above it
    for cut in cuts_of_the_bench():
        crossing = {i for i, cell in enumerate(abstraction.cells) if cell.polytope.meets(cut)}
        assert any(crossing.isdisjoint(path) for path in paths)


def grid(side: int) -> tuple[Cells, ...]:
    steps = ((-1, 0), (0, -1), (0, 1), (1, 0))
    return tuple(
        tuple(
            (y + dy) * side + x + dx
            for dy, dx in steps
            if 0 <= y + dy < side and 0 <= x + dx < side
        )
        for y in range(side)
        for x in range(side)
    )


def test_a_conflict_limit_is_no_exhaustion() -> None:
    problem = simple(grid(4), [0], [15], [], 15)
    planner = Planner(problem, conflicts=1)
    paths, unknowns = [], 0
    while not isinstance(verdict := planner.next_plan(), Fails):
        match verdict:
            case Holds(witness=plan):
                paths.append(plan.paths[0].cells)
            case Unknown(reason=reason):
                assert reason is Reason.CONFLICT_LIMIT
                unknowns += 1
    assert unknowns > 0
    assert sorted(paths) == by_networkx(problem)
    assert len(paths) == 184  # OEIS A007764


def test_why_there_is_none() -> None:
    wall = [4 * i + 1 for i in range(4)]
    _, end = paths_of(simple(grid(4), [0], [15], wall, 100))
    assert (end.plans, end.complete, end.blocked, end.why) == (0, True, (), Exhaustion.APART)
    _, end = paths_of(simple(grid(4), [0], [15], [], 5))
    assert (end.plans, end.complete, end.why) == (0, False, Exhaustion.TOO_FAR)
    # To be in A throughout, and to leave it.
    problem = simple(grid(2), [0], [3], [], 9)
    cells = tuple(map(frozenset, ("A", "A", "", "")))
    formula = sampled(ir.Always(A, EVER), Fraction(1), 9)
    _, end = paths_of(replace(problem, propositions=cells, formula=formula))
    assert (end.plans, end.complete, end.why) == (0, True, Exhaustion.FORMULA)


@pytest.mark.parametrize("changes", range(6))
def test_a_bound_that_hides_longer_paths_is_not_complete(changes: int) -> None:
    """Between two cells, one of them in A: to be there at the end takes an odd number of changes.

    From 1 on there is always a path with two more.
    """
    planned = PlannedEffector(0, (0,), (), None)
    wanted = sampled(ir.Always(ir.Eventually(A, EVER), EVER), Fraction(1), changes)
    regions = (frozenset[str](), frozenset("A"))
    problem = PlanningProblem(((1,), (0,)), regions, (planned,), wanted, False, changes, changes)
    found, end = paths_of(problem)
    assert found == [(0, 1) * half for half in range(1, (changes + 1) // 2 + 1)]
    assert not end.complete


def test_the_same_paths_in_the_same_order() -> None:
    problem = simple(grid(4), [0, 3], [15], [5], 9)
    assert paths_of(problem)[0] == paths_of(problem)[0]


def test_a_large_grid() -> None:
    side = 60
    verdict = Planner(simple(grid(side), [0], [side * side - 1], [], 200)).next_plan()
    assert isinstance(verdict, Holds)
    assert verdict.witness.changes == 2 * side - 2


def test_a_visit_on_the_way_and_back() -> None:
    """A line of cells with A at its end: from the middle there and back again, by samples too."""
    neighbours = tuple(tuple(j for j in (i - 1, i + 1) if 0 <= j < 5) for i in range(5))
    cells = tuple(map(frozenset, ("A", "", "", "", "C")))
    visit = sampled(ir.Eventually(A, EVER), Fraction(1), 12)
    problem = replace(simple(neighbours, [2], [4], [], 12), propositions=cells, formula=visit)
    verdict = Planner(problem).next_plan()
    assert isinstance(verdict, Holds)
    assert verdict.witness.paths[0].cells == (2, 1, 0, 1, 2, 3, 4)
    late = sampled(ir.Eventually(A, ir.Window(Fraction(5), Fraction(6))), Fraction(1), 12)
    verdict = Planner(replace(problem, formula=late, timed=True)).next_plan()
    assert isinstance(verdict, Holds)
    (path,) = verdict.witness.paths
    assert path.cells == (2, 1, 0, 1, 2, 3, 4)
    assert path.entries is not None
    assert path.entries[2] <= 6
    assert path.entries[3] > 5
    # In A throughout [0 s, 9 s] would leave 3 samples for 4 changes.
    tight = sampled(ir.Always(A, ir.Window(Fraction(3), Fraction(9))), Fraction(1), 12)
    end = Planner(replace(problem, formula=tight, timed=True)).next_plan()
    assert isinstance(end, Fails)
    assert end.counterexample.why is Exhaustion.FORMULA


def test_bad_arguments() -> None:
    with pytest.raises(ValueError, match="at least 0"):
        Planner(simple(grid(2), [0], [1], [], -1))
    planner = Planner(simple(grid(2), [0], [1], [], 3))
    for cells in ((4,), (-1,)):
        with pytest.raises(ValueError, match="no cells"):
            planner.block(CounterExample(0, cells, "no"))
    planner.block(CounterExample(1, (0,), "of an effector that is not planned"))
    assert planner.blocked == ()

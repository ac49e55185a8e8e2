from collections import Counter
from dataclasses import dataclass

import networkx as nx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.encodings.specification import path_problem
from compiler.geometry.abstraction import abstract
from solvers.planner import CellPath, Planner
from solvers.verdict import Fails, Holds, Reason, Unknown
from tests.oracles.planes import bench, cuts_of_the_bench, workspaces
from tests.oracles.tasks import avoid, task

SETTINGS = settings(max_examples=60, deadline=None)


@dataclass(frozen=True)
class Graph:
    neighbours: tuple[tuple[int, ...], ...]


def brute_force(cells, start, target, forbidden, most):
    graph = nx.Graph((i, j) for i, near in enumerate(cells.neighbours) for j in near)
    graph.add_nodes_from(range(len(cells.neighbours)))
    graph.remove_nodes_from(forbidden)
    start, target = set(start) & set(graph), set(target) & set(graph)
    paths = [(cell,) for cell in start & target]
    for s in start:
        for t in target - {s}:
            if most:
                paths += map(tuple, nx.all_simple_paths(graph, s, t, cutoff=most))
    return sorted(paths)


def drain(planner):
    paths = []
    while True:
        match planner.next_path():
            case Holds(witness=path):
                paths.append(path.cells)
            case Fails(counterexample=end):
                return paths, end
            case Unknown():
                pytest.fail("a small graph needs no budget")


@st.composite
def problems(draw):
    count = draw(st.integers(1, 7))
    cell = st.integers(0, count - 1)
    edges = draw(st.sets(st.tuples(cell, cell).filter(lambda e: e[0] < e[1])))
    near = [sorted({b for e in edges for a, b in (e, e[::-1]) if a == i}) for i in range(count)]
    start, target = draw(st.sets(cell, max_size=2)), draw(st.sets(cell, max_size=3))
    forbidden = draw(st.sets(cell, max_size=2))
    return Graph(tuple(map(tuple, near))), start, target, forbidden, draw(st.integers(0, 7))


@settings(max_examples=150, deadline=None)
@given(problems())
def test_all_simple_paths_the_shortest_first(problem):
    paths, end = drain(Planner(*problem))
    assert sorted(paths) == brute_force(*problem)
    lengths = [len(path) for path in paths]
    assert lengths == sorted(lengths)
    assert end.paths == len(paths)
    assert end.changes == problem[-1]
    assert not end.blocked
    if end.complete:
        assert brute_force(*problem[:-1], most=len(problem[0].neighbours)) == sorted(paths)


@SETTINGS
@given(problems(), st.data())
def test_blocked_prefixes_are_respected(problem, data):
    planner, everything = Planner(*problem), brute_force(*problem)
    given_out, blocked = [], []
    early = data.draw(st.lists(st.sampled_from(everything), max_size=2)) if everything else []
    for path in early:  # before any position is laid out
        blocked.append(path[: data.draw(st.integers(1, len(path)))])
        planner.block_prefix(blocked[-1], "early")
    while isinstance(verdict := planner.next_path(), Holds):
        path = verdict.witness.cells
        assert not any(path[: len(prefix)] == prefix for prefix in blocked)
        given_out.append(path)
        if data.draw(st.booleans()):
            blocked.append(path[: data.draw(st.integers(1, len(path)))])
            planner.block_prefix(blocked[-1], f"after {len(given_out)}")
    assert isinstance(verdict, Fails)
    assert max(Counter(given_out).values(), default=1) == 1
    missing = set(everything) - set(given_out)
    assert set(given_out) <= set(everything)
    assert all(any(p[: len(prefix)] == prefix for prefix in blocked) for p in missing)
    assert [b.cells for b in verdict.counterexample.blocked] == blocked == [
        b.cells for b in planner.blocked
    ]  # fmt: skip
    assert all(b.reason for b in planner.blocked)


@settings(max_examples=25, deadline=None)
@given(workspaces(max_regions=3), st.data())
def test_paths_through_random_workspaces(workspace, data):
    abstraction = abstract(workspace)
    cell = st.integers(0, len(abstraction.cells) - 1)
    start, target = data.draw(st.sets(cell, max_size=2)), data.draw(st.sets(cell, max_size=2))
    problem = (abstraction, start, target, data.draw(st.sets(cell, max_size=2)), 4)
    assert sorted(drain(Planner(*problem))[0]) == brute_force(*problem)


def test_the_running_example_goes_round_both_ways():
    abstraction = abstract(bench())
    asked = path_problem(abstraction, task(avoid("O"), workspace="Bench"))
    problem = (abstraction, asked.start, asked.target, asked.forbidden, 80)
    paths, end = drain(Planner(*problem))
    assert sorted(paths) == brute_force(*problem)
    assert end.complete
    # some path crosses nothing below the obstacle, some path nothing above it
    for cut in cuts_of_the_bench():
        crossing = {i for i, cell in enumerate(abstraction.cells) if cell.polytope.meets(cut)}
        assert any(crossing.isdisjoint(path) for path in paths)


def grid(side):
    cells = [(x, y) for y in range(side) for x in range(side)]
    return Graph(
        tuple(
            tuple(sorted(cells.index(n) for n in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1))
                         if n in cells))
            for x, y in cells
        )
    )  # fmt: skip


def test_a_conflict_limit_is_no_exhaustion():
    planner = Planner(grid(4), [0], [15], [], 15, conflicts=1)
    paths, unknowns = [], 0
    while not isinstance(verdict := planner.next_path(), Fails):
        match verdict:
            case Holds(witness=path):
                paths.append(path.cells)
            case Unknown(reason=reason):
                assert reason is Reason.CONFLICT_LIMIT
                unknowns += 1
    assert unknowns > 0
    assert sorted(paths) == brute_force(grid(4), [0], [15], [], 15)
    assert len(paths) == 184  # OEIS A007764


def test_a_cut_off_target_is_proved():
    wall = [4 * i + 1 for i in range(4)]
    _, end = drain(Planner(grid(4), [0], [15], wall, 100))
    assert (end.paths, end.complete, end.blocked) == (0, True, ())
    _, end = drain(Planner(grid(4), [0], [15], [], 5))
    assert (end.paths, end.complete) == (0, False)


def test_the_same_paths_in_the_same_order():
    runs = [drain(Planner(grid(4), [0, 3], [15], [5], 9))[0] for _ in range(2)]
    assert runs[0] == runs[1]


def test_a_large_grid():
    side = 40
    verdict = Planner(grid(side), [0], [side * side - 1], [], 100).next_path()
    assert isinstance(verdict, Holds)
    assert verdict.witness.changes == 2 * side - 2


def test_bad_arguments():
    with pytest.raises(ValueError, match="at least 0"):
        Planner(grid(2), [0], [1], [], -1)
    planner = Planner(grid(2), [0], [1], [], 3)
    for cells in ((), (4,), (-1,)):
        with pytest.raises(ValueError, match="prefix"):
            planner.block_prefix(cells, "no")
    assert CellPath((3,)).changes == 0

"""Paths through some cells, counted, against all simple paths that networkx lists."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.path_count import MOST, count_paths
from compiler.tasks.specification import PlannedEffector, PlanningProblem
from tests.oracles.some_cases import examples


def problem(graph: nx.Graph, start: list[int], end: list[int]) -> PlanningProblem:
    neighbours = tuple(tuple(sorted(graph.neighbors(cell))) for cell in range(len(graph)))
    none = tuple(frozenset[str]() for _ in neighbours)
    planned = (PlannedEffector(0, tuple(start), (), tuple(end)),)
    return PlanningProblem(neighbours, none, planned, None, False, 99, 99)


@settings(max_examples=examples(30, 200), deadline=None)
@given(st.data())
def test_as_many_as_there_are(data: st.DataObject) -> None:
    count = data.draw(st.integers(2, 8))
    pairs = data.draw(st.lists(st.sampled_from(list(combinations(range(count), 2)))))
    graph = nx.Graph(pairs)
    graph.add_nodes_from(range(count))
    numbers = st.integers(0, count - 1)
    start, end = (sorted(data.draw(st.sets(numbers, min_size=1))) for _ in range(2))
    cells = tuple(data.draw(st.lists(numbers, max_size=3, unique=True)))
    changes, ordered = data.draw(st.integers(0, 7)), data.draw(st.booleans())
    paths = {
        tuple(path)
        for a in start
        for b in end
        for path in ([[a]] if a == b else nx.all_simple_paths(graph, a, b, cutoff=changes))
        if len(path) - 1 <= changes
    }
    expected = sum(
        cells in combinations(path, len(cells)) if ordered else set(cells) <= set(path)
        for path in paths
    )
    found = count_paths(problem(graph, start, end), 0, cells, changes, ordered=ordered)
    assert found == expected


def test_counting_ends() -> None:
    size = 9
    graph = nx.convert_node_labels_to_integers(nx.grid_2d_graph(size, size))
    posed = problem(graph, [0], [size * size - 1])
    assert count_paths(posed, 0, (), 2 * size - 2, ordered=True) == MOST
    # One way along two sides: the corner lies on one shortest path alone.
    assert count_paths(posed, 0, (size - 1,), 2 * size - 2, ordered=True) == 1

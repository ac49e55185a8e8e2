from dataclasses import dataclass
from itertools import product

import networkx as nx
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.encodings.unroll import UNREACHABLE, Unrolling, distances


@dataclass(frozen=True)
class Graph:
    neighbours: tuple[tuple[int, ...], ...]


def line(count):
    return Graph(tuple(tuple(j for j in (i - 1, i + 1) if 0 <= j < count) for i in range(count)))


def models(clauses, variables):
    for bits in product([False, True], repeat=variables):
        true = np.array([False, *bits])
        if all(any(true[abs(lit)] == (lit > 0) for lit in c) for c in clauses):
            yield true


@settings(max_examples=60, deadline=None)
@given(st.integers(2, 7).flatmap(lambda n: st.tuples(
    st.just(n), st.sets(st.tuples(st.integers(0, n - 1), st.integers(0, n - 1))),
    st.sets(st.integers(0, n - 1), min_size=1), st.lists(st.booleans(), min_size=n, max_size=n),
)))  # fmt: skip
def test_distances_are_those_of_networkx(case):
    count, edges, sources, allowed = case
    graph = nx.Graph((i, j) for i, j in edges if i != j)
    graph.add_nodes_from(range(count))
    cells = Graph(tuple(tuple(sorted(graph[i])) for i in range(count)))
    graph.remove_nodes_from([i for i in range(count) if not allowed[i]])
    expected = np.full(count, UNREACHABLE)
    for source in sources & set(graph):
        for cell, steps in nx.single_source_shortest_path_length(graph, source).items():
            expected[cell] = min(expected[cell], steps)
    assert (distances(cells, sources, np.array(allowed)) == expected).all()


def test_the_models_of_a_line_are_its_only_path():
    unrolling = Unrolling(line(3), [0], [2], [], 5)
    assert (unrolling.shortest, unrolling.limit, unrolling.complete) == (2, 2, True)
    clauses = [c for _ in range(3) for array in unrolling.extend() for c in array.tolist()]
    clauses.append([unrolling.at_target(2)])
    variables = max(abs(lit) for c in clauses for lit in c)
    paths = {unrolling.decode(true, 2) for true in models(clauses, variables)}
    assert paths == {(0, 1, 2)}


def test_variables_exist_only_where_the_cell_can_be():
    unrolling = Unrolling(line(4), [0, 1], [3], [], 3)
    for _ in range(4):
        unrolling.extend()
    exists = [[unrolling.variable(c, j) > 0 for c in range(4)] for j in range(4)]
    assert exists == [
        [True, True, False, False],
        [False, True, True, False],
        [False, False, True, True],
        [False, False, False, True],
    ]
    assert unrolling.excluding([0, 1]) == [-unrolling.variable(0, 0), -unrolling.variable(1, 1)]
    assert unrolling.excluding([0, 3]) is None


def test_nothing_to_find():
    apart = Unrolling(line(3), [0], [2], [1], 5)
    assert (apart.shortest, apart.complete) == (None, True)
    assert Unrolling(line(3), [], [2], [], 5).shortest is None
    assert Unrolling(line(3), [1], [], [], 5).shortest is None
    short = Unrolling(line(5), [0], [4], [], 2)
    assert (short.shortest, short.limit, short.complete) == (4, 2, False)

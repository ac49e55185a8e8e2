"""Distances and edges of graphs of cells."""

from __future__ import annotations

import networkx as nx
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.tasks.places import UNREACHABLE, distances, edges
from tests.oracles.plans import Cells, graphs
from tests.oracles.some_cases import examples


@settings(max_examples=examples(30, 60), deadline=None)
@given(graphs(7), st.data())
def test_distances_are_those_of_networkx(
    neighbours: tuple[Cells, ...], data: st.DataObject
) -> None:
    count = len(neighbours)
    sources = data.draw(st.sets(st.integers(0, count - 1), min_size=1))
    allowed = data.draw(st.lists(st.booleans(), min_size=count, max_size=count))
    graph = nx.Graph((i, j) for i, near in enumerate(neighbours) for j in near)
    graph.add_nodes_from(range(count))
    graph.remove_nodes_from([i for i in range(count) if not allowed[i]])
    expected = np.full(count, UNREACHABLE)
    for source in sources & set(graph):
        for cell, steps in nx.single_source_shortest_path_length(graph, source).items():
            expected[cell] = min(expected[cell], steps)
    assert (distances(neighbours, sources, np.array(allowed)) == expected).all()


@settings(max_examples=40, deadline=None)
@given(graphs(6), st.data())
def test_edges_out_of_some_cells(neighbours: tuple[Cells, ...], data: st.DataObject) -> None:
    cells = data.draw(st.lists(st.integers(0, len(neighbours) - 1), max_size=5))
    owners, heads = edges(neighbours).of(np.array(cells, dtype=np.int64))
    expected = [(k, head) for k, cell in enumerate(cells) for head in neighbours[cell]]
    assert list(zip(owners.tolist(), heads.tolist(), strict=True)) == expected

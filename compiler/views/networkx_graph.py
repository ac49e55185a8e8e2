"""Pictures as graphs of networkx (Hagberg, Schult & Swart 2008)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from compiler.views.picture import Picture

if TYPE_CHECKING:
    import networkx as nx


def to_networkx(picture: Picture) -> nx.MultiDiGraph:
    """The picture's nodes, by key, and edges, each with what is drawn and what it stands for.

    Nodes have ``label``, ``accepting``, ``highlighted``, ``initial`` and ``data``; edges have
    ``label``, ``highlighted`` and ``data``.  The graph has ``name`` and ``title``.  The edges of a
    picture without directions lead both ways.
    """
    import networkx as nx

    initial = {arrow.head for arrow in picture.initial}
    graph = nx.MultiDiGraph(name=picture.name, title=picture.title)
    for node in picture.nodes:
        graph.add_node(
            node.key,
            label=node.label,
            accepting=node.double,
            highlighted=node.highlighted,
            initial=node.key in initial,
            data=dict(node.data),
        )
    for edge in picture.edges:
        ends = [(edge.tail, edge.head), (edge.head, edge.tail)]
        for tail, head in ends[: 1 if picture.directed else 2]:
            graph.add_edge(
                tail,
                head,
                label="\n".join(edge.lines),
                highlighted=edge.highlighted,
                data=dict(edge.data),
            )
    return graph

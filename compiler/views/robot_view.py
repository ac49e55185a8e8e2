"""The labelled graph of a robot as a picture (Definition 1, Figure 1c)."""

from __future__ import annotations

from collections import Counter

from compiler.robots.labelled_graph import LabelledGraph
from compiler.views.picture import Arrow, Edge, Node, Picture


def robot_view(graph: LabelledGraph) -> Picture:
    """Modules as nodes, connections as edges with their symbols of Gamma.

    Several occurrences of a module are numbered in the order of the word.  An arrow from nowhere
    leads to what stands on the world.  All edges go from an output end to an input end; the names
    of the frames are in the data, and in the hint of each module.
    """
    names = _names(graph)
    nodes = tuple(
        Node(
            f"m{node.place}",
            names[node.place],
            data={"module": node.module, "place": node.place},
            hint=f"symbol {node.place + 1}: input {node.input_frame}, output {node.output_frame}",
        )
        for node in graph.nodes
    )
    modules = {node.place: node for node in graph.nodes}
    edges = tuple(
        Edge(
            f"m{edge.lower}",
            f"m{edge.upper}",
            (" ".join(edge.label),) if edge.label else (),
            data={
                "edge": edge.label,
                "output_frame": modules[edge.lower].output_frame,
                "input_frame": modules[edge.upper].input_frame,
            },
        )
        for edge in graph.edges
    )
    return Picture("robot", "circle", nodes, edges, tuple(Arrow(f"m{r}") for r in graph.roots))


def _names(graph: LabelledGraph) -> dict[int, str]:
    """Per place the module's name, numbered where it occurs more than once."""
    total = Counter(node.module for node in graph.nodes)
    seen: Counter[str] = Counter()
    found: dict[int, str] = {}
    for node in graph.nodes:
        seen[node.module] += 1
        several = total[node.module] > 1
        found[node.place] = f"{node.module} {seen[node.module]}" if several else node.module
    return found

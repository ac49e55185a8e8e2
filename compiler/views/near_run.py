"""The part of a picture about its highlighted run, as the paper's Figure 2 shows it."""

from __future__ import annotations

from dataclasses import replace

from compiler.views.picture import Picture


def near_run(picture: Picture) -> Picture:
    """The highlighted nodes and what is one edge away from them, with those edges alone."""
    core = {node.key for node in picture.nodes if node.highlighted}
    edges = tuple(edge for edge in picture.edges if core & {edge.tail, edge.head})
    shown = core.union(*((edge.tail, edge.head) for edge in edges))
    return replace(
        picture,
        nodes=tuple(node for node in picture.nodes if node.key in shown),
        edges=edges,
        initial=tuple(arrow for arrow in picture.initial if arrow.head in shown),
    )

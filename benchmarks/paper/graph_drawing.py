"""Graphs at given places: circles with names, arrows with labels, and a run in red."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compiler.arrays import Array
from compiler.views.workspace_view import Edge, Node, Picture
from srgc.render.html_text import text
from srgc.render.svg import document, place

RADIUS, RIM = 15.0, 3.5
"""Of a node, and how much less the second outline of an accepting one has."""
HEAD = 8.0
"""The length of an arrow head."""
PLAIN, RUN = "#1a2233", "#b3261e"
HALO = 'paint-order="stroke" stroke="#fff" stroke-width="4" stroke-linejoin="round"'


def graph_svg(
    picture: Picture,
    places: Mapping[str, tuple[float, float]],
    names: Mapping[str, str],
    size: tuple[float, float],
    title: str,
) -> str:
    """The picture as SVG.

    Args:
        picture: nodes and edges; those that are highlighted are red.
        places: of the nodes, by their keys.
        names: what stands in the nodes, by their keys.
        size: of the picture.
        title: above it.
    """
    at = {key: np.array(where) for key, where in places.items()}
    arrows = [_arrow(at[edge.tail], at[edge.head], _colour(edge)) for edge in picture.edges]
    arrows += [
        _arrow(at[first.head] - [2.6 * RADIUS, 0], at[first.head], _colour(first), tail_radius=0.0)
        for first in picture.initial
    ]
    circles = [_node(node, at[node.key], names[node.key]) for node in picture.nodes]
    labels = [_label(edge, at[edge.tail], at[edge.head]) for edge in picture.edges]
    return document("".join([*arrows, *circles, *labels]), size, "graph", title)


def _colour(thing: object) -> str:
    return RUN if getattr(thing, "highlighted", False) else PLAIN


def _arrow(tail: Array, head: Array, colour: str, *, tail_radius: float = RADIUS) -> str:
    way = (head - tail) / np.linalg.norm(head - tail)
    start, end = tail + tail_radius * way, head - RADIUS * way
    across = np.array([-way[1], way[0]])
    base = end - HEAD * way
    corners = [end, base + HEAD / 2.4 * across, base - HEAD / 2.4 * across]
    points = " ".join(f"{place(x)},{place(y)}" for x, y in corners)
    return (
        f'<line x1="{place(start[0])}" y1="{place(start[1])}" x2="{place(base[0])}" '
        f'y2="{place(base[1])}" stroke="{colour}" stroke-width="1.4"/>'
        f'<polygon points="{points}" fill="{colour}"/>'
    )


def _node(node: Node, at: Array, name: str) -> str:
    colour = _colour(node)
    circle = f'cx="{place(at[0])}" cy="{place(at[1])}" fill="#fff" stroke="{colour}"'
    rims = [RADIUS, RADIUS - RIM] if node.double else [RADIUS]
    outlines = "".join(f'<circle {circle} r="{radius}" stroke-width="1.4"/>' for radius in rims)
    return (
        f"<g><title>{text(node.label)}</title>{outlines}"
        f'<text x="{place(at[0])}" y="{place(at[1] + 4)}" text-anchor="middle" font-size="11" '
        f'fill="{colour}">{text(name)}</text></g>'
    )


def _label(edge: Edge, tail: Array, head: Array) -> str:
    """Above a level arrow, on the left of an upright one, else on it."""
    says = " ".join(edge.lines).replace("eps", "ε")
    (x, y), (across, down) = (tail + head) / 2, np.abs(head - tail)
    x, anchor = (x - 6, "end") if across == 0 else (x, "middle")
    y += -7 if down == 0 else 4
    return (
        f'<text x="{place(x)}" y="{place(y)}" text-anchor="{anchor}" font-size="11" '
        f'fill="{_colour(edge)}" {HALO}>{text(says)}</text>'
    )

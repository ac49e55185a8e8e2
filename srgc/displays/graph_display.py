"""A graph: drawn by Graphviz where that is installed, and a table of its edges elsewhere."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence

from compiler.views.dot import to_dot
from compiler.views.picture import Picture
from srgc.displays.figure import image
from srgc.faults import UsageFault
from srgc.graphs.graph_file import drawn_by_graphviz
from srgc.render.html_block import block, head, lines, table
from srgc.render.html_text import text

MOST_DRAWN = 400
"""Graphs with more nodes are shown as tables: a picture of them helps nobody."""
MOST_ROWS = 200


def graph_text(picture: Picture) -> str:
    """The edges of a graph, one a line."""
    sign = "->" if picture.directed else "--"
    rows = [_line(tail, label, sign, head) for tail, label, head, _ in _rows(picture)]
    return "\n".join([_title(picture), *rows[:MOST_ROWS], *_left_out(rows)])


def graph_html(picture: Picture, remarks: Sequence[str] = ()) -> str:
    """A display of a graph."""
    drawn = _drawn(picture)
    if drawn is not None:
        return block(image(drawn, _title(picture)), lines(*remarks))
    rows = list(_rows(picture))
    cells = [[_cell(part, marked=marked) for part in parts] for *parts, marked in rows[:MOST_ROWS]]
    key = "→ where a run begins, ◎ where it may end" if picture.initial else ""
    return block(
        head(_title(picture)),
        table(("from", "label", "to"), cells),
        lines(*_left_out(rows), *filter(None, [key]), *remarks),
    )


def _line(tail: str, label: str, sign: str, head: str) -> str:
    said = "; ".join(label.split("\n"))
    return f"{tail} {sign} {head}{': ' if said else ''}{said}" if head else tail


def _title(picture: Picture) -> str:
    nodes, edges = len(picture.nodes), len(picture.edges)
    return f"{picture.title or picture.name}: {nodes} nodes, {edges} edges"


def _rows(picture: Picture) -> Iterator[tuple[str, str, str, bool]]:
    """Tail, label and head of every edge, and whether it is highlighted.

    A node without edges has a row of its own.
    """
    initial = {arrow.head for arrow in picture.initial}
    names = {node.key: f"{node.label}{' ◎' if node.double else ''}" for node in picture.nodes}
    for edge in picture.edges:
        tail = f"{'→ ' if edge.tail in initial else ''}{names[edge.tail]}"
        yield tail, "\n".join(edge.lines), names[edge.head], edge.highlighted
    joined = {end for edge in picture.edges for end in (edge.tail, edge.head)}
    for node in picture.nodes:
        if node.key not in joined:
            start = "→ " if node.key in initial else ""
            yield f"{start}{names[node.key]}", "", "", node.highlighted


def _left_out(rows: Sequence[object]) -> list[str]:
    return [f"and {len(rows) - MOST_ROWS} more"] if len(rows) > MOST_ROWS else []


def _cell(content: str, *, marked: bool) -> str:
    shown = text(content).replace("\n", "<br>")
    return f'<span class="bad">{shown}</span>' if marked else shown


def _drawn(picture: Picture) -> str | None:
    """The picture as SVG; None where nothing draws it."""
    if shutil.which("dot") is None or len(picture.nodes) > MOST_DRAWN:
        return None
    try:
        return drawn_by_graphviz(to_dot(picture), "svg")[0].decode()
    except UsageFault:
        return None

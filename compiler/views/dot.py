"""Pictures as DOT texts; source: the DOT language and its ``escString``, graphviz.org.

A picture determines its text, statement by statement in a fixed order. Every identifier is quoted,
so no name is read as a keyword, a port or HTML.
"""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping

from compiler.views.workspace_view import Arrow, Edge, Node, Picture

RED = "#d00000"
FONT = "sans-serif"
LETTER_INCHES, NODE_INCHES = 0.085, 0.5
"""The widths of a letter and of a node, in inches.

Labels of loops lie above their nodes; nodes are kept far enough apart that the labels of neighbours
do not meet.
"""

# In a label a backslash starts an escape, and an ampersand an entity of HTML.
_ESCAPES = str.maketrans({"\\": "\\\\", '"': '\\"', "\n": "\\n"})


def to_dot(picture: Picture) -> str:
    """The picture as a DOT text; equal pictures give equal texts."""
    kind, arrow = ("digraph", "->") if picture.directed else ("graph", "--")
    sources = _sources(picture)
    lines = [f"{kind} {_identifier(picture.name)} {{"]
    lines += [f"  {line};" for line in _defaults(picture)]
    lines += [f"  {_start(source)};" for source in sources.values()]
    lines += [f"  {_node(node, picture)};" for node in picture.nodes]
    lines += [
        f"  {sources[i]} {arrow} {_identifier(initial.head)}{_arrow(initial)};"
        for i, initial in enumerate(picture.initial)
    ]
    beside = _plain_loops(picture)
    lines += [
        f"  {_identifier(edge.tail)} {arrow} {_identifier(edge.head)}{_edge(edge, beside)};"
        for edge in picture.edges
        if edge.highlighted or edge.tail not in beside or edge.tail != edge.head
    ]
    return "\n".join([*lines, "}", ""])


def _defaults(picture: Picture) -> Iterator[str]:
    pinned = any(node.place is not None for node in picture.nodes)
    graph = {"layout": "neato", "splines": "line"} if pinned else {"rankdir": "LR"}
    longest = max(
        (len(line) for e in picture.edges if e.tail == e.head for line in e.lines), default=0
    )
    if longest:
        graph["ranksep"] = f"{max(0.8, LETTER_INCHES * longest - NODE_INCHES):.2f}"
    if picture.title or picture.caption:
        graph |= {"label": _written(picture), "labelloc": "b" if picture.caption else "t"}
    yield f"graph{_attributes({**graph, 'fontname': _quoted(FONT)})}"
    node = {"shape": picture.shape, "fontname": _quoted(FONT), "fontsize": "12"}
    if any(node.fill is not None for node in picture.nodes):
        node["style"] = "filled"
    yield f"node{_attributes(node)}"
    yield f"edge{_attributes({'fontname': _quoted(FONT), 'fontsize': '11'})}"


def _sources(picture: Picture) -> dict[int, str]:
    """For each initial arrow the identifier of the invisible node that it leaves."""
    taken = {node.key for node in picture.nodes}
    prefix = "start"
    while any(key.startswith(prefix) for key in taken):
        prefix = f"_{prefix}"
    return {i: _identifier(f"{prefix}{i}") for i in range(len(picture.initial))}


def _start(source: str) -> str:
    return f'{source} [label="", shape=none, width=0, height=0]'


def _node(node: Node, picture: Picture) -> str:
    attributes = {"label": _quoted(node.label)}
    if node.place is not None:
        x, y = node.place
        attributes["pos"] = f'"{x:.4f},{y:.4f}!"'
    if node.shape != picture.shape:
        attributes["shape"] = node.shape
    if node.double:
        attributes["peripheries"] = "2"
    if node.fill is not None:
        attributes["fillcolor"] = _quoted(node.fill)
    if node.hint is not None:
        attributes["tooltip"] = _quoted(node.hint)
    if node.highlighted:
        attributes |= _highlight()
    return f"{_identifier(node.key)}{_attributes(attributes)}"


def _plain_loops(picture: Picture) -> dict[str, tuple[str, ...]]:
    """For each node with a highlighted loop the labels of its other loops.

    The labels of two loops would be drawn on top of each other, so the loops are drawn as one,
    whose label lines are in colour and in black.
    """
    loops = [edge for edge in picture.edges if edge.tail == edge.head]
    beside: dict[str, tuple[str, ...]] = {edge.tail: () for edge in loops if edge.highlighted}
    for edge in loops:
        if edge.tail in beside and not edge.highlighted:
            beside[edge.tail] += edge.lines
    return beside


def _edge(edge: Edge, beside: Mapping[str, tuple[str, ...]]) -> str:
    plain = beside.get(edge.tail, ()) if edge.highlighted and edge.tail == edge.head else ()
    attributes = _labelled("\n".join(edge.lines), highlighted=edge.highlighted)
    if plain:
        coloured = "".join(f"{_html(line)}<br/>" for line in edge.lines)
        black = "<br/>".join(map(_html, plain))
        attributes["label"] = f'<{coloured}<font color="black">{black}</font>>'
    return _attributes(attributes)


def _arrow(arrow: Arrow) -> str:
    return _attributes(_labelled(arrow.label, highlighted=arrow.highlighted))


def _labelled(label: str, *, highlighted: bool) -> dict[str, str]:
    attributes = {"label": _quoted(label)} if label else {}
    return attributes | _highlight() if highlighted else attributes


def _highlight() -> dict[str, str]:
    return {"color": _quoted(RED), "fontcolor": _quoted(RED), "penwidth": "2"}


def _attributes(attributes: Mapping[str, str]) -> str:
    if not attributes:
        return ""
    return f" [{', '.join(f'{name}={value}' for name, value in attributes.items())}]"


def _written(picture: Picture) -> str:
    """The text around a picture: the title, and the caption with left-aligned lines."""
    title = _quoted(picture.title)[1:-1]
    lines = "".join(f"{_quoted(line)[1:-1]}\\l" for line in picture.caption)
    gap = "\\n" if title and lines else ""
    return f'"{title}{gap}{lines}"'


def _quoted(text: str) -> str:
    """A text that is drawn literally."""
    return _identifier(text.replace("&", "&amp;"))


def _html(text: str) -> str:
    """The text for use inside an HTML-like label."""
    return html.escape(text).replace("\\", "\\\\")


def _identifier(text: str) -> str:
    return f'"{text.translate(_ESCAPES)}"'

"""Automata, words, grammars, robots and workspaces as graphs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from compiler.views.workspace_view import Picture
from srgc.api.program import Specification, program_of, symbols
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault

if TYPE_CHECKING:
    import networkx as nx
    from networkx import MultiDiGraph


# --- Pictures as graphs of networkx (Hagberg, Schult & Swart 2008) --------------------------------

INSTALL = 'this needs the library networkx: pip install "srgc[networkx]"'


def to_networkx(picture: Picture) -> nx.MultiDiGraph:
    """Convert a picture to a graph of networkx, with its nodes by key.

    Nodes have the attributes ``label``, ``accepting``, ``highlighted``, ``initial`` and ``data``,
    edges ``label``, ``highlighted`` and ``data``, the graph ``name`` and ``title``.  ``data`` says
    what a node or an edge stands for.  An undirected edge becomes two edges, one each way.

    Raises:
        UsageFault: networkx is not installed.
    """
    try:
        import networkx as nx
    except ModuleNotFoundError:
        raise UsageFault(INSTALL) from None

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


# --- Automata, words, grammars, robots and workspaces as graphs -----------------------------------


View: TypeAlias = Literal["sra", "fra", "dfa", "dpda", "words", "grammar", "robot", "workspace"]


@dataclass(frozen=True, slots=True)
class Graph:
    """A graph with labelled nodes and edges; a notebook displays its drawing.

    Attributes:
        picture: its nodes and edges, in a fixed order.
        remarks: notes for a reader of the drawing.
    """

    picture: Picture
    remarks: tuple[str, ...] = ()

    @property
    def dot(self) -> str:
        """The graph in the DOT language, for Graphviz."""
        from compiler.views.dot import to_dot

        return to_dot(self.picture)

    @spoken
    def networkx(self) -> MultiDiGraph:
        """Convert the graph to a ``networkx.MultiDiGraph``.

        Nodes have the attributes ``label``, ``accepting``, ``highlighted``, ``initial`` and
        ``data`` (what they stand for), edges ``label``, ``highlighted`` and ``data``.

        Raises:
            SrgcError: networkx is not installed.
        """
        return to_networkx(self.picture)

    def __repr__(self) -> str:
        nodes, edges = len(self.picture.nodes), len(self.picture.edges)
        return f"<Graph {self.picture.name}: {nodes} nodes, {edges} edges>"

    def __str__(self) -> str:
        from srgc.api.displays import graph_text

        return graph_text(self.picture)

    def _repr_html_(self) -> str:
        from srgc.api.displays import graph_html

        return graph_html(self.picture, self.remarks)


@spoken
def graph(
    program: Specification,
    of: View,
    *,
    grammar: str | None = None,
    workspace: str | None = None,
    depth: int | None = None,
    highlight: str | Sequence[str] | None = None,
    near: bool | None = None,
    word: str | Sequence[str] | None = None,
    derivation: int | None = None,
    cells: int | None = None,
) -> Graph:
    """Make the graph that ``srgc graph --of ...`` draws.

    Args:
        program: the specification, or the path of its file.
        of: what to draw.  Of a family: its pushdown automaton (``sra``), the same with semantic
            updates (``fra``), its finite automaton or accept condition (``dfa``), its deterministic
            pushdown automaton (``dpda``), its ``words`` or its ``grammar``.  Otherwise one
            ``robot``, or the cells of a ``workspace``.
        grammar: the family; may be omitted if there is only one.
        workspace: the workspace; may be omitted if there is only one.
        depth: for ``words``: the largest number of modules, by default 3.
        highlight: a word whose run is coloured.
        near: whether to show only that run and its neighbours; by default only for ``words``.
        word: for a ``robot``: its word.
        derivation: for a ``robot``: the number of a derivation of the word, from 1.
        cells: for a ``workspace``: the least number of cells to divide it into.

    Raises:
        SrgcError: something named does not exist, or the arguments do not fit together.
    """
    from srgc.graphs.graph_request import GraphRequest, drawing_of

    if cells is not None and cells < 1:
        raise UsageFault("`cells` counts from 1")
    run = None if highlight is None else symbols(highlight)
    robot = None if word is None else symbols(word)
    request = GraphRequest(of, grammar, workspace, depth, run, near, robot, derivation, cells)
    drawing = drawing_of(program_of(program).ir, request)
    return Graph(drawing.picture, drawing.remarks)

"""The labelled graph of a derivation (Definition 1, Figure 1c).

*Nodes* are the occurrences of modules in the word, each with an input frame (end 1) and an output
frame (end 2).  An *edge* leads from the output end of a module to the input end of the module that
stands on it:

- With semantics, a module stands on the module before it on the way that the frames take from the
  world (``frame_paths``, ``frame_parents``).
- A module that no frame passes, and every module of a grammar without semantics, stands on its
  neighbour in the word; brackets make branches (``neighbours``).
- A base stands on nothing.

So the graph is a forest; it is connected if and only if one module alone stands on the world.  The
edge symbols of the word are its labels (``edge_labels``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from compiler.grammars.derivation import Derivation
from compiler.graphs.edge_labels import edge_labels
from compiler.graphs.frame_parents import frame_parents
from compiler.graphs.neighbours import word_neighbours
from grammar_lang import ir

if TYPE_CHECKING:
    import networkx as nx


@dataclass(frozen=True, slots=True)
class ModuleNode:
    """An occurrence of a module: its place in the word, from 0."""

    place: int
    module: str

    @property
    def input_frame(self) -> str:
        """The frame at end 1, as the paper writes it."""
        return f"{self.module}_1"

    @property
    def output_frame(self) -> str:
        """The frame at end 2."""
        return f"{self.module}_2"


@dataclass(frozen=True, slots=True)
class Connection:
    """An edge from the output end of one module to the input end of another, both by place."""

    lower: int
    upper: int
    label: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class LabelledGraph:
    """The (Sigma, Gamma)-labelled graph of a robot.

    ``nodes`` are in the order of the word; ``edges`` in that of their upper modules.
    """

    word: tuple[str, ...]
    nodes: tuple[ModuleNode, ...]
    edges: tuple[Connection, ...]

    @property
    def roots(self) -> tuple[int, ...]:
        """The places of the modules that stand on no other."""
        upper = {edge.upper for edge in self.edges}
        return tuple(node.place for node in self.nodes if node.place not in upper)

    def to_networkx(self) -> nx.DiGraph:
        """Nodes by place with ``module`` (Sigma), edges with ``edge`` (Gamma, joined by blanks)."""
        import networkx as nx

        graph = nx.DiGraph()
        for node in self.nodes:
            graph.add_node(node.place, module=node.module)
        for edge in self.edges:
            graph.add_edge(edge.lower, edge.upper, edge=" ".join(edge.label))
        return graph


def labelled_graph(
    program: ir.Program, grammar: ir.Grammar, derivation: Derivation
) -> LabelledGraph:
    """The labelled graph of a derivation of a grammar of the program.

    Raises:
        SemanticsError: a frame is not defined, or depends on itself.
    """
    bases = frozenset(name for name, module in program.modules.items() if module.role == "base")
    parents = word_neighbours(derivation.word, program.modules, bases)
    if grammar.semantics is not None:
        parents |= frame_parents(derivation, grammar, program.modules)
    labels = edge_labels(derivation.word, parents)
    nodes = tuple(ModuleNode(place, derivation.word[place]) for place in parents)
    edges = tuple(
        Connection(lower, upper, labels.get(upper, ()))
        for upper, lower in parents.items()
        if lower is not None
    )
    return LabelledGraph(derivation.word, nodes, edges)

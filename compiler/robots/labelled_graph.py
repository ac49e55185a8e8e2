"""The labelled graph of a derivation (Definition 1, Figure 1c).

*Nodes* are the occurrences of modules in the word, each with an input frame (end 1) and an output
frame (end 2).  An *edge* leads from the output end of a module to the input end of the module that
stands on it:

- With semantics, a module stands on the module before it on the way that the frames of its
  production take from the world (``frame_paths``, ``frame_parents``).
- A module that no frame passes, and every module of a grammar without semantics, stands on its
  neighbour in the derivation tree (``neighbours``).

So the graph is a forest; it is connected if and only if one module alone stands on the world.

The *label* of an edge has the edge symbols that stand directly before the upper module in the word
(directly after it, where it comes before the lower one), as far as they belong to productions on
the way between the two in the derivation tree.  Brackets around other branches that end there
(begin there), and what they enclose, are left out.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from compiler.grammars.derivation import Derivation
from compiler.robots.frame_parents import frame_parents
from compiler.robots.neighbours import tree_neighbours
from grammar_lang import ir

if TYPE_CHECKING:
    import networkx as nx

BRACKETS = {"(": ")", "[": "]", "{": "}", "<": ">"}
OPENING = {closing: opening for opening, closing in BRACKETS.items()}


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
    parents = tree_neighbours(derivation)
    if grammar.semantics is not None:
        parents |= frame_parents(derivation, grammar, program.modules)
    tree = _Tree(derivation)
    nodes = tuple(ModuleNode(place, derivation.word[place]) for place in parents)
    edges = tuple(
        Connection(lower, upper, tree.label(lower, upper, parents))
        for upper, lower in parents.items()
        if lower is not None
    )
    return LabelledGraph(derivation.word, nodes, edges)


class _Tree:
    """The derivation tree with the extents of its subtrees; nodes are in pre-order."""

    def __init__(self, derivation: Derivation) -> None:
        self.derivation = derivation
        self.owner = [0] * len(derivation.word)
        self.above = [-1] * len(derivation.nodes)
        self.size = [1] * len(derivation.nodes)
        for number, node in enumerate(derivation.nodes):
            for child, symbol in zip(node.children, node.production.right, strict=True):
                if symbol.kind == "nonterminal":
                    self.above[child] = number
                else:
                    self.owner[child] = number
        for number in range(len(derivation.nodes) - 1, 0, -1):
            self.size[self.above[number]] += self.size[number]

    def label(self, lower: int, upper: int, modules: Container[int]) -> tuple[str, ...]:
        """The edge symbols beside the upper module that join it to the lower one."""
        step = -1 if lower < upper else 1
        found: list[str] = []
        place = upper + step
        while place != lower and place not in modules:
            owner = self.owner[place]
            if self._below(self.owner[lower], owner) or self._below(self.owner[upper], owner):
                found.append(self.derivation.word[place])
            place += step
        if step > 0:
            return _outside_closed_branches(found[::-1], BRACKETS)[::-1]
        return _outside_closed_branches(found[::-1], OPENING)

    def _below(self, node: int, top: int) -> bool:
        """Whether a node is in the subtree of another."""
        return top <= node < top + self.size[top]


def _outside_closed_branches(symbols: Sequence[str], partner: Mapping[str, str]) -> tuple[str, ...]:
    """The symbols without brackets that are closed, and without what these enclose.

    ``partner`` gives the opening bracket of each closing one; one that is not among the symbols is
    taken to stand before them all.
    """
    kept: list[str] = []
    for symbol in symbols:
        if symbol not in partner:
            kept.append(symbol)
            continue
        opening = [i for i, earlier in enumerate(kept) if earlier == partner[symbol]]
        del kept[opening[-1] if opening else 0 :]
    return tuple(kept)

"""The labelled graph of a derivation (Definition 1, Figure 1c).

*Nodes* are the occurrences of modules in the word, each with an input frame (end 1) and an output
frame (end 2). An *edge* leads from the output end of a module to the input end of the module that
stands on it:

- If the grammar has semantics, a module stands on the module before it on the path of the frames
  from the world (``frame_paths``, ``frame_parents``).
- A module that no frame passes, and every module of a grammar without semantics, stands on its
  neighbour in the word; brackets make branches (``neighbours``).
- A base stands on nothing.

So the graph is a forest; it is connected if and only if exactly one module stands on the world. The
edge symbols of the word are its labels (``edge_labels``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from compiler.robots.frame_parents import frame_parents
from compiler.robots.frame_paths import BRACKETS, OPENING, bracket_partners, word_neighbours
from compiler.words.derivation import Derivation
from grammar_lang import ir


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

    ``nodes`` are in word order; ``edges`` are in the order of their upper modules.
    """

    word: tuple[str, ...]
    nodes: tuple[ModuleNode, ...]
    edges: tuple[Connection, ...]

    @property
    def roots(self) -> tuple[int, ...]:
        """The places of the modules that stand on no other."""
        upper = {edge.upper for edge in self.edges}
        return tuple(node.place for node in self.nodes if node.place not in upper)


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


# --- Which edge symbols of a word label which connection of its modules ---------------------------
#
# Each symbol is used at most once. The symbols between two consecutive modules of the word label
# the connection of these two. If they are not connected, the symbols label the unlabelled
# connection that is nearest to the later module on the path between the two; the last such gap of
# the word chooses first. Brackets that close a branch, and branches without modules, are not
# labels.


def edge_labels(
    word: Sequence[str], parents: Mapping[int, int | None]
) -> dict[int, tuple[str, ...]]:
    """The labels of the connections, by the place of their upper modules.

    ``parents`` maps the place of each module, in word order, to the module it stands on.
    """
    places = list(parents)
    partners = bracket_partners(word)
    depth = _depths(parents)
    labels: dict[int, tuple[str, ...]] = {}
    apart: list[tuple[int, int, tuple[str, ...]]] = []
    for earlier, later in pairwise(places):
        symbols = _symbols(word, earlier + 1, later, partners)
        if parents[later] == earlier:
            labels[later] = symbols
        elif parents[earlier] == later:
            labels[earlier] = symbols
        elif symbols:
            apart.append((earlier, later, symbols))
    for earlier, later, symbols in reversed(apart):
        free = (edge for edge in _way(later, earlier, parents, depth) if edge not in labels)
        chosen = next(free, None)
        if chosen is not None:
            labels[chosen] = symbols
    return labels


def _symbols(
    word: Sequence[str], start: int, end: int, partners: Mapping[int, int]
) -> tuple[str, ...]:
    """The symbols of a gap, without closing brackets and closed branches."""
    found: list[str] = []
    place = start
    while place < end:
        symbol, partner = word[place], partners.get(place)
        if symbol in BRACKETS and partner is not None and partner < end:
            place = partner
        elif symbol not in OPENING or partner is None:
            found.append(symbol)
        place += 1
    return tuple(found)


def _depths(parents: Mapping[int, int | None]) -> dict[int, int]:
    depth: dict[int, int] = {}
    for start in parents:
        climbed: list[int] = []
        module: int | None = start
        while module is not None and module not in depth:
            climbed.append(module)
            module = parents[module]
        below = -1 if module is None else depth[module]
        for above, each in enumerate(reversed(climbed), 1):
            depth[each] = below + above
    return depth


def _way(
    here: int, there: int, parents: Mapping[int, int | None], depth: Mapping[int, int]
) -> list[int]:
    """The connections from one module to another, by upper module; empty if in two trees."""
    near: list[int] = []
    far: list[int] = []
    while here != there:
        side = near if depth[here] >= depth[there] else far
        top = here if side is near else there
        below = parents[top]
        if below is None:
            return []
        side.append(top)
        if side is near:
            here = below
        else:
            there = below
    return near + far[::-1]

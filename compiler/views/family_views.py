"""A robot family as pictures: its grammar, its automata, and the labelled graph of a robot."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from compiler.robots.labelled_graph import LabelledGraph
from compiler.views.workspace_view import (
    Arrow,
    Edge,
    Node,
    Picture,
    not_accepted,
    refuse_unknown,
    run_of,
)
from compiler.words.finite_automaton import Dfa
from compiler.words.language import Language
from compiler.words.pushdown_automaton import sra
from compiler.words.regular_automaton import linear_automaton

# --- A grammar as a picture: nonterminals with their productions (Definition 3) -------------------


def grammar_view(language: Language, highlight: Sequence[str] | None = None) -> Picture:
    """Nonterminals (ellipses) with their productions (boxes); edges number the right side.

    The productions of a derivation of ``highlight`` are highlighted with their symbols.

    Raises:
        HighlightError: ``highlight`` is not a word of the language.
    """
    srg = language.srg
    applied: set[str] = set()
    if highlight is not None:
        run = run_of(sra(srg, language.accept), highlight)
        applied = {move.label for move in run if move.label is not None}
    keys = {("nonterminal", name): f"n{k}" for k, name in enumerate(srg.nonterminals)}
    keys |= {("terminal", name): f"t{k}" for k, name in enumerate(srg.terminals)}
    boxes: list[Node] = []
    edges: list[Edge] = []
    used: set[str] = set()
    coloured: set[str] = set()
    for r, production in enumerate(srg.productions):
        left, own = keys["nonterminal", production.left], f"p{r}"
        marked = production.label in applied
        data = {"production": production}
        boxes.append(Node(own, production.label, "box", highlighted=marked, data=data))
        edges.append(Edge(left, own, highlighted=marked))
        ends = [left]
        for i, symbol in enumerate(production.right):
            kind = "nonterminal" if symbol.kind == "nonterminal" else "terminal"
            ends.append(keys[kind, symbol.name])
            place = {"place": i}
            edges.append(Edge(own, ends[-1], (str(i + 1),), highlighted=marked, data=place))
        used.update(ends)
        coloured.update(ends if marked else ())
    symbols = [
        Node(
            key,
            name,
            "ellipse" if kind == "nonterminal" else "plaintext",
            highlighted=key in coloured,
            data={"symbol": name, "kind": kind},
        )
        for (kind, name), key in keys.items()
        if kind == "nonterminal" or key in used
    ]
    start = Arrow(keys["nonterminal", srg.start], highlighted=highlight is not None)
    return Picture("grammar", "ellipse", (*symbols, *boxes), tuple(edges), (start,))


# --- Finite automata as pictures: of a linear family, or of its accept condition ------------------


def family_dfa_view(language: Language, highlight: Sequence[str] | None = None) -> Picture:
    """The finite automaton of a family whose grammar is left- or right-linear.

    For other families it is the automaton of the accept condition alone, which accepts more than
    the family. The title says which one is drawn.

    Raises:
        HighlightError: the automaton that is drawn does not accept ``highlight``.
    """
    name = language.srg.name
    family = linear_automaton(language.srg, language.accept)
    if family is not None:
        return dfa_view(family, f"{name}: minimal finite automaton of the family", highlight)
    title = f"{name}: accept condition only, the grammar is neither left- nor right-linear"
    return dfa_view(language.accept, title, highlight)


def dfa_view(dfa: Dfa, title: str = "", highlight: Sequence[str] | None = None) -> Picture:
    """A finite automaton without the states from which no word is accepted.

    Symbols between the same states share an edge; those that the run of ``highlight`` reads there
    have an edge of their own.

    Raises:
        HighlightError: the automaton does not accept ``highlight``.
    """
    path = () if highlight is None else _path(dfa, highlight)
    used = set() if highlight is None else set(zip(path, highlight, strict=False))
    visited = set(path)
    live = dfa.live()
    shown = [state for state in range(dfa.size) if live[state] or state == 0]
    symbols: dict[tuple[int, int, bool], list[str]] = {}
    for state in shown:
        for code, symbol in enumerate(dfa.alphabet):
            target = dfa.step(state, code)
            if live[target]:
                key = (state, target, (state, symbol) not in used)
                symbols.setdefault(key, []).append(symbol)
    nodes = tuple(
        Node(
            f"s{state}",
            f"q{state}",
            double=dfa.accepting[state],
            highlighted=state in visited,
            data={"state": state},
        )
        for state in shown
    )
    edges = tuple(
        Edge(
            f"s{tail}",
            f"s{head}",
            tuple(shared),
            highlighted=not plain,
            data={"symbols": tuple(shared)},
        )
        for (tail, head, plain), shared in sorted(symbols.items(), key=lambda item: item[0])
    )
    start = Arrow("s0", highlighted=bool(path))
    return Picture("dfa", "circle", nodes, edges, (start,), title)


def _path(dfa: Dfa, word: Sequence[str]) -> tuple[int, ...]:
    """The states that an accepted word passes."""
    refuse_unknown(word, dfa.alphabet)
    path = dfa.run(word)
    if path is None or not dfa.accepting[path[-1]]:
        raise not_accepted(word)
    return path


# --- The labelled graph of a robot as a picture (Definition 1, Figure 1c) -------------------------


def robot_view(graph: LabelledGraph) -> Picture:
    """Modules as nodes, and connections as edges with their symbols of Gamma.

    Several occurrences of a module are numbered in word order. Initial arrows lead to modules that
    stand on the world. All edges go from an output end to an input end; the names of the frames are
    in the data, and in the hint of each module.
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
    """For each place the module's name, numbered if it occurs more than once."""
    total = Counter(node.module for node in graph.nodes)
    seen: Counter[str] = Counter()
    found: dict[int, str] = {}
    for node in graph.nodes:
        seen[node.module] += 1
        several = total[node.module] > 1
        found[node.place] = f"{node.module} {seen[node.module]}" if several else node.module
    return found

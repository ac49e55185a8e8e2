"""A grammar as a picture: nonterminals with their productions (Definition 3)."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.views.picture import Arrow, Edge, Node, Picture, run_of
from compiler.words.language import Language
from compiler.words.pushdown_automaton import sra


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

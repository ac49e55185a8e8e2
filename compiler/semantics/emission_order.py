"""In which order the productions of a derivation emit: that of the word."""

from __future__ import annotations

from compiler.grammars.derivation import Derivation


def emission_order(derivation: Derivation) -> list[int]:
    """The nodes by their first modules, else first terminals; effectors count in this order."""
    nodes = range(len(derivation.nodes))
    return sorted(nodes, key=lambda node: (_place(derivation, node), node))


def _place(derivation: Derivation, node: int) -> int:
    """Where in the word a production emits."""
    current = derivation.nodes[node]
    own = [
        (symbol.kind != "module", current.children[position])
        for position, symbol in enumerate(current.production.right)
        if symbol.kind != "nonterminal"
    ]
    return min(own)[1] if own else len(derivation.word)

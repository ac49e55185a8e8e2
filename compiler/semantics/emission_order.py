"""In which order the productions of a derivation emit: that of the word."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.grammars.derivation import Derivation
from grammar_lang import ir


def emission_order(derivation: Derivation) -> list[int]:
    """The nodes by their first modules, else first terminals; effectors count in this order."""
    nodes = range(len(derivation.nodes))
    return sorted(nodes, key=lambda node: (_place(derivation, node), node))


def body_symbols(
    derivation: Derivation, semantics: Mapping[str, ir.SemanticBlock]
) -> tuple[int | None, ...]:
    """Per body, in the order of the robot's, the symbol in the word that brings it.

    None for a body of a production without terminals.
    """
    found: list[int | None] = []
    for node in emission_order(derivation):
        place = _place(derivation, node)
        emissions = semantics[derivation.nodes[node].production.label].emissions
        bodies = sum(not isinstance(emission, ir.Effector) for emission in emissions)
        found += [place if place < len(derivation.word) else None] * bodies
    return tuple(found)


def _place(derivation: Derivation, node: int) -> int:
    """Where in the word a production emits."""
    current = derivation.nodes[node]
    own = [
        (symbol.kind != "module", current.children[position])
        for position, symbol in enumerate(current.production.right)
        if symbol.kind != "nonterminal"
    ]
    return min(own)[1] if own else len(derivation.word)

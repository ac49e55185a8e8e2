"""On which module each module of a derivation stands, told from the derivation tree alone."""

from __future__ import annotations

from compiler.grammars.derivation import Derivation


def tree_neighbours(derivation: Derivation) -> dict[int, int | None]:
    """The module that each module stands on, by place in the word; None where there is none.

    On a right side, a symbol stands on the nearest module before it; where there is none, on the
    last module of the nearest nonterminal before it that has one; where there is none, on what the
    left side stands on.  The last module of a nonterminal is that of its right side; where it has
    none, that of its last nonterminal that has one.
    """
    last = _last_modules(derivation)
    below: list[int | None] = [None] * len(derivation.nodes)
    found: dict[int, int | None] = {}
    for number, node in enumerate(derivation.nodes):
        place, own = below[number], False
        for child, symbol in zip(node.children, node.production.right, strict=True):
            if symbol.kind == "module":
                found[child] = place
                place, own = child, True
            elif symbol.kind == "nonterminal":
                below[child] = place
                if not own and last[child] is not None:
                    place = last[child]
    return dict(sorted(found.items()))


def _last_modules(derivation: Derivation) -> list[int | None]:
    """Per node its last module, by place in the word."""
    last: list[int | None] = [None] * len(derivation.nodes)
    for number in range(len(last) - 1, -1, -1):
        node = derivation.nodes[number]
        pairs = list(zip(node.children, node.production.right, strict=True))
        own = [child for child, symbol in pairs if symbol.kind == "module"]
        inner = [last[child] for child, symbol in pairs if symbol.kind == "nonterminal"]
        candidates = own or [place for place in inner if place is not None]
        last[number] = candidates[-1] if candidates else None
    return last

"""Derivations (Definition 3): the tree of productions that derives a word.

The structure of a robot is a derivation, not a word.  A leftmost derivation is given by the labels
of its productions; ``replay`` checks one.  Nothing here is recursive in the length of the word.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from grammar_lang import ir


class BadDerivation(ValueError):
    """The labels are not a leftmost derivation of a word from the start symbol."""


@dataclass(frozen=True, slots=True)
class DerivationNode:
    """One application of a production.

    ``children`` has one entry for each symbol of the right side: the index in the word for a
    terminal, the index of the node for a nonterminal.
    """

    production: ir.Production
    children: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Derivation:
    """A derivation tree; ``nodes`` are in leftmost order (pre-order), node 0 derives the start."""

    word: tuple[str, ...]
    nodes: tuple[DerivationNode, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of the productions, in leftmost order."""
        return tuple(node.production.label for node in self.nodes)

    def spans(self) -> list[tuple[int, int]]:
        """For each node, the range of positions in the word that it derives."""
        inner = [
            [
                child
                for child, symbol in zip(node.children, node.production.right, strict=True)
                if symbol.kind == "nonterminal"
            ]
            for node in self.nodes
        ]
        length = [0] * len(self.nodes)
        for i in range(len(self.nodes) - 1, -1, -1):
            terminals = len(self.nodes[i].children) - len(inner[i])
            length[i] = terminals + sum(length[child] for child in inner[i])
        begin = [0] * len(self.nodes)
        for i, node in enumerate(self.nodes):
            place, following = begin[i], iter(inner[i])
            for symbol in node.production.right:
                if symbol.kind != "nonterminal":
                    place += 1
                    continue
                child = next(following)
                begin[child] = place
                place += length[child]
        return [(b, b + n) for b, n in zip(begin, length, strict=True)]


def replay(grammar: ir.Grammar, labels: Iterable[str]) -> Derivation:
    """The leftmost derivation with these labels, from the start symbol.

    The accept condition is not checked.

    Raises:
        BadDerivation: an unknown label, a production of another nonterminal than the leftmost, or
            too few or too many labels.
    """
    by_label = {production.label: production for production in grammar.productions}
    productions: list[ir.Production] = []
    for label in labels:
        if label not in by_label:
            raise BadDerivation(f"grammar {grammar.name} has no production {label!r}")
        productions.append(by_label[label])
    return tree(grammar.start, productions)


def tree(start: str, productions: Sequence[ir.Production]) -> Derivation:
    """The derivation that replaces the leftmost nonterminal by these productions in turn.

    Raises:
        BadDerivation: as in ``replay``.
    """
    word: list[str] = []
    children: list[list[int]] = []
    todo = [ir.Symbol(start, "nonterminal")]
    parents: list[list[int] | None] = [None]
    while todo:
        symbol, siblings = todo.pop(), parents.pop()
        if symbol.kind != "nonterminal":
            if siblings is not None:
                siblings.append(len(word))
            word.append(symbol.name)
            continue
        step = len(children)
        if step == len(productions):
            raise BadDerivation(f"the derivation stops before {symbol.name} is replaced")
        production = productions[step]
        if production.left != symbol.name:
            raise BadDerivation(
                f"step {step + 1}: {production.label} replaces {production.left}, "
                f"but the leftmost nonterminal is {symbol.name}"
            )
        if siblings is not None:
            siblings.append(step)
        own: list[int] = []
        children.append(own)
        todo += reversed(production.right)
        parents += [own] * len(production.right)
    if len(children) < len(productions):
        rest = productions[len(children)].label
        raise BadDerivation(
            f"{rest} is left over: the word is complete after {len(children)} steps"
        )
    nodes = (DerivationNode(p, tuple(c)) for p, c in zip(productions, children, strict=True))
    return Derivation(tuple(word), tuple(nodes))


# --- The order in which the productions of a derivation emit: that of the word --------------------


def emission_order(derivation: Derivation) -> list[int]:
    """The nodes ordered by first module or else first terminal; effectors count in this order."""
    nodes = range(len(derivation.nodes))
    return sorted(nodes, key=lambda node: (_place(derivation, node), node))


def _place(derivation: Derivation, node: int) -> int:
    """The position in the word at which a production emits."""
    current = derivation.nodes[node]
    own = [
        (symbol.kind != "module", current.children[position])
        for position, symbol in enumerate(current.production.right)
        if symbol.kind != "nonterminal"
    ]
    return min(own)[1] if own else len(derivation.word)

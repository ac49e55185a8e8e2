"""Whether all derivations of a graph are variants of one derivation, smaller or larger.

A derivation is a variant of another one if it results from that one by removing some nodes of
removable productions and inserting any number of nodes of transparent ones. The other derivation
has all the poses that a variant has.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.lemmas.conditioned_derivations import Application, ConditionedDerivations, Node
from compiler.lemmas.neutral_productions import NeutralProductions
from compiler.words.derivation import Derivation
from grammar_lang import ir


def are_variants(
    derivations: ConditionedDerivations,
    base: Derivation,
    productions: Sequence[ir.Production],
    neutral: NeutralProductions,
) -> bool:
    """Whether every derivation of a graph is a variant of ``base``.

    Args:
        derivations: the graph, whose rules are the ``productions`` by number.
        base: a derivation by the same productions.
        productions: the productions of the grammar.
        neutral: which of them are removable, and which transparent.
    """
    numbers = {production.label: number for number, production in enumerate(productions)}
    rules = [numbers[node.production.label] for node in base.nodes]
    inner = [
        [
            child
            for child, symbol in zip(node.children, node.production.right, strict=True)
            if symbol.kind == "nonterminal"
        ]
        for node in base.nodes
    ]
    by_node: dict[Node, list[Application]] = {root: [] for root in derivations.roots}
    for application in derivations.applications:
        by_node.setdefault(application.node, []).append(application)
    # Starts with all pairs; pairs that some application contradicts are removed until none is left.
    variants = {(node, place) for node in by_node for place in range(len(rules))}

    def fits(application: Application, place: int) -> bool:
        found = [child for _, child in application.children]
        if application.rule == rules[place] and all(
            (child, below) in variants for child, below in zip(found, inner[place], strict=True)
        ):
            return True
        if application.rule in neutral.transparent and (found[0], place) in variants:
            return True
        return rules[place] in neutral.removable and fits(application, inner[place][0])

    changed = True
    while changed:
        kept = {
            (node, place)
            for node, place in variants
            if all(fits(application, place) for application in by_node[node])
        }
        changed = len(kept) < len(variants)
        variants = kept
    return all((root, 0) in variants for root in derivations.roots)

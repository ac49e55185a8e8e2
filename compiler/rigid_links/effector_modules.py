"""Which module an effector of a robot belongs to, where the grammar leaves no doubt."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.grammars.derivation import Derivation, DerivationNode
from compiler.semantics.emission_order import emission_order
from grammar_lang import ir


def effector_modules(
    derivation: Derivation,
    semantics: Mapping[str, ir.SemanticBlock],
    modules: Mapping[str, ir.Module],
) -> tuple[int | None, ...]:
    """For every effector, in the order in which the language numbers them, a place in the word.

    An effector belongs to a module if the production that emits it emits no other and has one
    module of the role effector only; of others (None) nobody can say.
    """
    found: list[int | None] = []
    for number in emission_order(derivation):
        node = derivation.nodes[number]
        emissions = semantics[node.production.label].emissions
        count = sum(isinstance(emission, ir.Effector) for emission in emissions)
        places = [place for place, name in _modules(node) if modules[name].role == "effector"]
        found += places if (count, len(places)) == (1, 1) else [None] * count
    return tuple(found)


def _modules(node: DerivationNode) -> list[tuple[int, str]]:
    """The modules of a production by place and name."""
    symbols = zip(node.children, node.production.right, strict=True)
    return [(place, symbol.name) for place, symbol in symbols if symbol.kind == "module"]

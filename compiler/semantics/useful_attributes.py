"""Which attributes of a grammar some emission reads, directly or through other attributes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.elaboration.circularity import reads

Key: TypeAlias = tuple[str, str]
"""A nonterminal and the name of one of its attributes."""


@dataclass(frozen=True, slots=True)
class UsefulAttributes:
    """Per nonterminal the names of its useful attributes, in order of discovery."""

    synthesized: Mapping[str, tuple[str, ...]]
    inherited: Mapping[str, tuple[str, ...]]

    def rules(
        self, production: ir.Production, block: ir.SemanticBlock
    ) -> tuple[ir.AttributeRule, ...]:
        """The rules of a block that define useful attributes, in their order."""
        return tuple(rule for rule in block.rules if self._defines(production, rule.target))

    def due(self, production: ir.Production) -> Iterator[ir.AttributeOf]:
        """The useful attributes that the block of a production has to define."""
        for name in self.synthesized.get(production.left, ()):
            yield ir.AttributeOf(ir.THIS, name)
        for position, symbol in enumerate(production.right):
            if symbol.kind == "nonterminal":
                for name in self.inherited.get(symbol.name, ()):
                    yield ir.AttributeOf(position, name)

    def _defines(self, production: ir.Production, target: ir.AttributeOf) -> bool:
        kind = self.synthesized if target.occurrence == ir.THIS else self.inherited
        return target.name in kind.get(owner(production, target), ())


def owner(production: ir.Production, attribute: ir.AttributeOf) -> str:
    """The nonterminal whose attribute a production names."""
    if attribute.occurrence == ir.THIS:
        return production.left
    return production.right[attribute.occurrence].name


def expressions(emission: ir.Emission) -> tuple[ir.Expr, ...]:
    """The expressions that an emission is made of."""
    match emission:
        case ir.Rod(frame, _, length, density, radius):
            return (frame, length, density) if radius is None else (frame, length, density, radius)
        case ir.PointMass(frame, mass):
            return (frame, mass)
        case ir.Solid(frame, mass, com, inertia):
            return (frame, mass, com, *inertia)
        case ir.Effector(frame):
            return (frame,)


def useful_attributes(
    productions: Iterable[ir.Production], blocks: Mapping[str, ir.SemanticBlock]
) -> UsefulAttributes:
    """The attributes that emissions need in some derivation; the others are never evaluated.

    An attribute that no production of its nonterminal defines for ``this`` is inherited.
    """
    synthesized: set[Key] = set()
    needs: dict[tuple[bool, Key], dict[Key, None]] = {}
    todo: list[Key] = []
    for production in productions:
        if production.label not in blocks:
            continue
        block = blocks[production.label]
        for rule in block.rules:
            here = rule.target.occurrence == ir.THIS
            key = owner(production, rule.target), rule.target.name
            if here:
                synthesized.add(key)
            read = needs.setdefault((here, key), {})
            read |= {(owner(production, each), each.name): None for each in reads(rule.value)}
        for emission in block.emissions:
            for expression in expressions(emission):
                todo += [(owner(production, each), each.name) for each in reads(expression)]
    found: dict[Key, None] = {}
    while todo:
        key = todo.pop()
        if key not in found:
            found[key] = None
            todo += needs.get((key in synthesized, key), ())
    return UsefulAttributes(
        _by_nonterminal(key for key in found if key in synthesized),
        _by_nonterminal(key for key in found if key not in synthesized),
    )


def _by_nonterminal(keys: Iterable[Key]) -> dict[str, tuple[str, ...]]:
    names: dict[str, list[str]] = {}
    for nonterminal, name in keys:
        names.setdefault(nonterminal, []).append(name)
    return {nonterminal: tuple(each) for nonterminal, each in names.items()}

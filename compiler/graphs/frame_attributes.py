"""Which attributes of a grammar are frames: those that are made as frames, and their copies."""

from __future__ import annotations

from compiler.graphs.frame_paths import Attribute, attribute
from grammar_lang import ir


def frame_attributes(grammar: ir.Grammar) -> frozenset[Attribute]:
    """The attributes that are frames; ``frame`` is one where the start symbol inherits it."""
    found: set[Attribute] = set()
    copies: dict[Attribute, list[Attribute]] = {}
    synthesized: set[Attribute] = set()
    todo: list[Attribute] = []
    for production in grammar.productions:
        for rule in (grammar.semantics or {})[production.label].rules:
            target = attribute(production, rule.target)
            if rule.target.occurrence == ir.THIS:
                synthesized.add(target)
            match rule.value:
                case ir.AttributeOf() as source:
                    copies.setdefault(attribute(production, source), []).append(target)
                case ir.World() | ir.Rot() | ir.Move() | ir.Shift() | ir.Compose():
                    todo.append(target)
                case _:
                    pass
    if (grammar.start, "frame") not in synthesized:
        todo.append((grammar.start, "frame"))
    while todo:
        current = todo.pop()
        if current not in found:
            found.add(current)
            todo += copies.get(current, ())
    return frozenset(found)

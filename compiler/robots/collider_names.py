"""The names by which reports tell the colliders of a robot apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, emission_order
from grammar_lang import ir
from grammar_lang.source import Span

KINDS = {ir.Rod: "rod", ir.PointMass: "point", ir.Solid: "solid"}


@dataclass(frozen=True, slots=True)
class _Emitted:
    """A body or shape with the word indices of the modules that may own it."""

    emission: ir.Emission
    owners: tuple[int, ...]


def collider_names(
    program: ir.Program, grammar: ir.Grammar, derivation: Derivation, model: RobotModel
) -> tuple[str, ...]:
    """The name of each of a robot's ``colliders``, such as ``body 1 (Tube at symbol 2)``.

    If several modules may own one, its name tells its kind, its line and these modules instead.
    The names are bare numbers if the robot does not have the bodies of the derivation.
    """
    emitted = list(_emitted(derivation, grammar.semantics or {}))
    shapes = [each for each in emitted if isinstance(each.emission, ir.Shape)]
    bodies = [each for each in emitted if not isinstance(each.emission, ir.Shape)]
    alike = len(bodies) + len(model.payloads) == len(model.bodies)
    if not alike or len(shapes) != len(model.shapes):
        return model.collider_names
    bare = [each for number, each in enumerate(bodies) if number not in model.covered]
    every = [*bare, *shapes]
    owners = model.collider_owners or (None,) * len(every)
    return tuple(
        _told(program, derivation, name, each)
        if owner is None
        else f"{name} ({owner.module} at symbol {owner.symbol})"
        for name, owner, each in zip(model.collider_names, owners, every, strict=True)
    )


def _emitted(
    derivation: Derivation, semantics: Mapping[str, ir.SemanticBlock]
) -> Iterator[_Emitted]:
    """The bodies and shapes of a derivation in order."""
    for node in emission_order(derivation):
        current = derivation.nodes[node]
        for emission in semantics[current.production.label].emissions:
            if not isinstance(emission, ir.Effector):
                own = ir.owners(current.production, emission)
                yield _Emitted(emission, tuple(current.children[i] for i in own))


def _told(program: ir.Program, derivation: Derivation, name: str, each: _Emitted) -> str:
    """A name with what is known of a body that no single module is said to own."""
    modules = list(dict.fromkeys(derivation.word[symbol] for symbol in each.owners))
    if len(each.owners) == 1:
        return f"{name} ({modules[0]} at symbol {each.owners[0]})"
    emission = each.emission
    kind = emission.kind if isinstance(emission, ir.Shape) else KINDS[type(emission)]
    parts = [f"{kind}{_place(program, emission.span)}"]
    if modules:
        parts.append(f"of {' or '.join(modules)}")
    return f"{name} ({', '.join(parts)})"


def _place(program: ir.Program, span: Span) -> str:
    """The line of a statement, with its file unless that is the main one; empty if not known."""
    if span.file >= len(program.sources) or span.start >= span.end:
        return ""
    source = program.sources[span.file]
    line, _ = source.position(span.start)
    return f" in line {line}" + (f" of {source.path or source.name}" if span.file else "")

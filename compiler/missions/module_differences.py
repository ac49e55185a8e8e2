"""The modules of an existing robot that are built differently in the spec of its next task.

A module consists of its declaration, and of the parts of the productions in which it occurs:
frames, bodies, shapes, effectors; for a grammar from ports, the ports, too. The meaning of the
specs is compared, so comments, units and the names of local values make no difference, nor do the
names of the nonterminals of a written grammar. The parts of a rule that name no module belong to
all modules of its production.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.ir.emissions import with_expressions
from grammar_lang.ir.expressions import with_leaves

Aspects: TypeAlias = dict[str, object]
"""Maps each aspect of a module to the statements of a production about it, comparable values."""


@dataclass(frozen=True, slots=True)
class ModuleDifference:
    """A module, and ``what`` differs in it, in words, as ``("parameter length", "bodies")``."""

    module: str
    what: tuple[str, ...]


def module_differences(
    modules: Sequence[str],
    labels: Collection[str],
    before: tuple[ir.Program, ir.Grammar],
    after: tuple[ir.Program, ir.Grammar],
) -> tuple[ModuleDifference, ...]:
    """The modules that are built differently, in the order given; empty if there are none.

    Args:
        modules: the names of modules of the robot; both programs have them.
        labels: the labels of the productions that derive the robot.
        before: the program in which the robot was found, and its grammar.
        after: the program of the next task, and its grammar.
    """
    found = []
    for name in dict.fromkeys(modules):
        old, new = before[0].modules[name], after[0].modules[name]
        what = [*_declared(old, new), *_built(name, labels, before[1], after[1])]
        if what:
            found.append(ModuleDifference(name, tuple(dict.fromkeys(what))))
    return tuple(found)


# --- What modules declare -------------------------------------------------------------------------


def _declared(old: ir.Module, new: ir.Module) -> Iterator[str]:
    """The differences of the declarations."""
    if old == new:
        return
    if old.role != new.role:
        yield "role"
    for kind, ours, theirs in (
        ("parameter", old.parameters, new.parameters),
        ("degree of freedom", old.dofs, new.dofs),
    ):
        yield from _listed(
            kind, {each.name: each for each in ours}, {each.name: each for each in theirs}
        )
    if (old.states, old.inputs, old.torques) != (new.states, new.inputs, new.torques):
        yield "dynamics"


def _listed(kind: str, old: Mapping[str, object], new: Mapping[str, object]) -> Iterator[str]:
    """The names that were added, removed or changed."""
    for name in {**old, **new}:
        if old.get(name) != new.get(name):
            yield f"{kind} {name}"


# --- What productions say about modules -----------------------------------------------------------


def _built(name: str, labels: Collection[str], old: ir.Grammar, new: ir.Grammar) -> Iterator[str]:
    """Differences between a robot's productions with the module and the most similar new ones.

    If the module occurs in no production of the new grammar, it cannot be kept, and nothing is
    reported.
    """
    theirs = [*_aspects(name, new, None)]
    for ours in _aspects(name, old, labels) if theirs else ():
        yield from min((_different(ours, each) for each in theirs), key=len)


def _different(old: Aspects, new: Aspects) -> list[str]:
    return [kind for kind, value in old.items() if kind in new and new[kind] != value]


def _aspects(name: str, grammar: ir.Grammar, labels: Collection[str] | None) -> Iterator[Aspects]:
    """The statements of each production about each occurrence of a module, by label if given."""
    blocks = grammar.semantics or {}
    for production in grammar.productions:
        if labels is not None and production.label not in labels:
            continue
        block = blocks.get(production.label, ir.SemanticBlock((), ()))
        for place, symbol in enumerate(production.right):
            if symbol.name == name:
                ports = bool(grammar.listed)
                yield _aspects_of(production, block, place, ports=ports)


def _aspects_of(
    production: ir.Production, block: ir.SemanticBlock, place: int, *, ports: bool
) -> Aspects:
    """The statements of a production about a module at a position of its right side."""
    renamed = _numbered(block)
    emitted = [
        with_expressions(each, renamed)
        for each in block.emissions
        if place in ir.owners(production, each)
    ]
    frames = [
        (renamed(rule.target), with_leaves(rule.value, renamed))
        for rule in block.rules
        if place in (rule.mentions or (place,))
    ]
    own = {
        "frames": frames,
        "bodies": [each for each in emitted if not isinstance(each, ir.Shape | ir.Effector)],
        "shapes": [each for each in emitted if isinstance(each, ir.Shape)],
        "effectors": [each for each in emitted if isinstance(each, ir.Effector)],
    }
    if ports:
        # Nonterminals are the types of ports; that of the first module is not a type.
        right = [symbol.name for symbol in production.right]
        return {"ports": [production.left, *right], **own}
    right = ["" if each.kind == "nonterminal" else each.name for each in production.right]
    return {"production": right, **own}


def _numbered(block: ir.SemanticBlock) -> Callable[[ir.Expr], ir.Expr]:
    """A function that replaces names of local values by numbers, in the order of definition."""
    local = [rule.target.name for rule in block.rules if rule.target.occurrence == ir.LOCAL]
    numbers = {name: str(number) for number, name in enumerate(local)}

    def renamed(leaf: ir.Expr) -> ir.Expr:
        if isinstance(leaf, ir.AttributeOf) and leaf.occurrence == ir.LOCAL:
            return ir.AttributeOf(ir.LOCAL, numbers.get(leaf.name, leaf.name))
        return leaf

    return renamed

"""In what modules of a robot that there is are built otherwise in the spec of its next task.

A module is what it declares, and what the rules of the productions that it stands in say: frames,
bodies, shapes, effectors; of a grammar from ports, the ports, too.  Compared is what the specs come
to, so that comments, units and the names of local values make no difference, nor do the names of
the nonterminals of a written grammar.  What a rule does not name a module in belongs to all modules
of its production.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.ir.emissions import with_expressions
from grammar_lang.ir.expressions import with_leaves

Aspects: TypeAlias = dict[str, object]
"""What a production says of a module, by what that is about, as values that can be compared."""


@dataclass(frozen=True, slots=True)
class ModuleDifference:
    """A module, and in ``what`` it differs, in words, as ``("parameter length", "bodies")``."""

    module: str
    what: tuple[str, ...]


def module_differences(
    modules: Sequence[str],
    labels: Collection[str],
    before: tuple[ir.Program, ir.Grammar],
    after: tuple[ir.Program, ir.Grammar],
) -> tuple[ModuleDifference, ...]:
    """The modules that are built otherwise, in the order given; none where all are the same.

    Args:
        modules: the names of modules of the robot; both programs have them.
        labels: those of the productions that derive the robot.
        before: the program that the robot was found in, and its grammar.
        after: the program of the next task, and the grammar there.
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
    """In what the declarations differ."""
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
    """What was, is or has become another one."""
    for name in {**old, **new}:
        if old.get(name) != new.get(name):
            yield f"{kind} {name}"


# --- What productions say of them -----------------------------------------------------------------


def _built(name: str, labels: Collection[str], old: ir.Grammar, new: ir.Grammar) -> Iterator[str]:
    """In what the productions of a robot with the module differ from the most similar ones.

    Where the module stands in none of the new grammar, it cannot be kept, so that nothing is said.
    """
    theirs = [*_aspects(name, new, None)]
    for ours in _aspects(name, old, labels) if theirs else ():
        yield from min((_different(ours, each) for each in theirs), key=len)


def _different(old: Aspects, new: Aspects) -> list[str]:
    return [kind for kind, value in old.items() if kind in new and new[kind] != value]


def _aspects(name: str, grammar: ir.Grammar, labels: Collection[str] | None) -> Iterator[Aspects]:
    """What each production says of each occurrence of a module; those with the labels alone."""
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
    """The same of one occurrence of a module, at a place of the right side."""
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
        # Nonterminals are the types of ports; that of the first module is no type.
        right = [symbol.name for symbol in production.right]
        return {"ports": [production.left, *right], **own}
    right = ["" if each.kind == "nonterminal" else each.name for each in production.right]
    return {"production": right, **own}


def _numbered(block: ir.SemanticBlock) -> Callable[[ir.Expr], ir.Expr]:
    """What gives local values numbers in the place of names, in the order in which they stand."""
    local = [rule.target.name for rule in block.rules if rule.target.occurrence == ir.LOCAL]
    numbers = {name: str(number) for number, name in enumerate(local)}

    def renamed(leaf: ir.Expr) -> ir.Expr:
        if isinstance(leaf, ir.AttributeOf) and leaf.occurrence == ir.LOCAL:
            return ir.AttributeOf(ir.LOCAL, numbers.get(leaf.name, leaf.name))
        return leaf

    return renamed

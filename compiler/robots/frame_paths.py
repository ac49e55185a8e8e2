"""Through which modules the frames of a production lead: read off its semantic rules.

A frame expression is a product: what it starts from (the world, or a frame attribute) and steps.
Its *path* has, from the start outwards, the modules that it passes.

- A module that a step mentions (by a degree of freedom or a parameter) is passed at that step, and
  is called moving.  Definitions in the same block are put in for what they define.
- A module that no step mentions (a base, an effector, a link of constant length) has both ends in
  one place as far as the rules tell.  It is passed where the word puts it: a path passes it after
  the start or moving module that is the nearest before it on the right side, if what the path goes
  on to (a module, the occurrence whose attribute is defined, or the outside) stands after it.
  Where only later occurrences lead to it (the frames run against the word) it is passed after the
  first of them; a base never is, it stands on the world.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from grammar_lang import ir

Attribute: TypeAlias = tuple[str, str]
Item: TypeAlias = ir.AttributeOf | int | None
"""A frame attribute from outside the block, a module by its position, or (first only) the world."""
Step: TypeAlias = ir.Rot | ir.Move | ir.Shift


@dataclass(frozen=True, slots=True)
class FramePath:
    """The path of a frame expression; ``items[0]`` is its start."""

    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class ProductionPaths:
    """The frame paths of a production: of each frame it defines, and all in the block's order.

    ``grounded`` are the modules that stand on the world though no path says so.
    """

    defined: Mapping[ir.AttributeOf, FramePath]
    paths: tuple[FramePath, ...]
    grounded: frozenset[int]


@dataclass(frozen=True, slots=True)
class _Draft:
    """A frame expression before the modules that no step mentions are put in.

    ``limit``: where on the right side the frame is handed over; its end where it is emitted or
    handed to the outside.
    """

    target: ir.AttributeOf | None
    items: tuple[Item, ...]
    limit: int


def production_paths(
    production: ir.Production,
    block: ir.SemanticBlock,
    frames: frozenset[Attribute],
    bases: frozenset[str],
) -> ProductionPaths:
    """The frame paths of a production; ``frames`` are the attributes that are frames."""
    drafts = list(_drafts(production, block, frames))
    modules = [i for i, symbol in enumerate(production.right) if symbol.kind == "module"]
    moving = {item for draft in drafts for item in draft.items if isinstance(item, int)}
    anchors: dict[int, Item] = {}
    grounded: set[int] = set()
    for module in modules:
        if module not in moving:
            base = production.right[module].name in bases
            anchor = _anchor(module, drafts, forward_only=base)
            if anchor:
                anchors[module] = anchor[0]
            elif base:
                grounded.add(module)
    paths = [FramePath(_filled(draft, anchors)) for draft in drafts]
    defined = {
        draft.target: path
        for draft, path in zip(drafts, paths, strict=True)
        if draft.target is not None
    }
    return ProductionPaths(defined, tuple(paths), frozenset(grounded))


def start_position(path: FramePath) -> int:
    """Where the start of a path stands on the right side; -1 before it."""
    return _position(path.items[0])


# --- still modules -----------------------------------------------------------------------------


def _position(item: Item) -> int:
    """Where an item stands on the right side; the left side and the world stand before it."""
    if isinstance(item, int):
        return item
    return -1 if item is None else item.occurrence


def _anchor(module: int, drafts: Sequence[_Draft], *, forward_only: bool) -> tuple[Item] | None:
    """After what a module that no step mentions is passed."""
    best: tuple[Item] | None = None
    backward: tuple[Item] | None = None
    for draft in drafts:
        limits = (*map(_position, draft.items[1:]), draft.limit)
        for item, limit in zip(draft.items, limits, strict=True):
            if limit <= module:
                continue
            if _position(item) > module:
                backward = backward or (item,)
            elif best is None or _position(item) > _position(best[0]):
                best = (item,)
    return best or (None if forward_only else backward)


def _filled(draft: _Draft, anchors: Mapping[int, Item]) -> tuple[Item, ...]:
    """The items with the still modules that are passed between them."""
    after: dict[Item, list[int]] = {}
    for module, anchor in anchors.items():
        after.setdefault(anchor, []).append(module)
    limits = (*map(_position, draft.items[1:]), draft.limit)
    found: list[Item] = []
    for item, limit in zip(draft.items, limits, strict=True):
        found.append(item)
        found += [module for module in after.get(item, ()) if module < limit]
    return tuple(found)


# --- expressions -------------------------------------------------------------------------------


def _drafts(
    production: ir.Production, block: ir.SemanticBlock, frames: frozenset[Attribute]
) -> Iterator[_Draft]:
    local = {rule.target: rule.value for rule in block.rules}
    end = len(production.right)
    for rule in block.rules:
        if attribute(production, rule.target) in frames:
            inside = rule.target.occurrence != ir.THIS
            limit = rule.target.occurrence if inside else end
            yield _Draft(rule.target, _items(rule.value, local), limit)
    for emission in block.emissions:
        yield _Draft(None, _items(emission.frame, local), end)


def attribute(production: ir.Production, occurrence: ir.AttributeOf) -> Attribute:
    """The nonterminal and the name of an attribute."""
    if occurrence.occurrence == ir.THIS:
        return production.left, occurrence.name
    return production.right[occurrence.occurrence].name, occurrence.name


def _items(expression: ir.Expr, local: Mapping[ir.AttributeOf, ir.Expr]) -> tuple[Item, ...]:
    """The start of a frame expression and the modules and attributes that follow."""
    factors = _factors(expression, local)
    starts_outside = bool(factors) and isinstance(factors[0], ir.AttributeOf)
    found: list[Item] = [] if starts_outside else [None]
    for factor in factors:
        if isinstance(factor, ir.AttributeOf):
            found.append(factor)
        else:
            found += [module for module in _mentioned(factor, local) if module not in found]
    return tuple(found)


def _factors(
    expression: ir.Expr, local: Mapping[ir.AttributeOf, ir.Expr]
) -> list[ir.AttributeOf | Step]:
    """The factors of a frame expression, without the world, local definitions put in."""
    found: list[ir.AttributeOf | Step] = []
    todo: list[tuple[ir.Expr, frozenset[ir.AttributeOf]]] = [(expression, frozenset())]
    while todo:
        current, inside = todo.pop()
        match current:
            case ir.Compose(left, right):
                todo += [(right, inside), (left, inside)]
            case ir.AttributeOf() if current in local and current not in inside:
                todo.append((local[current], inside | {current}))
            case ir.AttributeOf() | ir.Rot() | ir.Move() | ir.Shift():
                found.append(current)
            case _:
                pass
    return found


def _mentioned(step: Step, local: Mapping[ir.AttributeOf, ir.Expr]) -> list[int]:
    """The modules that a step mentions, in the order of the word."""
    found: set[int] = set()
    seen: set[ir.AttributeOf] = set()
    todo: list[ir.Expr] = [step]
    while todo:
        current = todo.pop()
        match current:
            case ir.DofOf(occurrence, _) | ir.ParameterOf(occurrence, _):
                found.add(occurrence)
            case ir.AttributeOf() if current in local and current not in seen:
                seen.add(current)
                todo.append(local[current])
            case _:
                todo += _operands(current)
    return sorted(found)


def _operands(expression: ir.Expr) -> tuple[ir.Expr, ...]:
    match expression:
        case ir.Rot(_, operand) | ir.Move(_, operand) | ir.Shift(operand) | ir.Unary(_, operand):
            return (operand,)
        case ir.Binary(_, left, right):
            return left, right
        case ir.Vector(x, y, z):
            return x, y, z
        case _:
            return ()

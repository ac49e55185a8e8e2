"""The modules that the frames of a production pass, read off its semantic rules.

A frame expression is a product: a start (the world, or a frame attribute) and steps. Its *path*
lists, from the start outwards, the modules that it passes.

- A step passes the modules that it mentions: by a degree of freedom, a parameter or a constant.
  Names defined in the same block are replaced by their definitions. The modules behind a number
  from another block (``Behind``) are known only in a derivation.
- A module that nothing mentions has both ends in one place as far as the rules tell; it is *still*.
  It is passed at its place in the word: after the start or the passed module that is nearest before
  it on the right side, by every path that goes on from there to something after it. If only later
  occurrences lead to it (the frames run against the word), it is passed after the first of them. A
  module in brackets is not passed on the way to something outside them. Effectors, if there are as
  many modules as emissions, are passed on the way of their emission.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.robots.evaluation_order import owner
from grammar_lang import ir

Attribute: TypeAlias = tuple[str, str]


@dataclass(frozen=True, slots=True)
class Behind:
    """The modules that determine numbers: those mentioned, and those behind attributes."""

    modules: tuple[int, ...]
    attributes: tuple[ir.AttributeOf, ...]

    @property
    def position(self) -> int:
        """The last position on the right side; -1 if everything comes from the left side."""
        return max((*self.modules, *(each.occurrence for each in self.attributes)), default=-1)


Item: TypeAlias = ir.AttributeOf | Behind | int | None
"""A frame attribute from outside the block, modules, or (first only) the world."""
Step: TypeAlias = ir.Rot | ir.Move | ir.Shift
Rules: TypeAlias = Mapping[ir.AttributeOf, ir.AttributeRule]


@dataclass(frozen=True, slots=True)
class Draft:
    """A frame expression before still modules are inserted.

    ``target`` is the attribute it defines, None if it is emitted. ``limit`` is the position on the
    right side to which it is passed; the length of that side if it is emitted or passed to the
    outside. ``body`` holds the modules of the other arguments of an emission.
    """

    target: ir.AttributeOf | None
    items: tuple[Item, ...]
    limit: int
    body: tuple[int | Behind, ...] = ()


@dataclass(frozen=True, slots=True)
class ProductionDrafts:
    """The frame expressions of a production.

    ``numbers`` maps each scalar or vector that it defines to the modules behind it, ``tips`` maps
    its effectors to their emitted frames.
    """

    production: ir.Production
    drafts: tuple[Draft, ...]
    numbers: Mapping[ir.AttributeOf, Behind]
    tips: Mapping[int, Draft]


@dataclass(frozen=True, slots=True)
class FramePath:
    """The path of a frame expression; ``items[0]`` is its start."""

    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class Leaf:
    """Modules that stand at the end of a path unless other paths pass them."""

    path: FramePath
    modules: int | Behind


@dataclass(frozen=True, slots=True)
class ProductionPaths:
    """The frame paths of a production: ``defined`` by attribute, ``paths`` in the block's order."""

    defined: Mapping[ir.AttributeOf, FramePath]
    paths: tuple[FramePath, ...]
    leaves: tuple[Leaf, ...]


def position(item: Item) -> int:
    """The position of an item on the right side; -1 for the left side and the world."""
    match item:
        case int():
            return item
        case Behind():
            return item.position
        case ir.AttributeOf(occurrence, _):
            return occurrence
        case None:
            return -1


# --- still modules -----------------------------------------------------------------------------


def production_paths(found: ProductionDrafts, still: Sequence[int]) -> ProductionPaths:
    """The frame paths of a production with its ``still`` modules inserted."""
    filling = _Filling(found, bracket_levels([symbol.name for symbol in found.production.right]))
    ends = {module: filling.anchor(module) for module in still}
    filling.after = {module: draft.items[-1] for module, draft in ends.items() if draft is not None}
    paths = [filling.path(draft.items, draft.limit) for draft in found.drafts]
    defined = {
        draft.target: path
        for draft, path in zip(found.drafts, paths, strict=True)
        if draft.target is not None
    }
    leaves = [
        Leaf(filling.path(draft.items, module), module)
        for module, draft in ends.items()
        if draft is not None
    ]
    for draft in found.drafts:
        for modules in draft.body:
            place = position(modules)
            limit = place if place >= 0 else draft.limit
            leaves.append(Leaf(filling.path(draft.items, limit), modules))
    return ProductionPaths(defined, tuple(paths), tuple(leaves))


@dataclass(slots=True)
class _Filling:
    """Inserts still modules into paths; ``after`` maps each to the item it is passed after."""

    found: ProductionDrafts
    levels: Sequence[tuple[int, ...]]
    after: dict[int, Item] = field(default_factory=dict[int, Item])

    def anchor(self, module: int) -> Draft | None:
        """The start of a draft, up to the item after which a still module is passed."""
        tip = self.found.tips.get(module)
        own, _ = self._anchors(module, [] if tip is None else [tip])
        forward, backward = self._anchors(module, self.found.drafts)
        return own or forward or backward

    def _anchors(self, module: int, drafts: Sequence[Draft]) -> tuple[Draft | None, Draft | None]:
        """The anchor among the given drafts, along the word and against it."""
        best: tuple[tuple[bool, int, int], Draft] | None = None
        backward: Draft | None = None
        for draft in drafts:
            limits = (*map(position, draft.items[1:]), draft.limit)
            for index, (item, limit) in enumerate(zip(draft.items, limits, strict=True)):
                place = position(item)
                if limit <= module:
                    continue
                head = Draft(None, draft.items[: index + 1], draft.limit)
                if place > module:
                    backward = backward or head
                    continue
                level = self.level(item)
                inside = self.levels[module][: len(level)] == level
                rank = (inside, place, index)
                if best is None or rank > best[0]:
                    best = (rank, head)
        return None if best is None else best[1], backward

    def path(self, items: Sequence[Item], limit: int) -> FramePath:
        """The items, with the still modules that are passed between them."""
        limits = (*map(position, items[1:]), limit)
        result: list[Item] = []
        for item, bound in zip(items, limits, strict=True):
            result.append(item)
            level = self.levels[bound] if 0 <= bound < len(self.levels) else self.level(item)
            result += [
                module
                for module, anchor in self.after.items()
                if anchor == item
                and module < bound
                and level[: len(self.levels[module])] == self.levels[module]
            ]
        return FramePath(tuple(result))

    def level(self, item: Item) -> tuple[int, ...]:
        """The brackets around an item."""
        place = position(item)
        return () if place < 0 else self.levels[place]


# --- expressions -------------------------------------------------------------------------------


def production_drafts(
    production: ir.Production,
    block: ir.SemanticBlock,
    frames: frozenset[Attribute],
    effectors: frozenset[str],
) -> ProductionDrafts:
    """The frame expressions of a production.

    ``frames`` are the attributes that are frames, ``effectors`` the modules with that role.
    """
    rules = {rule.target: rule for rule in block.rules}
    drafts: list[Draft] = []
    numbers: dict[ir.AttributeOf, Behind] = {}
    end = len(production.right)
    for rule in block.rules:
        if rule.target.occurrence == ir.LOCAL:
            continue  # inserted where it is read
        if attribute(production, rule.target) in frames:
            inside = rule.target.occurrence != ir.THIS
            limit = rule.target.occurrence if inside else end
            drafts.append(Draft(rule.target, _items(rule.value, rules), limit))
        else:
            numbers[rule.target] = _behind([rule.value], rule.mentions, rules)
    for emission in block.emissions:
        body = _behind(_body(emission), emission.mentions, rules)
        modules: tuple[int | Behind, ...] = body.modules
        if body.attributes:
            modules += (Behind((), body.attributes),)
        drafts.append(Draft(None, _items(emission.frame, rules), end, modules))
    emitted = zip(drafts[len(drafts) - len(block.emissions) :], block.emissions, strict=True)
    tips = [draft for draft, emission in emitted if isinstance(emission, ir.Effector)]
    owners = [i for i, symbol in enumerate(production.right) if symbol.name in effectors]
    owned = dict(zip(owners, tips, strict=True)) if len(owners) == len(tips) else {}
    return ProductionDrafts(production, tuple(drafts), numbers, owned)


def attribute(production: ir.Production, occurrence: ir.AttributeOf) -> Attribute:
    """The nonterminal (for a local value the production) and the name of an attribute."""
    return owner(production, occurrence), occurrence.name


def _items(expression: ir.Expr, rules: Rules) -> tuple[Item, ...]:
    """The start of a frame expression and the modules and attributes that follow."""
    factors = list(_factors(expression, rules))
    starts_outside = bool(factors) and isinstance(factors[0], ir.AttributeOf)
    found: list[Item] = [] if starts_outside else [None]
    for factor in factors:
        if isinstance(factor, ir.AttributeOf):
            found.append(factor)
            continue
        step = _behind([factor], (), rules)
        if step.attributes:
            found.append(step)
        else:
            found += [module for module in step.modules if module not in found]
    return tuple(found)


def _factors(expression: ir.Expr, rules: Rules) -> Iterator[ir.AttributeOf | Step]:
    """The factors of a frame expression without the world, with local definitions inserted."""
    todo: list[tuple[ir.Expr, frozenset[ir.AttributeOf]]] = [(expression, frozenset())]
    while todo:
        current, inside = todo.pop()
        match current:
            case ir.Compose(left, right):
                todo += [(right, inside), (left, inside)]
            case ir.AttributeOf() if current in rules and current not in inside:
                todo.append((rules[current].value, inside | {current}))
            case ir.AttributeOf() | ir.Rot() | ir.Move() | ir.Shift():
                yield current
            case _:
                pass


def _behind(expressions: Sequence[ir.Expr], mentions: Sequence[int], rules: Rules) -> Behind:
    """The modules and attributes behind expressions, with local definitions inserted."""
    modules = set(mentions)
    attributes: dict[ir.AttributeOf, None] = {}
    seen: set[ir.AttributeOf] = set()
    todo = [*expressions]
    while todo:
        current = todo.pop()
        match current:
            case ir.DofOf(occurrence, _) | ir.ParameterOf(occurrence, _):
                modules.add(occurrence)
            case ir.AttributeOf() if current in rules:
                if current not in seen:
                    seen.add(current)
                    modules |= set(rules[current].mentions)
                    todo.append(rules[current].value)
            case ir.AttributeOf():
                attributes[current] = None
            case ir.Rot() | ir.Move() | ir.Shift():
                modules |= set(current.mentions)
                todo += _operands(current)
            case _:
                todo += _operands(current)
    return Behind(tuple(sorted(modules)), tuple(attributes))


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


def _body(emission: ir.Emission) -> tuple[ir.Expr, ...]:
    """The arguments of an emission other than its frame."""
    match emission:
        case ir.Rod(_, _, length, density, radius):
            return (length, density) if radius is None else (length, density, radius)
        case ir.PointMass(_, mass):
            return (mass,)
        case ir.Solid(_, mass, com, inertia):
            return (mass, com, *inertia)
        case ir.Shape(_, _, _, sizes):
            return sizes
        case ir.Effector():
            return ()


# --- The module that each module stands on, from the word and its brackets alone ------------------


BRACKETS = {"(": ")", "[": "]", "{": "}", "<": ">"}
OPENING = {closing: opening for opening, closing in BRACKETS.items()}


def word_neighbours(
    word: Sequence[str], modules: Container[str], bases: Container[str]
) -> dict[int, int | None]:
    """The module that each module stands on, by place in the word; None if it stands on none.

    A module stands on the one before it at its level. An opening bracket begins a level that starts
    at the module before it, and the closing bracket returns to that module. Brackets that do not
    balance are ignored. A base stands on nothing.
    """
    partners = bracket_partners(word)
    balanced = len(partners) == sum(symbol in BRACKETS or symbol in OPENING for symbol in word)
    found: dict[int, int | None] = {}
    outer: list[int | None] = []
    below: int | None = None
    for place, symbol in enumerate(word):
        if symbol in modules:
            found[place] = None if symbol in bases else below
            below = place
        elif balanced and symbol in BRACKETS:
            outer.append(below)
        elif balanced and symbol in OPENING:
            below = outer.pop()
    return found


def bracket_partners(word: Sequence[str]) -> dict[int, int]:
    """The place of each bracket's partner; brackets without a partner are left out."""
    partners: dict[int, int] = {}
    opened: list[int] = []
    for place, symbol in enumerate(word):
        if symbol in BRACKETS:
            opened.append(place)
        elif symbol in OPENING and opened and word[opened[-1]] == OPENING[symbol]:
            partners[place] = opened.pop()
            partners[partners[place]] = place
    return partners


def bracket_levels(symbols: Sequence[str]) -> tuple[tuple[int, ...], ...]:
    """For each symbol the places of the brackets around it; all empty if they do not balance."""
    partners = bracket_partners(symbols)
    if any(i not in partners for i, s in enumerate(symbols) if s in BRACKETS or s in OPENING):
        return ((),) * len(symbols)
    found: list[tuple[int, ...]] = []
    level: tuple[int, ...] = ()
    for place, symbol in enumerate(symbols):
        level = level[:-1] if symbol in OPENING else level
        found.append(level)
        level = (*level, place) if symbol in BRACKETS else level
    return tuple(found)

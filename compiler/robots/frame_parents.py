"""The module on which each module of a derivation stands, as far as its frames determine it."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from compiler.robots.attributes import SemanticsError
from compiler.robots.frame_paths import (
    Attribute,
    Behind,
    FramePath,
    Item,
    ProductionDrafts,
    ProductionPaths,
    attribute,
    position,
    production_drafts,
    production_paths,
)
from compiler.words.derivation import Derivation
from grammar_lang import ir

Instance: TypeAlias = tuple[int, str]


class Ends(NamedTuple):
    """The first and the last module on the way from the world to a frame, by place in the word."""

    first: int | None
    last: int | None


def frame_parents(
    derivation: Derivation, grammar: ir.Grammar, modules: Mapping[str, ir.Module]
) -> dict[int, int | None]:
    """The module that each module stands on, by place in the word; None for the world.

    A module stands on the one before it on a frame path that passes it: the first path of its
    production that starts before it on the right side; else the first path of another production;
    else the first path of its production. A module that only the body of an emission mentions
    stands at the end of the path of that emission's frame, and nothing stands on it.

    A path that starts at a frame attribute continues the path that defines it. If a frame made from
    the world is put behind another frame, its first module stands on the last module of the other.
    A base stands on the world. If there are bases, anything else that would stand on the world
    stands on the nearest base before it in the word, or on the first base. Modules that no frame
    passes are left out.

    Raises:
        SemanticsError: an attribute is not defined, or depends on itself.
    """
    frames = frame_attributes(grammar)
    effectors = frozenset(name for name, module in modules.items() if module.role == "effector")
    drafts = {
        production.label: production_drafts(
            production, (grammar.semantics or {})[production.label], frames, effectors
        )
        for production in grammar.productions
    }
    bases = [
        place
        for place, symbol in enumerate(derivation.word)
        if symbol in modules and modules[symbol].role == "base"
    ]
    tracing = _Tracing(derivation, drafts, frozenset(bases))
    parents = tracing.own()
    parents |= dict.fromkeys(bases)
    _break_cycles(parents)
    tracing.put_behind(parents)
    return _grounded(parents, bases)


@dataclass(slots=True)
class _Tracing:
    """The ends of the frames of a derivation, found on demand with an explicit stack.

    ``moving`` holds the modules that steps mention, ``ending`` those that only bodies mention.
    """

    derivation: Derivation
    drafts: Mapping[str, ProductionDrafts]
    bases: frozenset[int]
    numbers: DerivedNumbers = field(init=False)
    moving: set[int] = field(default_factory=set[int])
    ending: set[int] = field(default_factory=set[int])
    paths: list[ProductionPaths] = field(default_factory=list[ProductionPaths])
    ends: dict[Instance, Ends] = field(default_factory=dict[Instance, Ends])

    def __post_init__(self) -> None:
        self.numbers = DerivedNumbers(self.derivation, self.drafts)
        for number, node in enumerate(self.derivation.nodes):
            for draft in self.drafts[node.production.label].drafts:
                for item in draft.items:
                    if isinstance(item, int | Behind):
                        self.moving.update(self.numbers.places(number, item))
                for body in draft.body:
                    self.ending.update(self.numbers.places(number, body))
        self.ending -= self.moving | self.bases
        known: dict[tuple[str, tuple[int, ...]], ProductionPaths] = {}
        named = self.moving | self.ending | self.bases
        for node in self.derivation.nodes:
            right = node.production.right
            still = tuple(
                i
                for i, child in enumerate(node.children)
                if right[i].kind == "module" and child not in named
            )
            key = (node.production.label, still)
            if key not in known:
                known[key] = production_paths(self.drafts[key[0]], still)
            self.paths.append(known[key])

    def own(self) -> dict[int, int | None]:
        """The module before each module on the paths of its production, else on paths of others."""
        forward: dict[int, int | None] = {}
        foreign: dict[int, int | None] = {}
        backward: dict[int, int | None] = {}
        leaves: dict[int, int | None] = {}
        for number, found in enumerate(self.paths):
            for path in found.paths:
                start = position(path.items[0])
                before: int | None = None
                for item, ends in self.walk(number, path):
                    if not isinstance(item, ir.AttributeOf) and ends.first is not None:
                        chosen = forward if start < position(item) else backward
                        chosen = foreign if isinstance(item, Behind) else chosen
                        if before != ends.first:
                            chosen.setdefault(ends.first, before)
                    before = before if ends.last is None else ends.last
            for leaf in found.leaves:
                last = self._ends(number, leaf.path).last
                for place in self.numbers.places(number, leaf.modules):
                    if place not in self.moving:
                        leaves.setdefault(place, last)
        return {**leaves, **backward, **foreign, **forward}

    def put_behind(self, parents: dict[int, int | None]) -> None:
        """Let frames that are put behind other frames stand on these."""
        for number, found in enumerate(self.paths):
            for path in found.paths:
                before: int | None = None
                for item, (first, last) in self.walk(number, path):
                    behind = before is not None and isinstance(item, ir.AttributeOf)
                    free = first is not None and first not in self.bases
                    if behind and free and first is not None and parents.get(first) is None:
                        parents[first] = before if _root(parents, before) != first else None
                    before = before if last is None else last

    def walk(self, node: int, path: FramePath) -> Iterator[tuple[Item, Ends]]:
        """The items of a path in the block of a node, without the world, with their ends.

        Modules behind numbers come one by one. A module comes once, and no base comes after another
        module.
        """
        passed: set[int] = set()
        begun = False
        for item in path.items:
            if isinstance(item, ir.AttributeOf):
                ends = self.demand(self.instance(node, item))
                begun = begun or ends.last is not None
                yield item, ends
            elif item is not None:
                for place in self.numbers.places(node, item):
                    if place not in passed and not (begun and place in self.bases):
                        passed.add(place)
                        begun = True
                        yield item, Ends(place, place)

    def instance(self, node: int, item: ir.AttributeOf) -> Instance:
        """The node that has an attribute, and its name."""
        if item.occurrence == ir.THIS:
            return node, item.name
        return self.derivation.nodes[node].children[item.occurrence], item.name

    def demand(self, instance: Instance) -> Ends:
        """The ends of a frame; first finds those of the frames that it depends on."""
        if instance in self.ends:
            return self.ends[instance]
        stack = [instance]
        waiting = {instance}
        while stack:
            current = stack[-1]
            where, path = self.definition(current)
            missing = [
                needed
                for item in path.items
                if isinstance(item, ir.AttributeOf)
                and (needed := self.instance(where, item)) not in self.ends
            ]
            if missing and missing[0] in waiting:
                raise SemanticsError(f"attribute `{missing[0][1]}` depends on itself")
            if missing:
                stack.append(missing[0])
                waiting.add(missing[0])
                continue
            self.ends.setdefault(current, self._ends(where, path))
            waiting.discard(stack.pop())
        return self.ends[instance]

    def _ends(self, where: int, path: FramePath) -> Ends:
        first: int | None = None
        last: int | None = None
        for _, ends in self.walk(where, path):
            first = ends.first if first is None else first
            last = last if ends.last is None else ends.last
        return Ends(first, last)

    def definition(self, instance: Instance) -> tuple[int, FramePath]:
        """The node whose block defines a frame, and the frame's path there."""
        node, name = instance
        path = self.paths[node].defined.get(ir.AttributeOf(ir.THIS, name))
        if path is not None:
            return node, path
        parent, place = self.numbers.above[node]
        if parent < 0:
            if name == "frame":
                return node, FramePath((None,))
        else:
            path = self.paths[parent].defined.get(ir.AttributeOf(place, name))
            if path is not None:
                return parent, path
        left = self.derivation.nodes[node].production.left
        raise SemanticsError(f"attribute `{name}` of `{left}` has no rule")


def _root(parents: Mapping[int, int | None], module: int | None) -> int | None:
    """The module at the bottom of all modules that a module stands on."""
    root = module
    while module is not None:
        root, module = module, parents.get(module)
    return root


def _break_cycles(parents: dict[int, int | None]) -> None:
    """Let the module of each cycle that comes first in the word stand on the world.

    Cycles arise if frames lead back through a module that they come from.
    """
    seen: dict[int, int] = {}
    for start in sorted(parents):
        walked: list[int] = []
        module: int | None = start
        while module is not None and module not in seen:
            seen[module] = start
            walked.append(module)
            module = parents.get(module)
        if module is not None and seen[module] == start:
            parents[min(walked[walked.index(module) :])] = None


def _grounded(parents: Mapping[int, int | None], bases: Sequence[int]) -> dict[int, int | None]:
    """Let modules that stand on the world stand on bases, if there are any."""
    found = dict(sorted(parents.items()))
    ground = frozenset(bases)
    for module, parent in found.items():
        if parent is None and bases and module not in ground:
            found[module] = bases[max(bisect(bases, module) - 1, 0)]
    return found


# --- The modules of a derivation that determine the numbers in its frames -------------------------


@dataclass(slots=True)
class DerivedNumbers:
    """Follows scalar attributes through a derivation to the modules behind them.

    ``above`` holds, for each node, its parent and its position on the parent's right side.
    """

    derivation: Derivation
    drafts: Mapping[str, ProductionDrafts]
    above: list[tuple[int, int]] = field(default_factory=list[tuple[int, int]])
    _known: dict[tuple[int, Behind], tuple[int, ...]] = field(
        default_factory=dict[tuple[int, Behind], tuple[int, ...]]
    )

    def __post_init__(self) -> None:
        self.above = [(-1, -1)] * len(self.derivation.nodes)
        for number, node in enumerate(self.derivation.nodes):
            for index, symbol in enumerate(node.production.right):
                if symbol.kind == "nonterminal":
                    self.above[node.children[index]] = (number, index)

    def places(self, node: int, modules: int | Behind) -> tuple[int, ...]:
        """The places, in word order, of modules that are named in the block of a node."""
        if isinstance(modules, int):
            return (self.derivation.nodes[node].children[modules],)
        if (node, modules) not in self._known:
            self._known[node, modules] = tuple(sorted(self._follow(node, modules)))
        return self._known[node, modules]

    def _follow(self, node: int, modules: Behind) -> set[int]:
        found: set[int] = set()
        seen: set[tuple[int, ir.AttributeOf]] = set()
        todo = [(node, modules)]
        while todo:
            where, current = todo.pop()
            children = self.derivation.nodes[where].children
            found.update(children[module] for module in current.modules)
            for each in current.attributes:
                defining, target = self._definition(where, each)
                drafts = self.drafts[self.derivation.nodes[defining].production.label]
                if (defining, target) not in seen and target in drafts.numbers:
                    seen.add((defining, target))
                    todo.append((defining, drafts.numbers[target]))
        return found

    def _definition(self, node: int, each: ir.AttributeOf) -> tuple[int, ir.AttributeOf]:
        """The node whose block defines an attribute, and the attribute's name there."""
        if each.occurrence != ir.THIS:
            child = self.derivation.nodes[node].children[each.occurrence]
            return child, ir.AttributeOf(ir.THIS, each.name)
        parent, position = self.above[node]
        return (max(parent, 0), ir.AttributeOf(position, each.name))


# --- Which attributes of a grammar are frames: those defined as frames, and copies of these -------


def frame_attributes(grammar: ir.Grammar) -> frozenset[Attribute]:
    """The attributes that are frames; ``frame`` is one if the start symbol inherits it."""
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

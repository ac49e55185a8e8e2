"""On which module each module of a derivation stands, as far as its frames tell."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from compiler.grammars.derivation import Derivation
from compiler.robots.attributes import SemanticsError
from compiler.robots.frame_attributes import frame_attributes
from compiler.robots.frame_paths import (
    FramePath,
    Item,
    ProductionPaths,
    production_paths,
    start_position,
)
from grammar_lang import ir

Instance: TypeAlias = tuple[int, str]


class Ends(NamedTuple):
    """The first and the last module on the way from the world to a frame, by place in the word."""

    first: int | None
    last: int | None


WORLD = Ends(None, None)


def frame_parents(
    derivation: Derivation, grammar: ir.Grammar, modules: Mapping[str, ir.Module]
) -> dict[int, int | None]:
    """The module that each module stands on, by place in the word; None for the world.

    A module stands on the one before it on the first frame path of its production that passes it,
    among those that start before it on the right side, if there are any.  What a path starts from
    is continued where it was defined; where a frame made from the world is put behind another, its
    first module stands on the last of the other.  Of what stands on the world after all,
    everything but bases stands on the nearest base before it in the word, or the first base.
    Modules that no frame passes are left out.

    Raises:
        SemanticsError: an attribute is not defined, or depends on itself.
    """
    frames = frame_attributes(grammar)
    bases = frozenset(name for name, module in modules.items() if module.role == "base")
    paths = {
        production.label: production_paths(
            production, (grammar.semantics or {})[production.label], frames, bases
        )
        for production in grammar.productions
    }
    tracing = _Tracing(derivation, paths)
    parents = tracing.own()
    _break_cycles(parents)
    tracing.put_behind(parents)
    return _grounded(derivation.word, parents, bases)


@dataclass(slots=True)
class _Tracing:
    """The ends of the frames of a derivation, found on demand with an explicit stack."""

    derivation: Derivation
    paths: Mapping[str, ProductionPaths]
    above: list[tuple[int, int]] = field(default_factory=list[tuple[int, int]])
    ends: dict[Instance, Ends] = field(default_factory=dict[Instance, Ends])

    def __post_init__(self) -> None:
        self.above = [(-1, -1)] * len(self.derivation.nodes)
        for number, node in enumerate(self.derivation.nodes):
            for position, symbol in enumerate(node.production.right):
                if symbol.kind == "nonterminal":
                    self.above[node.children[position]] = (number, position)

    def own(self) -> dict[int, int | None]:
        """The module before each on the paths of its production."""
        parents: dict[int, int | None] = {}
        backward: dict[int, int | None] = {}
        for number, node in enumerate(self.derivation.nodes):
            found = self.paths[node.production.label]
            parents |= {node.children[position]: None for position in found.grounded}
            for path in found.paths:
                start = start_position(path)
                before: int | None = None
                for item, ends in self.walk(number, path):
                    if isinstance(item, int) and ends.first is not None:
                        chosen = parents if start < item else backward
                        chosen.setdefault(ends.first, before)
                    before = before if ends.last is None else ends.last
        return {**backward, **parents}

    def put_behind(self, parents: dict[int, int | None]) -> None:
        """Join the frames that are put behind others to those."""
        for number, node in enumerate(self.derivation.nodes):
            for path in self.paths[node.production.label].paths:
                before: int | None = None
                for item, (first, last) in self.walk(number, path):
                    behind = before is not None and not isinstance(item, int)
                    if behind and first is not None and parents.get(first) is None:
                        parents[first] = before if _root(parents, before) != first else None
                    before = before if last is None else last

    def walk(self, node: int, path: FramePath) -> Iterator[tuple[Item, Ends]]:
        """The items of a path in the block of a node, the world left out, with their ends."""
        children = self.derivation.nodes[node].children
        for item in path.items:
            if isinstance(item, int):
                yield item, Ends(children[item], children[item])
            elif item is not None:
                yield item, self.demand(self.instance(node, item))

    def instance(self, node: int, item: ir.AttributeOf) -> Instance:
        """The node that has an attribute, and its name."""
        if item.occurrence == ir.THIS:
            return node, item.name
        return self.derivation.nodes[node].children[item.occurrence], item.name

    def demand(self, instance: Instance) -> Ends:
        """The ends of a frame, finding first whatever they depend on."""
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
        children = self.derivation.nodes[where].children
        for item in path.items:
            if isinstance(item, int):
                ends = Ends(children[item], children[item])
            else:
                ends = WORLD if item is None else self.ends[self.instance(where, item)]
            first = ends.first if first is None else first
            last = last if ends.last is None else ends.last
        return Ends(first, last)

    def definition(self, instance: Instance) -> tuple[int, FramePath]:
        """The node whose block defines a frame, and its path there."""
        node, name = instance
        production = self.derivation.nodes[node].production
        path = self.paths[production.label].defined.get(ir.AttributeOf(ir.THIS, name))
        if path is not None:
            return node, path
        parent, position = self.above[node]
        if parent < 0:
            if name == "frame":
                return node, FramePath((None,))
        else:
            above = self.derivation.nodes[parent].production
            path = self.paths[above.label].defined.get(ir.AttributeOf(position, name))
            if path is not None:
                return parent, path
        raise SemanticsError(f"attribute `{name}` of `{production.left}` has no rule")


def _root(parents: Mapping[int, int | None], module: int | None) -> int | None:
    """The module at the bottom of all that a module stands on."""
    root = module
    while module is not None:
        root, module = module, parents.get(module)
    return root


def _break_cycles(parents: dict[int, int | None]) -> None:
    """Put a module of each cycle, that which comes first in the word, on the world.

    Frames that lead back through a module that they come from have such cycles.
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


def _grounded(
    word: Sequence[str], parents: Mapping[int, int | None], bases: frozenset[str]
) -> dict[int, int | None]:
    """Put what stands on the world onto bases, where there are any."""
    ground = sorted(i for i, parent in parents.items() if parent is None and word[i] in bases)
    found = dict(sorted(parents.items()))
    for module, parent in found.items():
        if parent is None and ground and word[module] not in bases:
            found[module] = ground[max(bisect(ground, module) - 1, 0)]
    return found

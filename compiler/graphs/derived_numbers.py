"""Of which modules of a derivation the numbers in its frames are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from compiler.grammars.derivation import Derivation
from compiler.graphs.frame_paths import Behind, ProductionDrafts
from grammar_lang import ir


@dataclass(slots=True)
class DerivedNumbers:
    """Follows scalar attributes through a derivation to the modules behind them.

    ``above`` is per node its parent and where it stands on the right side of that.
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
            for position, symbol in enumerate(node.production.right):
                if symbol.kind == "nonterminal":
                    self.above[node.children[position]] = (number, position)

    def places(self, node: int, modules: int | Behind) -> tuple[int, ...]:
        """Modules of the block of a node by place, in the order of the word."""
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
        """The node whose block defines an attribute, and what it is called there."""
        if each.occurrence != ir.THIS:
            child = self.derivation.nodes[node].children[each.occurrence]
            return child, ir.AttributeOf(ir.THIS, each.name)
        parent, position = self.above[node]
        return (max(parent, 0), ir.AttributeOf(position, each.name))

"""What the items of a program declare, whatever is wrong with them."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field

from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from srgc.language_server.names.occurrence_names import named_positions


@dataclass(slots=True)
class Declared:
    """What the items of a program declare, by name; of several declarations the first counts."""

    terminals: dict[str, s.Ident] = field(default_factory=dict[str, s.Ident])
    modules: dict[str, s.Module] = field(default_factory=dict[str, s.Module])
    grammars: dict[str, s.Grammar] = field(default_factory=dict[str, s.Grammar])
    semantics: dict[str, s.Semantics] = field(default_factory=dict[str, s.Semantics])
    workspaces: dict[str, t.Workspace] = field(default_factory=dict[str, t.Workspace])
    tasks: dict[str, t.Task] = field(default_factory=dict[str, t.Task])

    def add(self, item: t.Item) -> None:
        """Take note of an item."""
        match item:
            case s.Module(name=name):
                self.terminals.setdefault(name.text, name)
                self.modules.setdefault(name.text, item)
            case s.Edges(names=names):
                for name in names:
                    self.terminals.setdefault(name.text, name)
            case s.Grammar(name=name):
                self.grammars.setdefault(name.text, item)
            case s.Semantics(grammar=name):
                self.semantics.setdefault(name.text, item)
            case t.Workspace(name=name):
                self.workspaces.setdefault(name.text, item)
            case t.Task(name=name):
                self.tasks.setdefault(name.text, item)
            case t.Include():
                pass

    def is_first(self, item: t.Item) -> bool:
        """Whether no item before it has the same name and kind."""
        match item:
            case s.Module(name=name):
                return self.modules.get(name.text) is item
            case s.Grammar(name=name):
                return self.grammars.get(name.text) is item
            case t.Workspace(name=name):
                return self.workspaces.get(name.text) is item
            case _:
                return True


def declared_by(file: t.File) -> Declared:
    """What a file declares."""
    found = Declared()
    for item in file.items:
        found.add(item)
    return found


def module_names(module: s.Module) -> dict[str, s.ModuleItem]:
    """The parameters, constants, degrees of freedom, states and inputs of a module, by name."""
    found: dict[str, s.ModuleItem] = {}
    for item in module.items:
        if isinstance(item, s.Param | s.Const | s.Dof | s.State | s.Input):
            found.setdefault(item.name.text, item)
    return found


def productions_of(grammar: s.Grammar) -> dict[str, s.Production]:
    """The productions of a grammar, by label."""
    return _first_by(grammar, lambda production: production.label.text)


def nonterminals_of(grammar: s.Grammar) -> dict[str, s.Production]:
    """The nonterminals of a grammar, each with its first production."""
    return _first_by(grammar, lambda production: production.left.text)


def _first_by(grammar: s.Grammar, name: Callable[[s.Production], str]) -> dict[str, s.Production]:
    found: dict[str, s.Production] = {}
    for item in grammar.items:
        if isinstance(item, s.Production):
            found.setdefault(name(item), item)
    return found


def workspace_of(task: t.Task) -> str | None:
    """The workspace that a task names."""
    return next((i.name.text for i in task.items if isinstance(i, t.TaskWorkspace)), None)


def positions_in(production: s.Production, taken: Collection[str]) -> dict[str, int]:
    """How a production calls the symbols of its right side."""
    symbols = [occurrence.symbol for occurrence in production.right]
    return named_positions(symbols, [each.alias for each in production.right], taken)

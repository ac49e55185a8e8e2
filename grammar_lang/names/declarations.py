"""What a specification declares, and the errors about names that are declared twice or not at all.

Modules, edges and nonterminals share one name space.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.names.entities import REGIONS, Entity, Kind, entity, nonterminals, places
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t


@dataclass
class Declarations:
    """The items of a specification by name; of several of a name only the first is kept."""

    terminals: dict[str, Entity] = field(default_factory=dict[str, Entity])
    modules: dict[str, s.Module] = field(default_factory=dict[str, s.Module])
    grammars: dict[str, s.Grammar] = field(default_factory=dict[str, s.Grammar])
    semantics: dict[str, s.Semantics] = field(default_factory=dict[str, s.Semantics])
    workspaces: dict[str, t.Workspace] = field(default_factory=dict[str, t.Workspace])
    tasks: dict[str, t.Task] = field(default_factory=dict[str, t.Task])

    def is_first(self, item: t.Item) -> bool:
        """Whether no item before it has its name space; a task and a semantics have none."""
        match item:
            case s.Module(name=name):
                return self.modules.get(name.text) is item
            case s.Grammar(name=name):
                return self.grammars.get(name.text) is item
            case t.Workspace(name=name):
                return self.workspaces.get(name.text) is item
            case _:
                return True

    @cached_property
    def places(self) -> Mapping[str, Mapping[str, Entity]]:
        """The regions and maps of each workspace, by name."""
        return {name: places(workspace) for name, workspace in self.workspaces.items()}

    @cached_property
    def regions(self) -> Mapping[str, tuple[str, ...]]:
        """The names of the regions of each workspace."""
        return {
            workspace: tuple(name for name, place in found.items() if place.kind != "map")
            for workspace, found in self.places.items()
        }

    @cached_property
    def by_name(self) -> Mapping[str, Entity]:
        """Modules, edges, nonterminals, regions, maps and items; the first of each name."""
        found: dict[str, Entity] = {}
        for each in self._all():
            found.setdefault(each.name, each)
        return found

    def _all(self) -> Iterator[Entity]:
        yield from self.terminals.values()
        for grammar in self.grammars.values():
            yield named(grammar)
            yield from nonterminals(grammar).values()
        yield from map(named, self.workspaces.values())
        yield from map(named, self.tasks.values())
        for found in self.places.values():
            yield from found.values()


def named(item: s.Grammar | t.Workspace | t.Task) -> Entity:
    """The entity that an item declares."""
    kinds: dict[type, Kind] = {s.Grammar: "grammar", t.Workspace: "workspace", t.Task: "task"}
    return entity(kinds[type(item)], (), item.name, item.span)


# --- collection --------------------------------------------------------------------------------


def duplicate(name: s.Ident, first: Span, sink: Sink, hint: str = "choose another name") -> None:
    """Report a second declaration of a name."""
    message = f"`{name.text}` is declared twice"
    sink.error(Code.DUPLICATE_NAME, message, name.span, hint, [(first, "first here")])


def _terminal(
    kind: Kind, name: s.Ident, statement: Span, declared: Declarations, sink: Sink
) -> bool:
    found = declared.terminals.setdefault(name.text, entity(kind, (), name, statement))
    if found.span is not name.span:
        duplicate(name, found.span, sink)
    return found.span is name.span


def _edges(edges: s.Edges, declared: Declarations, sink: Sink) -> None:
    for name in edges.names:
        if not name.text or not name.text.isprintable() or " " in name.text:
            message = "an edge label is neither empty nor contains blanks"
            sink.error(Code.SYNTAX, message, name.span, "write visible characters only")
        else:
            _terminal("edge", name, edges.span, declared, sink)


def _semantics(semantics: s.Semantics, declared: Declarations, sink: Sink) -> None:
    name = semantics.grammar
    first = declared.semantics.setdefault(name.text, semantics)
    if first is not semantics:
        message = f"a second `semantics` of grammar `{name.text}`"
        notes = [(first.grammar.span, "first here")]
        sink.error(Code.DUPLICATE_NAME, message, name.span, "merge the two", notes)


def _item(item: t.Item, declared: Declarations, sink: Sink) -> None:
    match item:
        case s.Module(name=name):
            if _terminal("module", name, item.span, declared, sink):
                declared.modules[name.text] = item
        case s.Edges():
            _edges(item, declared, sink)
        case s.Semantics():
            _semantics(item, declared, sink)
        case s.Grammar() | t.Workspace() | t.Task():
            _named(item, declared, sink)
        case t.Include():
            pass


def _named(item: s.Grammar | t.Workspace | t.Task, declared: Declarations, sink: Sink) -> None:
    first: s.Grammar | t.Workspace | t.Task
    match item:
        case s.Grammar():
            first = declared.grammars.setdefault(item.name.text, item)
        case t.Workspace():
            first = declared.workspaces.setdefault(item.name.text, item)
        case t.Task():
            first = declared.tasks.setdefault(item.name.text, item)
    if first is not item:
        duplicate(item.name, first.name.span, sink)


def declarations(file: t.File, sink: Sink) -> Declarations:
    """Collect the declarations of a file; second ones of a name are reported."""
    declared = Declarations()
    for item in file.items:
        _item(item, declared, sink)
    return declared


# --- names that stand for nothing due ----------------------------------------------------------


def _described(found: Entity) -> str:
    if found.kind in REGIONS:
        return f"a region of workspace `{found.scope[0]}`"
    if found.kind == "map":
        return f"a map of obstacles of workspace `{found.scope[0]}`"
    return f"an {found.kind}" if found.kind == "edge" else f"a {found.kind}"


def report_unknown(
    name: s.Ident,
    due: str,
    known: Collection[str],
    declared: Declarations,
    sink: Sink,
    message: str | None = None,
) -> None:
    """Report a name that is not ``due``: what it is instead, or that there is none.

    Args:
        name: the name.
        due: what is due here, with its article: ``a grammar``.
        known: the names that would do.
        declared: what the specification declares.
        sink: where the error goes.
        message: what to say of a name that stands for nothing at all.
    """
    what = due.split(" ", 1)[1]
    hint = did_you_mean(name.text, known, what, sink)
    other = declared.by_name.get(name.text)
    if other is not None:
        message = f"`{name.text}` is {_described(other)}, not {due}"
        notes = [(other.span, "declared here")]
        sink.error(Code.WRONG_KIND, message, name.span, hint, notes)
    else:
        unknown = message or f"unknown {what} `{name.text}`"
        sink.error(Code.UNKNOWN_NAME, unknown, name.span, hint)

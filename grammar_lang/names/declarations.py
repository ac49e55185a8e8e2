"""The entities that names refer to, and the items of a specification that declare them."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Collection, Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, TypeAlias

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.parsing.tables import RESERVED
from grammar_lang.source import Span, node
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t

# --- The entities that names refer to, as the items of a specification declare them ------------


Kind: TypeAlias = Literal[
    "module",
    "edge",
    "parameter",
    "constant",
    "degree of freedom",
    "state",
    "input",
    "frame",
    "port type",
    "grammar",
    "nonterminal",
    "production",
    "occurrence",
    "attribute",
    "local value",
    "workspace",
    "region",
    "obstacle",
    "target",
    "map",
    "task",
    "mission",
]
TERMINALS: tuple[Kind, ...] = ("module", "edge")
MEMBERS: tuple[Kind, ...] = (
    "parameter",
    "constant",
    "degree of freedom",
    "state",
    "input",
    "frame",
)
REGIONS: tuple[Kind, ...] = ("region", "obstacle", "target")

_MEMBER_KINDS: dict[type, Kind] = {
    s.Param: "parameter",
    s.Const: "constant",
    s.Dof: "degree of freedom",
    s.State: "state",
    s.Input: "input",
    s.Frame: "frame",
}


_Named: TypeAlias = s.Grammar | t.Workspace | t.Task | m.Mission
_NAMED_KINDS: dict[type, Kind] = {
    s.Grammar: "grammar",
    t.Workspace: "workspace",
    t.Task: "task",
    m.Mission: "mission",
}


@node
class Entity:
    """The thing that a name refers to.

    ``scope`` is where the name is valid.  It is empty for modules, edges and items; the module of a
    parameter, constant, degree of freedom, state, input or frame; the grammar of a nonterminal or
    production; the grammar and production of an alias or a local value; the grammar and nonterminal
    of an attribute; the workspace of a region or map.  ``span`` is the name where it is first
    declared, and ``statement`` is that declaration; attributes and port types have neither.
    """

    kind: Kind
    scope: tuple[str, ...]
    name: str
    span: Span = field(default=s.NOWHERE, compare=False, repr=False)
    statement: Span = field(default=s.NOWHERE, compare=False, repr=False)


def entity(kind: Kind, scope: tuple[str, ...], name: s.Ident, statement: Span) -> Entity:
    """The entity that a name declares."""
    return Entity(kind, scope, name.text, name.span, statement)


def members(module: s.Module) -> dict[str, Entity]:
    """The parameters, constants, degrees of freedom, states, inputs and frames of a module."""
    found: dict[str, Entity] = {}
    for item in module.items:
        if isinstance(item, s.Param | s.Const | s.Dof | s.State | s.Input | s.Frame):
            kind, scope = _MEMBER_KINDS[type(item)], (module.name.text,)
            found.setdefault(item.name.text, entity(kind, scope, item.name, item.span))
    return found


def productions(grammar: s.Grammar) -> dict[str, s.Production]:
    """The productions of a grammar, by label."""
    found: dict[str, s.Production] = {}
    for item in grammar.items:
        if isinstance(item, s.Production):
            found.setdefault(item.label.text, item)
    return found


def nonterminals(grammar: s.Grammar) -> dict[str, Entity]:
    """The left sides of the productions of a grammar, by name."""
    found: dict[str, Entity] = {}
    for item in grammar.items:
        if isinstance(item, s.Production) and item.left.text not in found:
            scope = (grammar.name.text,)
            found[item.left.text] = entity("nonterminal", scope, item.left, item.span)
    return found


def places(workspace: t.Workspace) -> dict[str, Entity]:
    """The regions and then the maps of a workspace, by name."""
    scope = (workspace.name.text,)
    found: dict[str, Entity] = {}
    maps: dict[str, Entity] = {}
    for item in workspace.items:
        if isinstance(item, t.Region) and item.name is not None and item.kind != "bounds":
            found.setdefault(item.name.text, entity(item.kind, scope, item.name, item.span))
        elif isinstance(item, t.ObstaclesFrom):
            name = map_name(item.path.text)
            maps.setdefault(name, Entity("map", scope, name, item.path.span, item.span))
    return found | {name: each for name, each in maps.items() if name not in found}


# --- occurrences -------------------------------------------------------------------------------


@node
class Occurrences:
    """The names of the occurrences in a word (section "Names" of the language reference).

    ``places`` maps each name to a position: X if X occurs once, X1 to Xn if it occurs n times, and
    the aliases given in the production.  ``repeated`` maps each repeated symbol to the names of its
    occurrences.  ``clashes`` are the occurrences whose name is already that of another symbol, each
    with that name.
    """

    places: Mapping[str, int]
    repeated: Mapping[str, tuple[str, ...]]
    clashes: tuple[tuple[s.Ident, str], ...]


def occurrences(
    word: Sequence[s.Occurrence], taken: Container[str], unnumbered: Container[str] = ()
) -> Occurrences:
    """The names of the occurrences in a word.

    Args:
        word: the symbols with their aliases.
        taken: the names of symbols, which no other occurrence may have.
        unnumbered: symbols whose occurrences are not distinguished by numbers.
    """
    positions: dict[str, list[int]] = {}
    for position, each in enumerate(word):
        positions.setdefault(each.symbol.text, []).append(position)
    found = {name: own[0] for name, own in positions.items() if len(own) == 1}
    repeated: dict[str, tuple[str, ...]] = {}
    clashes: list[tuple[s.Ident, str]] = []
    for name, own in positions.items():
        if len(own) == 1:
            continue
        numbered = {f"{name}{number}": word[at] for number, at in enumerate(own, 1)}
        repeated[name] = tuple(
            number if each.alias is None else each.alias.text for number, each in numbered.items()
        )
        if name not in unnumbered:
            found |= {n: at for n, at in zip(numbered, own, strict=True) if n not in taken}
            clashes += [
                (each.symbol, number)
                for number, each in numbered.items()
                if number in taken and each.alias is None
            ]
    for position, each in enumerate(word):
        alias = each.alias
        if alias is None:
            continue
        free = found.get(alias.text, position) == position and alias.text not in repeated
        if free and alias.text not in taken:
            found[alias.text] = position
        else:
            clashes.append((alias, alias.text))
    return Occurrences(found, repeated, tuple(clashes))


_NO_LETTER = re.compile(r"[^A-Za-z0-9_]")


def map_name(path: str) -> str:
    """The name of a file without its extension, as a NAME: ``maps/yard 2.yaml`` is ``yard_2``.

    Characters that a NAME cannot have become ``_``; a leading digit or a reserved word is preceded
    by ``_``.
    """
    stem = posixpath.splitext(posixpath.basename(path))[0]
    name = _NO_LETTER.sub("_", stem)
    return f"_{name}" if not name or name[0].isdigit() or name in RESERVED else name


# --------------------------------------------------------------------------------------------------
# The declarations of a specification, and errors about duplicate and unknown names.
#
# Modules, edges and nonterminals share one name space.


@dataclass
class Declarations:
    """The items of a specification by name; only the first of each name is kept."""

    terminals: dict[str, Entity] = field(default_factory=dict[str, Entity])
    modules: dict[str, s.Module] = field(default_factory=dict[str, s.Module])
    grammars: dict[str, s.Grammar] = field(default_factory=dict[str, s.Grammar])
    semantics: dict[str, s.Semantics] = field(default_factory=dict[str, s.Semantics])
    workspaces: dict[str, t.Workspace] = field(default_factory=dict[str, t.Workspace])
    tasks: dict[str, t.Task] = field(default_factory=dict[str, t.Task])
    missions: dict[str, m.Mission] = field(default_factory=dict[str, m.Mission])

    def is_first(self, item: t.Item) -> bool:
        """Whether the scope of an item's name is that item; True for items that have no scope."""
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
        """Modules, edges, nonterminals, regions, maps and items by name; the first of each name."""
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
        yield from map(named, self.missions.values())
        for found in self.places.values():
            yield from found.values()


def named(item: _Named) -> Entity:
    """The entity that an item declares."""
    return entity(_NAMED_KINDS[type(item)], (), item.name, item.span)


# --- Collection --------------------------------------------------------------------------------


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
        case s.Grammar() | t.Workspace() | t.Task() | m.Mission():
            _named(item, declared, sink)
        case t.Include():
            pass


def _named(item: _Named, declared: Declarations, sink: Sink) -> None:
    first: _Named
    match item:
        case s.Grammar():
            first = declared.grammars.setdefault(item.name.text, item)
        case t.Workspace():
            first = declared.workspaces.setdefault(item.name.text, item)
        case t.Task():
            first = declared.tasks.setdefault(item.name.text, item)
        case m.Mission():
            first = declared.missions.setdefault(item.name.text, item)
    if first is not item:
        duplicate(item.name, first.name.span, sink)


def declarations(file: t.File, sink: Sink) -> Declarations:
    """Collect the declarations of a file; report every name that is declared twice."""
    declared = Declarations()
    for item in file.items:
        _item(item, declared, sink)
    return declared


# --- Names of the wrong kind, or of nothing ----------------------------------------------------


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
    """Report a name that does not refer to what is expected: it is something else, or unknown.

    Args:
        name: the name.
        due: what is expected here, with its article: ``a grammar``.
        known: the names that would be right.
        declared: the declarations of the specification.
        sink: collects the error.
        message: the message for a name that refers to nothing.
    """
    what = due.split(" ", 1)[1]
    hint = did_you_mean(name.text, known, what, sink)
    if name.text.startswith("Std_") and hint.startswith(("known", "no ")):
        hint = 'names of the library begin so: `include std "serial.srg";`, for instance'
    other = declared.by_name.get(name.text)
    if other is not None:
        message = f"`{name.text}` is {_described(other)}, not {due}"
        notes = [(other.span, "declared here")]
        sink.error(Code.WRONG_KIND, message, name.span, hint, notes)
    else:
        unknown = message or f"unknown {what} `{name.text}`"
        sink.error(Code.UNKNOWN_NAME, unknown, name.span, hint)

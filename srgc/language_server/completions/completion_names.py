"""The names that may be written at a cursor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from lsprotocol import types as lsp

from grammar_lang import syntax as s
from grammar_lang.elaboration.modules import INPUT
from grammar_lang.names.clause_names import symbols_of
from grammar_lang.names.declarations import (
    REGIONS,
    Kind,
    members,
    nonterminals,
    occurrences,
    productions,
)
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from srgc.language_server.completions.call_forms import EMISSIONS, FUNCTIONS
from srgc.language_server.completions.cursor import Cursor, open_call
from srgc.language_server.documents.analysis import Analysis

# --- The names that may be written at a cursor ----------------------------------------------------


_KINDS = lsp.CompletionItemKind
_ROLES = ("base", "joint", "link", "effector")
_MEMBERS: dict[Kind, lsp.CompletionItemKind] = {
    "parameter": _KINDS.Property,
    "constant": _KINDS.Constant,
    "degree of freedom": _KINDS.Variable,
    "state": _KINDS.Variable,
    "input": _KINDS.Variable,
    "frame": _KINDS.Field,
}


@dataclass(frozen=True, slots=True)
class Offer:
    """A name that may be written; ``insert`` is the text to insert if it differs from the name."""

    label: str
    kind: lsp.CompletionItemKind
    detail: str
    insert: str | None = None


def _named(names: Iterable[str], kind: lsp.CompletionItemKind, detail: str) -> list[Offer]:
    return [Offer(name, kind, detail) for name in names]


def _has_input(module: s.Module) -> bool:
    return any(isinstance(item, s.Port) and item.name.text == INPUT for item in module.items)


class NamesDue:
    """The names that may be written at a cursor, depending on the text before it."""

    def __init__(self, analysis: Analysis, cursor: Cursor) -> None:
        self._analysis = analysis
        self._declared = analysis.declared
        self._cursor = cursor
        self._said = cursor.statement
        self._last = cursor.statement[-1] if cursor.statement else ""
        self._value = "NUMBER" in cursor.expected

    def offers(self) -> list[Offer]:
        """All names that may be written here."""
        kind = self._cursor.item[0]
        if "NAME" not in self._cursor.expected:
            return []
        match kind:
            case "module":
                return list(self._module())
            case "grammar":
                return list(self._grammar())
            case "semantics":
                return list(self._semantics())
            case "workspace":
                placed = self._said[:1] == ("obstacles",) and self._value
                return list(self._functions(("rot", "move"))) if placed else []
            case "task":
                return list(self._task())
            case "mission":
                return list(self._mission())
            case _:
                return []

    # --- Declared names ------------------------------------------------------------------------

    def _symbols(self) -> Iterator[Offer]:
        for name, found in self._declared.terminals.items():
            kind = _KINDS.Class if found.kind == "module" else _KINDS.EnumMember
            yield Offer(name, kind, found.kind)

    def _nonterminals(self) -> Iterator[Offer]:
        grammar = self._declared.grammars.get(self._cursor.item[1])
        if grammar is not None:
            yield from _named(nonterminals(grammar), _KINDS.Interface, "nonterminal")

    def _members(self, module: str, *, semantics: bool) -> Iterator[Offer]:
        found = self._declared.modules.get(module)
        for name, member in ({} if found is None else members(found)).items():
            if not semantics or member.kind not in {"state", "input"}:
                yield Offer(name, _MEMBERS[member.kind], member.kind)

    def _functions(self, names: Iterable[str]) -> Iterator[Offer]:
        for name in names:
            yield Offer(name, _KINDS.Function, FUNCTIONS[name].means, f"{name}($0)")
        yield Offer("pi", _KINDS.Constant, "3.14159…")

    # --- Item by item --------------------------------------------------------------------------

    def _module(self) -> Iterator[Offer]:
        name = self._cursor.item[1]
        if self._last == "role":
            yield from _named(_ROLES, _KINDS.EnumMember, "role")
        elif self._said[-2:] in {("der", "("), ("torque", "("), ("rate", "(")}:
            due = "state" if self._said[-2] == "der" else "degree of freedom"
            yield from (o for o in self._members(name, semantics=False) if o.detail == due)
        elif self._said[:1] == ("port",) and self._last == ":":
            yield from self._port_types()
        elif self._said == ("port",):
            yield Offer("in", _KINDS.Field, "where another module carries this one")
            yield from (o for o in self._members(name, semantics=False) if o.detail == "frame")
        elif (left := self._arguments_left()) is not None:
            yield from left
        elif self._value:
            own = self._said[:1] in {("der",), ("torque",)}
            yield from self._members(name, semantics=False)
            if own:
                yield Offer("u", _KINDS.Variable, "the free input")
            functions = ["sin", "cos", "tan", "sqrt", "abs"]
            if own:
                functions.append("rate")
            elif self._said[:1] == ("frame",) or open_call(self._said) is not None:
                yield Offer("in", _KINDS.Field, "where the module is mounted")
                functions += ["rot", "move"]
            yield from self._functions(functions)

    def _port_types(self) -> Iterator[Offer]:
        found = self._analysis.names.entities("port type")
        yield from _named([each.name for each in found], _KINDS.Interface, "type of ports")

    def _arguments_left(self) -> list[Offer] | None:
        """The remaining arguments of an emission, if one may begin here; else None."""
        call = open_call(self._said)
        if call is None or call.name not in EMISSIONS or self._last not in {"(", ","}:
            return None
        return [
            Offer(name, _KINDS.Property, means, f"{name}: $0")
            for name, means in EMISSIONS[call.name].parameters
            if name not in call.named
        ]

    def _grammar(self) -> Iterator[Offer]:
        if self._said[:1] == ("accept",):
            if not self._value:
                yield from self._symbols()
        elif self._said == ("start",):
            if "ports" in self._cursor.before[:4]:
                yield from _named(self._declared.modules, _KINDS.Class, "module")
            yield from self._nonterminals()
        elif self._said[:1] == ("with",):
            fitting = (
                name
                for name, module in self._declared.modules.items()
                if name not in self._said and _has_input(module)
            )
            yield from _named(fitting, _KINDS.Class, "module")
        elif "->" in self._said:
            yield from self._nonterminals()
            if self._last != ":" or self._said.count(":") > 1:
                yield from self._symbols()
        elif len(self._said) == 2 and self._last == ":":
            yield from self._nonterminals()

    def _semantics(self) -> Iterator[Offer]:
        declared = self._declared
        if self._cursor.before == ("semantics",):
            free = [
                name
                for name, grammar in declared.grammars.items()
                if name not in declared.semantics and not grammar.from_ports
            ]
            yield from _named(free, _KINDS.Module, "grammar")
            return
        grammar = declared.grammars.get(self._cursor.item[1])
        if grammar is None:
            return
        labelled = productions(grammar)
        if not self._cursor.block:
            blocks = declared.semantics.get(grammar.name.text)
            done = set() if blocks is None else {block.label.text for block in blocks.blocks}
            for label in labelled:
                if label not in done:
                    yield Offer(label, _KINDS.Function, "production", f"{label} {{ $0 }}")
        elif self._cursor.block in labelled:
            yield from self._in_block(grammar, labelled[self._cursor.block])

    def _in_block(self, grammar: s.Grammar, production: s.Production) -> Iterator[Offer]:
        own = nonterminals(grammar)
        places = occurrences(production.right, {*self._declared.terminals, *own}).places
        left = self._arguments_left()
        if self._last == ".":
            owner = self._said[-2] if len(self._said) > 1 else ""
            symbol = production.left.text
            if owner in places:
                symbol = production.right[places[owner]].symbol.text
            yield from self._members(symbol, semantics=True)
            module = self._declared.modules.get(symbol)
            if module is not None and s.owns_body(module):
                yield Offer("in", _KINDS.Field, "where the module is mounted")
            yield from self._attributes(grammar.name.text, symbol)
        elif left is not None:
            yield from left
        else:
            aliases = {each.alias.text for each in production.right if each.alias is not None}
            for name, place in sorted(places.items(), key=lambda at: (at[0] in aliases, at[1])):
                symbol = production.right[place].symbol.text
                if symbol in own or symbol in self._declared.modules:
                    yield Offer(name, _KINDS.Variable, f"this occurrence of {symbol}")
            if self._value:
                scope = (grammar.name.text, production.label.text)
                local = self._analysis.names.entities("local value", scope=scope)
                yield from _named([each.name for each in local], _KINDS.Field, "local value")
                yield from self._functions(n for n in FUNCTIONS if n != "rate")

    def _attributes(self, grammar: str, nonterminal: str) -> Iterator[Offer]:
        found = self._analysis.names.entities("attribute", scope=(grammar, nonterminal))
        yield from _named([each.name for each in found], _KINDS.Field, "attribute")

    # --- Tasks ---------------------------------------------------------------------------------

    def _task(self) -> Iterator[Offer]:
        head, declared = self._said[:1], self._declared
        if self._said == ("robot",):
            yield from _named(declared.grammars, _KINDS.Module, "grammar")
        elif self._said == ("workspace",):
            yield from _named(declared.workspaces, _KINDS.Module, "workspace")
        elif head == ("from",):
            yield from self._origin()
        elif head == ("carry",) and self._last in {"from", "to"}:
            yield from self._regions(maps=False)
        elif head == ("minimize",) and not self._value:
            yield from self._objectives(self._chosen("robot", t.Robot))
        elif head == ("avoid",) and "except" in self._said:
            yield from _named(declared.modules, _KINDS.Class, "module")
        elif head in {("start",), ("reach",), ("avoid",), ("satisfy",)} and not self._value:
            yield from self._regions(maps=head in {("avoid",), ("satisfy",)})
            if self._said == ("avoid",):
                yield Offer("self", _KINDS.Keyword, "the robot's own bodies")
        elif self._value:
            yield Offer("pi", _KINDS.Constant, "3.14159…")

    def _objectives(self, robots: str) -> Iterator[Offer]:
        """The possible objectives or, inside ``sum(…)``, the attributes of a grammar's modules."""
        if self._last != "(":
            yield from OBJECTIVES
        elif self._said[-2:] == ("sum", "("):
            grammar = self._declared.grammars.get(robots)
            symbols = {} if grammar is None else dict.fromkeys(symbols_of(grammar))
            for offer in (o for name in symbols for o in self._members(name, semantics=True)):
                if offer.detail in {"constant", "parameter"}:
                    yield offer

    def _chosen(self, word: str, kind: type[t.Robot | t.TaskWorkspace]) -> str:
        """The robot or the workspace of the task; empty if none is chosen."""
        named = next((name for each, name in pairwise(self._cursor.before) if each == word), "")
        task = self._declared.tasks.get(self._cursor.item[1])
        if not named and task is not None:
            named = next((item.name.text for item in task.items if isinstance(item, kind)), "")
        return named

    def _regions(self, *, maps: bool) -> Iterator[Offer]:
        named = self._chosen("workspace", t.TaskWorkspace)
        for name, place in self._declared.places.get(named, {}).items():
            kind = "region" if place.kind in REGIONS else "map"
            if maps or kind == "region":
                yield Offer(name, _KINDS.Field, f"{kind} of {named}")

    def _origin(self) -> Iterator[Offer]:
        if "fixed" not in self._said:
            yield from self._symbols()
            return
        word = self._said[1 : self._said.index("fixed")]
        symbols = [s.Occurrence(None, s.Ident(name)) for name in word]
        places = occurrences(symbols, self._declared.terminals).places
        if self._last == ".":
            place = places.get(self._said[-2])
            if place is not None:
                found = self._members(word[place], semantics=True)
                yield from (offer for offer in found if offer.detail == "parameter")
        elif self._last in {"fixed", ","}:
            for name, place in sorted(places.items(), key=lambda at: at[1]):
                if word[place] in self._declared.modules:
                    yield Offer(name, _KINDS.Variable, f"this occurrence of {word[place]}")

    # --- Missions ------------------------------------------------------------------------------

    def _mission(self) -> Iterator[Offer]:
        head = self._said[:1]
        if head == ("tasks",):
            left = (name for name in self._declared.tasks if name not in self._said)
            yield from _named(left, _KINDS.Event, "task")
        elif head == ("free",):
            yield from self._free()
        elif head == ("minimize",) and not self._value:
            if self._last != "(" and "one" not in self._cursor.before:
                yield CHANGES
            yield from self._objectives(self._robots())
        elif self._value:
            yield Offer("pi", _KINDS.Constant, "3.14159…")

    def _free(self) -> Iterator[Offer]:
        """The modules of the grammar that have parameters or, after a dot, these parameters."""
        if self._last == ".":
            found = self._members(self._said[-2], semantics=True)
            yield from (offer for offer in found if offer.detail == "parameter")
            return
        grammar = self._declared.grammars.get(self._robots())
        symbols = self._declared.modules if grammar is None else dict.fromkeys(symbols_of(grammar))
        for name in symbols:
            if any(each.detail == "parameter" for each in self._members(name, semantics=True)):
                yield Offer(name, _KINDS.Class, "module")

    def _robots(self) -> str:
        """The grammar of the mission's tasks; empty if it is not known."""
        mission = self._declared.missions.get(self._cursor.item[1])
        items = () if mission is None else mission.items
        listed = (name.text for i in items if isinstance(i, m.MissionTasks) for name in i.names)
        for name in (*self._cursor.before, *listed):
            task = self._declared.tasks.get(name)
            for item in () if task is None else task.items:
                if isinstance(item, t.Robot):
                    return item.name.text
        return ""


OBJECTIVES = (
    Offer("modules", _KINDS.EnumMember, "the number of modules"),
    Offer("mass", _KINDS.EnumMember, "the mass of all bodies, without loads"),
    Offer("time", _KINDS.EnumMember, "how long the motion takes"),
    Offer("energy", _KINDS.EnumMember, "what the drives turn over"),
    Offer("effort", _KINDS.EnumMember, "the largest share of its bound that an input uses"),
    Offer("sum", _KINDS.Function, "the sum of an attribute over the modules", "sum($0)"),
)
CHANGES = Offer("changes", _KINDS.EnumMember, "what the changes between the tasks cost")

"""Name resolution: one walk over the syntax finds the entity that each name refers to.

Errors are ignored here: a name that refers to nothing is left out, and every other name is
recorded.  Later checks report entities of the wrong kind.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.names.clause_names import (
    condition_symbols,
    named_modules,
    region_names,
    summed_attributes,
    symbols_of,
)
from grammar_lang.names.declarations import (
    Declarations,
    Entity,
    Occurrences,
    declarations,
    entity,
    map_name,
    members,
    named,
    nonterminals,
    occurrences,
    productions,
)
from grammar_lang.names.table import Mention, NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from grammar_lang.syntax.expressions import readings


def _bare(name: s.Ident) -> Span:
    """The span of a name without its quotes."""
    span = name.span
    quotes = span.end - span.start - len(name.text)
    return Span(span.start + 1, span.end - 1, span.file) if quotes == 2 else span


@dataclass(slots=True)
class _GrammarNames:
    """The names of a grammar; ``symbols`` are its terminals and nonterminals."""

    grammar: s.Grammar
    symbols: Mapping[str, Entity]
    productions: Mapping[str, s.Production]

    def production(self, label: s.Ident) -> Entity:
        """The entity of the production with this label, which must exist."""
        first = self.productions[label.text]
        return entity("production", (self.grammar.name.text,), first.label, first.span)


@dataclass(slots=True)
class _Resolver:
    declared: Declarations
    found: list[Mention] = field(default_factory=list[Mention])
    words: dict[Span, Occurrences] = field(default_factory=dict[Span, Occurrences])
    within: Entity | None = None
    _members: dict[str, Mapping[str, Entity]] = field(
        default_factory=dict[str, Mapping[str, Entity]]
    )
    _grammars: dict[str, _GrammarNames] = field(default_factory=dict[str, _GrammarNames])

    # --- Recording mentions --------------------------------------------------------------------

    def add(
        self,
        meant: Entity | None,
        name: s.Ident,
        *,
        declares: bool = False,
        position: int | None = None,
    ) -> None:
        """Record that a name refers to an entity, unless that is None."""
        if meant is not None:
            span = _bare(name)
            self.found.append(Mention(meant, span, name.span, declares, self.within, position))

    def numbered(self, meant: Entity | None, name: s.Ident, position: int) -> None:
        """Record the name of a symbol, which may be followed by a number."""
        if meant is not None:
            span = Span(name.span.start, name.span.start + len(meant.name), name.span.file)
            here = self.within
            mention = Mention(meant, span, name.span, within=here, position=position)
            self.found.append(mention)

    def members(self, module: str) -> Mapping[str, Entity]:
        """The members that the module of that name declares; empty if there is no such module."""
        if module not in self.declared.modules:
            return {}
        if module not in self._members:
            self._members[module] = members(self.declared.modules[module])
        return self._members[module]

    def names_of(self, grammar: s.Grammar) -> _GrammarNames:
        """The names of a grammar."""
        name = grammar.name.text
        if name not in self._grammars:
            symbols = nonterminals(grammar) | self.declared.terminals
            self._grammars[name] = _GrammarNames(grammar, symbols, productions(grammar))
        return self._grammars[name]

    # --- items ---------------------------------------------------------------------------------

    def item(self, item: t.Item) -> None:
        """Resolve the names of an item; a second item of the same name is not entered."""
        self.within = None
        match item:
            case s.Module(name=name):
                self.add(self.declared.terminals.get(name.text), name, declares=True)
            case s.Edges(names=names):
                for name in names:
                    self.add(self.declared.terminals.get(name.text), name, declares=True)
            case s.Grammar() | t.Workspace() | t.Task() | m.Mission():
                self.add(named(item), item.name, declares=True)
            case s.Semantics() | t.Include():
                pass
        if self.declared.is_first(item):
            self._inside(item)

    def _inside(self, item: t.Item) -> None:
        match item:
            case s.Module():
                self._module(item)
            case s.Grammar():
                self._grammar(item)
            case s.Semantics():
                self._semantics(item)
            case t.Workspace():
                self._workspace(item)
            case t.Task():
                self.within = named(item)
                self._task(item)
            case m.Mission():
                self.within = named(item)
                self._mission(item)
            case s.Edges() | t.Include():
                pass

    def _module(self, module: s.Module) -> None:
        known = self.members(module.name.text)
        for item in module.items:
            self.within = self.declared.terminals.get(module.name.text)
            match item:
                case s.Role() | s.Named() | s.Emission():
                    pass
                case s.Port():
                    self.add(known.get(item.name.text), item.name)
                    kind = Entity("port type", (), item.type.text)
                    self.add(kind, item.type, declares=True)
                case _:
                    self.within = known.get(item.name.text)
                    declares = not isinstance(item, s.Derivative | s.Torque | s.Drive)
                    self.add(self.within, item.name, declares=declares)
            for name in readings(s.module_expressions(item)):
                if isinstance(name, s.Name):
                    self.add(known.get(name.ident.text), name.ident)

    def _workspace(self, workspace: t.Workspace) -> None:
        scope = (workspace.name.text,)
        known = self.declared.places[workspace.name.text]
        for item in workspace.items:
            if isinstance(item, t.Region) and item.name is not None:
                self.add(known[item.name.text], item.name, declares=True)
            elif isinstance(item, t.ObstaclesFrom):
                map_ = Entity("map", scope, map_name(item.path.text), item.path.span, item.span)
                self.add(map_, item.path, declares=True)

    # --- grammars ------------------------------------------------------------------------------

    def _grammar(self, grammar: s.Grammar) -> None:
        names = self.names_of(grammar)
        symbols = names.symbols
        edges = {name for name, each in self.declared.terminals.items() if each.kind == "edge"}
        for item in grammar.items:
            match item:
                case s.StartSymbol(name=name):
                    self.add(symbols.get(name.text), name)
                case s.Listed(names=modules):
                    for name in modules:
                        self.add(symbols.get(name.text), name)
                case s.Production():
                    self.within = names.production(item.label)
                    self._production(item, symbols)
                    self.words[item.span] = occurrences(item.right, symbols, edges)
                case s.Accept(condition=condition):
                    for name in condition_symbols(condition):
                        self.add(symbols.get(name.text), name)
            self.within = None

    def _production(self, item: s.Production, symbols: Mapping[str, Entity]) -> None:
        self.add(self.within, item.label, declares=True)
        left = symbols.get(item.left.text)
        is_nonterminal = left is not None and left.kind == "nonterminal"
        self.add(left, item.left, declares=is_nonterminal)
        for each in item.right:
            if each.alias is not None:
                self.add(_alias(self.within, each), each.alias, declares=True)
            self.add(symbols.get(each.symbol.text), each.symbol)

    # --- semantics -----------------------------------------------------------------------------

    def _semantics(self, semantics: s.Semantics) -> None:
        grammar = self.declared.grammars.get(semantics.grammar.text)
        if grammar is None:
            return
        self.add(named(grammar), semantics.grammar)
        names = self.names_of(grammar)
        for block in semantics.blocks:
            production = names.productions.get(block.label.text)
            if production is not None:
                self.within = names.production(block.label)
                self.add(self.within, block.label)
                self._block(block, production, names.symbols)
        self.within = None

    def _block(
        self, block: s.Block, production: s.Production, symbols: Mapping[str, Entity]
    ) -> None:
        local = local_values(self.within, block)
        for statement in block.statements:
            values: Iterable[s.Expr] = s.statement_expressions(statement)
            match statement:
                case s.Rule(target=target):
                    self._member(target, production, symbols, declares=True)
                case s.Let(name=declared):
                    self.add(local.get(declared.text), declared, declares=True)
                case s.Emission():
                    pass
            for name in readings(values):
                if isinstance(name, s.Member):
                    self._member(name, production, symbols)
                else:
                    self.add(local.get(name.ident.text), name.ident)

    def _member(
        self,
        member: s.Member,
        production: s.Production,
        symbols: Mapping[str, Entity],
        *,
        declares: bool = False,
    ) -> None:
        """Resolve ``owner.name``: a member of a module, or an attribute of a nonterminal."""
        symbol, position = production.left, ir.THIS
        if member.owner.text != "this":
            found = _position(member.owner.text, production, self.words[production.span])
            if found is None:
                return
            position = found
            each = production.right[position]
            symbol = each.symbol
            if each.alias is not None and each.alias.text == member.owner.text:
                self.add(_alias(self.within, each), member.owner, position=position)
            else:
                self.numbered(symbols.get(symbol.text), member.owner, position)
        meant = symbols.get(symbol.text)
        if meant is not None and meant.kind == "nonterminal":
            attribute = Entity("attribute", (*meant.scope, meant.name), member.name.text)
            self.add(attribute, member.name, declares=declares, position=position)
        else:
            known = self.members(symbol.text)
            self.add(known.get(member.name.text), member.name, position=position)

    # --- tasks ---------------------------------------------------------------------------------

    def _task(self, task: t.Task) -> None:
        declared = self.declared
        at = next((i.name.text for i in task.items if isinstance(i, t.TaskWorkspace)), "")
        known = declared.places.get(at, {})
        for item in task.items:
            match item:
                case t.Robot(name=name) if name.text in declared.grammars:
                    self.add(named(declared.grammars[name.text]), name)
                case t.TaskWorkspace(name=name) if name.text in declared.workspaces:
                    self.add(named(declared.workspaces[name.text]), name)
                case t.From():
                    self._origin(item)
                case m.Minimize():
                    self._sums(task, item)
                case _:
                    for name in region_names(item):
                        self.add(known.get(name.text), name)
            for module in named_modules(item):
                if module.text in declared.modules:
                    self.add(declared.terminals.get(module.text), module)

    def _mission(self, mission: m.Mission) -> None:
        declared, known = self.declared, list[t.Task]()
        for item in mission.items:
            for name in item.names if isinstance(item, m.MissionTasks) else ():
                if name.text in declared.tasks:
                    known.append(declared.tasks[name.text])
                    self.add(named(known[-1]), name)
        for item in mission.items:
            if isinstance(item, m.Free):
                for freed in item.parameters:
                    self._parameter(freed.module, freed.name)
            elif isinstance(item, m.Minimize) and known:
                self._sums(known[0], item)

    def _parameter(self, module: s.Ident, name: s.Ident) -> None:
        """Resolve ``MODULE.parameter`` in a ``free``, outside of any word."""
        if module.text in self.declared.modules:
            self.add(self.declared.terminals.get(module.text), module)
            self.add(self.members(module.text).get(name.text), name, position=0)

    def _sums(self, task: t.Task, item: m.Minimize) -> None:
        """Resolve summed attributes: each name refers to a member of every module that has it."""
        robots = (each.name.text for each in task.items if isinstance(each, t.Robot))
        grammar = self.declared.grammars.get(next(robots, ""))
        if grammar is not None:
            symbols = {*symbols_of(grammar)}
            modules = [module for module in self.declared.modules if module in symbols]
            for name in summed_attributes(item):
                for module in modules:
                    member = self.members(module).get(name.text)
                    if member is not None and member.kind in {"constant", "parameter"}:
                        self.add(member, name)

    def _origin(self, item: t.From) -> None:
        terminals = self.declared.terminals
        for symbol in item.word:
            self.add(terminals.get(symbol.text), symbol)
        word = occurrences([s.Occurrence(None, symbol) for symbol in item.word], terminals)
        self.words[item.span] = word
        for fixing in item.fixed:
            position = word.places.get(fixing.occurrence.text)
            if position is not None:
                name = item.word[position].text
                self.numbered(terminals.get(name), fixing.occurrence, position)
                self.add(self.members(name).get(fixing.name.text), fixing.name, position=position)


def _position(owner: str, production: s.Production, word: Occurrences) -> int | None:
    """The position of the occurrence that an owner names.

    An alias that is also the name of another symbol is an error, but renaming must still find its
    uses.
    """
    if any(own == owner for _, own in word.clashes):
        for position, each in enumerate(production.right):
            if each.alias is not None and each.alias.text == owner:
                return position
    return word.places.get(owner)


def local_values(production: Entity | None, block: s.Block) -> dict[str, Entity]:
    """The local values in the block of a production; the first of each name."""
    found: dict[str, Entity] = {}
    for item in block.statements if production is not None else ():
        if isinstance(item, s.Let) and production is not None:
            scope = (*production.scope, production.name)
            found.setdefault(item.name.text, entity("local value", scope, item.name, item.span))
    return found


def _alias(production: Entity | None, occurrence: s.Occurrence) -> Entity | None:
    """The entity of an occurrence with an alias."""
    if production is None or occurrence.alias is None:
        return None
    alias = occurrence.alias
    statement = alias.span.to(occurrence.symbol.span)
    return entity("occurrence", (*production.scope, production.name), alias, statement)


def resolve_names(file: t.File, sink: Sink) -> NameTable:
    """Resolve the names of a specification.

    Args:
        file: the items of the main file and of all its includes.
        sink: collects the errors about names that are declared twice.
    """
    resolver = _Resolver(declarations(file, sink))
    # A semantics may stand before its grammar, so semantics come last.
    for item in sorted(file.items, key=lambda each: isinstance(each, s.Semantics)):
        resolver.item(item)
    return NameTable(resolver.found, resolver.declared, resolver.words)

"""Every name of a file and its includes, resolved from the syntax alone.

Errors do not matter here: what cannot be resolved has no mark, and everything else has.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from grammar_lang import syntax as s
from grammar_lang import syntax_formulas as f
from grammar_lang import syntax_tasks as t
from grammar_lang.files.map_names import map_name
from grammar_lang.readings import bounds, readings
from grammar_lang.source import Span
from srgc.language_server.names.declared import (
    Declared,
    module_names,
    nonterminals_of,
    positions_in,
    productions_of,
    workspace_of,
)
from srgc.language_server.names.names import Key, Kind, Mark, NameIndex
from srgc.language_server.names.occurrence_names import named_positions


def _bare(name: s.Ident) -> Span:
    """The place of a name, without the quotes that may be about it."""
    span = name.span
    quotes = span.end - span.start - len(name.text)
    return Span(span.start + 1, span.end - 1, span.file) if quotes == 2 else span


@dataclass(slots=True)
class _Marks:
    declared: Declared
    found: list[Mark] = field(default_factory=list[Mark])

    def add(
        self, kind: Kind, scope: tuple[str, ...], name: s.Ident, *, defines: bool = False
    ) -> None:
        self.found.append(Mark(Key(kind, scope, name.text), _bare(name), name.span, defines))

    def numbered(self, key: Key, name: s.Ident) -> None:
        """A name that is a symbol's, perhaps with a number behind it."""
        span = Span(name.span.start, name.span.start + len(key.name), name.span.file)
        self.found.append(Mark(key, span, name.span))

    def terminal(self, name: s.Ident, *, defines: bool = False) -> None:
        if name.text in self.declared.terminals:
            self.add("terminal", (), name, defines=defines)

    def item(self, item: t.Item) -> None:
        """The names of an item; inside a second one of its name nothing is resolved."""
        match item:
            case s.Module(name=name):
                self.terminal(name, defines=True)
            case s.Edges(names=names):
                for name in names:
                    self.terminal(name, defines=True)
            case s.Grammar(name=name):
                self.add("grammar", (), name, defines=True)
            case t.Workspace(name=name):
                self.add("workspace", (), name, defines=True)
            case t.Task(name=name):
                self.add("task", (), name, defines=True)
            case s.Semantics() | t.Include():
                pass
        if self.declared.is_first(item):
            self._inside(item)

    def _inside(self, item: t.Item) -> None:
        match item:
            case s.Module():
                self._module(item)
            case s.Grammar():
                _Grammar(self, item).read()
            case s.Semantics():
                self._semantics(item)
            case t.Workspace():
                self._workspace(item)
            case t.Task():
                _Task(self, item).read()
            case s.Edges() | t.Include():
                pass

    # --- modules -------------------------------------------------------------------------------

    def _module(self, module: s.Module) -> None:
        known, scope = module_names(module), (module.name.text,)
        for item in module.items:
            if isinstance(item, s.Param | s.Const | s.Dof | s.State | s.Input):
                self.add("member", scope, item.name, defines=True)
            elif isinstance(item, s.Derivative | s.Torque) and item.name.text in known:
                self.add("member", scope, item.name)
            for name in readings(_expressions(item)):
                if isinstance(name, s.Name) and name.ident.text in known:
                    self.add("member", scope, name.ident)

    # --- semantics -----------------------------------------------------------------------------

    def _semantics(self, semantics: s.Semantics) -> None:
        grammar = self.declared.grammars.get(semantics.grammar.text)
        if grammar is None:
            return
        self.add("grammar", (), semantics.grammar)
        productions, nonterminals = productions_of(grammar), nonterminals_of(grammar)
        taken = {*self.declared.terminals, *nonterminals}
        for block in semantics.blocks:
            production = productions.get(block.label.text)
            if production is not None:
                self.add("label", (grammar.name.text,), block.label)
                places = positions_in(production, taken)
                _Block(self, grammar.name.text, production, nonterminals, places).read(block)

    # --- workspaces ----------------------------------------------------------------------------

    def _workspace(self, workspace: t.Workspace) -> None:
        scope = (workspace.name.text,)
        for item in workspace.items:
            if isinstance(item, t.Region) and item.name is not None:
                self.add("region", scope, item.name, defines=True)
            elif isinstance(item, t.ObstaclesFrom):
                key, span = Key("map", scope, map_name(item.path.text)), item.path.span
                self.found.append(Mark(key, _bare(item.path), span, defines=True))


def _expressions(item: s.ModuleItem) -> tuple[s.Expr, ...]:
    """The expressions of a statement of a module."""
    match item:
        case s.Param(domain=domain) | s.Input(domain=domain):
            return bounds(domain)
        case s.Const(value=value) | s.Derivative(value=value) | s.Torque(value=value):
            return (value,)
        case s.Dof(range=ranged, rate=rate):
            return (*bounds(ranged), *bounds(rate))
        case s.State(initial=initial):
            return () if initial is None else (initial,)
        case s.Role():
            return ()


@dataclass(slots=True)
class _Grammar:
    marks: _Marks
    grammar: s.Grammar
    scope: tuple[str, ...] = ()
    nonterminals: Collection[str] = ()

    def read(self) -> None:
        self.scope = (self.grammar.name.text,)
        self.nonterminals = nonterminals_of(self.grammar)
        for item in self.grammar.items:
            match item:
                case s.StartSymbol(name=name):
                    self._symbol(name)
                case s.Production():
                    self._production(item)
                case s.Accept(condition=condition):
                    for name in condition_symbols(condition):
                        self.marks.terminal(name)

    def _production(self, item: s.Production) -> None:
        self.marks.add("label", self.scope, item.label, defines=True)
        self._symbol(item.left, defines=True)
        for occurrence in item.right:
            if occurrence.alias is not None:
                scope = (*self.scope, item.label.text)
                self.marks.add("occurrence", scope, occurrence.alias, defines=True)
            self._symbol(occurrence.symbol)

    def _symbol(self, name: s.Ident, *, defines: bool = False) -> None:
        if name.text in self.marks.declared.terminals:
            self.marks.terminal(name)
        elif name.text in self.nonterminals:
            self.marks.add("nonterminal", self.scope, name, defines=defines)


def condition_symbols(condition: s.Condition) -> Iterator[s.Ident]:
    """The symbols that an accept condition names."""
    match condition:
        case s.Factor(word=word):
            yield from word
        case s.Count(symbol=symbol):
            if symbol is not None:
                yield symbol
        case s.Matches(regex=regex):
            yield from _regex_symbols(regex)
        case s.Not(part=part):
            yield from condition_symbols(part)
        case s.And(parts=parts) | s.Or(parts=parts):
            for each in parts:
                yield from condition_symbols(each)


def _regex_symbols(regex: s.Regex) -> Iterator[s.Ident]:
    match regex:
        case s.RegexSymbol(symbol=symbol):
            yield symbol
        case s.RegexSequence(parts=parts) | s.RegexChoice(parts=parts):
            for each in parts:
                yield from _regex_symbols(each)
        case s.RegexRepeat(part=part):
            yield from _regex_symbols(part)
        case s.RegexEmpty():
            pass


@dataclass(slots=True)
class _Block:
    """The names of the block of a production; ``places`` are its occurrences."""

    marks: _Marks
    grammar: str
    production: s.Production
    nonterminals: Collection[str]
    places: Mapping[str, int]

    def read(self, block: s.Block) -> None:
        for statement in block.statements:
            if isinstance(statement, s.Rule):
                self._member(statement.target, defines=True)
                values: Iterable[s.Expr] = (statement.value,)
            else:
                values = [argument.value for argument in statement.arguments]
            for name in readings(values):
                if isinstance(name, s.Member):
                    self._member(name)

    def _member(self, member: s.Member, *, defines: bool = False) -> None:
        if member.owner.text == "this":
            self._of(self.production.left, member.name, defines=defines)
            return
        place = self.places.get(member.owner.text)
        if place is None:
            return
        symbol = self.production.right[place].symbol
        self._owner(member.owner, symbol)
        self._of(symbol, member.name, defines=defines)

    def _owner(self, owner: s.Ident, symbol: s.Ident) -> None:
        aliases = (each.alias for each in self.production.right)
        if any(alias is not None and alias.text == owner.text for alias in aliases):
            scope = (self.grammar, self.production.label.text)
            self.marks.add("occurrence", scope, owner)
        elif symbol.text in self.marks.declared.terminals:
            self.marks.numbered(Key("terminal", (), symbol.text), owner)
        elif symbol.text in self.nonterminals:
            self.marks.numbered(Key("nonterminal", (self.grammar,), symbol.text), owner)

    def _of(self, symbol: s.Ident, name: s.Ident, *, defines: bool) -> None:
        """What stands behind the dot: of a module, or of a nonterminal."""
        module = self.marks.declared.modules.get(symbol.text)
        if module is not None:
            if name.text in module_names(module):
                self.marks.add("member", (symbol.text,), name)
        elif symbol.text in self.nonterminals:
            scope = (self.grammar, symbol.text)
            self.marks.add("attribute", scope, name, defines=defines)


class _Task:
    """The names of a task."""

    def __init__(self, marks: _Marks, task: t.Task) -> None:
        self._marks = marks
        self._task = task
        self._workspace = workspace_of(task) or ""
        workspace = marks.declared.workspaces.get(self._workspace)
        items = () if workspace is None else workspace.items
        regions = [item.name for item in items if isinstance(item, t.Region)]
        self._regions = {name.text for name in regions if name is not None}
        self._maps = {map_name(i.path.text) for i in items if isinstance(i, t.ObstaclesFrom)}

    def read(self) -> None:
        for item in self._task.items:
            match item:
                case t.Robot(name=name):
                    if name.text in self._marks.declared.grammars:
                        self._marks.add("grammar", (), name)
                case t.TaskWorkspace(name=name):
                    if name.text in self._marks.declared.workspaces:
                        self._marks.add("workspace", (), name)
                case t.From():
                    self._origin(item)
                case _:
                    for name in _region_names(item):
                        self._region(name)

    def _region(self, name: s.Ident) -> None:
        if name.text in self._regions:
            self._marks.add("region", (self._workspace,), name)
        elif name.text in self._maps:
            self._marks.add("map", (self._workspace,), name)

    def _origin(self, item: t.From) -> None:
        for symbol in item.word:
            self._marks.terminal(symbol)
        declared = self._marks.declared
        places = named_positions(item.word, [None] * len(item.word), declared.terminals)
        for fixing in item.fixed:
            place = places.get(fixing.occurrence.text)
            if place is None:
                continue
            name = item.word[place].text
            if name in declared.terminals:
                self._marks.numbered(Key("terminal", (), name), fixing.occurrence)
            module = declared.modules.get(name)
            if module is not None and fixing.name.text in module_names(module):
                self._marks.add("member", (name,), fixing.name)


def _region_names(item: t.TaskItem) -> Iterator[s.Ident]:
    match item:
        case t.StartIn(region=region) | t.Reach(region=region):
            yield region
        case t.Avoid(regions=regions):
            yield from regions
        case t.Satisfy(formula=formula):
            yield from _atoms(formula)
        case _:
            pass


def _atoms(formula: f.Formula) -> Iterator[s.Ident]:
    match formula:
        case f.Atom(region=region):
            yield region
        case f.Unary(operand=operand) | f.Last(operand=operand):
            yield from _atoms(operand)
        case f.Joined(operands=operands):
            for operand in operands:
                yield from _atoms(operand)
        case f.Binary(left=left, right=right):
            yield from _atoms(left)
            yield from _atoms(right)


def name_index(file: t.File, declared: Declared) -> NameIndex:
    """The index of all names of a program."""
    marks = _Marks(declared)
    for item in file.items:
        marks.item(item)
    return NameIndex(marks.found)

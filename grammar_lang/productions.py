"""Grammars (Definition 3): symbols resolved, occurrences named."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.acceptance import Conditions
from grammar_lang.findings.codes import Code
from grammar_lang.findings.diagnostics import Sink
from grammar_lang.findings.spelling import did_you_mean
from grammar_lang.modules import duplicate
from grammar_lang.resolve import Declarations
from grammar_lang.source import Span


@dataclass(frozen=True, slots=True)
class ProductionInfo:
    """A production and the names of its occurrences.

    ``names`` maps a name to a position on the right side, ``repeated`` a symbol that occurs
    several times to the names that tell its occurrences apart.  ``broken`` productions hold an
    unknown symbol, which was reported.
    """

    production: ir.Production
    names: Mapping[str, int]
    repeated: Mapping[str, tuple[str, ...]]
    broken: bool
    label: Span


@dataclass(frozen=True, slots=True)
class GrammarInfo:
    """A grammar without its semantics, and its productions by label."""

    grammar: ir.Grammar
    productions: Mapping[str, ProductionInfo]


@dataclass(slots=True)
class _Reader:
    declared: Declarations
    sink: Sink
    nonterminals: dict[str, Span]
    lefts: frozenset[str]
    starts: list[s.StartSymbol] = field(default_factory=list[s.StartSymbol])
    productions: dict[str, ProductionInfo] = field(default_factory=dict[str, ProductionInfo])
    accepts: list[ir.Accept] = field(default_factory=list[ir.Accept])

    def kind(self, name: str) -> ir.SymbolKind | None:
        if name in self.declared.modules:
            return "module"
        if name in self.declared.terminals:
            return "edge"
        return "nonterminal" if name in self.nonterminals else None

    def clash(self, name: str) -> bool:
        """Whether a module or edge stands on a left side, which was reported."""
        return name in self.lefts and name in self.declared.terminals

    def item(self, item: s.GrammarItem) -> None:
        match item:
            case s.StartSymbol():
                self._start(item)
            case s.Production(label=label):
                info = self._production(item)
                if label.text in self.productions:
                    duplicate(label, self.productions[label.text].label, self.sink)
                else:
                    self.productions[label.text] = info
            case s.Accept(condition=condition):
                self.accepts.append(Conditions(self._terminal, self.sink).lower(condition))

    def _start(self, item: s.StartSymbol) -> None:
        if self.starts:
            notes = [(self.starts[0].span, "first here")]
            hint = "a grammar has one start symbol"
            self.sink.error(Code.REPEATED_CLAUSE, "a second start symbol", item.span, hint, notes)
        elif item.name.text not in self.nonterminals and not self.clash(item.name.text):
            message = f"the start symbol `{item.name.text}` has no production"
            hint = did_you_mean(item.name.text, self.nonterminals, "nonterminal", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, item.name.span, hint)
        self.starts.append(item)

    def _terminal(self, name: s.Ident) -> str:
        kind = self.kind(name.text)
        if kind == "nonterminal":
            message = f"`{name.text}` is a nonterminal; words are made of modules and edges"
            self.sink.error(Code.WRONG_KIND, message, name.span, "name a module or an edge")
        elif kind is None:
            known = self.declared.terminals
            hint = did_you_mean(name.text, known, "module or edge", self.sink)
            self.sink.error(
                Code.UNKNOWN_NAME, f"unknown module or edge `{name.text}`", name.span, hint
            )
        return name.text

    # --- productions ---------------------------------------------------------------------------

    def _symbol(self, occurrence: s.Occurrence) -> ir.Symbol | None:
        name = occurrence.symbol
        kind = self.kind(name.text)
        if kind is None:
            known = (*self.declared.terminals, *self.nonterminals)
            self.sink.error(
                Code.UNKNOWN_NAME,
                f"unknown symbol `{name.text}`: no module, edge or nonterminal has this name",
                name.span,
                did_you_mean(name.text, known, "symbol", self.sink),
            )
            return None
        alias = None if occurrence.alias is None else occurrence.alias.text
        return ir.Symbol(name.text, kind, alias, name.span)

    def _production(self, item: s.Production) -> ProductionInfo:
        found = [self._symbol(occurrence) for occurrence in item.right]
        symbols = tuple(symbol for symbol in found if symbol is not None)
        broken = len(symbols) < len(found) or item.left.text not in self.nonterminals
        production = ir.Production(item.label.text, item.left.text, symbols, item.span)
        if broken:
            return ProductionInfo(production, {}, {}, broken=True, label=item.label.span)
        names = _Names(self, item)
        names.collect(symbols)
        return ProductionInfo(
            production, names.names, names.repeated, broken=False, label=item.label.span
        )


@dataclass(slots=True)
class _Names:
    """Names the occurrences of one production (section "Names" of the language)."""

    reader: _Reader
    item: s.Production
    names: dict[str, int] = field(default_factory=dict[str, int])
    repeated: dict[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])

    def collect(self, symbols: tuple[ir.Symbol, ...]) -> None:
        positions: dict[str, list[int]] = {}
        for position, symbol in enumerate(symbols):
            positions.setdefault(symbol.name, []).append(position)
        for name, places in positions.items():
            if len(places) == 1:
                self.names[name] = places[0]
        for name, places in positions.items():
            if len(places) > 1:
                self._number(name, places, symbols)
        for position, occurrence in enumerate(self.item.right):
            if occurrence.alias is not None:
                self._alias(occurrence.alias, position)

    def _number(self, name: str, places: list[int], symbols: tuple[ir.Symbol, ...]) -> None:
        numbered = [f"{name}{n}" for n in range(1, len(places) + 1)]
        self.repeated[name] = tuple(
            symbols[place].alias or own for own, place in zip(numbered, places, strict=True)
        )
        if symbols[places[0]].kind == "edge":
            return
        for own, place in zip(numbered, places, strict=True):
            if self.reader.kind(own) is None:
                self.names.setdefault(own, place)
            elif symbols[place].alias is None:
                message = f"this occurrence is called `{own}`, which is another symbol's name"
                hint = f"name it: `left:{name}`"
                self.reader.sink.error(Code.DUPLICATE_NAME, message, symbols[place].span, hint)

    def _alias(self, alias: s.Ident, position: int) -> None:
        taken = self.names.get(alias.text, position) != position or alias.text in self.repeated
        if taken or self.reader.kind(alias.text) is not None:
            message = f"`{alias.text}` is already the name of a symbol"
            self.reader.sink.error(Code.DUPLICATE_NAME, message, alias.span, "choose another name")
        else:
            self.names[alias.text] = position


def _nonterminals(start: str, productions: Mapping[str, ProductionInfo]) -> tuple[str, ...]:
    """The start symbol, then the others in order of first appearance."""
    found = dict.fromkeys([start])
    for info in productions.values():
        found[info.production.left] = None
        for symbol in info.production.right:
            if symbol.kind == "nonterminal":
                found[symbol.name] = None
    return tuple(found)


def _accept(parts: list[ir.Accept]) -> ir.Accept:
    return parts[0] if len(parts) == 1 else ir.AllOf(tuple(parts))


def _without_terminals(
    lefts: Mapping[str, Span], declared: Declarations, sink: Sink
) -> dict[str, Span]:
    """The left sides that are nonterminals; the others are reported."""
    found: dict[str, Span] = {}
    for name, span in lefts.items():
        if name not in declared.terminals:
            found[name] = span
            continue
        message = f"`{name}` is a module or an edge; it cannot be replaced"
        notes = [(declared.terminals[name], "declared here")]
        hint = "the left side of a production is a nonterminal with a name of its own"
        sink.error(Code.WRONG_KIND, message, span, hint, notes)
    return found


def lower_grammar(grammar: s.Grammar, declared: Declarations, sink: Sink) -> GrammarInfo:
    """The grammar with its symbols resolved; whatever is wrong with it is reported."""
    lefts: dict[str, Span] = {}
    for item in grammar.items:
        if isinstance(item, s.Production):
            lefts.setdefault(item.left.text, item.left.span)
    nonterminals = _without_terminals(lefts, declared, sink)
    reader = _Reader(declared, sink, nonterminals, frozenset(lefts))
    for item in grammar.items:
        reader.item(item)
    if not reader.starts:
        message = f"grammar `{grammar.name.text}` has no start symbol"
        hint = f"add `start {next(iter(nonterminals), 'N')};`"
        sink.error(Code.MISSING_START, message, grammar.name.span, hint)
    start = reader.starts[0].name.text if reader.starts else ""
    lowered = ir.Grammar(
        grammar.name.text,
        start,
        _nonterminals(start, reader.productions),
        tuple(info.production for info in reader.productions.values()),
        _accept(reader.accepts),
        None,
        grammar.span,
    )
    return GrammarInfo(lowered, reader.productions)

"""Grammars (Definition 3): check symbols and accept conditions, and name the occurrences."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.closed import Constants
from grammar_lang.names.declarations import Entity, Kind, Occurrences, duplicate, nonterminals
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span

_KINDS: Mapping[Kind, ir.SymbolKind] = {
    "module": "module",
    "edge": "edge",
    "nonterminal": "nonterminal",
}
_UNNAMED = Occurrences({}, {}, ())


@dataclass(frozen=True, slots=True)
class ProductionInfo:
    """A production and the names of its occurrences.

    A ``broken`` production has an unknown symbol, which was reported; its occurrences have no
    names.
    """

    production: ir.Production
    word: Occurrences
    broken: bool
    label: Span

    @property
    def names(self) -> Mapping[str, int]:
        """The position on the right side that each name refers to."""
        return self.word.places


@dataclass(frozen=True, slots=True)
class GrammarInfo:
    """A grammar without its semantics, and its productions by label."""

    grammar: ir.Grammar
    productions: Mapping[str, ProductionInfo]


@dataclass(slots=True)
class _Reader:
    names: NameTable
    sink: Sink
    nonterminals: tuple[str, ...]
    lefts: Collection[str]
    listed: bool = False
    """Whether modules are listed as in a grammar from ports, which is an error."""
    starts: list[s.StartSymbol] = field(default_factory=list[s.StartSymbol])
    productions: dict[str, ProductionInfo] = field(default_factory=dict[str, ProductionInfo])
    accepts: list[ir.Accept] = field(default_factory=list[ir.Accept])

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
                self.accepts.append(Conditions(self.names, self.sink).lower(condition))
            case s.Listed():
                message = "`with` lists the modules of a grammar from ports"
                hint = "write `grammar NAME from ports { … }`, or productions"
                self.sink.error(Code.OTHER_GRAMMAR, message, item.span, hint)

    def _start(self, item: s.StartSymbol) -> None:
        if self.starts:
            notes = [(self.starts[0].span, "first here")]
            hint = "a grammar has one start symbol"
            self.sink.error(Code.REPEATED_CLAUSE, "a second start symbol", item.span, hint, notes)
        elif not self._is_left(item.name) and not self.listed:
            message = f"the start symbol `{item.name.text}` has no production"
            hint = did_you_mean(item.name.text, self.nonterminals, "nonterminal", self.sink)
            self.sink.error(Code.UNKNOWN_NAME, message, item.name.span, hint)
        self.starts.append(item)

    def _is_left(self, name: s.Ident) -> bool:
        """Whether a symbol is on a left side; modules and edges there were reported before."""
        found = self.names.entity(name)
        return found is not None and (found.kind == "nonterminal" or name.text in self.lefts)

    # --- Productions ---------------------------------------------------------------------------

    def _symbol(self, occurrence: s.Occurrence) -> ir.Symbol | None:
        name, found = occurrence.symbol, self.names.entity(occurrence.symbol)
        if found is None:
            known = (*self.names.declared.terminals, *self.nonterminals)
            self.sink.error(
                Code.UNKNOWN_NAME,
                f"unknown symbol `{name.text}`: no module, edge or nonterminal has this name",
                name.span,
                did_you_mean(name.text, known, "symbol", self.sink),
            )
            return None
        alias = None if occurrence.alias is None else occurrence.alias.text
        return ir.Symbol(name.text, _KINDS[found.kind], alias, name.span)

    def _production(self, item: s.Production) -> ProductionInfo:
        found = [self._symbol(occurrence) for occurrence in item.right]
        symbols = tuple(symbol for symbol in found if symbol is not None)
        broken = len(symbols) < len(found) or item.left.text not in self.nonterminals
        production = ir.Production(item.label.text, item.left.text, symbols, item.span)
        word = _UNNAMED if broken else self.names.words[item.span]
        for name, own in word.clashes:
            if name.text == own:
                message, hint = f"`{own}` is already the name of a symbol", "choose another name"
            else:
                message = f"this occurrence is called `{own}`, which is another symbol's name"
                hint = f"name it: `left:{name.text}`"
            self.sink.error(Code.DUPLICATE_NAME, message, name.span, hint)
        return ProductionInfo(production, word, broken, item.label.span)


def grammar_of(
    grammar: s.Grammar, start: str, productions: Iterable[ir.Production], accepts: list[ir.Accept]
) -> ir.Grammar:
    """A grammar without semantics; its nonterminals are in order of first appearance."""
    found = dict.fromkeys([start])
    rules = tuple(productions)
    for production in rules:
        found[production.left] = None
        found |= {x.name: None for x in production.right if x.kind == "nonterminal"}
    accept = accepts[0] if len(accepts) == 1 else ir.AllOf(tuple(accepts))
    return ir.Grammar(grammar.name.text, start, tuple(found), rules, accept, None, grammar.span)


def _check_left_sides(lefts: Mapping[str, Entity], names: NameTable, sink: Sink) -> None:
    """Report left sides that are modules or edges."""
    for name, left in lefts.items():
        terminal = names.declared.terminals.get(name)
        if terminal is not None:
            message = f"`{name}` is a module or an edge; it cannot be replaced"
            notes = [(terminal.span, "declared here")]
            hint = "the left side of a production is a nonterminal with a name of its own"
            sink.error(Code.WRONG_KIND, message, left.span, hint, notes)


def lower_grammar(grammar: s.Grammar, names: NameTable, sink: Sink) -> GrammarInfo:
    """The grammar with its symbols resolved; errors in it are reported."""
    lefts = nonterminals(grammar)
    _check_left_sides(lefts, names, sink)
    own = tuple(name for name in lefts if name not in names.declared.terminals)
    listed = not lefts and any(isinstance(item, s.Listed) for item in grammar.items)
    reader = _Reader(names, sink, own, lefts, listed)
    for item in grammar.items:
        reader.item(item)
    if not reader.starts:
        message = f"grammar `{grammar.name.text}` has no start symbol"
        hint = f"add `start {next(iter(own), 'N')};`"
        sink.error(Code.MISSING_START, message, grammar.name.span, hint)
    start = reader.starts[0].name.text if reader.starts else ""
    lowered = (info.production for info in reader.productions.values())
    return GrammarInfo(grammar_of(grammar, start, lowered, reader.accepts), reader.productions)


# --- Accept conditions ------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Conditions:
    """Lowers the accept conditions of a grammar."""

    names: NameTable
    sink: Sink

    def terminal(self, name: s.Ident) -> str:
        """The name of a module or an edge; anything else is reported."""
        found = self.names.entity(name)
        if found is not None and found.kind == "nonterminal":
            message = f"`{name.text}` is a nonterminal; words are made of modules and edges"
            self.sink.error(Code.WRONG_KIND, message, name.span, "name a module or an edge")
        elif found is None:
            known = self.names.declared.terminals
            hint = did_you_mean(name.text, known, "module or edge", self.sink)
            self.sink.error(
                Code.UNKNOWN_NAME, f"unknown module or edge `{name.text}`", name.span, hint
            )
        return name.text

    def lower(self, condition: s.Condition) -> ir.Accept:
        """The condition with its symbols checked."""
        match condition:
            case s.Factor():
                return self._factor(condition)
            case s.Count(symbol=symbol, comparison=comparison, bound=bound):
                name = None if symbol is None else self.terminal(symbol)
                number = Constants(self.sink).integer(bound, None, "a bound on a count")
                return ir.Count(name, comparison, number or 0)
            case s.Matches(regex=regex):
                return ir.Matches(self._regex(regex))
            case s.Not(part=part):
                return ir.NotAccept(self.lower(part))
            case s.And(parts=parts):
                return ir.AllOf(tuple(self.lower(p) for p in parts))
            case s.Or(parts=parts):
                return ir.AnyOf(tuple(self.lower(p) for p in parts))

    def _factor(self, factor: s.Factor) -> ir.Accept:
        word = tuple(self.terminal(symbol) for symbol in factor.word)
        match factor.where:
            case "contains":
                return ir.Contains(word)
            case "starts":
                return ir.StartsWith(word)
            case "ends":
                return ir.EndsWith(word)

    def _regex(self, regex: s.Regex) -> ir.Regex:
        match regex:
            case s.RegexSymbol(symbol=symbol):
                return ir.RSymbol(self.terminal(symbol))
            case s.RegexEmpty():
                return ir.REmpty()
            case s.RegexSequence(parts=parts):
                return ir.RSequence(tuple(self._regex(p) for p in parts))
            case s.RegexChoice(parts=parts):
                return ir.RChoice(tuple(self._regex(p) for p in parts))
            case s.RegexRepeat(part=part, mark=mark):
                return ir.RRepeat(self._regex(part), mark)

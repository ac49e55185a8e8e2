"""Accept conditions: regular conditions on the word."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.closed import Constants
from grammar_lang.findings.diagnostics import Sink


@dataclass(frozen=True, slots=True)
class Conditions:
    """Lowers conditions; ``terminal`` checks that a name is a module or an edge."""

    terminal: Callable[[s.Ident], str]
    sink: Sink

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

"""Membership by other people's libraries; the accept condition is not looked at.

Grammars are handed over as objects and never as text, where a name's spelling means something.
"""

from __future__ import annotations

from typing import Any

from grammar_lang import ir

Word = tuple[str, ...]


class NltkChart:
    """Earley's chart of nltk.

    A word is told by an edge of the start symbol over all of it: no tree is taken out, for which
    nltk has limits.
    """

    def __init__(self, grammar: ir.Grammar) -> None:
        from nltk.grammar import CFG, Nonterminal, Production
        from nltk.parse.earleychart import EarleyChartParser

        def side(right: tuple[ir.Symbol, ...]) -> list[Any]:
            return [Nonterminal(s.name) if s.kind == "nonterminal" else s.name for s in right]

        self.start = Nonterminal(grammar.start)
        self.known = {s.name for p in grammar.productions for s in p.right}
        productions = [Production(Nonterminal(p.left), side(p.right)) for p in grammar.productions]
        self.parser = EarleyChartParser(CFG(self.start, productions))

    def accepts(self, word: Word) -> bool:
        """Whether the word is derived; nltk itself raises an error for unknown tokens."""
        if not self.known.issuperset(word):
            return False
        chart = self.parser.chart_parse(list(word))
        whole = chart.select(start=0, end=len(word), lhs=self.start, is_complete=True)
        return next(iter(whole), None) is not None


class PyformlangCyk:
    """The Cocke-Younger-Kasami table of pyformlang."""

    def __init__(self, grammar: ir.Grammar) -> None:
        from pyformlang.cfg import CFG, Production, Terminal, Variable

        def side(right: tuple[ir.Symbol, ...]) -> list[Any]:
            return [
                (Variable if symbol.kind == "nonterminal" else Terminal)(symbol.name)
                for symbol in right
            ]

        self.terminal = Terminal
        productions = {Production(Variable(p.left), side(p.right)) for p in grammar.productions}
        self.cfg = CFG(start_symbol=Variable(grammar.start), productions=productions)

    def accepts(self, word: Word) -> bool:
        """Whether the word is derived."""
        return bool(self.cfg.contains([self.terminal(name) for name in word]))

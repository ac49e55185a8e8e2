"""The libraries that the language operations are compared with, one small adapter each.

Each is given the grammar in its own form and the word in its own form, ready-made: neither the
renaming of symbols nor the conversion of words is timed.  Each is asked in the way that is
quickest for it and answers yes or no; no adapter repairs an answer.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from language_grammars import grammar
from language_lr_peers import LarkEarley, LarkLalr, ParglareGlr, ParglareLr
from language_peer import NotApplicableError, Peer, Word, names_of, rights_of, terminals_of

from grammar_lang import ir

# --- automata-lib ---------------------------------------------------------------------------------


def linear_transitions(
    grammar: ir.Grammar,
) -> tuple[int, int, dict[int, dict[str, set[int]]]]:
    """Start, end and transitions of the automaton of a right- or left-linear grammar.

    Raises:
        NotApplicableError: the grammar is neither.
    """
    states = {name: i + 2 for i, name in enumerate(grammar.nonterminals)}
    right = all(_is_linear(p.right, -1) for p in grammar.productions)
    if not right and not all(_is_linear(p.right, 0) for p in grammar.productions):
        raise NotApplicableError("the grammar is not right- or left-linear")
    first, last = (states[grammar.start], 1) if right else (1, states[grammar.start])
    steps: dict[int, dict[str, set[int]]] = {0: {}, **{i: {} for i in states.values()}, 1: {}}
    for production in grammar.productions:
        letters = [s.name for s in production.right if s.kind != "nonterminal"]
        inner = [states[s.name] for s in production.right if s.kind == "nonterminal"]
        source = states[production.left] if right else (*inner, 1)[0]
        target = (*inner, 1)[0] if right else states[production.left]
        for letter in letters[:-1]:
            steps[len(steps)] = {}
            steps[source].setdefault(letter, set()).add(len(steps) - 1)
            source = len(steps) - 1
        steps[source].setdefault(letters[-1] if letters else "", set()).add(target)
    return first, last, steps


def _is_linear(right: Sequence[ir.Symbol], place: int) -> bool:
    inner = [i for i, symbol in enumerate(right) if symbol.kind == "nonterminal"]
    return not inner or inner == [place % len(right)]


class AutomataDfa(Peer):
    """The minimal DFA of a linear grammar; the library reads no grammars, so it gets an NFA."""

    name = "automata-lib DFA"
    any_grammar = False

    def __init__(self, grammar: ir.Grammar) -> None:
        from automata.fa.dfa import DFA
        from automata.fa.nfa import NFA

        first, last, steps = linear_transitions(grammar)
        nfa = NFA(
            states=set(steps),
            input_symbols=set(terminals_of(grammar)),
            transitions=steps,
            initial_state=first,
            final_states={last},
        )
        self._dfa = DFA.from_nfa(nfa, minify=True)

    def accepts(self, word: Any) -> bool:
        return bool(self._dfa.accepts_input(word))


class AutomataNpda(Peer):
    """The top-down pushdown automaton with one working state, accepting by final state."""

    name = "automata-lib NPDA"

    def __init__(self, grammar: ir.Grammar) -> None:
        from automata.pda.npda import NPDA

        names = names_of(grammar, "N", "t")
        moves: dict[str, dict[str, set[tuple[str, Any]]]] = {"": {"#": {("end", ("#",))}}}
        for left, right in rights_of(grammar, names):
            moves[""].setdefault(left, set()).add(("work", tuple(right)))
        self._letters = {t: names[t, False] for t in terminals_of(grammar)}
        moves |= {letter: {letter: {("work", "")}} for letter in self._letters.values()}
        start = {"": {"bottom": {("work", (names[grammar.start, True], "#"))}}}
        self._npda = NPDA(
            states={"start", "work", "end"},
            input_symbols=set(self._letters.values()),
            stack_symbols={*names.values(), "#", "bottom"},
            transitions={"start": start, "work": moves},
            initial_state="start",
            initial_stack_symbol="bottom",
            final_states={"end"},
            acceptance_mode="final_state",
        )

    def encode(self, word: Word) -> Any:
        return tuple(self._letters.get(token, token) for token in word)

    def accepts(self, word: Any) -> bool:
        return bool(self._npda.accepts_input(word))


# --- general parsers ------------------------------------------------------------------------------


class Pyformlang(Peer):
    """``contains``: CYK on the normal form, which is made once, beforehand."""

    name = "pyformlang CYK"

    def __init__(self, grammar: ir.Grammar) -> None:
        from pyformlang.cfg import CFG, Production, Terminal, Variable

        names = names_of(grammar, "N", "t")
        self._letters = {t: Terminal(names[t, False]) for t in terminals_of(grammar)}
        symbols: dict[str, Any] = {n: Variable(n) for n in names.values()}
        symbols |= {names[t, False]: terminal for t, terminal in self._letters.items()}
        self.cfg = CFG(
            start_symbol=symbols[names[grammar.start, True]],
            productions={
                Production(symbols[left], [symbols[s] for s in right])
                for left, right in rights_of(grammar, names)
            },
        )
        self.cfg.to_normal_form()

    def encode(self, word: Word) -> Any:
        from pyformlang.cfg import Terminal

        return [self._letters.get(token) or Terminal(token) for token in word]

    def accepts(self, word: Any) -> bool:
        return bool(self.cfg.contains(word))


class Nltk(Peer):
    """The chart of the default parser (left-corner, bottom-up), asked for a spanning edge."""

    name = "nltk chart"

    def __init__(self, grammar: ir.Grammar) -> None:
        from nltk import CFG, ChartParser, Nonterminal, Production

        def symbol(name: str, *, inner: bool) -> Any:
            return Nonterminal(name) if inner else name

        self._start = Nonterminal(grammar.start)
        productions = [
            Production(
                Nonterminal(p.left),
                [symbol(s.name, inner=s.kind == "nonterminal") for s in p.right],
            )
            for p in grammar.productions
        ]
        # The parser gives up after five seconds unless told otherwise.
        self._parser = ChartParser(CFG(self._start, productions), max_time=None)

    def accepts(self, word: Any) -> bool:
        chart = self._parser.chart_parse(word)
        spanning = chart.select(lhs=self._start, span=(0, len(word)), is_complete=True)
        return next(spanning, None) is not None


class GenlmEarley(Peer):
    """Earley over the Boolean semiring, column by column.

    Called with a word it keeps the columns of every prefix for ever, recurses over the word and
    copies the list of columns at every symbol; this loop over its columns does neither.
    """

    name = "genlm Earley"

    def __init__(self, grammar: ir.Grammar) -> None:
        from genlm.grammar.cfg import CFG
        from genlm.grammar.parse.earley import Earley
        from genlm.grammar.semiring import Boolean

        names = names_of(grammar, "N", "t")
        self._letters = {t: names[t, False] for t in terminals_of(grammar)}
        cfg = CFG(R=Boolean, S=names[grammar.start, True], V=set(self._letters.values()))
        for left, right in rights_of(grammar, names):
            cfg.add(Boolean.one, left, *right)
        self._earley = Earley(cfg)

    def encode(self, word: Word) -> Any:
        return tuple(self._letters.get(token, token) for token in word)

    def accepts(self, word: Any) -> bool:
        earley = self._earley
        if not word:
            weight = earley(word)  # without a rule for it the sum of no weights, the number 0
            return weight != 0 and bool(weight.score)
        earley.clear_cache()
        columns = list(earley.chart(()))
        for token in word:
            column = earley.next_column(columns, token)
            if not column.i_chart and not column.c_chart:
                return False
            columns.append(column)
        found = columns[-1].c_chart.get((0, earley.cfg.S))
        return found is not None and bool(found.score)


PEERS: tuple[type[Peer], ...] = (
    AutomataDfa,
    LarkLalr,
    ParglareLr,
    GenlmEarley,
    ParglareGlr,
    LarkEarley,
    Nltk,
    Pyformlang,
    AutomataNpda,
)


def import_libraries(kinds: Iterable[type[Peer]]) -> None:
    """Imports are nobody's building time, and end badly when a time limit interrupts them."""
    for kind in kinds:
        kind(grammar("small", "a", "S -> a S | a"))

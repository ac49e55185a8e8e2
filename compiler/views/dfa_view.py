"""Finite automata as pictures: that of a linear family, or that of its accept condition."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.automata.finite_automaton import Dfa
from compiler.automata.linear_automaton import linear_automaton
from compiler.languages.language import Language
from compiler.views.highlighted_run import not_accepted, refuse_unknown
from compiler.views.picture import Arrow, Edge, Node, Picture


def family_dfa_view(language: Language, highlight: Sequence[str] | None = None) -> Picture:
    """The finite automaton of a family, where its grammar is left- or right-linear.

    Other families have none: there it is the automaton of the accept condition alone, which
    accepts more than the family.  The title says which.

    Raises:
        HighlightError: the automaton that is drawn does not accept ``highlight``.
    """
    name = language.srg.name
    family = linear_automaton(language.srg, language.accept)
    if family is not None:
        return dfa_view(family, f"{name}: minimal finite automaton of the family", highlight)
    title = f"{name}: accept condition only, the grammar is neither left- nor right-linear"
    return dfa_view(language.accept, title, highlight)


def dfa_view(dfa: Dfa, title: str = "", highlight: Sequence[str] | None = None) -> Picture:
    """A finite automaton without the states from which no word is accepted.

    Symbols between the same states share an edge; those that the run of ``highlight`` reads there
    have an edge of their own.

    Raises:
        HighlightError: the automaton does not accept ``highlight``.
    """
    path = () if highlight is None else _path(dfa, highlight)
    used = set() if highlight is None else set(zip(path, highlight, strict=False))
    visited = set(path)
    live = dfa.live()
    shown = [state for state in range(dfa.size) if live[state] or state == 0]
    symbols: dict[tuple[int, int, bool], list[str]] = {}
    for state in shown:
        for code, symbol in enumerate(dfa.alphabet):
            target = dfa.step(state, code)
            if live[target]:
                key = (state, target, (state, symbol) not in used)
                symbols.setdefault(key, []).append(symbol)
    nodes = tuple(
        Node(
            f"s{state}",
            f"q{state}",
            double=dfa.accepting[state],
            highlighted=state in visited,
            data={"state": state},
        )
        for state in shown
    )
    edges = tuple(
        Edge(
            f"s{tail}",
            f"s{head}",
            tuple(shared),
            highlighted=not plain,
            data={"symbols": tuple(shared)},
        )
        for (tail, head, plain), shared in sorted(symbols.items(), key=lambda item: item[0])
    )
    start = Arrow("s0", highlighted=bool(path))
    return Picture("dfa", "circle", nodes, edges, (start,), title)


def _path(dfa: Dfa, word: Sequence[str]) -> tuple[int, ...]:
    """The states met by an accepted word."""
    refuse_unknown(word, dfa.alphabet)
    path = dfa.run(word)
    if path is None or not dfa.accepting[path[-1]]:
        raise not_accepted(word)
    return path

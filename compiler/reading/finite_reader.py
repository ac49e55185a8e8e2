"""Membership by a finite automaton, as fast as Python reads: one dictionary per state.

Keys are interned, as names in the text of a program are, so that these are found by identity.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from operator import getitem
from sys import intern
from typing import Any

from compiler.automata.finite_automaton import Dfa

ACCEPTING = object()
"""A key of the accepting states; no symbol equals it."""


class FiniteReader:
    """The words of a finite automaton."""

    def __init__(self, dfa: Dfa) -> None:
        live = dfa.live()
        states: list[dict[Any, Any]] = [{} for _ in live]
        width = len(dfa.alphabet)
        for source, row in enumerate(states):
            for symbol, name in enumerate(map(intern, dfa.alphabet)):
                target = dfa.table[source * width + symbol]
                if live[target]:
                    row[name] = states[target]
            if dfa.accepting[source]:
                row[ACCEPTING] = row
        self.initial: Mapping[Any, Any] = states[0]

    def accepts(self, word: Iterable[str]) -> bool:
        """Whether the word is accepted; a word with an unknown token is not."""
        try:
            return ACCEPTING in reduce(getitem, word, self.initial)
        except KeyError:
            return False

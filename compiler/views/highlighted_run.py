"""The runs that views show in colour, and what is said where there is none."""

from __future__ import annotations

from collections.abc import Container, Sequence

from compiler.automata.pushdown_automaton import Pda, Transition
from compiler.automata.pushdown_runs import accepting_run


class HighlightError(ValueError):
    """A word that cannot be highlighted, with the reason."""


def refuse_unknown(word: Sequence[str], alphabet: Container[str]) -> None:
    """Refuse a word with a token that is no symbol.

    Raises:
        HighlightError: there is one; it is named.
    """
    for token in word:
        if token not in alphabet:
            raise HighlightError(f"`{token}` is no symbol of the words")


def not_accepted(word: Sequence[str]) -> HighlightError:
    """The fault of a word over the right symbols."""
    return HighlightError(f"the word `{' '.join(word)}` is not accepted")


def run_of(pda: Pda, word: Sequence[str]) -> tuple[Transition, ...]:
    """The transitions of an accepting run of a word.

    Raises:
        HighlightError: an unknown symbol, or the word is not accepted.
    """
    refuse_unknown(word, pda.alphabet)
    run = accepting_run(pda, word)
    if run is None:
        raise not_accepted(word)
    return run

"""The derivation of a word that a command is about."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from compiler.views.picture import HighlightError, not_accepted, refuse_unknown, run_of
from compiler.words.derivation import Derivation, replay
from compiler.words.grammar import cyclic, trimmed
from compiler.words.language import Language
from compiler.words.pushdown_automaton import sra
from compiler.words.structures import derivations_of
from grammar_lang import ir
from srgc.faults import UsageFault, argument


@dataclass(frozen=True, slots=True)
class ChosenDerivation:
    """A derivation, and what a reader has to know beside it."""

    derivation: Derivation
    remarks: tuple[str, ...]


def chosen_derivation(
    words: Language, grammar: ir.Grammar, word: tuple[str, ...], wanted: int | None
) -> ChosenDerivation:
    """A derivation of a word: the ``wanted``-th, counted from 1, or the first.

    Raises:
        UsageFault: the word is not in the family, or has not so many derivations.
    """
    try:
        refuse_unknown(word, words.srg.terminals)
        if not words.accepts(word):
            raise not_accepted(word)
        derivations = _derivations(words, grammar, word)
    except HighlightError as error:
        raise UsageFault(str(error)) from None
    number = wanted or 1
    first = list(islice(derivations, number))
    if len(first) < number:
        noun = "derivation" if len(first) == 1 else "derivations"
        raise UsageFault(
            f"the word has {len(first)} {noun}: there is no ", argument("derivation"), f" {number}"
        )
    remarks: tuple[str, ...] = ()
    if cyclic(trimmed(words.srg.cfg)):
        remarks = ("a nonterminal of the grammar derives itself: one derivation is shown",)
    elif wanted is None and next(derivations, None) is not None:
        remarks = ("the word has several derivations: --derivation 2 shows the next",)
    return ChosenDerivation(first[-1], remarks)


def _derivations(
    words: Language, grammar: ir.Grammar, word: tuple[str, ...]
) -> Iterator[Derivation]:
    """The derivations of a word; one of them where there may be infinitely many."""
    if not cyclic(trimmed(words.srg.cfg)):
        return derivations_of(words, word)
    run = run_of(sra(words.srg, words.accept), word)
    return iter([replay(grammar, [step.label for step in run if step.label is not None])])

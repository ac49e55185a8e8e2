"""The size of a finite language: how many words, and how long the longest is."""

from __future__ import annotations

from math import prod

from compiler.grammars.binary_normal_form import BinaryGrammar
from compiler.grammars.grammar import components
from compiler.languages.budget import BudgetExceededError
from compiler.languages.language import Language

MOVE_LIMIT = 500
SIZE_LIMIT = 100_000


def longest_word(language: Language) -> int | None:
    """The length of the longest word of a language that is not empty; None where it is infinite."""
    product = language.product
    return product.longest() if product.is_finite() else None


def number_of_words(language: Language, longest: int, *, unambiguous: bool) -> int | None:
    """How many words a finite language has, the empty one left aside.

    None where counting would take too long.

    Args:
        language: the language.
        longest: the length of its longest word.
        unambiguous: whether every word is known to have one derivation, which are then counted.
            Otherwise words are counted prefix by prefix: ``SIZE_LIMIT`` moves of a finite automaton
            at most; where there is none and the grammar is not LR(1) either, ``MOVE_LIMIT`` moves,
            if the nonterminals times ``longest`` are not more than ``SIZE_LIMIT``.
    """
    if unambiguous:
        return _derivations(language.product)
    regular = language.finite_automaton is not None
    if not regular and language.is_lr:
        return _derivations(language.product)
    small = longest <= MOVE_LIMIT and longest * len(language.product.rules) <= SIZE_LIMIT
    if not regular and not small:
        return None
    try:
        counts = language.count_words(longest, budget=SIZE_LIMIT if regular else MOVE_LIMIT)
    except BudgetExceededError:
        return None
    return sum(counts[1:])


def _derivations(grammar: BinaryGrammar) -> int:
    """The number of derivations of a finite language.

    Neither the normal form nor the product with a deterministic automaton adds one.
    """
    first = grammar.terminals
    children = [
        [s - first for right in rights for s in right if s >= first] for rights in grammar.rules
    ]
    component = components(len(children), children.__getitem__)
    number = [0] * len(children)
    for k in sorted(range(len(children)), key=component.__getitem__):
        number[k] = sum(
            prod(1 if s < first else number[s - first] for s in right) for right in grammar.rules[k]
        )
    return sum(number[start - first] for start in grammar.starts)

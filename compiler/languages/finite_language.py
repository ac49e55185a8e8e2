"""The size of a finite language: how many words, and how long the longest is."""

from __future__ import annotations

from math import prod

from compiler.grammars.grammar import components
from compiler.languages.intersection import BinaryGrammar
from compiler.languages.language import Language
from compiler.languages.residuals import Residual, Residuals

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
            Otherwise words are counted prefix by prefix, in ``MOVE_LIMIT`` moves at most, if the
            nonterminals times ``longest`` are not more than ``SIZE_LIMIT``.
    """
    product = language.product
    return _derivations(product) if unambiguous else _words(product, longest)


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


def _words(grammar: BinaryGrammar, longest: int) -> int | None:
    """The number of words by the residuals of their prefixes; None beyond the limits."""
    if longest > MOVE_LIMIT or longest * len(grammar.rules) > SIZE_LIMIT:
        return None
    residuals = Residuals(grammar, longest)
    level, total, moves = {residuals.root: 1}, 0, 0
    while level:
        following: dict[Residual, int] = {}
        for residual, prefixes in level.items():
            for symbol in residuals.symbols(residual):
                moves += 1
                if moves > MOVE_LIMIT:
                    return None
                target = residuals.after(residual, symbol)
                if target is not None:
                    following[target] = following.get(target, 0) + prefixes
        level = following
        total += sum(n for residual, n in level.items() if residual.accepting)
    return total

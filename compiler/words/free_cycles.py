"""Cycles in derivations that add no weight: with one, infinitely many words have the same weight.

Without one, every bound on the weight leaves finitely many words.  A rule ``A -> B C`` leads from A
to B and adds what C derives, and from A to C and adds what B derives.  A cycle is free if all that
it adds can have weight zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from compiler.words.grammar import components
from compiler.words.intersection import BinaryGrammar


def has_free_cycle(product: BinaryGrammar, weights: Sequence[Fraction]) -> bool:
    """Whether infinitely many words have the same weight.

    Args:
        product: a grammar in binary normal form whose nonterminals are all useful.
        weights: the weights of the terminals, by number; none is negative.
    """
    return bool(free_terminals(product, weights))


def free_terminals(product: BinaryGrammar, weights: Sequence[Fraction]) -> frozenset[int]:
    """The numbers of the terminals that free cycles add; empty if there is no free cycle."""
    first, size = product.terminals, len(product.rules)
    free = _weightless(product, weights)
    steps = [
        (left, inner - first, beside)
        for left, rights in enumerate(product.rules)
        for right in rights
        if len(right) == 2
        for inner, beside in (right, right[::-1])
        if inner >= first and beside in free
    ]
    after: list[list[int]] = [[] for _ in range(size)]
    for left, inner, _ in steps:
        after[left].append(inner)
    component = components(size, after.__getitem__)
    added = {beside for left, inner, beside in steps if component[left] == component[inner]}
    return _derived(product, added, free)


def _weightless(product: BinaryGrammar, weights: Sequence[Fraction]) -> frozenset[int]:
    """The symbols that derive a word of weight zero; linear time."""
    users: dict[int, list[tuple[int, int]]] = {}
    missing = [[len(right) for right in rights] for rights in product.rules]
    for k, rights in enumerate(product.rules):
        for number, right in enumerate(rights):
            for symbol in right:
                users.setdefault(symbol, []).append((k, number))
    todo = [symbol for symbol in range(product.terminals) if not weights[symbol]]
    found = set(todo)
    while todo:
        for k, number in users.get(todo.pop(), ()):
            missing[k][number] -= 1
            left = product.terminals + k
            if not missing[k][number] and left not in found:
                found.add(left)
                todo.append(left)
    return frozenset(found)


def _derived(product: BinaryGrammar, symbols: set[int], free: frozenset[int]) -> frozenset[int]:
    """The terminals in words over ``free`` that the symbols derive."""
    found, todo = set(symbols), list(symbols)
    while todo:
        symbol = todo.pop()
        if symbol < product.terminals:
            continue
        for right in product.rules[symbol - product.terminals]:
            fresh = set(right) - found if free.issuperset(right) else set[int]()
            found |= fresh
            todo += fresh
    return frozenset(symbol for symbol in found if symbol < product.terminals)

"""Cycles that add no weight, against the lengths and weights of words, counted by brute force."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest

from compiler.words.free_cycles import free_terminals, has_free_cycle
from compiler.words.intersection import BinaryGrammar

LONGEST, HEAVIEST = 22, 4
"""Of two nonterminals and weights of at most 1.

A nonterminal derives a lightest word of at most 2 symbols, and without a free cycle a word of
weight w has at most 18 symbols for w up to 4: what weighs nothing has at most 2, what weighs 1 at
most 3, and the two parts into which the rest first splits come after at most one more part that
weighs nothing.  A free cycle adds at most 4 symbols to a word of at most 4 symbols.
"""
FIRST_ENDLESS = 19


def derived(grammar: BinaryGrammar, weights: list[int]) -> list[list[set[int]]]:
    """For each nonterminal and length, the weights up to ``HEAVIEST`` of the words it derives."""
    table: list[list[set[int]]] = [[set() for _ in range(LONGEST + 1)] for _ in grammar.rules]

    def of(symbol: int, length: int) -> set[int]:
        if symbol < grammar.terminals:
            return {weights[symbol]} if length == 1 else set()
        return table[symbol - grammar.terminals][length]

    for length in range(1, LONGEST + 1):
        for k, rights in enumerate(grammar.rules):
            for right in rights:
                if len(right) == 1:
                    table[k][length] |= of(right[0], length)
                    continue
                for left in range(1, length):
                    sums = {a + b for a in of(right[0], left) for b in of(right[1], length - left)}
                    table[k][length] |= {total for total in sums if total <= HEAVIEST}
    return table


def is_useful(grammar: BinaryGrammar, weights: list[int]) -> bool:
    """Whether both nonterminals derive words, and the first uses the second."""
    used = any(symbol == grammar.terminals + 1 for right in grammar.rules[0] for symbol in right)
    return used and all(any(row) for row in derived(grammar, weights))


def random_grammar(seed: int) -> tuple[BinaryGrammar, list[int]]:
    rng = random.Random(f"free cycles {seed}")
    weights = [0, 1]
    while True:
        rules = tuple(
            tuple(
                dict.fromkeys(
                    (rng.randrange(2),)
                    if rng.random() < 0.35
                    else (rng.randrange(4), rng.randrange(4))
                    for _ in range(rng.randint(1, 3))
                )
            )
            for _ in range(2)
        )
        grammar = BinaryGrammar(2, rules, (2,), empty_word=False)
        if is_useful(grammar, weights):
            return grammar, weights


def test_decisions_are_those_of_the_words() -> None:
    answers = {True: 0, False: 0}
    for seed in range(400):
        grammar, weights = random_grammar(seed)
        lengths = derived(grammar, weights)[0]
        endless = any(lengths[FIRST_ENDLESS:])
        assert has_free_cycle(grammar, list(map(Fraction, weights))) == endless, grammar
        answers[endless] += 1
    assert min(answers.values()) > 100


A, B, S, N = 0, 1, 2, 3


@pytest.mark.parametrize(
    ("rules", "starts", "free"),
    [
        (((),), (), set()),
        ((((A,), (B,)), ((A,),)), (S,), set()),  # finite
        ((((A, S), (A,)), ((A,),)), (S,), {A}),
        ((((B, S), (A,)), ((A,),)), (S,), set()),
        ((((S, B), (A,)), ((A,),)), (S,), set()),
        ((((N, S), (B,)), ((A,), (B,))), (S,), {A}),  # what N derives may weigh nothing
        ((((N, S), (B,)), ((A, B), (B,))), (S,), set()),
        ((((N, N), (A,)), ((B, S), (A, B))), (S,), set()),
        ((((N, N), (A,)), ((B, S), (A, S))), (S,), {A}),
        ((((A, N), (A,)), ((A, S), (B, B))), (S,), {A}),  # around by way of another
        ((((N, A), (A,)), ((B, N), (B,))), (S,), set()),  # what weighs nothing stands outside
    ],
)
def test_cycles_by_hand(
    rules: tuple[tuple[tuple[int, ...], ...], ...], starts: tuple[int, ...], free: set[int]
) -> None:
    grammar = BinaryGrammar(2, rules, starts, empty_word=False)
    weights = [Fraction(0), Fraction(1, 3)]
    assert free_terminals(grammar, weights) == free
    assert has_free_cycle(grammar, weights) is bool(free)


def test_without_weights_every_infinite_language_has_a_free_cycle() -> None:
    for seed in range(100):
        grammar, _ = random_grammar(seed)
        assert has_free_cycle(grammar, [Fraction(0)] * 2) is not grammar.is_finite()
        assert not has_free_cycle(grammar, [Fraction(1)] * 2)


def test_long_chains_take_linear_time() -> None:
    """Nonterminal k derives symbols of k + 1 only, the last one itself."""
    size = 20_000
    rules = tuple(((B, 2 + k + 1), (A,)) for k in range(size - 1))
    last = 2 + size - 1
    endless = BinaryGrammar(2, (*rules, ((A, last), (A,))), (2,), empty_word=False)
    assert has_free_cycle(endless, [Fraction(0), Fraction(1)])
    assert not has_free_cycle(endless, [Fraction(1), Fraction(0)])

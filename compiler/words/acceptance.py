"""The accept condition as a deterministic finite automaton.

The paper's accept set A = {w : some w_i = EN} (Definition 4) is generalised to regular conditions
on the word.  Factors: Knuth, Morris, Pratt (1977); regular expressions: Thompson (1968).
"""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from typing import assert_never

from compiler.words.finite_automaton import (
    STATE_LIMIT,
    AutomatonTooLargeError,
    Dfa,
    Nfa,
    complement,
    determinise,
    intersection,
    minimal,
    union,
)
from grammar_lang import ir


def accept_dfa(accept: ir.Accept, alphabet: tuple[str, ...]) -> Dfa:
    """The minimal complete automaton of an accept condition over ``alphabet``.

    Raises:
        ValueError: the condition names a symbol that is not in the alphabet.
        AutomatonTooLargeError: an intermediate automaton has more than ``STATE_LIMIT`` states.
    """
    done: list[Dfa] = []
    todo: list[tuple[ir.Accept, bool]] = [(accept, False)]
    while todo:
        node, visited = todo.pop()
        match node:
            case ir.AllOf(parts) | ir.AnyOf(parts):
                if not visited:
                    todo.append((node, True))
                    todo += [(part, False) for part in reversed(parts)]
                    continue
                operands = done[len(done) - len(parts) :]
                del done[len(done) - len(parts) :]
                done.append(_combine(operands, alphabet, every=isinstance(node, ir.AllOf)))
            case ir.NotAccept(part):
                if visited:
                    done.append(complement(done.pop()))
                else:
                    todo += [(node, True), (part, False)]
            case _:
                done.append(_atom(node, alphabet))
    return done[0]


def _combine(operands: Sequence[Dfa], alphabet: tuple[str, ...], *, every: bool) -> Dfa:
    result = _constant(alphabet, value=every)
    for operand in operands:
        result = intersection(result, operand) if every else union(result, operand)
    return result


def _constant(alphabet: tuple[str, ...], *, value: bool) -> Dfa:
    return Dfa(alphabet, (0,) * len(alphabet), (value,))


def _atom(
    node: ir.Contains | ir.StartsWith | ir.EndsWith | ir.Count | ir.Matches,
    alphabet: tuple[str, ...],
) -> Dfa:
    match node:
        case ir.Contains(word):
            return minimal(_factor(_codes(word, alphabet), alphabet, absorbing=True))
        case ir.EndsWith(word):
            return minimal(_factor(_codes(word, alphabet), alphabet, absorbing=False))
        case ir.StartsWith(word):
            return minimal(_prefix(_codes(word, alphabet), alphabet))
        case ir.Count(symbol, comparison, bound):
            counted = range(len(alphabet)) if symbol is None else _codes((symbol,), alphabet)
            return minimal(_count(counted, comparison, bound, alphabet))
        case ir.Matches(regex):
            return minimal(determinise(_thompson(regex, alphabet)))
        case _:
            assert_never(node)


def _codes(word: Sequence[str], alphabet: tuple[str, ...]) -> tuple[int, ...]:
    number = {name: i for i, name in enumerate(alphabet)}
    for token in word:
        if token not in number:
            raise ValueError(f"accept condition: {token!r} is not a module or edge")
    return tuple(number[token] for token in word)


def _factor(word: tuple[int, ...], alphabet: tuple[str, ...], *, absorbing: bool) -> Dfa:
    """State k: the longest suffix read that is a prefix of ``word`` has length k."""
    width, size = len(alphabet), len(word) + 1
    table = [0] * (size * width)
    border = 0
    for state in range(size):
        for symbol in range(width):
            fallback = table[border * width + symbol] if state else 0
            matched = state < len(word) and word[state] == symbol
            table[state * width + symbol] = state + 1 if matched else fallback
        if 0 < state < len(word):
            border = table[border * width + word[state]]
    if absorbing:
        table[len(word) * width :] = [len(word)] * width
    return Dfa(alphabet, tuple(table), tuple(state == len(word) for state in range(size)))


def _prefix(word: tuple[int, ...], alphabet: tuple[str, ...]) -> Dfa:
    """State k < |word|: the first k symbols match; the last two states accept and reject."""
    yes, no = len(word), len(word) + 1
    table = [
        state + 1 if symbol == expected else no
        for state, expected in enumerate(word)
        for symbol in range(len(alphabet))
    ]
    table += [yes] * len(alphabet) + [no] * len(alphabet)
    return Dfa(alphabet, tuple(table), tuple(state == yes for state in range(len(word) + 2)))


def _count(
    counted: Container[int], comparison: ir.Comparison, bound: int, alphabet: tuple[str, ...]
) -> Dfa:
    """State k: k counted symbols so far; the last state means more than ``bound``."""
    if bound >= STATE_LIMIT:
        raise AutomatonTooLargeError
    tests: dict[ir.Comparison, Callable[[int], bool]] = {
        "<=": lambda k: k <= bound,
        "<": lambda k: k < bound,
        ">=": lambda k: k >= bound,
        ">": lambda k: k > bound,
        "==": lambda k: k == bound,
    }
    last = max(bound, -1) + 1
    table = tuple(
        min(state + (symbol in counted), last)
        for state in range(last + 1)
        for symbol in range(len(alphabet))
    )
    return Dfa(alphabet, table, tuple(map(tests[comparison], range(last + 1))))


def at_most(alphabet: tuple[str, ...], symbols: Container[str], bound: int) -> Dfa:
    """The words with at most ``bound`` occurrences of ``symbols`` in total."""
    counted = frozenset(i for i, name in enumerate(alphabet) if name in symbols)
    return minimal(_count(counted, "<=", bound, alphabet))


# --- Regular expressions -----------------------------------------------------------------------


def _thompson(regex: ir.Regex, alphabet: tuple[str, ...]) -> Nfa:
    """Thompson's automaton; state 0 is initial, state 1 final."""
    moves: list[tuple[int, int | None, int]] = []
    size = 2
    todo: list[tuple[ir.Regex, int, int]] = [(regex, 0, 1)]
    while todo:
        node, source, target = todo.pop()
        match node:
            case ir.RSymbol(name):
                moves.append((source, _codes((name,), alphabet)[0], target))
            case ir.REmpty():
                moves.append((source, None, target))
            case ir.RSequence(parts):
                for part in parts:
                    todo.append((part, source, size))
                    source, size = size, size + 1
                moves.append((source, None, target))
            case ir.RChoice(parts):
                todo += [(part, source, target) for part in parts]
            case ir.RRepeat(part, mark):
                inner, outer = size, size + 1
                size += 2
                todo.append((part, inner, outer))
                moves += [(source, None, inner), (outer, None, target)]
                if mark in "*+":
                    moves.append((outer, None, inner))
                if mark in "*?":
                    moves.append((source, None, target))
            case _:
                assert_never(node)
    return Nfa(alphabet, size, tuple(moves), (0,), frozenset((1,)))

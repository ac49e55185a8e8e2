"""Words by the sum of the weights of their symbols: enumerated, and accepted up to a bound."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heapify, heappop, heappush
from math import ceil, floor, lcm
from typing import TypeAlias

from compiler.time_limits.time_limit import check_time
from compiler.words.finite_automaton import STATE_LIMIT, AutomatonTooLargeError, Dfa, minimal
from compiler.words.intersection import BinaryGrammar, RightSide
from compiler.words.language import Language


def _scaled(
    alphabet: Sequence[str], weights: Mapping[str, Fraction]
) -> tuple[tuple[int, ...], int]:
    """The weights of the symbols as integers, and the factor that they were multiplied by."""
    negative = [name for name, weight in weights.items() if weight < 0]
    if negative:
        raise ValueError(f"the weight of `{negative[0]}` is negative")
    exact = [Fraction(weights.get(name, 0)) for name in alphabet]
    scale = lcm(*(weight.denominator for weight in exact))
    return tuple(int(weight * scale) for weight in exact), scale


# --- The words of a language by weight, each once, lazily -----------------------------------------
#
# The words of every nonterminal are a sorted list that grows on demand (Jimenez & Marzal,
# *Computing the k shortest paths*, WAE 1999; Huang & Chiang, *Better k-best parsing*, IWPT 2005,
# algorithm 3).  The first word of each comes from Knuth's generalisation of shortest paths, *Inf.
# Proc. Lett.* 6 (1977).  Both need an order of words that concatenation preserves.


_Key: TypeAlias = tuple[int, int, tuple[int, ...]]
"""The weight, the length and the symbols of a word, compared in this order."""
_Choice: TypeAlias = tuple[RightSide, tuple[int, ...]]
"""A right side, and for each of its symbols the position of a word in the list of that symbol."""


def words_by_weight(
    language: Language, weights: Mapping[str, Fraction], *, max_modules: int | None = None
) -> Iterator[tuple[Fraction, tuple[str, ...]]]:
    """The words of a language by the sum of the weights of their symbols, each once, lazily.

    Words of equal weight are ordered by length and then by the order of the symbols.  If weightless
    symbols can repeat without bound, there may be infinitely many words of one weight, and heavier
    words are never reached.

    Args:
        language: the language.
        weights: the weights of symbols, none negative; symbols that are not named weigh 0.
        max_modules: the greatest number of modules; None: no bound.

    Raises:
        ValueError: immediately, if a weight is negative.
    """
    scaled, scale = _scaled(language.srg.terminals, weights)
    return _in_order(language, scaled, scale, max_modules)


def _in_order(
    language: Language, weights: tuple[int, ...], scale: int, max_modules: int | None
) -> Iterator[tuple[Fraction, tuple[str, ...]]]:
    grammar = language.restricted(max_modules)
    if grammar.empty_word:
        yield Fraction(0), ()
    for weight, _, word in _RankedWords(grammar, weights).words():
        yield Fraction(weight, scale), language.srg.decode(word)


@dataclass(slots=True)
class _Ranked:
    """The first words of a symbol in order, and the choices that the next word is among.

    The words of all other choices come after that of a choice in ``heap`` or ``waiting``.
    """

    waiting: list[_Choice]
    heap: list[tuple[_Key, _Choice]] = field(default_factory=list)
    found: list[_Key] = field(default_factory=list)
    complete: bool = False

    def advance(self) -> bool:
        """Take the least choice of the heap; return whether that ends the search for a word."""
        if not self.heap:
            self.complete = True
            return True
        key, (right, ranks) = heappop(self.heap)
        # Each choice is reached in one way: the last rank grows first, the first while the last is
        # 0.
        self.waiting.append((right, (*ranks[:-1], ranks[-1] + 1)))
        if len(ranks) == 2 and not ranks[1]:
            self.waiting.append((right, (ranks[0] + 1, 0)))
        if key == self.found[-1]:  # another derivation of the same word
            return False
        self.found.append(key)
        return True


class _RankedWords:
    """The non-empty words of a grammar in order; a terminal is a word of one symbol."""

    def __init__(self, grammar: BinaryGrammar, weights: Sequence[int]) -> None:
        # The last nonterminal derives what the start symbols derive.
        rules = (*grammar.rules, tuple((start,) for start in grammar.starts))
        self._ranked = [_Ranked([]) for _ in range(grammar.terminals)]
        self._ranked += [
            _Ranked([(right, (0,) * len(right)) for right in rights]) for rights in rules
        ]
        self._find_first(weights)

    def words(self) -> Iterator[_Key]:
        """All words in order."""
        start = len(self._ranked) - 1
        ranked = self._ranked[start]
        while not ranked.complete:
            yield ranked.found[-1]
            self._extend(start)

    def _find_first(self, weights: Sequence[int]) -> None:
        """Find the first word of every symbol; a symbol without words is complete."""
        users: list[list[tuple[int, RightSide]]] = [[] for _ in self._ranked]
        for left, ranked in enumerate(self._ranked):
            for right, _ in ranked.waiting:
                for symbol in dict.fromkeys(right):
                    users[symbol].append((left, right))
        heap: list[tuple[_Key, int]] = [((w, 1, (t,)), t) for t, w in enumerate(weights)]
        heapify(heap)
        while heap:
            check_time()
            key, symbol = heappop(heap)
            if self._ranked[symbol].found:
                continue
            self._ranked[symbol].found.append(key)
            for left, right in users[symbol]:
                if not self._ranked[left].found:
                    found = self._key(right, (0,) * len(right))
                    if found is not None:
                        heappush(heap, (found, left))
        for ranked in self._ranked:
            ranked.complete = not ranked.found

    def _extend(self, symbol: int) -> None:
        """Find the next word of a symbol, or that there is none.

        That may need the next word of a part of the last word, and so on.  The last words of the
        symbols on the stack become smaller, so no symbol is on it twice.
        """
        stack = [symbol]
        while stack:
            check_time()
            ranked = self._ranked[stack[-1]]
            missing = self._enter(ranked)
            if missing is not None:
                stack.append(missing)
            elif ranked.advance():
                stack.pop()

    def _enter(self, ranked: _Ranked) -> int | None:
        """Move the waiting choices to the heap, until one needs a further word of some symbol."""
        while ranked.waiting:
            check_time()
            choice = ranked.waiting[-1]
            for symbol, rank in zip(*choice, strict=True):
                part = self._ranked[symbol]
                if rank == len(part.found) and not part.complete:
                    return symbol
            ranked.waiting.pop()
            key = self._key(*choice)
            if key is not None:
                heappush(ranked.heap, (key, choice))
        return None

    def _key(self, right: RightSide, ranks: tuple[int, ...]) -> _Key | None:
        """The word of a choice; None if a symbol has no word at that position."""
        weight, length = 0, 0
        word: tuple[int, ...] = ()
        for symbol, rank in zip(right, ranks, strict=True):
            found = self._ranked[symbol].found
            if rank >= len(found):
                return None
            part = found[rank]
            weight, length, word = weight + part[0], length + part[1], word + part[2]
        return weight, length, word


# --- The words up to a weight ---------------------------------------------------------------------


def weight_at_most(
    alphabet: tuple[str, ...],
    weights: Mapping[str, Fraction],
    bound: Fraction,
    *,
    strict: bool = False,
    inside: Dfa | None = None,
) -> Dfa:
    """The minimal automaton of the words whose weight is at most the bound (``strict``: below it).

    Args:
        alphabet: the symbols.
        weights: the weights of symbols, none negative; symbols that are not named weigh 0.
        bound: the bound on the sum of the weights.
        strict: whether the sum must be below the bound.
        inside: an automaton that must accept the words as well; sums without such words get no
            state.

    Raises:
        ValueError: a weight is negative.
        AutomatonTooLargeError: with a state for each sum up to the bound, there are more than
            ``STATE_LIMIT`` states.
    """
    scaled, scale = _scaled(alphabet, weights)
    most = ceil(bound * scale) - 1 if strict else floor(bound * scale)
    asked = Dfa(alphabet, (0,) * len(alphabet), (True,)) if inside is None else inside
    live = asked.live()
    if most < 0 or not live[0]:
        return Dfa(alphabet, (0,) * len(alphabet), (False,))
    reached = [(0, 0)]
    number = {(0, 0): 0}
    table: list[int | None] = []
    for state, total in reached:
        check_time()
        for symbol, weight in enumerate(scaled):
            after = asked.step(state, symbol), total + weight
            if live[after[0]] and after[1] <= most and after not in number:
                if len(reached) + 1 == STATE_LIMIT:  # all other words have one state
                    raise AutomatonTooLargeError
                number[after] = len(reached)
                reached.append(after)
            table.append(number.get(after))
    dead = len(reached)
    moves = [dead if target is None else target for target in table] + [dead] * len(alphabet)
    accepting = (*(asked.accepting[state] for state, _ in reached), False)
    return minimal(Dfa(alphabet, tuple(moves), accepting))

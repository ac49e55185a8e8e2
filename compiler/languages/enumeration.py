"""The words of a language in length-lexicographic order, each once, lazily."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count

from compiler.reading.reading import Reading, State

FIRST_HORIZON = 32


def words_in_order(
    reading_up_to: Callable[[int], Reading[State]], longest: int | None
) -> Iterator[tuple[int, ...]]:
    """All words of at most ``longest`` symbols (None: all), by length, then by the symbols' order.

    Args:
        reading_up_to: makes a reading with the horizon asked for; longer words need a larger one.
        longest: the greatest length; for a finite language at most that of its longest word, for
            the search does not see an end by itself.
    """
    reading = reading_up_to(FIRST_HORIZON if longest is None else min(longest, FIRST_HORIZON))
    for length in count():
        if longest is not None and length > longest:
            return
        if length > reading.horizon:
            horizon = 2 * reading.horizon
            reading = reading_up_to(horizon if longest is None else min(longest, horizon))
        yield from words_of_length(reading, length)


def words_of_length(reading: Reading[State], length: int) -> Iterator[tuple[int, ...]]:
    """The words of one length in lexicographic order, by depth-first search without dead ends."""
    if not reading.lengths(reading.root) >> length & 1:
        return
    word: list[int] = []
    if length == 0:
        yield ()
        return
    moves, lengths = reading.moves, reading.lengths
    choices = [iter(moves(reading.root))]
    rest = length - 1
    while choices:
        for symbol, following in choices[-1]:
            if lengths(following) >> rest & 1:
                word.append(symbol)
                if rest:
                    choices.append(iter(moves(following)))
                    rest -= 1
                    break
                yield tuple(word)
                word.pop()
        else:
            choices.pop()
            del word[-1:]
            rest += 1

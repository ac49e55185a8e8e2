"""The words of a language in length-lexicographic order, each once, lazily."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from compiler.time_limits.time_limit import check_time
from compiler.words.budget import LENGTH_LIMIT, WordsTooLongError
from compiler.words.recogniser import Recogniser, State

FIRST_HORIZON = 32


def words_in_order(
    recogniser_up_to: Callable[[int], Recogniser[State]],
    first: int,
    longest: int | None,
    last: Callable[[], int | None],
) -> Iterator[tuple[int, ...]]:
    """All words, by length and then by the order of the symbols.

    Args:
        recogniser_up_to: makes one with the horizon asked for; longer words need a larger one.
        first: no word is shorter.
        longest: no longer ones are asked for, or there are none; None: not known.
        last: asked once, where there is no word of some length: the length of the longest word,
            less than ``first`` for an empty language; None: there are infinitely many.

    Raises:
        WordsTooLongError: it comes to words of more than ``LENGTH_LIMIT`` symbols.
    """
    asked = longest is not None
    horizon = max(FIRST_HORIZON, first)
    recogniser = None
    dead: set[tuple[State, int]] = set()
    length = first
    while longest is None or length <= longest:
        check_time()
        if length > LENGTH_LIMIT:
            raise WordsTooLongError
        if recogniser is None or length > recogniser.horizon:
            horizon = horizon if recogniser is None else 2 * recogniser.horizon
            recogniser = recogniser_up_to(horizon if longest is None else min(longest, horizon))
            dead = set()
        found = False
        for word in words_of_length(recogniser, length, dead):
            found = True
            yield word
        if not found and not asked:
            asked, longest = True, last()
        length += 1


def words_of_length(
    recogniser: Recogniser[State], length: int, dead: set[tuple[State, int]] | None = None
) -> Iterator[tuple[int, ...]]:
    """The words of one length in lexicographic order, by depth-first search.

    ``dead`` remembers states from which no word of some length follows, though their lengths have
    it: no such dead end is entered twice.
    """
    if length and recogniser.lengths(recogniser.root) >> length & 1:
        yield from _search(recogniser, length, set() if dead is None else dead)
    elif length == 0 and recogniser.accepting(recogniser.root):
        yield ()


def _search(
    recogniser: Recogniser[State], length: int, dead: set[tuple[State, int]]
) -> Iterator[tuple[int, ...]]:
    moves, lengths, accepting = recogniser.moves, recogniser.lengths, recogniser.accepting
    word: list[int] = []
    path = [recogniser.root]
    choices = [iter(moves(recogniser.root))]
    # The length of the path at the last word, to tell dead ends from what has been listed.
    fruitful = 0
    rest = length - 1
    while choices:
        check_time()
        for symbol, following in choices[-1]:
            if not lengths(following) >> rest & 1:
                continue
            if rest:
                if (following, rest) in dead:
                    continue
                word.append(symbol)
                path.append(following)
                choices.append(iter(moves(following)))
                rest -= 1
                break
            if accepting(following):
                fruitful = len(path)
                yield (*word, symbol)
        else:
            rest += 1
            if fruitful < len(path):
                dead.add((path[-1], rest))
            fruitful = min(fruitful, len(path) - 1)
            choices.pop()
            path.pop()
            del word[-1:]

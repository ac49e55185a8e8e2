"""The words of a language: enumerated in order, and counted by length."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from operator import mul

from compiler.time_limits.time_limit import check_time
from compiler.words.budget import LENGTH_LIMIT, MOVE_BUDGET, BudgetExceededError, WordsTooLongError
from compiler.words.intersection import BinaryGrammar, RightSide
from compiler.words.recogniser import Recogniser, State

# --- The words of a language in length-lexicographic order, each once, lazily ---------------------


FIRST_HORIZON = 32


def words_in_order(
    recogniser_up_to: Callable[[int], Recogniser[State]],
    first: int,
    longest: int | None,
    last: Callable[[], int | None],
) -> Iterator[tuple[int, ...]]:
    """All words, by length and then by the order of the symbols.

    Args:
        recogniser_up_to: makes a recogniser with a given horizon; longer words need a larger one.
        first: a lower bound on the length of all words.
        longest: the greatest length wanted, or a bound on the length of all words; None if unknown.
        last: called once, when some length has no word.  It returns the length of the longest word,
            less than ``first`` for an empty language, or None if there are infinitely many words.

    Raises:
        WordsTooLongError: the enumeration reaches words of more than ``LENGTH_LIMIT`` symbols.
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

    ``dead`` records states that allow a length but have no word of that length, so that no dead end
    is entered twice.
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
    # The length of the path at the last word, to distinguish dead ends from finished branches.
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


# --- The number of derivations of a grammar in binary normal form, by length ----------------------
#
# For an unambiguous grammar this is the number of words, in polynomial time.  A number below it
# stands for one word, so a uniformly random number gives a uniformly random word (Hickey & Cohen
# 1983, *Uniform random generation of strings in a context-free language*).


SPARSE = 4
"""If fewer than one in this many lengths has words, only those lengths are visited."""


PRODUCT_BUDGET = 100_000_000
"""The most products of two numbers that are computed."""


class DerivationCounts:
    """``of(symbol)[n]`` is the number of derivations of words of n symbols, n up to ``longest``.

    Raises:
        BudgetExceededError: ``PRODUCT_BUDGET`` does not suffice.
    """

    def __init__(self, grammar: BinaryGrammar, longest: int) -> None:
        self.grammar = grammar
        self.longest = longest
        self._products = 0
        self._terminal = [0, 1][: longest + 1] + [0] * (longest - 1)
        self._rows: list[list[int]] = [[0] for _ in grammar.rules]
        # For each nonterminal, the lengths of its words, which are often few.
        self._lengths: list[list[int]] = [[] for _ in grammar.rules]
        for length in range(1, longest + 1):
            found = [sum(self._ways(side, length) for side in rights) for rights in grammar.rules]
            for row, lengths, number in zip(self._rows, self._lengths, found, strict=True):
                row.append(number)
                if number:
                    lengths.append(length)
            if self._products > PRODUCT_BUDGET:
                raise BudgetExceededError("counting derivations", PRODUCT_BUDGET, "of long words")

    def of(self, symbol: int) -> list[int]:
        """The numbers of derivations of a symbol, by length."""
        first = self.grammar.terminals
        return self._terminal if symbol < first else self._rows[symbol - first]

    def total(self, length: int) -> int:
        """The number of derivations of words of that length."""
        empty = int(self.grammar.empty_word and length == 0)
        return empty + sum(self.of(start)[length] for start in self.grammar.starts)

    def word(self, length: int, index: int) -> tuple[int, ...]:
        """The word of derivation number ``index``, below ``total(length)``, in a fixed order."""
        if length == 0:
            return ()
        word: list[int] = []
        symbol, index = self._start(length, index)
        todo = [(symbol, length, index)]
        while todo:
            symbol, size, index = todo.pop()
            if symbol < self.grammar.terminals:
                word.append(symbol)
                continue
            side, cut, index = self._choice(symbol, size, index)
            if len(side) == 1:
                todo.append((side[0], 1, 0))
                continue
            right = self.of(side[1])[size - cut]
            todo.append((side[1], size - cut, index % right))
            todo.append((side[0], cut, index // right))
        return tuple(word)

    def _ways(self, side: RightSide, length: int) -> int:
        """The derivations of one length that begin with this right side, from the shorter ones."""
        first = self.grammar.terminals
        if len(side) == 1:
            return int(length == 1)
        left, right = side
        if left < first:
            return self.of(right)[length - 1]
        if right < first:
            return self.of(left)[length - 1]
        ways, more = self.of(left), self.of(right)
        some = min(self._lengths[left - first], self._lengths[right - first], key=len)
        self._products += len(some)
        if some is self._lengths[right - first]:
            ways, more = more, ways
        if len(some) * SPARSE < length:
            return sum(ways[cut] * more[length - cut] for cut in some if cut < length)
        return sum(map(mul, ways[1:length], more[length - 1 : 0 : -1]))

    def _start(self, length: int, index: int) -> tuple[int, int]:
        for start in self.grammar.starts:
            number = self.of(start)[length]
            if index < number:
                return start, index
            index -= number
        raise IndexError("there are not so many derivations")

    def _choice(self, symbol: int, length: int, index: int) -> tuple[RightSide, int, int]:
        """The right side, where it is split in two, and the remaining index."""
        for side in self.grammar.rules[symbol - self.grammar.terminals]:
            if len(side) == 1:
                if length == 1 and index == 0:
                    return side, 0, 0
                index -= int(length == 1)
                continue
            left, right = self.of(side[0]), self.of(side[1])
            for cut in range(1, length):
                number = left[cut] * right[length - cut]
                if index < number:
                    return side, cut, index
                index -= number
        raise IndexError("there are not so many derivations")


# --- Words counted by their prefixes, each once, however many derivations it has ------------------
#
# Prefixes of one length are grouped by the state that they lead to.  An automaton has a bounded
# number of states; for an ambiguous grammar there may be exponentially many, hence the budget.


QUESTION = "counting the words"
REASON = (
    "they are counted prefix by prefix, for the grammar is not known to be regular or "
    "unambiguous (LR(1))"
)


def count_by_length(
    recogniser: Recogniser[State], longest: int, budget: int | None = MOVE_BUDGET
) -> tuple[int, ...]:
    """The number of words of each length from 0 to ``longest``, at most the recogniser's horizon.

    Raises:
        BudgetExceededError: more than ``budget`` moves are needed; None means no bound.
    """
    level = {recogniser.root: 1} if recogniser.lengths(recogniser.root) else {}
    counts: list[int] = []
    moves = 0
    for rest in range(longest, -1, -1):
        counts.append(sum(n for state, n in level.items() if recogniser.accepting(state)))
        if not rest:
            break
        mask = (1 << rest) - 1
        following: dict[State, int] = {}
        for state, number in level.items():
            check_time()
            for _, target in recogniser.moves(state):
                moves += 1
                if budget is not None and moves > budget:
                    raise BudgetExceededError(QUESTION, budget, REASON)
                if recogniser.lengths(target) & mask:
                    following[target] = following.get(target, 0) + number
        level = following
    return tuple(counts)


class WordsOfLength:
    """The ``number`` words of one length, numbered in lexicographic order.

    Raises:
        BudgetExceededError: more than ``budget`` moves are needed; None means no bound.
    """

    def __init__(
        self, recogniser: Recogniser[State], length: int, budget: int | None = MOVE_BUDGET
    ) -> None:
        self.length = length
        moves = 0
        place = {recogniser.root: 0} if recogniser.lengths(recogniser.root) >> length & 1 else {}
        self._moves: list[list[list[tuple[int, int]]]] = []
        for rest in range(length - 1, -1, -1):
            following: dict[State, int] = {}
            rows: list[list[tuple[int, int]]] = []
            for state in place:
                row: list[tuple[int, int]] = []
                for symbol, target in recogniser.moves(state):
                    moves += 1
                    if budget is not None and moves > budget:
                        raise BudgetExceededError(QUESTION, budget, REASON)
                    if recogniser.lengths(target) >> rest & 1:
                        row.append((symbol, following.setdefault(target, len(following))))
                rows.append(row)
            self._moves.append(rows)
            place = following
        self._ways = [[1] * len(place)]
        for rows in reversed(self._moves):
            below = self._ways[-1]
            self._ways.append([sum(below[target] for _, target in row) for row in rows])
        self._ways.reverse()
        self.number = sum(self._ways[0])

    def word(self, index: int) -> tuple[int, ...]:
        """The word with that number, from 0.

        Raises:
            IndexError: there are fewer words.
        """
        if not 0 <= index < self.number:
            raise IndexError(f"there are {self.number} words of length {self.length}")
        word: list[int] = []
        state = 0
        for rows, ways in zip(self._moves, self._ways[1:], strict=True):
            for symbol, target in rows[state]:
                if index < ways[target]:
                    word.append(symbol)
                    state = target
                    break
                index -= ways[target]
        return tuple(word)

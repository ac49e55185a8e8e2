"""Finite automata: subset construction, Boolean operations, minimisation.

The subset construction is by Rabin and Scott (1959), Boolean operations use products, and
minimisation is by Hopcroft (1971).  The states of a minimal automaton are numbered in breadth-first
order by symbol, so equal languages give equal automata.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence, Sized
from dataclasses import dataclass

STATE_LIMIT = 100_000


class AutomatonTooLargeError(ValueError):
    """An automaton would have more than ``limit`` states."""

    def __init__(self, limit: int = STATE_LIMIT) -> None:
        super().__init__(f"the condition needs a finite automaton of over {limit} states")


@dataclass(frozen=True, slots=True)
class Dfa:
    """A complete deterministic automaton; the initial state is 0.

    ``table[state * len(alphabet) + symbol]`` is the next state, symbols counted from 0.
    """

    alphabet: tuple[str, ...]
    table: tuple[int, ...]
    accepting: tuple[bool, ...]

    @property
    def size(self) -> int:
        """The number of states."""
        return len(self.accepting)

    def step(self, state: int, symbol: int) -> int:
        """The state after reading one symbol, by number."""
        return self.table[state * len(self.alphabet) + symbol]

    def run(self, word: Iterable[str]) -> tuple[int, ...] | None:
        """The states visited, starting with the initial one; None if a token is not a symbol."""
        number = {name: i for i, name in enumerate(self.alphabet)}
        states = [0]
        for token in word:
            if token not in number:
                return None
            states.append(self.step(states[-1], number[token]))
        return tuple(states)

    def accepts(self, word: Iterable[str]) -> bool:
        """Whether the word is accepted; a word with an unknown token is not."""
        states = self.run(word)
        return states is not None and self.accepting[states[-1]]

    def live(self) -> tuple[bool, ...]:
        """For each state, whether an accepting state can be reached from it."""
        width = len(self.alphabet)
        before: list[list[int]] = [[] for _ in range(self.size)]
        for i, target in enumerate(self.table):
            before[target].append(i // width)
        alive = list(self.accepting)
        todo = [s for s in range(self.size) if alive[s]]
        while todo:
            for state in before[todo.pop()]:
                if not alive[state]:
                    alive[state] = True
                    todo.append(state)
        return tuple(alive)

    def longest(self) -> int | None:
        """The length of the longest word; None if there is no bound, -1 if there is no word."""
        live = self.live()
        if not live[0]:
            return -1
        width = len(self.alphabet)
        pending = [0] * self.size
        before: list[list[int]] = [[] for _ in range(self.size)]
        for i, target in enumerate(self.table):
            if live[target] and live[i // width]:
                pending[i // width] += 1
                before[target].append(i // width)
        # Backwards from states without live successors; states on a cycle are never reached.
        todo = [s for s in range(self.size) if live[s] and not pending[s]]
        length = [0] * self.size
        settled = 0
        while todo:
            state = todo.pop()
            settled += 1
            for source in before[state]:
                length[source] = max(length[source], length[state] + 1)
                pending[source] -= 1
                if not pending[source]:
                    todo.append(source)
        return length[0] if settled == sum(live) else None


@dataclass(frozen=True, slots=True)
class Nfa:
    """A nondeterministic automaton with empty moves.

    ``moves`` are (state, symbol number or None for an empty move, state).
    """

    alphabet: tuple[str, ...]
    size: int
    moves: tuple[tuple[int, int | None, int], ...]
    initial: tuple[int, ...]
    final: frozenset[int]


def determinise(nfa: Nfa, limit: int = STATE_LIMIT) -> Dfa:
    """The subset construction.

    Raises:
        AutomatonTooLargeError: there are more than ``limit`` states.
    """
    width = len(nfa.alphabet)
    empty: list[list[int]] = [[] for _ in range(nfa.size)]
    reading: list[list[tuple[int, int]]] = [[] for _ in range(nfa.size)]
    for source, symbol, target in nfa.moves:
        if symbol is None:
            empty[source].append(target)
        else:
            reading[source].append((symbol, target))
    subsets = [_closure(nfa.initial, empty)]
    number = {subsets[0]: 0}
    table: list[int] = []
    for subset in subsets:
        reached: list[set[int]] = [set() for _ in range(width)]
        for state in subset:
            for symbol, target in reading[state]:
                reached[symbol].add(target)
        for targets in reached:
            image = _closure(targets, empty)
            if image not in number:
                number[image] = _next_number(subsets, limit)
                subsets.append(image)
            table.append(number[image])
    return Dfa(nfa.alphabet, tuple(table), tuple(not nfa.final.isdisjoint(s) for s in subsets))


def _closure(states: Iterable[int], empty: Sequence[Sequence[int]]) -> frozenset[int]:
    """The states reached by empty moves."""
    found = set(states)
    todo = list(found)
    while todo:
        for target in empty[todo.pop()]:
            if target not in found:
                found.add(target)
                todo.append(target)
    return frozenset(found)


def _next_number(states: Sized, limit: int = STATE_LIMIT) -> int:
    if len(states) >= limit:
        raise AutomatonTooLargeError(limit)
    return len(states)


# --- Boolean operations ------------------------------------------------------------------------


def complement(dfa: Dfa) -> Dfa:
    """The words that are not accepted; minimal if ``dfa`` is."""
    return Dfa(dfa.alphabet, dfa.table, tuple(not a for a in dfa.accepting))


def intersection(left: Dfa, right: Dfa) -> Dfa:
    """The words that both accept; minimal."""
    return _product(left, right, lambda a, b: a and b)


def union(left: Dfa, right: Dfa) -> Dfa:
    """The words that at least one of both accepts; minimal."""
    return _product(left, right, lambda a, b: a or b)


def _product(left: Dfa, right: Dfa, combine: Callable[[bool, bool], bool]) -> Dfa:
    if left.alphabet != right.alphabet:
        raise ValueError("product of automata over different alphabets")
    pairs = [(0, 0)]
    number = {(0, 0): 0}
    table: list[int] = []
    for p, q in pairs:
        for symbol in range(len(left.alphabet)):
            pair = (left.step(p, symbol), right.step(q, symbol))
            if pair not in number:
                number[pair] = _next_number(pairs)
                pairs.append(pair)
            table.append(number[pair])
    marks = tuple(combine(left.accepting[p], right.accepting[q]) for p, q in pairs)
    return minimal(Dfa(left.alphabet, tuple(table), marks))


# --- Minimisation ------------------------------------------------------------------------------


def minimal(dfa: Dfa) -> Dfa:
    """The minimal complete automaton, numbered in breadth-first order by symbol."""
    block = _equivalence(dfa)
    width = len(dfa.alphabet)
    order = [0]
    number = {block[0]: 0}
    table: list[int] = []
    for state in order:
        for symbol in range(width):
            target = dfa.step(state, symbol)
            if block[target] not in number:
                number[block[target]] = len(order)
                order.append(target)
            table.append(number[block[target]])
    return Dfa(dfa.alphabet, tuple(table), tuple(dfa.accepting[state] for state in order))


def _equivalence(dfa: Dfa) -> list[int]:
    """For each state, the number of its class of equivalent states (Hopcroft 1971)."""
    width = len(dfa.alphabet)
    before: list[list[list[int]]] = [[[] for _ in range(dfa.size)] for _ in range(width)]
    for i, target in enumerate(dfa.table):
        before[i % width][target].append(i // width)
    halves = (
        {s for s in range(dfa.size) if dfa.accepting[s]},
        {s for s in range(dfa.size) if not dfa.accepting[s]},
    )
    blocks = [half for half in halves if half]
    block = [0] * dfa.size
    for b, members in enumerate(blocks):
        for state in members:
            block[state] = b
    todo = {(b, symbol) for b in range(len(blocks)) for symbol in range(width)}
    while todo:
        splitter, symbol = todo.pop()
        touched: dict[int, set[int]] = {}
        for state in blocks[splitter]:
            for source in before[symbol][state]:
                touched.setdefault(block[source], set()).add(source)
        for b, inside in touched.items():
            if len(inside) < len(blocks[b]):
                _split(blocks, block, b, inside, todo, width)
    return block


def _split(
    blocks: list[set[int]],
    block: list[int],
    b: int,
    inside: set[int],
    todo: set[tuple[int, int]],
    width: int,
) -> None:
    """Split block ``b`` into ``inside`` and the rest; the smaller part becomes a new block."""
    outside_size = len(blocks[b]) - len(inside)
    smaller = inside if len(inside) <= outside_size else blocks[b] - inside
    blocks[b] -= smaller
    new = len(blocks)
    blocks.append(smaller)
    for state in smaller:
        block[state] = new
    # If b is not pending, the smaller part suffices; if b is pending, it stays so.
    todo.update((new, symbol) for symbol in range(width))

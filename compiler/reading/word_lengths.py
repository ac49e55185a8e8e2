"""The lengths of words as bit sets: bit m is set where there is a word of length m."""

from __future__ import annotations

from compiler.grammars.binary_normal_form import BinaryGrammar

CACHE_LIMIT = 50_000


class WordLengths:
    """Exact up to ``horizon`` symbols; ``inside[k]`` are the lengths of nonterminal number k."""

    def __init__(self, grammar: BinaryGrammar, horizon: int) -> None:
        self.grammar = grammar
        self.horizon = horizon
        self.mask = (1 << (horizon + 1)) - 1
        self.inside = _inside(grammar, self.mask)
        self._sums: dict[tuple[int, int], int] = {}

    def before(self, symbol: int, lengths: int) -> int:
        """The lengths of a symbol followed by one of ``lengths``."""
        if symbol < self.grammar.terminals:
            return (lengths << 1) & self.mask
        key = (symbol, lengths)
        known = self._sums.get(key)
        if known is None:
            if len(self._sums) >= CACHE_LIMIT:
                self._sums.clear()
            inside = self.inside[symbol - self.grammar.terminals]
            known = self._sums[key] = sumset(inside, lengths) & self.mask
        return known


def _inside(grammar: BinaryGrammar, mask: int) -> list[int]:
    first, rules = grammar.terminals, grammar.rules
    inside = [0] * len(rules)
    users: list[dict[int, None]] = [{} for _ in rules]
    for k, rights in enumerate(rules):
        for right in rights:
            for symbol in right:
                if symbol >= first:
                    users[symbol - first][k] = None
    todo = dict.fromkeys(range(len(rules)))
    while todo:
        k = next(iter(todo))
        del todo[k]
        bits = 0
        for right in rules[k]:
            parts = [2 if s < first else inside[s - first] for s in right]
            bits |= parts[0] if len(parts) == 1 else sumset(parts[0], parts[1])
        if bits & mask != inside[k]:
            inside[k] = bits & mask
            todo.update(users[k])
    return inside


def sumset(left: int, right: int) -> int:
    """All sums of an element of one bit set and one of the other."""
    if left.bit_count() > right.bit_count():
        left, right = right, left
    result = 0
    while left:
        low = left & -left
        result |= right << (low.bit_length() - 1)
        left ^= low
    return result

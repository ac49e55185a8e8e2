"""The short words of a grammar with the number of their derivations, by dynamic programming.

Words of a nonterminal are put together from the shorter words of the symbols of its right sides,
length by length (the inside algorithm of Baker 1979, over sets of words).  As many lengths are
covered as a budget of steps allows; a step puts one word together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from compiler.grammars.grammar import Cfg, Rule, components, nullable

# A word is a text with the character of code s for symbol s: quick to join and to hash.
Row: TypeAlias = dict[str, int]
Table: TypeAlias = list[Row]


@dataclass(frozen=True, slots=True)
class ShortWords:
    """All words of at most ``length`` symbols, each with the number of its derivations."""

    length: int
    derivations: dict[tuple[int, ...], int]


def short_words(cfg: Cfg, step_limit: int, longest: int) -> ShortWords:
    """The words of a trimmed grammar without cycles, in order of length, then of symbols.

    Args:
        cfg: the grammar.
        step_limit: the most steps; the covered length is the largest that they suffice for.
        longest: no words of more symbols are looked for.
    """
    tables = _Tables(cfg, step_limit)
    length = -1
    while length < longest and tables.extend():
        length += 1
    found: dict[tuple[int, ...], int] = {}
    for row in tables.of(cfg.start)[: length + 1]:
        for word in sorted(row):
            found[tuple(map(ord, word))] = row[word]
    return ShortWords(length, found)


class _Tables:
    """``words[k][n]``: the words of length n of nonterminal k.

    ``heads[r][i][n]``: those of the first i + 1 symbols of rule r.  A head is made only as long as
    the least length of what follows in its rule leaves room for.
    """

    def __init__(self, cfg: Cfg, steps: int) -> None:
        self.cfg = cfg
        self.steps = steps
        self.least = _least_lengths(cfg)
        self.words: list[Table] = [[] for _ in range(cfg.nonterminals)]
        self.terminals: list[Table] = [[{}, {chr(s): 1}] for s in range(cfg.terminals)]
        rank = _ranks(cfg)
        self.order = sorted(
            range(len(cfg.rules)), key=lambda r: rank[cfg.rules[r].left - cfg.terminals]
        )
        self.heads: list[list[Table]] = [[[] for _ in right] for _, right in cfg.rules]
        self.room = [_room(rule, self.least) for rule in cfg.rules]
        self.length = 0

    def of(self, symbol: int) -> Table:
        first = self.cfg.terminals
        return self.terminals[symbol] if symbol < first else self.words[symbol - first]

    def extend(self) -> bool:
        """Make all tables one length longer; False where the steps do not suffice."""
        for table in self.words:
            table.append({})
        for r in self.order:
            for i in range(len(self.heads[r])):
                if self.length >= self.room[r][i]:
                    self.heads[r][i].append(self._next_row(r, i))
            if self.steps < 0:
                return False
            self._derive(r)
        self.length += 1
        return True

    def _derive(self, r: int) -> None:
        """Give the words of rule r that have the new length to its left side."""
        left, right = self.cfg.rules[r]
        target = self.words[left - self.cfg.terminals][self.length]
        row = self.heads[r][-1][self.length] if right else {"": 1} if self.length == 0 else {}
        self.steps -= len(row)
        for word, number in row.items():
            target[word] = target.get(word, 0) + number

    def _next_row(self, r: int, i: int) -> Row:
        """The words of the first i + 1 symbols of rule r that have the next length."""
        length = self.length - self.room[r][i]
        tail = self.of(self.cfg.rules[r].right[i])
        self.steps -= 1
        if i == 0:
            return tail[length] if length < len(tail) else {}
        head = self.heads[r][i - 1]
        row: Row = {}
        for n in range(max(0, length - len(tail) + 1), min(length + 1, len(head))):
            self.steps -= len(head[n]) * len(tail[length - n])
            if self.steps < 0:
                break
            for start, ways in head[n].items():
                for end, more in tail[length - n].items():
                    row[start + end] = row.get(start + end, 0) + ways * more
        return row


def _least_lengths(cfg: Cfg) -> tuple[int, ...]:
    """The length of the shortest word of every symbol, given that all rules are useful."""
    first = cfg.terminals
    unknown = -1
    least = [1] * first + [unknown] * cfg.nonterminals
    users: list[list[int]] = [[] for _ in range(first + cfg.nonterminals)]
    for r, (_, right) in enumerate(cfg.rules):
        for symbol in set(right):
            users[symbol].append(r)
    todo = list(range(len(cfg.rules)))
    while todo:
        left, right = cfg.rules[todo.pop()]
        if any(least[s] == unknown for s in right):
            continue
        length = sum(least[s] for s in right)
        if least[left] == unknown or length < least[left]:
            least[left] = length
            todo += users[left]
    return tuple(max(0, n) for n in least)


def _room(rule: Rule, least: tuple[int, ...]) -> tuple[int, ...]:
    """Per position of a right side, the least length of what comes after it."""
    after = [0]
    for symbol in reversed(rule.right[1:]):
        after.append(after[-1] + least[symbol])
    return tuple(reversed(after)) if rule.right else ()


def _ranks(cfg: Cfg) -> tuple[int, ...]:
    """Nonterminals ranked so that a word of one comes from words of equal length of lower ones."""
    empty, first = nullable(cfg), cfg.terminals
    below: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    for left, right in cfg.rules:
        solid = [symbol for symbol in right if symbol not in empty]
        if len(solid) <= 1:
            below[left - first] += [s - first for s in (solid or right) if s >= first]
    return components(cfg.nonterminals, below.__getitem__)

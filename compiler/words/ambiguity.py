"""Ambiguous words: words of a robot family that have several derivations."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import NamedTuple, TypeAlias

from compiler.words.grammar import Cfg, Rule, Srg, components, nullable, trimmed, useful_rules
from compiler.words.language import Language
from compiler.words.regular_ambiguity import Decision, decide_ambiguity
from compiler.words.regular_automaton import transition_network
from compiler.words.structures import structures
from grammar_lang import ir

# --- The short words of a grammar with the numbers of their derivations, by dynamic programming ---
#
# Words of a nonterminal are composed of the shorter words of the symbols on its right sides, length
# by length (the inside algorithm of Baker 1979, over sets of words).  A budget of steps limits the
# lengths covered; a step composes one word.


# A word is a text with the character of code s for symbol s: quick to join and to hash.
Row: TypeAlias = dict[str, int]
Table: TypeAlias = list[Row]


@dataclass(frozen=True, slots=True)
class ShortWords:
    """All words of at most ``length`` symbols, each with the number of its derivations."""

    length: int
    derivations: dict[tuple[int, ...], int]


def short_words(cfg: Cfg, step_limit: int, longest: int) -> ShortWords:
    """The words of a trimmed grammar without cycles, by length and then by symbols.

    Args:
        cfg: the grammar.
        step_limit: the most steps; they determine the greatest length covered.
        longest: longer words are not sought.
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
    """``words[k][n]`` are the words of length n of nonterminal k.

    ``heads[r][i][n]`` are those of the first i + 1 symbols of rule r.  A head is only made up to
    the length that leaves room for the shortest rest of its rule.
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
        """Extend all tables by one length; False if the steps do not suffice."""
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
        """Add the words of rule r of the new length to its left side."""
        left, right = self.cfg.rules[r]
        target = self.words[left - self.cfg.terminals][self.length]
        row = self.heads[r][-1][self.length] if right else {"": 1} if self.length == 0 else {}
        self.steps -= len(row)
        for word, number in row.items():
            target[word] = target.get(word, 0) + number

    def _next_row(self, r: int, i: int) -> Row:
        """The words of the next length of the first i + 1 symbols of rule r."""
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
    """The length of the shortest word of every symbol; all rules must be useful."""
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
    """For each position of a right side, the least length of what comes after it."""
    after = [0]
    for symbol in reversed(rule.right[1:]):
        after.append(after[-1] + least[symbol])
    return tuple(reversed(after)) if rule.right else ()


def _ranks(cfg: Cfg) -> tuple[int, ...]:
    """Ranks of nonterminals: words of one are made from words of equal length of lower ones."""
    empty, first = nullable(cfg), cfg.terminals
    below: list[list[int]] = [[] for _ in range(cfg.nonterminals)]
    for left, right in cfg.rules:
        solid = [symbol for symbol in right if symbol not in empty]
        if len(solid) <= 1:
            below[left - first] += [s - first for s in (solid or right) if s >= first]
    return components(cfg.nonterminals, below.__getitem__)


# --- Ambiguous words: words of a robot family that have several derivations -----------------------
#
# Ambiguity of a context-free grammar is undecidable (Cantor 1962; Floyd 1962).  For a grammar
# without self-embedding it is decided exactly, and an LR(1) grammar is unambiguous (Knuth 1965).
# For any other, all words up to some length are examined: the greatest length up to
# ``LENGTH_LIMIT`` for which the words of all nonterminals can be composed in ``STEP_LIMIT`` steps.
# If none of them is ambiguous, the first ``FIRST_DERIVATIONS`` derivations of accepted words with
# at most ``FIRST_MODULES`` modules are examined as well.


STEP_LIMIT = 6_000
LENGTH_LIMIT = 40
FIRST_DERIVATIONS = 64
FIRST_MODULES = 6


@dataclass(frozen=True, slots=True)
class Ambiguity:
    """Ambiguous words in order: by length, then by the order of the symbols.

    ``decided``: if no word is listed, none is ambiguous.
    """

    words: tuple[tuple[str, ...], ...]
    decided: bool


def ambiguity(language: Language, longest: int | None) -> Ambiguity:
    """The ambiguous words found within the bounds above.

    The empty word is not a robot and is ignored.

    Args:
        language: the language of a grammar that is not cyclic.
        longest: the length of its longest word; None if it is infinite.
    """
    cfg = trimmed(language.srg.cfg)
    network = transition_network(cfg)
    decision = None if network is None else decide_ambiguity(network, language.accept)
    if decision == Decision(None) or (decision is None and language.is_lr):
        return Ambiguity((), decided=True)
    found, complete = _short(language, cfg, longest)
    if decision is not None and decision.word is not None and decision.word not in found:
        found.insert(0, decision.word)
    words = tuple(map(language.srg.decode, found))
    return Ambiguity(words, decided=complete or decision is not None)


def _short(language: Language, cfg: Cfg, longest: int | None) -> tuple[list[tuple[int, ...]], bool]:
    """The short ambiguous words, and whether all words were examined."""
    most = LENGTH_LIMIT if longest is None else min(longest, LENGTH_LIMIT)
    listed = short_words(cfg, STEP_LIMIT, most)
    complete = listed.length == longest
    accepted = [word for word in listed.derivations if word and _accepts(language, word)]
    found = [word for word in accepted if listed.derivations[word] > 1]
    if not found and not complete and len(accepted) < FIRST_DERIVATIONS:
        found = _first(language)
    return found, complete


def _accepts(language: Language, word: tuple[int, ...]) -> bool:
    state = 0
    for symbol in word:
        state = language.accept.step(state, symbol)
    return language.accept.accepting[state]


def _first(language: Language) -> list[tuple[int, ...]]:
    """The ambiguous words among the first derivations, which are sorted by word."""
    first = islice(structures(language, FIRST_MODULES), FIRST_DERIVATIONS)
    twice = dict.fromkeys(b.word for a, b in pairwise(first) if a.word == b.word)
    return [codes for word in twice if (codes := language.srg.encode(word)) is not None]


# --- Cycles of unit and empty productions: derivations A =>+ A, step by step ----------------------
#
# A production may replace a nonterminal by another one alone if all its other symbols derive the
# empty word (Hopcroft, Motwani & Ullman, section 7.1).


class _Step(NamedTuple):
    """Rule ``rule`` replaces ``source`` by ``target``; its other symbols derive the empty word."""

    rule: int
    source: int
    target: int


@dataclass(frozen=True, slots=True)
class ProductionCycle:
    """Productions that lead from a nonterminal back to the same nonterminal alone.

    ``nonterminals`` has one entry more than ``productions``: the last is the first again.
    """

    productions: tuple[ir.Production, ...]
    nonterminals: tuple[str, ...]

    @property
    def vanishing(self) -> tuple[str, ...]:
        """The other symbols on the right sides, which derive the empty word."""
        found: dict[str, None] = {}
        for production, target in zip(self.productions, self.nonterminals[1:], strict=True):
            names = [symbol.name for symbol in production.right]
            names.remove(target)
            found |= dict.fromkeys(names)
        return tuple(found)


def production_cycles(rules: Srg) -> tuple[ProductionCycle, ...]:
    """One cycle for each set of nonterminals that derive each other alone.

    It is a shortest cycle through the first production of the set that is on a cycle.
    """
    steps = _steps(rules)
    outgoing: list[list[_Step]] = [[] for _ in rules.nonterminals]
    for step in steps:
        outgoing[step.source].append(step)
    targets = [[step.target for step in row] for row in outgoing]
    component = components(len(targets), targets.__getitem__)
    found: dict[int, ProductionCycle] = {}
    for step in steps:
        own = component[step.source]
        if own == component[step.target] and own not in found:
            cycle = [step, *_way(step.target, step.source, outgoing)]
            found[own] = ProductionCycle(
                tuple(rules.productions[s.rule] for s in cycle),
                tuple(rules.nonterminals[n] for n in (step.source, *(s.target for s in cycle))),
            )
    return tuple(found.values())


def _steps(rules: Srg) -> list[_Step]:
    """The steps of useful productions, in declaration order."""
    cfg = rules.cfg
    useful = useful_rules(cfg)
    empty, first = nullable(cfg), cfg.terminals
    steps: list[_Step] = []
    for r in useful:
        left, right = cfg.rules[r]
        solid = [symbol for symbol in right if symbol not in empty]
        if len(solid) <= 1:
            alone = dict.fromkeys(solid or right)
            steps += [_Step(r, left - first, s - first) for s in alone if s >= first]
    return steps


def _way(source: int, target: int, outgoing: list[list[_Step]]) -> list[_Step]:
    """A shortest path from one nonterminal to another, which must exist (breadth first)."""
    arrived: dict[int, _Step | None] = {source: None}
    todo = deque([source])
    while target not in arrived:
        for step in outgoing[todo.popleft()]:
            if step.target not in arrived:
                arrived[step.target] = step
                todo.append(step.target)
    way: list[_Step] = []
    last = arrived[target]
    while last is not None:
        way.append(last)
        last = arrived[last.source]
    return way[::-1]

"""The derivations of all words of a grammar that a finite automaton accepts, as a finite graph.

A node of a derivation is identified by its nonterminal and by the states of the automaton before
and after its part of the word: Bar-Hillel, Perles & Shamir (1961), applied to the productions as
they are written. So the derivations in the graph are exactly the derivations of these words.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from compiler.time_limits.time_limit import check_time
from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import Cfg, rules_by_left

MOST_APPLICATIONS = 5_000
"""Larger graphs are not built."""


class TooManyDerivations(ValueError):
    """The graph would have more than ``MOST_APPLICATIONS`` applications."""


class Node(NamedTuple):
    """A nonterminal, and the states before and after the word that it derives."""

    nonterminal: int
    before: int
    after: int


@dataclass(frozen=True, slots=True)
class Application:
    """A production, by number, at a node; ``children`` are the nodes by position on the right."""

    rule: int
    node: Node
    children: tuple[tuple[int, Node], ...]


@dataclass(frozen=True, slots=True)
class ConditionedDerivations:
    """The applications that occur in some derivation, and the nodes at which derivations begin."""

    roots: tuple[Node, ...]
    applications: tuple[Application, ...]


def conditioned_derivations(cfg: Cfg, dfa: Dfa) -> ConditionedDerivations:
    """The derivations of the words of ``cfg`` that ``dfa``, over its terminals, accepts.

    Raises:
        TooManyDerivations: there are too many applications.
    """
    table = _Returns(cfg, dfa)
    table.call((cfg.start, 0))
    table.close()
    roots = tuple(
        Node(cfg.start, 0, after)
        for after in sorted(table.found[cfg.start, 0])
        if dfa.accepting[after]
    )
    waiting, known, applications = list(roots), set(roots), list[Application]()
    while waiting:
        check_time()
        node = waiting.pop()
        for application in table.applications(node):
            applications.append(application)
            if len(applications) > MOST_APPLICATIONS:
                raise TooManyDerivations
            for _, child in application.children:
                if child not in known:
                    known.add(child)
                    waiting.append(child)
    return ConditionedDerivations(roots, tuple(applications))


_Call: TypeAlias = tuple[int, int]
"""A nonterminal and the state in which reading it begins."""
_Part: TypeAlias = tuple[_Call, int, int, int]
"""Part of a call: a rule, how many of its symbols are read, and the state after them."""


@dataclass(slots=True)
class _Returns:
    """For each call the states that its nonterminal can return in."""

    cfg: Cfg
    dfa: Dfa
    found: dict[_Call, set[int]] = field(default_factory=dict[_Call, set[int]])
    waiting: dict[_Call, list[_Part]] = field(default_factory=dict[_Call, list[_Part]])
    todo: list[_Part] = field(default_factory=list[_Part])
    by_left: list[list[int]] = field(init=False)
    live: tuple[bool, ...] = field(init=False)

    def __post_init__(self) -> None:
        self.by_left = [list(rules) for rules in rules_by_left(self.cfg)]
        self.live = self.dfa.live()

    def call(self, call: _Call) -> None:
        """Begin to read a nonterminal in a state."""
        if call in self.found:
            return
        self.found[call], self.waiting[call] = set(), []
        rules = self.by_left[call[0] - self.cfg.terminals]
        self.todo += [(call, rule, 0, call[1]) for rule in rules]

    def close(self) -> None:
        """Follow all calls to their ends."""
        steps = 0
        while self.todo:
            steps += 1
            if steps > 50 * MOST_APPLICATIONS:
                raise TooManyDerivations
            call, rule, place, state = self.todo.pop()
            right = self.cfg.rules[rule].right
            if place == len(right):
                if state not in self.found[call]:
                    self.found[call].add(state)
                    self.todo += [(c, r, k, state) for c, r, k, _ in self.waiting[call]]
                continue
            symbol = right[place]
            if symbol < self.cfg.terminals:
                after = self.dfa.step(state, symbol)
                if self.live[after]:
                    self.todo.append((call, rule, place + 1, after))
                continue
            inner = (symbol, state)
            self.call(inner)
            self.waiting[inner].append((call, rule, place + 1, state))
            self.todo += [(call, rule, place + 1, after) for after in sorted(self.found[inner])]

    def applications(self, node: Node) -> Iterator[Application]:
        """The productions at a node, with all ways to divide its part of the word."""
        for rule in self.by_left[node.nonterminal - self.cfg.terminals]:
            right = self.cfg.rules[rule].right
            parts: list[tuple[int, tuple[tuple[int, Node], ...]]] = [(node.before, ())]
            for place, symbol in enumerate(right):
                parts = [
                    (after, (*children, *child))
                    for state, children in parts
                    for after, child in self._past(place, symbol, state)
                ]
                if len(parts) > MOST_APPLICATIONS:
                    raise TooManyDerivations
            for state, children in parts:
                if state == node.after:
                    yield Application(rule, node, children)

    def _past(
        self, place: int, symbol: int, state: int
    ) -> Iterator[tuple[int, tuple[tuple[int, Node], ...]]]:
        """The states after one symbol, with the symbol's node if it is a nonterminal."""
        if symbol < self.cfg.terminals:
            after = self.dfa.step(state, symbol)
            if self.live[after]:
                yield after, ()
            return
        for after in sorted(self.found.get((symbol, state), ())):
            yield after, ((place, Node(symbol, state, after)),)

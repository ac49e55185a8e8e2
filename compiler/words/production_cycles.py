"""Cycles of unit and empty productions: derivations A =>+ A, step by step.

A production may replace a nonterminal by another one alone where all its other symbols derive the
empty word (Hopcroft, Motwani & Ullman, section 7.1).
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

from compiler.words.grammar import Srg, components, nullable, useful_rules
from grammar_lang import ir


class _Step(NamedTuple):
    """Rule ``rule`` replaces ``source`` by ``target``, the rest of it deriving the empty word."""

    rule: int
    source: int
    target: int


@dataclass(frozen=True, slots=True)
class ProductionCycle:
    """Productions that lead from a nonterminal back to it alone.

    ``nonterminals`` has one entry more than ``productions``: the last is the first again.
    """

    productions: tuple[ir.Production, ...]
    nonterminals: tuple[str, ...]

    @property
    def vanishing(self) -> tuple[str, ...]:
        """What stands beside the nonterminals on the right sides and derives the empty word."""
        found: dict[str, None] = {}
        for production, target in zip(self.productions, self.nonterminals[1:], strict=True):
            names = [symbol.name for symbol in production.right]
            names.remove(target)
            found |= dict.fromkeys(names)
        return tuple(found)


def production_cycles(rules: Srg) -> tuple[ProductionCycle, ...]:
    """One cycle for each set of nonterminals that derive each other alone.

    A shortest one through the first of its productions that is on a cycle.
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
    """The steps of useful productions, in order of declaration."""
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
    """A shortest way from one nonterminal to another, which there is (breadth first)."""
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

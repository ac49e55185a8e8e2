"""Random sentences of a lark grammar, as lists of terminals, by expanding its rules."""

from __future__ import annotations

import math
import random
from collections import defaultdict

from lark import Lark
from lark.grammar import NonTerminal, Rule


class Sentences:
    """Sentences of a grammar; within a budget of expansions, then along the shortest way out."""

    def __init__(self, parser: Lark) -> None:
        self.rules: dict[str, list[Rule]] = defaultdict(list)
        for rule in parser.rules:
            self.rules[rule.origin.name].append(rule)
        self.depth: dict[str, float] = dict.fromkeys(self.rules, math.inf)
        changed = True
        while changed:
            changed = False
            for name, rules in self.rules.items():
                depth = min(map(self._depth, rules))
                changed |= depth < self.depth[name]
                self.depth[name] = depth

    def _depth(self, rule: Rule) -> float:
        inner = (self.depth[s.name] for s in rule.expansion if isinstance(s, NonTerminal))
        return 1 + max(inner, default=0)

    def draw(self, start: str, choose: random.Random, budget: int) -> list[str]:
        """The names of the terminals of one sentence of a nonterminal."""
        sentence, waiting = [], [NonTerminal(start)]
        while waiting:
            symbol = waiting.pop()
            if not isinstance(symbol, NonTerminal):
                sentence.append(symbol.name)
                continue
            rules = self.rules[symbol.name]
            budget -= 1
            rule = choose.choice(rules) if budget > 0 else min(rules, key=self._depth)
            waiting += reversed(rule.expansion)
        return sentence

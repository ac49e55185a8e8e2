"""The tables of the LALR(1) parser, read from ``tables.json``.

Source: A. V. Aho, M. S. Lam, R. Sethi, J. D. Ullman, *Compilers*, section 4.7.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

END = "$END"
RESERVED = ("and", "or", "not", "empty", "this", "world", "start", "accept", "x", "y", "z")


@dataclass(frozen=True, slots=True)
class Reduction:
    """A rule: it replaces ``size`` symbols by ``origin``, and its value is made from its parts.

    ``parts`` are the positions of the symbols kept (-1 for an absent optional one), each with
    whether it is a repetition, whose values are spliced in.  A ``transparent`` rule with one kept
    value has that value; without a ``builder`` the value is the list of the kept values.  A rule
    that ``passes`` only renames its one symbol.
    """

    origin: str
    size: int
    builder: str
    parts: tuple[tuple[int, bool], ...]
    transparent: bool
    passes: bool


@dataclass(frozen=True, slots=True)
class Tables:
    """``actions[s]`` maps terminals to next states, or to ``-1 - k`` for reduction by rule k."""

    end: int
    words: frozenset[str]
    rules: Sequence[Reduction]
    actions: Sequence[Mapping[str, int]]
    gotos: Sequence[Mapping[str, int]]

    def after(self, state: int, terminal: str) -> int | None:
        """The state after shifting a terminal in a state; None if it cannot be shifted."""
        action = self.actions[state].get(terminal, -1)
        return action if action >= 0 else None

    def shift(self, states: list[int], terminal: str) -> bool:
        """Shift a terminal onto a stack of states, after any reductions; False if it does not fit.

        The end is accepted but not shifted.
        """
        while (action := self.actions[states[-1]].get(terminal)) is not None:
            if action >= 0:
                states.append(action)
                return True
            rule = self.rules[-1 - action]
            del states[len(states) - rule.size :]
            states.append(self.gotos[states[-1]][rule.origin])
            if terminal == END and states[-1] == self.end:
                return True
        return False

    def accepts(self, states: Sequence[int], terminal: str) -> bool:
        """Whether a terminal can be shifted onto a stack of states, after any reductions."""
        return self.shift(list(states), terminal)

    def expected(self, states: Sequence[int]) -> frozenset[str]:
        """The terminals that may stand next."""
        return frozenset(t for t in self.actions[states[-1]] if self.accepts(states, t))


@cache
def tables() -> Tables:
    """The tables of the language."""
    content = json.loads(Path(__file__).with_name("tables.json").read_text(encoding="utf-8"))
    rules = [
        Reduction(
            rule["origin"],
            rule["size"],
            rule["builder"],
            tuple(zip(rule["keep"], rule["splice"], strict=True)),
            rule["transparent"],
            rule["transparent"] and rule["size"] == 1 and rule["splice"] == [False],
        )
        for rule in content["rules"]
    ]
    return Tables(
        content["end"], frozenset(content["words"]), rules, content["actions"], content["gotos"]
    )

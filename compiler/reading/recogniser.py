"""Membership, by the fastest automaton that reads the grammar exactly as it is.

A finite automaton where the form of the grammar shows that it is regular; else a deterministic
pushdown automaton where the grammar is LR(1), no conflict being resolved in favour of one reading;
else the residuals, which read any grammar.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

Kind: TypeAlias = Literal["finite automaton", "LR(1)", "general"]


class Reader(Protocol):
    """Something that tells the words of a language."""

    def accepts(self, word: Iterable[str], /) -> bool:
        """Whether the word is in the language."""


@dataclass(frozen=True, slots=True)
class Recogniser:
    """``reader`` for the grammar; ``condition`` for the accept condition, None: it is in there."""

    kind: Kind
    reader: Reader
    condition: Reader | None

    def accepts(self, word: Sequence[str]) -> bool:
        """Whether the word is in the language; a word with an unknown token is not."""
        if self.condition is not None and not self.condition.accepts(word):
            return False
        return self.reader.accepts(word)

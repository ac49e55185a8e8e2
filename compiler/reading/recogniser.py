"""Membership, by the fastest automaton that reads the grammar exactly as it is.

A finite automaton where the form of the grammar shows that it is regular; else a pushdown automaton
whose states are made as they are needed, which reads any grammar.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

Kind: TypeAlias = Literal["finite automaton", "pushdown automaton"]


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

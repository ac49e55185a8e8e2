"""Membership, by the fastest automaton that reads the grammar exactly as it is.

A finite automaton where the form of the grammar shows that it is regular; else a pushdown automaton
whose states are made as they are needed, which reads any grammar.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol, TypeAlias

Kind: TypeAlias = Literal["finite automaton", "pushdown automaton"]


class Reader(Protocol):
    """Something that tells the words of a language."""

    def accepts(self, word: Iterable[str], /) -> bool:
        """Whether the word is in the language."""


@dataclass(frozen=True)
class Recogniser:
    """``reader`` for the grammar; ``condition`` for the accept condition, None: it is in there."""

    kind: Kind
    reader: Reader
    condition: Reader | None

    @cached_property
    def accepts(self) -> Callable[[Sequence[str]], bool]:
        """Whether a word is in the language; a word with an unknown token is not."""
        if self.condition is None:
            return self.reader.accepts
        return self._both

    def _both(self, word: Sequence[str]) -> bool:
        return (
            self.condition is not None
            and self.condition.accepts(word)
            and self.reader.accepts(word)
        )

"""What an adapter of another library is, and the names it gives to symbols."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from grammar_lang import ir

Word = tuple[str, ...]


class NotApplicableError(Exception):
    """Why a library does not read a grammar, or refuses it."""


class Peer(ABC):
    """A recogniser built from a grammar by another library."""

    name: ClassVar[str]
    any_grammar: ClassVar[bool] = True  # reads whatever is context-free, without a resolution

    @abstractmethod
    def __init__(self, grammar: ir.Grammar) -> None:
        """Build the recogniser.

        Raises:
            NotApplicableError: the grammar is not of the library's kind, or it refuses it.
        """

    def encode(self, word: Word) -> Any:
        """The word as the library wants it."""
        return list(word)

    @abstractmethod
    def accepts(self, word: Any) -> bool:
        """Whether an encoded word is in the language, as the library sees it."""

    def remark(self) -> str:
        """What a reader of its numbers should know about this grammar."""
        return ""


def terminals_of(grammar: ir.Grammar) -> tuple[str, ...]:
    """The terminals that occur, in order of first appearance."""
    rights = (symbol for production in grammar.productions for symbol in production.right)
    return tuple(dict.fromkeys(s.name for s in rights if s.kind != "nonterminal"))


def names_of(grammar: ir.Grammar, nonterminal: str, terminal: str) -> dict[tuple[str, bool], str]:
    """Names that no library takes for something else: the letter and a number."""
    found = {(n, True): f"{nonterminal}{i}" for i, n in enumerate(grammar.nonterminals)}
    return found | {(t, False): f"{terminal}{i}" for i, t in enumerate(terminals_of(grammar))}


def rights_of(
    grammar: ir.Grammar, names: Mapping[tuple[str, bool], str]
) -> Iterator[tuple[str, list[str]]]:
    """The productions in those names."""
    for production in grammar.productions:
        right = [names[s.name, s.kind == "nonterminal"] for s in production.right]
        yield names[production.left, True], right

"""Parse a text into abstract syntax, item by item, and report every independent error."""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import wraps
from typing import ParamSpec, TypeVar

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.parsing.lalr import Parser
from grammar_lang.parsing.repair import Place, Repair
from grammar_lang.parsing.syntax_errors import explain, slips, stray
from grammar_lang.parsing.tables import tables
from grammar_lang.parsing.tokens import (
    KEYWORDS,
    WORD,
    RawItem,
    Tokens,
    cut,
    tokenise,
    unclosed_comment,
)
from grammar_lang.parsing.tree_builder import BUILDERS, item_of
from grammar_lang.source import Span
from grammar_lang.syntax.tasks import File, Item

# --- Parsing without pauses of the garbage collector ----------------------------------------------
#
# The tree of a large file consists of millions of objects without a cycle.  While it is built,
# Python's collector would traverse all of them again and again; that took a third of the time of
# ``check`` at 2 MB and made it more than linear.


Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def without_collection(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """A wrapper of the function that disables the collection of cyclic garbage during calls."""

    @wraps(function)
    def paused(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not gc.isenabled():
            return function(*args, **kwargs)
        gc.disable()
        try:
            return function(*args, **kwargs)
        finally:
            gc.enable()

    return paused


MAX_ERRORS = 100
"""The most syntax errors reported for a file; a file with more is probably not a specification."""


@dataclass(slots=True)
class _Reader:
    tokens: Tokens
    sink: Sink
    found: list[Item] = field(default_factory=list[Item])
    broken: list[Span] = field(default_factory=list[Span])
    skipped: set[str] = field(default_factory=set[str])
    errors: int = 0

    def read(self) -> File:
        """Parse every item, until there are too many errors."""
        astray: int | None = None
        for raw in cut(self.tokens):
            if self.errors >= MAX_ERRORS:
                astray = raw.first if astray is None else astray
                break
            if self.tokens.at(raw.first) in KEYWORDS:
                self._lose(astray, raw.first)
                astray = None
                self._item(raw)
            elif astray is None or self._looks_like_item(raw):
                astray = raw.first if astray is None else astray
                stray(self.tokens, raw, self.sink)
                self.errors += 1
        self._lose(astray, len(self.tokens))
        return File(tuple(self.found), tuple(self.broken), frozenset(self.skipped))

    def _looks_like_item(self, raw: RawItem) -> bool:
        """Whether the item begins with ``WORD NAME {``: an item whose keyword is misspelt."""
        return raw.stop - raw.first > 3 and self.tokens.kinds[raw.first : raw.first + 3] == [
            WORD,
            WORD,
            "{",
        ]

    def _lose(self, first: int | None, stop: int) -> None:
        """Record the tokens ``first <= i < stop`` as broken; nothing if ``first`` is None."""
        if first is None:
            return
        self.broken.append(self.tokens.span(first, stop - 1))
        words = map(self.tokens.at, range(first, stop))
        self.skipped.update(word for word in words if word[0].isidentifier())

    def _item(self, raw: RawItem) -> None:
        def complain(place: Place, repair: Repair | None) -> bool:
            self.errors += 1
            explain(raw, place, repair, self.sink)
            return self.errors < MAX_ERRORS

        parser = Parser(tables(), self.tokens, BUILDERS, complain, self.skipped)
        value, sound = parser.item(raw)
        if value is not None:
            self.found.append(item_of(value))
        if not sound:
            self.broken.append(self.tokens.span(raw.first, raw.stop - 1))


@without_collection
def parse_tokens(text: str, sink: Sink, file: int = 0) -> tuple[File, Tokens]:
    """As :func:`parse`, and also the tokens, each with its terminal."""
    tokens = tokenise(text, file)
    comment = unclosed_comment(tokens)
    if comment is not None:
        sink.error(Code.SYNTAX, "this comment is never closed", comment, "add `*/`")
        return File((), (comment,)), tokens
    slips(tokens, sink, MAX_ERRORS)
    return _Reader(tokens, sink).read(), tokens


def parse(text: str, sink: Sink, file: int = 0) -> File:
    """Parse the items of ``text``; report what cannot be parsed.

    Args:
        text: the text of a file.
        sink: collects the errors.
        file: the number of the file, for spans.
    """
    return parse_tokens(text, sink, file)[0]

"""A program as an editor sees it, read from open documents: its names and diagnostics."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Diagnostic
from grammar_lang.load import Loaded, load, load_text
from grammar_lang.names.declarations import Declarations
from grammar_lang.names.table import Mention, NameTable
from grammar_lang.source import Source, Span
from grammar_lang.syntax import tasks as t
from srgc.language_server.documents.line_map import UTF16, LineMap

_NOTHING = t.File(())


class Analysis:
    """A main document with everything that it includes.

    ``name`` is the path of the main file, or the URI of a document that is not a file.  Everything
    is computed when it is first needed: most requests need only the syntax.
    """

    def __init__(self, loaded: Loaded, name: str, encoding: str) -> None:
        self.loaded = loaded
        self.name = name
        self._encoding = encoding
        self._lines: dict[int, LineMap] = {}

    # --- Files ---------------------------------------------------------------------------------

    @property
    def sources(self) -> Sequence[Source]:
        """All texts that were read; the file numbers of spans refer to them."""
        return self.loaded.sources

    @cached_property
    def _numbers(self) -> Mapping[str, int]:
        found: dict[str, int] = {}
        for number in range(len(self.sources)):
            found.setdefault(self.place(number), number)
        return found

    @property
    def places(self) -> list[str]:
        """The places of all files."""
        return [*self._numbers]

    def number(self, place: str) -> int | None:
        """The number of the file with that resolved path, or of the document with that URI."""
        return self._numbers.get(place)

    def place(self, number: int) -> str:
        """The resolved path of a file, or the URI of the main document."""
        name = self.sources[number].name
        return os.path.realpath(name) if self.path(number) is not None else name

    def path(self, number: int) -> Path | None:
        """The path of a file; None for a document that is not a file."""
        path = Path(self.sources[number].name)
        return path if path.is_absolute() else None

    def lines(self, number: int) -> LineMap:
        """The lines of a file."""
        if number not in self._lines:
            self._lines[number] = LineMap(self.sources[number].text, self._encoding)
        return self._lines[number]

    def text(self, span: Span) -> str:
        """The text at a span."""
        return self.sources[span.file].text[span.start : span.end]

    # --- What was read -------------------------------------------------------------------------

    @property
    def syntax(self) -> t.File:
        """The items of all files that could be read."""
        return self.loaded.syntax or _NOTHING

    @property
    def program(self) -> ir.Program | None:
        """The sound parts of the program."""
        return self.loaded.sound

    @property
    def declared(self) -> Declarations:
        """The items by name."""
        return self.names.declared

    @cached_property
    def names(self) -> NameTable:
        """The entities of the program's names, and where they are mentioned."""
        return self.loaded.names or NameTable((), Declarations(), {})

    def items(self, number: int) -> list[t.Item]:
        """The items in a file."""
        return [item for item in self.syntax.items if item.span.file == number]

    def mention(self, number: int, offset: int) -> Mention | None:
        """The name at a position."""
        return self.names.at(number, offset)

    def named_together(self, number: int, offset: int) -> Sequence[Mention]:
        """All entities that the name at a position stands for; empty if there is no name."""
        mention = self.names.at(number, offset)
        return () if mention is None else self.names.together(mention)

    def block(self, number: int, offset: int) -> s.Block | None:
        """The block of a production's semantics around a position."""
        for item in self.items(number):
            if isinstance(item, s.Semantics) and item.span.start <= offset <= item.span.end:
                blocks = (b for b in item.blocks if b.span.start <= offset <= b.span.end)
                return next(blocks, None)
        return None

    @cached_property
    def findings(self) -> Sequence[Diagnostic]:
        """All diagnostics of ``srgc check``."""
        from srgc.session import check_loaded

        return check_loaded(self.loaded).diagnostics

    @property
    def known_findings(self) -> Sequence[Diagnostic]:
        """The diagnostics known so far; nothing is computed."""
        found: Sequence[Diagnostic] = self.__dict__.get("findings", self.loaded.diagnostics)
        return found


def analyse(
    name: str, text: str, open_files: Mapping[str, bytes], encoding: str = UTF16
) -> Analysis:
    """The analysis of an open document.

    Args:
        name: its absolute path, or its URI if it is not a file.
        text: its text.
        open_files: the contents of this and other open files, by their resolved paths.
        encoding: the unit in which positions count.
    """
    path = Path(name)
    folder = path.parent if path.is_absolute() else None
    return Analysis(load_text(text, name, folder, open_files), name, encoding)


def analyse_file(
    path: Path, open_files: Mapping[str, bytes], encoding: str = UTF16
) -> Analysis | None:
    """The analysis of a file that is not open; None if it cannot be read."""
    loaded = load(path, open_files)
    return Analysis(loaded, str(path), encoding) if loaded.syntax is not None else None

"""The documents that the client has open, with all their changes."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path

from lsprotocol import types as lsp

from srgc.language_server.documents.line_map import UTF16, LineMap
from srgc.language_server.documents.projects import included
from srgc.language_server.documents.uris import path_of, uri_of

_LONE_RETURN = re.compile(r"\r(?!\n)")


def readable(text: str) -> str:
    """The text as the parser reads files, with every character at the same offset.

    A byte order mark becomes a blank, and a lone CR becomes LF.
    """
    if text.startswith("\ufeff"):
        text = f" {text[1:]}"
    return _LONE_RETURN.sub("\n", text)


class Document:
    """An open document; ``path`` is None if it is not a file, ``real`` is the resolved path."""

    def __init__(self, uri: str, text: str, version: int, encoding: str) -> None:
        self.uri = uri
        self.version = version
        self.path: Path | None = path_of(uri)
        # Without a path, its name must not look like a path, either.
        nameless = f"untitled:{uri}" if uri.startswith("/") else uri
        self.real = nameless if self.path is None else os.path.realpath(self.path)
        self._encoding = encoding
        self.replace(text)

    def replace(self, text: str) -> None:
        """Replace the whole text."""
        self.lines = LineMap(text, self._encoding)
        self.__dict__.pop("includes", None)
        self.text = readable(text)

    @cached_property
    def includes(self) -> list[str]:
        """The paths that the text includes."""
        return included(self.text)

    @property
    def data(self) -> bytes:
        """The bytes of the text."""
        return self.text.encode("utf-8", "surrogatepass")

    def apply(self, changes: Sequence[lsp.TextDocumentContentChangeEvent]) -> None:
        """Apply changes in order, each to the result of the one before."""
        for change in changes:
            if isinstance(change, lsp.TextDocumentContentChangePartial):
                start = self.lines.offset(change.range.start)
                end = max(start, self.lines.offset(change.range.end))
                old = self.lines.text
                self.replace(f"{old[:start]}{change.text}{old[end:]}")
            else:
                self.replace(change.text)


class OpenDocuments:
    """All open documents, by URI and by path; ``revision`` grows with every change."""

    def __init__(self) -> None:
        self.encoding = UTF16
        self.revision = 0
        self._by_uri: dict[str, Document] = {}

    def __iter__(self) -> Iterator[Document]:
        return iter(self._by_uri.values())

    def get(self, uri: str) -> Document | None:
        """The document with that URI, if it is open."""
        return self._by_uri.get(uri)

    def open(self, uri: str, text: str, version: int) -> None:
        """Add a document that was opened."""
        self._by_uri[uri] = Document(uri, text, version, self.encoding)
        self.revision += 1

    def change(
        self, uri: str, version: int, changes: Sequence[lsp.TextDocumentContentChangeEvent]
    ) -> None:
        """Apply changes to a document; one that is not open is ignored."""
        document = self._by_uri.get(uri)
        if document is not None:
            document.apply(changes)
            document.version = version
            self.revision += 1

    def close(self, uri: str) -> None:
        """Remove a document that was closed; its file on disk counts again."""
        if self._by_uri.pop(uri, None) is not None:
            self.revision += 1

    def touch(self) -> None:
        """Note that files on disk have changed."""
        self.revision += 1

    def files(self) -> dict[str, bytes]:
        """The contents of open files, by their resolved paths."""
        return {each.real: each.data for each in self if each.path is not None}

    def uri(self, path: Path) -> str:
        """The URI by which the client knows a file."""
        real = os.path.realpath(path)
        return next((each.uri for each in self if each.real == real), uri_of(path))

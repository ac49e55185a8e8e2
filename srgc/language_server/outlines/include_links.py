"""Links from the paths of includes and maps to the files."""

from __future__ import annotations

import os
import posixpath
from pathlib import Path

from lsprotocol import types as lsp

from grammar_lang.source import Span
from grammar_lang.syntax import Ident
from grammar_lang.syntax import tasks as t
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.published import UriOf


def include_links(analysis: Analysis, number: int, uri_of: UriOf) -> list[lsp.DocumentLink]:
    """The links of a document; what is no file of the program has none."""
    base = analysis.path(number)
    paths: list[Ident] = []
    for item in analysis.items(number):
        if isinstance(item, t.Include):
            paths.append(item.path)
        elif isinstance(item, t.Workspace):
            paths += [part.path for part in item.items if isinstance(part, t.ObstaclesFrom)]
    if base is None:
        return []
    links: list[lsp.DocumentLink] = []
    for path in paths:
        target = Path(posixpath.normpath(base.parent / path.text))
        if not path.text or not os.path.isfile(target):  # noqa: PTH113 - of any name
            continue
        inside = Span(path.span.start + 1, path.span.end - 1, path.span.file)
        place = analysis.lines(number).range(inside)
        links.append(lsp.DocumentLink(place, uri_of(target)))
    return links

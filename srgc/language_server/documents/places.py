"""Where a name is declared and where it is used."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from lsprotocol import types as lsp

from grammar_lang.source import Span
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.published import UriOf
from srgc.language_server.names.names import Key, Mark


def location(analysis: Analysis, span: Span, uri_of: UriOf) -> lsp.Location:
    """A span as a location."""
    path = analysis.path(span.file)
    uri = analysis.name if path is None else uri_of(path)
    return lsp.Location(uri, analysis.lines(span.file).range(span))


def definition(analysis: Analysis, number: int, offset: int, uri_of: UriOf) -> list[lsp.Location]:
    """The declarations of the name at a place; of a nonterminal, all its productions."""
    mark = analysis.mark(number, offset)
    if mark is None:
        return []
    return [location(analysis, m.span, uri_of) for m in analysis.names.definitions(mark.key)]


def references(
    analyses: Sequence[Analysis], place: str, offset: int, uri_of: UriOf, *, declarations: bool
) -> list[lsp.Location]:
    """Where the thing at a place is named, in every program that the file belongs to."""
    found: dict[tuple[str, int, int], lsp.Location] = {}
    for analysis in analyses:
        number = analysis.number(place)
        mark = None if number is None else analysis.mark(number, offset)
        for each in () if mark is None else analysis.names.of(mark.key):
            if declarations or not each.defines:
                key = (analysis.place(each.span.file), each.span.start, each.span.end)
                found.setdefault(key, location(analysis, each.span, uri_of))
    return [found[key] for key in sorted(found)]


def highlights(analysis: Analysis, number: int, offset: int) -> list[lsp.DocumentHighlight]:
    """The places of the name at a place, in the same file."""
    mark = analysis.mark(number, offset)
    if mark is None:
        return []
    kinds = {True: lsp.DocumentHighlightKind.Write, False: lsp.DocumentHighlightKind.Read}
    lines = analysis.lines(number)
    marks: Iterable[Mark] = analysis.names.of(mark.key)
    return [
        lsp.DocumentHighlight(lines.range(each.span), kinds[each.defines])
        for each in marks
        if each.span.file == number
    ]


_WHAT = {
    "terminal": "symbol",
    "label": "production",
    "member": "name",
    "map": "map of obstacles",
}


def described(analysis: Analysis, key: Key) -> str:
    """What a thing is, for a message: ``module `L```."""
    if key.kind == "terminal":
        kind = "module" if key.name in analysis.declared.modules else "edge"
        return f"{kind} `{key.name}`"
    if key.kind == "member":
        return f"`{key.name}` of module `{key.scope[0]}`"
    if key.kind == "attribute":
        return f"attribute `{key.name}` of `{key.scope[1]}`"
    return f"{_WHAT.get(key.kind, key.kind)} `{key.name}`"

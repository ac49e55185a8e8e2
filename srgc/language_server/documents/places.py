"""Where names are declared and used."""

from __future__ import annotations

from collections.abc import Sequence

from lsprotocol import types as lsp

from grammar_lang.names.declarations import MEMBERS, Entity
from grammar_lang.source import Span
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.uris import UriOf


def location(analysis: Analysis, span: Span, uri_of: UriOf) -> lsp.Location:
    """The location of a span."""
    path = analysis.path(span.file)
    uri = analysis.name if path is None else uri_of(path)
    return lsp.Location(uri, analysis.lines(span.file).range(span))


def definition(analysis: Analysis, number: int, offset: int, uri_of: UriOf) -> list[lsp.Location]:
    """The declarations of the name at a position; for a nonterminal, all its productions."""
    found = (
        declared
        for each in analysis.named_together(number, offset)
        for declared in analysis.names.declarations(each.entity)
    )
    return [location(analysis, each.span, uri_of) for each in found]


def references(
    analyses: Sequence[Analysis], place: str, offset: int, uri_of: UriOf, *, declarations: bool
) -> list[lsp.Location]:
    """The places where the entity at a position is named, in all programs with the file."""
    found: dict[tuple[str, int, int], lsp.Location] = {}
    for analysis in analyses:
        number = analysis.number(place)
        together = () if number is None else analysis.named_together(number, offset)
        for each in (m for one in together for m in analysis.names.mentions_of(one.entity)):
            if declarations or not each.declares:
                key = (analysis.place(each.span.file), each.span.start, each.span.end)
                found.setdefault(key, location(analysis, each.span, uri_of))
    return [found[key] for key in sorted(found)]


def highlights(analysis: Analysis, number: int, offset: int) -> list[lsp.DocumentHighlight]:
    """The places of the name at a position, in the same file."""
    kinds = {True: lsp.DocumentHighlightKind.Write, False: lsp.DocumentHighlightKind.Read}
    lines = analysis.lines(number)
    found = {
        each.span: each.declares
        for one in analysis.named_together(number, offset)
        for each in analysis.names.mentions_of(one.entity)
        if each.span.file == number
    }
    return [
        lsp.DocumentHighlight(lines.range(span), kinds[declares])
        for span, declares in found.items()
    ]


_WHAT = {"obstacle": "region", "target": "region", "map": "map of obstacles"}


def described(entity: Entity) -> str:
    """An entity in words, for a message, such as ``module `L```."""
    if entity.kind in MEMBERS:
        return f"`{entity.name}` of module `{entity.scope[0]}`"
    if entity.kind == "port type":
        return f"port type `{entity.name}`"
    if entity.kind == "attribute":
        return f"attribute `{entity.name}` of `{entity.scope[1]}`"
    return f"{_WHAT.get(entity.kind, entity.kind)} `{entity.name}`"

"""Completion: what may stand at the cursor, asked of the parser and of the names declared."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from lsprotocol import types as lsp

from grammar_lang.source import Span
from grammar_lang.units import UNIT_NAMES
from srgc.language_server.completions.completion_names import NamesDue, Offer
from srgc.language_server.completions.cursor import Cursor, cursor_at
from srgc.language_server.completions.snippets import EMISSIONS, ITEMS, STATEMENTS
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.keywords import explained

_KINDS = lsp.CompletionItemKind
_COMPOUND = ("N*m", "kg/m", "m/s", "m/s^2", "rad/s", "deg/s", "kg*m^2", "N*m*s/rad")
_SUFFIXES = {"include": (".srg",), "from": (".yaml", ".yml", ".geojson", ".json")}
_MOST_PATHS = 200


def _keywords(cursor: Cursor) -> Iterator[Offer]:
    for word in sorted(cursor.expected):
        if word.isidentifier() and not word.isupper():
            means = explained(word, cursor.item[0]) or "keyword"
            yield Offer(word, _KINDS.Keyword, means)


def _units(cursor: Cursor) -> Iterator[Offer]:
    if "UNIT" in cursor.expected:
        for name in (*UNIT_NAMES, *_COMPOUND):
            yield Offer(name, _KINDS.Unit, "unit")


def _snippets(cursor: Cursor) -> Iterator[Offer]:
    """Whole items and statements, where one may begin."""
    kind = cursor.item[0]
    forms: Mapping[str, str] = {}
    if not cursor.before:
        forms = ITEMS
    elif cursor.statement or "}" not in cursor.expected:
        return
    elif kind == "semantics":
        forms = EMISSIONS if cursor.block else STATEMENTS[kind]
    else:
        forms = STATEMENTS.get(kind, {})
    for name, body in forms.items():
        yield Offer(name, _KINDS.Snippet, f"{name} …", body)


def _paths(cursor: Cursor, folder: Path | None) -> Iterator[Offer]:
    """Files that a string may name."""
    said = cursor.statement[-1:]
    suffixes = _SUFFIXES.get(said[0]) if said else None
    if folder is None or suffixes is None:
        return
    written = (cursor.quoted or "").rpartition("/")[0]
    try:
        place = Path(os.path.realpath(folder / written))
        entries = sorted(place.iterdir())[:_MOST_PATHS]
    except (OSError, ValueError):
        return
    for entry in entries:
        shown = f"{written}/{entry.name}" if written else entry.name
        if entry.name.startswith(".") or not shown.isprintable():
            continue
        if entry.is_dir():
            yield Offer(f"{shown}/", _KINDS.Folder, "folder")
        elif entry.name.lower().endswith(suffixes):
            yield Offer(shown, _KINDS.File, "file")


def _offers(analysis: Analysis, cursor: Cursor, folder: Path | None) -> list[Offer]:
    if cursor.silent:
        return []
    if cursor.quoted is not None:
        return list(_paths(cursor, folder))
    names = NamesDue(analysis, cursor).offers()
    snippets = list(_snippets(cursor))
    replaced = {offer.label for offer in snippets}
    keywords = [offer for offer in _keywords(cursor) if offer.label not in replaced]
    return [*names, *snippets, *keywords, *_units(cursor)]


def completions(
    analysis: Analysis, text: str, offset: int, number: int = 0, *, snippets: bool = True
) -> list[lsp.CompletionItem]:
    """What may be written at an offset of a text.

    Args:
        analysis: the program.
        text: the text of the document.
        offset: where the cursor is.
        number: the number of the document in the program.
        snippets: whether the client knows snippets; else they are written as plain words.
    """
    cursor = cursor_at(text, offset)
    path = analysis.path(number)
    offers = _offers(analysis, cursor, None if path is None else path.parent)
    place = analysis.lines(number).range(Span(cursor.start, offset, number))
    items: dict[tuple[str, str | None], lsp.CompletionItem] = {}
    for rank, offer in enumerate(offers):
        body = offer.insert if snippets else None
        form = lsp.InsertTextFormat.PlainText if body is None else lsp.InsertTextFormat.Snippet
        items.setdefault(
            (offer.label, body),
            lsp.CompletionItem(
                label=offer.label,
                kind=offer.kind,
                detail=offer.detail,
                sort_text=f"{rank:04}",
                insert_text_format=form,
                text_edit=lsp.TextEdit(place, offer.label if body is None else body),
            ),
        )
    return list(items.values())

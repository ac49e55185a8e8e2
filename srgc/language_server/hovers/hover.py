"""Hover: what stands under the cursor."""

from __future__ import annotations

import re

from lsprotocol import types as lsp

from grammar_lang import syntax as s
from grammar_lang.diagnostics.code_pages import has_page, page_text, read_page
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.hovers.hover_names import hover_name
from srgc.language_server.hovers.hover_numbers import hover_number
from srgc.language_server.keywords import explained

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_SKIPPED = re.compile(r"""//[^\n]*|/\*(?:[^*]|\*(?!/))*(?:\*/|\Z)|"[^"\n]*"|'[^'\n]*'""")
_ITEMS: dict[type, str] = {
    s.Module: "module",
    s.Edges: "edge",
    s.Grammar: "grammar",
    s.Semantics: "semantics",
    t.Workspace: "workspace",
    t.Task: "task",
    t.Include: "include",
}


def _word_at(text: str, offset: int) -> Span | None:
    start = offset
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    found = _WORD.match(text, start)
    return None if found is None or found.end() < offset else Span(*found.span())


def _silent(text: str, offset: int) -> bool:
    """Whether an offset is in a comment or a string."""
    for found in _SKIPPED.finditer(text):
        if found.start() > offset:
            return False
        if offset < found.end() or (offset == found.end() and found[0].startswith("//")):
            return True
    return False


def _item_at(analysis: Analysis, number: int, offset: int) -> str:
    """The keyword of the item about a place."""
    for item in analysis.items(number):
        if item.span.start <= offset <= item.span.end:
            return _ITEMS[type(item)]
    return ""


def _keyword(analysis: Analysis, number: int, offset: int) -> tuple[str, Span] | None:
    text = analysis.sources[number].text
    word = _word_at(text, offset)
    if word is None:
        return None
    means = explained(text[word.start : word.end], _item_at(analysis, number, offset))
    return None if means is None else (means, word)


def _codes(analysis: Analysis, number: int, offset: int) -> list[str]:
    """What the codes of the findings at a place stand for."""
    told: dict[str, str] = {}
    for found in analysis.known_findings:
        at = found.span.file == number and found.span.start <= offset <= found.span.end
        if at and has_page(found.code) and found.code.value not in told:
            page = read_page(page_text(found.code))
            why = page.why.strip().partition("\n\n")[0]
            told[found.code.value] = f"**{found.code.value}: {page.title}.** {why}"
    return list(told.values())


def hover(analysis: Analysis, number: int, offset: int) -> lsp.Hover | None:
    """The text about the place of a cursor; None where there is nothing to say."""
    text = analysis.sources[number].text
    place: Span | None = None
    parts: list[str] = []
    mention = analysis.mention(number, offset)
    if mention is not None:
        parts.append(hover_name(analysis, mention.entity))
        place = mention.whole
    elif not _silent(text, offset):
        found = hover_number(text, offset) or _keyword(analysis, number, offset)
        if found is not None:
            parts.append(found[0])
            place = found[1]
    parts += _codes(analysis, number, offset)
    if not parts:
        return None
    content = lsp.MarkupContent(lsp.MarkupKind.Markdown, "\n\n---\n\n".join(parts))
    return lsp.Hover(content, None if place is None else analysis.lines(number).range(place))

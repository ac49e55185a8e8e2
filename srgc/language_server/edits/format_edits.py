"""Formatting: the canonical form, as edits of the lines that change."""

from __future__ import annotations

from difflib import SequenceMatcher

from lsprotocol import types as lsp

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import NotFaithful, canonical
from srgc.language_server.documents.line_map import LineMap

_MOST_LINES = 4000
"""Longer texts are replaced as a whole: finding what differs takes too long."""


def format_edits(text: str, lines: LineMap) -> list[lsp.TextEdit]:
    """The edits to the canonical form; none where the text has syntax errors.

    Args:
        text: the text as the parser reads it.
        lines: the lines of the same text as the client has it.
    """
    try:
        made = canonical(text.removeprefix("\ufeff"), Sink())
    except NotFaithful:
        return []
    if made is None or made == lines.text:
        return []
    end = "\r\n" if "\r\n" in lines.text else "\n"
    made = made.replace("\r\n", "\n").replace("\n", end)
    if made == lines.text:
        return []
    before, after = lines.text.splitlines(keepends=True), made.splitlines(keepends=True)
    if max(len(before), len(after)) > _MOST_LINES or "".join(before) != lines.text:
        return [lsp.TextEdit(lines.whole, made)]
    starts = [0]
    for line in before:
        starts.append(starts[-1] + len(line))
    edits: list[lsp.TextEdit] = []
    for kind, i1, i2, j1, j2 in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if kind != "equal":
            place = lsp.Range(lines.position(starts[i1]), lines.position(starts[i2]))
            edits.append(lsp.TextEdit(place, "".join(after[j1:j2])))
    return edits

"""Quick fixes: the hints of diagnostics that state exactly what to write."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from difflib import SequenceMatcher

from lsprotocol import types as lsp

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import NotFaithful, canonical
from srgc.language_server.documents.line_map import LineMap

_MEANT = re.compile(r"did you mean `([^`]+)`\?")
_ADD = re.compile(r"add (?:the )?(?:missing )?`([;}]|\*/)`")

Place = Callable[[lsp.Position], int]


def _hint(diagnostic: lsp.Diagnostic) -> str:
    data = diagnostic.data
    hint = data.get("hint") if isinstance(data, dict) else getattr(data, "hint", None)
    if isinstance(hint, str):
        return hint
    return diagnostic.message.rpartition("\nhint: ")[2]


def _edit(diagnostic: lsp.Diagnostic, text: str, place: Place) -> tuple[str, lsp.TextEdit] | None:
    """The title and the edit of the fix for one diagnostic."""
    hint, at = _hint(diagnostic), diagnostic.range
    meant = _MEANT.search(hint)
    if meant is not None:
        old = text[place(at.start) : place(at.end)]
        new = f"{old[0]}{meant[1]}{old[0]}" if old[:1] in {'"', "'"} else meant[1]
        if not old or "\n" in old or (not old.replace("_", "a").isalnum() and old[0] not in "\"'"):
            return None
        return f"Change to `{meant[1]}`", lsp.TextEdit(at, new)
    added = _ADD.fullmatch(hint)
    if added is not None:
        here = at.end if added[1] == "*/" else at.start
        return f"Add `{added[1]}`", lsp.TextEdit(lsp.Range(here, here), added[1])
    return None


def quick_fixes(
    uri: str, text: str, place: Place, diagnostics: Sequence[lsp.Diagnostic]
) -> list[lsp.CodeAction]:
    """The fixes for diagnostics.

    Args:
        uri: the document.
        text: its text.
        place: gives the offset of a position.
        diagnostics: the diagnostics about which the client asks.
    """
    found: list[lsp.CodeAction] = []
    for diagnostic in diagnostics:
        fix = _edit(diagnostic, text, place) if diagnostic.source == "srgc" else None
        if fix is not None:
            found.append(
                lsp.CodeAction(
                    title=fix[0],
                    kind=lsp.CodeActionKind.QuickFix,
                    diagnostics=[diagnostic],
                    is_preferred=True,
                    edit=lsp.WorkspaceEdit(changes={uri: [fix[1]]}),
                )
            )
    return found


# --- Formatting: the canonical form, as edits of the lines that change ----------------------------


_MOST_LINES = 4000
"""Longer texts are replaced as a whole, because computing the difference takes too long."""


def format_edits(text: str, lines: LineMap) -> list[lsp.TextEdit]:
    """The edits to the canonical form; none if the text has syntax errors.

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

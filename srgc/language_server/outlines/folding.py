"""Folding: items, blocks and comments that go over several lines."""

from __future__ import annotations

import re

from lsprotocol import types as lsp

from srgc.language_server.documents.line_map import LineMap

_PART = re.compile(
    r"""//[^\n]*|/\*(?:[^*]|\*(?!/))*(?:\*/|\Z)|"[^"\n]*"|'[^'\n]*'|[{}]""",
)


def _comment(lines: LineMap, start: int, end: int) -> lsp.FoldingRange | None:
    first, last = lines.position(start).line, lines.position(end).line
    if last <= first:
        return None
    return lsp.FoldingRange(first, last, kind=lsp.FoldingRangeKind.Comment)


def folding(text: str, lines: LineMap) -> list[lsp.FoldingRange]:
    """The ranges that can be folded, however broken the text is."""
    found: list[lsp.FoldingRange | None] = []
    open_braces: list[int] = []
    run: tuple[int, int] | None = None
    for part in _PART.finditer(text):
        if part[0].startswith("//"):
            alone = not text[text.rfind("\n", 0, part.start()) + 1 : part.start()].strip()
            joined = run is not None and not text[run[1] : part.start()].strip() and alone
            if run is not None and joined:
                run = (run[0], part.end())
                continue
            found.append(None if run is None else _comment(lines, *run))
            run = part.span() if alone else None
        elif part[0].startswith("/*"):
            found.append(_comment(lines, *part.span()))
        elif part[0] == "{":
            open_braces.append(part.start())
        elif part[0] == "}" and open_braces:
            found.append(_braces(lines, open_braces.pop(), part.start()))
    found.append(None if run is None else _comment(lines, *run))
    ranges = [each for each in found if each is not None]
    return sorted(ranges, key=lambda each: (each.start_line, each.end_line))


def _braces(lines: LineMap, start: int, end: int) -> lsp.FoldingRange | None:
    """What stands between braces; the line of the closing one stays."""
    first, last = lines.position(start).line, lines.position(end).line - 1
    return lsp.FoldingRange(first, last) if last > first else None

"""Hover: the text for the position of the cursor."""

from __future__ import annotations

import re
from fractions import Fraction

from lsprotocol import types as lsp

from grammar_lang import syntax as s
from grammar_lang.diagnostics.code_pages import has_page, page_text, read_page
from grammar_lang.parsing.tokens import NUMBER, Tokens, tokenise
from grammar_lang.source import Span
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t
from grammar_lang.units import UNIT_NAMES, describe, unit
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.hovers.hover_names import hover_mention
from srgc.language_server.hovers.production_physics import in_si
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
    m.Mission: "mission",
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
    """The keyword of the item around a position."""
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
    """The explanations of the codes of diagnostics at a position."""
    told: dict[str, str] = {}
    for found in analysis.known_findings:
        at = found.span.file == number and found.span.start <= offset <= found.span.end
        if at and has_page(found.code) and found.code.value not in told:
            page = read_page(page_text(found.code))
            why = page.why.strip().partition("\n\n")[0]
            told[found.code.value] = f"**{found.code.value}: {page.title}.** {why}"
    return list(told.values())


def hover(analysis: Analysis, number: int, offset: int) -> lsp.Hover | None:
    """The text for the position of a cursor; None if there is nothing to say."""
    text = analysis.sources[number].text
    place: Span | None = None
    parts: list[str] = []
    mention = analysis.mention(number, offset)
    if mention is not None:
        parts.append(hover_mention(analysis, mention))
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


# --- The SI value of the number under the cursor --------------------------------------------------


_NAMES = "|".join(sorted(UNIT_NAMES, key=len, reverse=True))
_UNIT = re.compile(
    rf"\s*((?:{_NAMES})(?:\^-?[0-9]+)?(?:[*/](?:{_NAMES})(?:\^-?[0-9]+)?)*)(?![A-Za-z0-9_.(])"
)
_CLOSING = {")": "(", "]": "[", "}": "{"}
_FAR = 400
"""The number of tokens among which the unit of a list is sought."""


def _unit_after(text: str, end: int) -> tuple[str, int] | None:
    found = _UNIT.match(text, end)
    return None if found is None else (found[1], found.end())


def _list_unit(tokens: Tokens, index: int) -> tuple[str, int] | None:
    """The unit after the bracket that closes around a token."""
    depth = 0
    for here in range(index + 1, min(index + _FAR, len(tokens))):
        kind = tokens.kinds[here]
        if kind in _CLOSING.values():
            depth += 1
        elif kind in _CLOSING and depth:
            depth -= 1
        elif kind in _CLOSING:
            found = _unit_after(tokens.text, tokens.ends[here])
            if found is not None or kind != ")":
                return found
        elif kind == ";" and depth == 0 and not _in_inequalities(tokens, here):
            return None
    return None


def _in_inequalities(tokens: Tokens, index: int) -> bool:
    """Whether a semicolon separates the inequalities of a polytope."""
    for here in range(index, 0, -1):
        if tokens.kinds[here] == "}":
            return False
        if tokens.kinds[here] == "{":
            return tokens.at(here - 1) == "polytope"
    return False


def hover_number(text: str, offset: int) -> tuple[str, Span] | None:
    """The SI value of the number with a unit at an offset; None if there is none."""
    tokens = tokenise(text)
    for index, start in enumerate(tokens.starts):
        if start > offset:
            break
        if tokens.kinds[index] != NUMBER:
            continue
        own = _unit_after(text, tokens.ends[index])
        stop = tokens.ends[index] if own is None else own[1]
        if not start <= offset <= stop:
            continue
        found = own or _list_unit(tokens, index)
        number = tokens.at(index)
        read = None if found is None or len(number) > 40 else unit(found[0])
        if found is None or read is None or abs(_exponent(number)) > 40:
            return None
        value = in_si(Fraction(number), read)
        written = f"{number} {found[0]}"
        what = describe(read.dimension) if not read.angular else "an angle or a rate of it"
        return f"`{written}` = {value}\n\nIn SI units; {what}.", Span(start, stop)
    return None


def _exponent(number: str) -> int:
    return int(number.lower().partition("e")[2] or 0)


# --- The text of a hover for clients that do not show Markdown ------------------------------------


_FENCE = re.compile(r"^```\w*\n(.*?)^```$\n?", re.MULTILINE | re.DOTALL)
_MARKED = re.compile(r"`([^`\n]+)`|\*\*(.+?)\*\*")


def plain_text(markdown: str) -> str:
    """The Markdown of hovers as plain text, without marks for fences, code and bold.

    The content of a fence is unchanged.
    """
    outside_and_fenced = _FENCE.split(markdown)
    return "".join(
        part if index % 2 else _unmarked(part) for index, part in enumerate(outside_and_fenced)
    )


def _unmarked(text: str) -> str:
    return _MARKED.sub(lambda found: found[1] or _unmarked(found[2]), text)

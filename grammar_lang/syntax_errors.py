"""What the parser rejects, said in the words of the language."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from grammar_lang.codes import Code
from grammar_lang.diagnostics import Sink
from grammar_lang.items import RawItem
from grammar_lang.source import Span
from grammar_lang.spelling import nearest
from grammar_lang.units import UNIT_NAMES

RESERVED = ("and", "or", "not", "empty", "this", "world", "start", "accept", "x", "y", "z")

_TOKEN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*|[0-9][0-9.]*|'[^'\n]*'|\"[^\"\n]*\"|->|[<>=]=|.", re.S)
_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_OPERATORS = frozenset({"+", "-", "*", "/", "^"})
_EXPRESSION = frozenset({"a number", "(", "-", "world", "this", "x", "y", "z", "a name"})


@dataclass(frozen=True, slots=True)
class Rejection:
    """The parser stopped at ``offset``, where one of ``expected`` (terminals as text) may stand.

    ``expected`` is None where no token could be read at all.
    """

    offset: int
    expected: frozenset[str] | None


def display_names(patterns: Mapping[str, str | None]) -> dict[str, str]:
    """What each terminal is called: its text, or a description where it is a pattern (None)."""
    described = {
        "NAME": "a name",
        "NUMBER": "a number",
        "STRING": "a quoted string",
        "UNIT": "a unit",
        "$END": "the end",
    }
    return {t: described.get(t, t) if p is None else p for t, p in patterns.items()}


def _quoted(name: str) -> str:
    return name if " " in name else f"`{name}`"


def _wanted(expected: frozenset[str]) -> str:
    """``expected`` as a phrase, operators and the beginnings of an expression summed up."""
    names = set(expected)
    if {"a number", "(", "-"} <= names:
        names = (names - _EXPRESSION) | {"an expression"}
    rest = names - _OPERATORS - {"a unit"}
    names = rest or names
    shown = [_quoted(n) for n in sorted(names)]
    if len(shown) > 8:
        shown = [*shown[:8], "…"]
    return shown[0] if len(shown) == 1 else f"one of {', '.join(shown)}"


def _keyword_hint(word: str, expected: Iterable[str]) -> str | None:
    close = nearest(word, sorted(e for e in expected if _WORD.fullmatch(e)))
    return None if close is None else f"did you mean `{close}`?"


def _character(text: str, offset: int, sink: Sink) -> None:
    character = text[offset]
    hint = None
    if character in "'\"":
        hint = "a quoted string ends on its own line"
    elif character.isalpha():
        hint = "names are made of the letters A to Z, digits and `_`"
    shown = f"`{character}`" if character.isprintable() else f"U+{ord(character):04X}"
    sink.error(
        Code.UNEXPECTED_CHARACTER,
        f"unexpected character {shown}",
        Span(offset, offset + 1),
        hint or "remove it",
    )


def _unfinished(item: RawItem, expected: frozenset[str], sink: Sink) -> None:
    end = item.span.end
    wanted = "`;`" if ";" in expected else _wanted(expected)
    if item.braces:
        sink.error(
            Code.SYNTAX,
            "expected `}`: a `{` is never closed",
            Span(end, end + 1),
            "add the missing `}`",
            [(item.braces[-1], "opened here")],
        )
    else:
        sink.error(
            Code.SYNTAX,
            f"expected {wanted} after this",
            Span(end, end + 1),
            f"add {wanted}",
        )


def _is_unknown_unit(text: str, found: Span, expected: frozenset[str]) -> bool:
    if "a unit" not in expected or not _WORD.match(text, found.start):
        return False
    before = text[: found.start].rstrip()[-1:]
    return before.isdigit() or before in {")", "]", "}"}


def _unit(text: str, found: Span, sink: Sink) -> None:
    word = text[found.start : found.end]
    close = nearest(word, UNIT_NAMES)
    known = f"the units are {' '.join(UNIT_NAMES)}, joined by `*`, `/` and `^`"
    hint = known if close is None else f"did you mean `{close}`? {known}"
    sink.error(Code.UNKNOWN_UNIT, f"unknown unit `{word}`", found, hint)


def explain(text: str, item: RawItem, rejection: Rejection, sink: Sink) -> None:
    """Report the first thing in ``item`` that the parser does not take."""
    if rejection.expected is None:
        _character(text, rejection.offset, sink)
        return
    expected, offset = rejection.expected, rejection.offset
    wanted = _wanted(expected)
    if offset >= item.span.end:
        _unfinished(item, expected, sink)
        return
    match = _TOKEN.match(text, offset)
    found = Span(offset, offset + 1 if match is None else match.end())
    word = text[found.start : found.end]
    hint = _keyword_hint(word, expected) if _WORD.fullmatch(word) else None
    previous = item.before(offset)
    new_line = "\n" in text[previous.end : offset]
    if hint is None and not new_line and _is_unknown_unit(text, found, expected):
        _unit(text, found, sink)
        return
    if ";" in expected and new_line:
        sink.error(Code.SYNTAX, "expected `;`", Span(previous.end, previous.end + 1), "add the `;`")
        return
    if word in RESERVED and "a name" in expected:
        hint = f"`{word}` is reserved; choose another name"
    hint = hint or f"write {wanted} here"
    sink.error(Code.SYNTAX, f"expected {wanted}, found `{word}`", found, hint)

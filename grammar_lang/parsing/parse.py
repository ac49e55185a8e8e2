"""Text to abstract syntax, item by item; every error that can be told from the next is reported."""

from __future__ import annotations

import gc
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import wraps
from typing import ParamSpec, TypeVar

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import nearest
from grammar_lang.parsing.lalr import RESERVED, TOO_DEEP, Parser, tables
from grammar_lang.parsing.tokens import (
    BAD,
    KEYWORDS,
    WORD,
    RawItem,
    Tokens,
    cut,
    tokenise,
    unclosed_comment,
)
from grammar_lang.parsing.tree_builder import BUILDERS, item_of
from grammar_lang.source import Span
from grammar_lang.syntax.tasks import File, Item
from grammar_lang.units import UNIT_NAMES

# --- Work without pauses for the collection of cyclic garbage -------------------------------------
#
# Trees of a large file are millions of objects without a cycle.  Python's collector walks through
# all of them again and again while they are made, which took a third of the time of ``check`` at 2
# MB and made it more than linear.


Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def without_collection(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """The function, during whose calls no cyclic garbage is collected."""

    @wraps(function)
    def paused(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Result:
        if not gc.isenabled():
            return function(*args, **kwargs)
        gc.disable()
        try:
            return function(*args, **kwargs)
        finally:
            gc.enable()

    return paused


MAX_ERRORS = 100
"""So many syntax errors of one file are reported; who has more has another kind of file."""


@dataclass(slots=True)
class _Reader:
    tokens: Tokens
    sink: Sink
    found: list[Item] = field(default_factory=list[Item])
    broken: list[Span] = field(default_factory=list[Span])
    skipped: set[str] = field(default_factory=set[str])
    errors: int = 0

    def read(self) -> File:
        """Every item, until there are too many errors."""
        astray: int | None = None
        for raw in cut(self.tokens):
            if self.errors >= MAX_ERRORS:
                astray = raw.first if astray is None else astray
                break
            if self.tokens.at(raw.first) in KEYWORDS:
                self._lose(astray, raw.first)
                astray = None
                self._item(raw)
            elif astray is None or self._looks_like_item(raw):
                astray = raw.first if astray is None else astray
                stray(self.tokens, raw, self.sink)
                self.errors += 1
        self._lose(astray, len(self.tokens))
        return File(tuple(self.found), tuple(self.broken), frozenset(self.skipped))

    def _looks_like_item(self, raw: RawItem) -> bool:
        """Whether ``WORD NAME {`` stands there: an item whose keyword is misspelt."""
        return raw.stop - raw.first > 3 and self.tokens.kinds[raw.first : raw.first + 3] == [
            WORD,
            WORD,
            "{",
        ]

    def _lose(self, first: int | None, stop: int) -> None:
        """Give up the tokens before ``stop`` from ``first`` on, if there are such."""
        if first is None:
            return
        self.broken.append(self.tokens.span(first, stop - 1))
        words = map(self.tokens.at, range(first, stop))
        self.skipped.update(word for word in words if word[0].isidentifier())

    def _item(self, raw: RawItem) -> None:
        def complain(here: int, expected: frozenset[str]) -> bool:
            self.errors += 1
            explain(self.tokens, raw, here, expected, self.sink)
            return self.errors < MAX_ERRORS

        parser = Parser(tables(), self.tokens, BUILDERS, complain, self.skipped)
        value, sound = parser.item(raw)
        if value is not None:
            self.found.append(item_of(value))
        if not sound:
            self.broken.append(self.tokens.span(raw.first, raw.stop - 1))


@without_collection
def parse_tokens(text: str, sink: Sink, file: int = 0) -> tuple[File, Tokens]:
    """As :func:`parse`; also the tokens, each with the terminal that it is."""
    tokens = tokenise(text, file)
    comment = unclosed_comment(tokens)
    if comment is not None:
        sink.error(Code.SYNTAX, "this comment is never closed", comment, "add `*/`")
        return File((), (comment,)), tokens
    return _Reader(tokens, sink).read(), tokens


def parse(text: str, sink: Sink, file: int = 0) -> File:
    """The items of ``text`` that can be read; whatever cannot is reported.

    Args:
        text: the text of a file.
        sink: takes the errors.
        file: the number of the file, for the spans.
    """
    return parse_tokens(text, sink, file)[0]


# --- What the parser rejects, said in the words of the language -----------------------------------


MAX_SHOWN = 40

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_OPERATORS = frozenset({"+", "-", "*", "/", "^"})
_EXPRESSION = frozenset({"NUMBER", "(", "-", "world", "this", "x", "y", "z", "NAME"})
_LOOKALIKES = {
    "\N{DEGREE SIGN}": "`deg`",
    "\N{MINUS SIGN}\N{EN DASH}\N{EM DASH}\N{HYPHEN}\N{NON-BREAKING HYPHEN}": "`-`",
    "\N{MULTIPLICATION SIGN}": "`x` between sides, `*` between numbers",
    "\N{MIDDLE DOT}\N{DOT OPERATOR}": "`*`",
    "\N{LEFT DOUBLE QUOTATION MARK}\N{RIGHT DOUBLE QUOTATION MARK}": '`"`',
    "\N{LEFT SINGLE QUOTATION MARK}\N{RIGHT SINGLE QUOTATION MARK}": "`'`",
    "\N{LESS-THAN OR EQUAL TO}": "`<=`",
    "\N{GREATER-THAN OR EQUAL TO}": "`>=`",
    "\N{RIGHTWARDS ARROW}": "`->`",
    "\N{NO-BREAK SPACE}\N{ZERO WIDTH SPACE}\N{ZERO WIDTH NO-BREAK SPACE}": "a plain blank",
}
_COMPARISONS = frozenset({"<", "<=", "==", ">=", ">"})
_HORIZON = "write a number of steps and how long one is, as in `horizon 10 steps of 0.2 s`"
_AT_MOST = (
    "write `horizon 10 steps of 0.2 s` for just so many steps, or `horizon at most 10 steps of "
    "0.2 s` for any number of them up to that"
)
_DESCRIBED = {
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a quoted string",
    "UNIT": "a unit",
    "EXPRESSION": "an expression",
    "$END": "the end",
}


def _quoted(name: str) -> str:
    return _DESCRIBED.get(name, f"`{name}`")


def _wanted(expected: frozenset[str]) -> str:
    """``expected`` as a phrase, operators and the beginnings of an expression summed up."""
    names = set(expected)
    if {"NUMBER", "(", "-"} <= names:
        names = (names - _EXPRESSION) | {"EXPRESSION"}
    names = names - _OPERATORS - {"UNIT"} or names
    shown = sorted(_quoted(n) for n in names)
    shown.sort(key=lambda name: (name[0] != "`", name))
    if len(shown) > 8:
        return f"one of {', '.join(shown[:8])}, …"
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} or {shown[-1]}"


def _shortened(text: str) -> str:
    return text if len(text) <= MAX_SHOWN else f"{text[: MAX_SHOWN - 1]}…"


def _keyword_hint(word: str, expected: Iterable[str]) -> str | None:
    keywords = sorted(e for e in expected if e not in _DESCRIBED and _WORD.fullmatch(e))
    close = nearest(word, keywords) if len(word) <= MAX_SHOWN else None
    return None if close is None else f"did you mean `{close}`?"


def _character(tokens: Tokens, here: int, sink: Sink) -> None:
    character = tokens.at(here)
    meant = next((meant for like, meant in _LOOKALIKES.items() if character in like), None)
    hint = "remove it" if meant is None else f"write {meant}"
    if character in {"'", '"'}:
        hint = "a quoted string ends on its own line"
    elif character.isalpha():
        hint = "names are made of the letters A to Z, digits and `_`"
    shown = f"`{character}`" if character.isprintable() else f"U+{ord(character):04X}"
    message = f"unexpected character {shown}"
    sink.error(Code.UNEXPECTED_CHARACTER, message, tokens.span(here), hint)


def _after(tokens: Tokens, here: int) -> Span:
    """Just after the token before."""
    end = tokens.ends[here - 1]
    return Span(end, end + 1, tokens.file)


def _unfinished(tokens: Tokens, item: RawItem, expected: frozenset[str], sink: Sink) -> None:
    at = _after(tokens, item.stop)
    if item.braces:
        message = "expected `}`: a `{` is never closed"
        notes = [(tokens.span(item.braces[-1]), "opened here")]
        sink.error(Code.SYNTAX, message, at, "add the missing `}`", notes)
    else:
        wanted = "`;`" if ";" in expected else _wanted(expected)
        sink.error(Code.SYNTAX, f"expected {wanted} after this", at, f"add {wanted}")


def _unknown_unit(tokens: Tokens, here: int, sink: Sink) -> None:
    word = _shortened(tokens.at(here))
    # `Nm` stands for a product; in `kgm` or `rads` a stroke may be missing instead.
    factors = word[:1], word[1:]
    product = factors[0].isupper() and all(factor in UNIT_NAMES for factor in factors)
    close = "*".join(factors) if product else nearest(word, UNIT_NAMES)
    known = f"the units are {' '.join(UNIT_NAMES)}, joined by `*`, `/` and `^`"
    hint = known if close is None else f"did you mean `{close}`? {known}"
    sink.error(Code.UNKNOWN_UNIT, f"unknown unit `{word}`", tokens.span(here), hint)


def _is_unknown_unit(tokens: Tokens, here: int, expected: frozenset[str]) -> bool:
    word = tokens.at(here)
    if "UNIT" not in expected or not _WORD.fullmatch(word) or word in tables().words:
        return False
    return tokens.kinds[here - 1] in {"NUMBER", ")", "]", "}"} and not tokens.on_new_line(here)


def _habit_hint(tokens: Tokens, here: int, wanted: str) -> str | None:
    """What to write instead of something that other notations have."""
    if wanted in {"`steps`", "`of`"}:
        return _HORIZON
    if "horizon" in map(tokens.at, range(max(0, here - 3), here)):
        return _AT_MOST
    if wanted == "`(`" and tokens.at(here - 1) == "at":
        return "write coordinates of joints, as in `start at (30 deg, 0)`, or `start in` a region"
    if wanted == "`feedback` or `open`" and tokens.at(here) == "closed":
        return "write `control feedback` for a closed loop"
    if wanted == "a name" and tokens.at(here - 1) == "margin":
        return "the margin stands before `except`"
    if wanted == "a name" and "except" in (tokens.at(here - 1), tokens.at(here - 2)):
        return "modules stand in pairs, as in `except Hand Tube, Tube Tube`"
    if wanted == "`%`" and "within" in map(tokens.at, range(max(0, here - 6), here)):
        return "`within` takes a share in percent, as in `within 5 %`"
    if "`then`" in wanted and tokens.at(here) in {",", "and"}:
        return "write `then` between objectives"
    if wanted == "`;` or `}`" and tokens.at(here) in _COMPARISONS:
        return "an inequality has two sides: write two of them, with `;` between"
    return None


_STATEMENTS = (
    "role", "param", "const", "dof", "drive", "frame", "port", "state", "input", "der", "torque",
)  # fmt: skip
"""The words with which statements of a module begin, beside its bodies."""


def _misspelt(tokens: Tokens, item: RawItem, here: int, sink: Sink) -> bool:
    """Report a word at the beginning of a statement that is none, where one is nearly meant."""
    begins = here >= 2 and tokens.at(here - 2) in {"{", "}", ";"}
    known = {"module": _STATEMENTS, "semantics": ("let",)}.get(tokens.at(item.first), ())
    if not known or not begins or not _WORD.fullmatch(tokens.at(here - 1)):
        return False
    word = _shortened(tokens.at(here - 1))
    close = nearest(word, known) if len(word) <= MAX_SHOWN else None
    if close is None and len(known) == 1:
        return False
    words = ", ".join(f"`{name}`" for name in _STATEMENTS)
    hint = f"it is one of {words}, or a body such as `rod(…)`"
    hint = hint if close is None else f"did you mean `{close}`?"
    message = f"no statement of a {tokens.at(item.first)} begins with `{word}`"
    sink.error(Code.SYNTAX, message, tokens.span(here - 1), hint)
    return True


def _wrong(tokens: Tokens, item: RawItem, here: int, expected: frozenset[str], sink: Sink) -> None:
    """Report a token that does not fit."""
    word, wanted = _shortened(tokens.at(here)), _wanted(expected)
    hint = _keyword_hint(word, expected) if _WORD.fullmatch(word) else None
    if word == "let" and tokens.at(item.first) == "module":
        hint = "in a module, `const` gives a number a name, and `frame` a frame"
    if hint is None and _is_unknown_unit(tokens, here, expected):
        _unknown_unit(tokens, here, sink)
    elif ";" in expected and (tokens.on_new_line(here) or word == "}"):
        sink.error(Code.SYNTAX, "expected `;`", _after(tokens, here), "add the `;`")
    else:
        if word in RESERVED and "NAME" in expected:
            hint = f"`{word}` is reserved; choose another name"
        due = "`;`" if ";" in expected and word in {",", ":", "."} else wanted
        hint = hint or _habit_hint(tokens, here, wanted) or f"write {due} here"
        message = f"expected {wanted}, found `{word}`"
        sink.error(Code.SYNTAX, message, tokens.span(here), hint)


def explain(tokens: Tokens, item: RawItem, here: int, expected: frozenset[str], sink: Sink) -> None:
    """Report the token ``here`` of an item, where one of ``expected`` would have to stand."""
    if expected is TOO_DEEP:
        at = tokens.span(min(here, item.stop - 1))
        hint = "split it into constants or attributes"
        sink.error(Code.TOO_DEEP, "this is nested too deeply", at, hint)
    elif here >= item.stop:
        _unfinished(tokens, item, expected, sink)
    elif tokens.kinds[here] == BAD:
        _character(tokens, here, sink)
    elif not expected <= {"(", "."} or not _misspelt(tokens, item, here, sink):
        _wrong(tokens, item, here, expected, sink)


def stray(tokens: Tokens, item: RawItem, sink: Sink) -> None:
    """Report tokens outside all items."""
    word = _shortened(tokens.at(item.first))
    at = tokens.span(item.first)
    if tokens.kinds[item.first] == BAD:
        _character(tokens, item.first, sink)
        return
    shown = ", ".join(f"`{keyword}`" for keyword in sorted(KEYWORDS))
    if word == "}":
        hint = "remove it: no `{` is open here"
    else:
        hint = _keyword_hint(word, KEYWORDS) or f"a declaration begins with one of {shown}"
    sink.error(Code.SYNTAX, f"expected one of {shown}, found `{word}`", at, hint)

"""The tokens of a text, and the ranges of tokens that items are parsed from."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from grammar_lang.source import Span

# --- A text as tokens, found in one pass and kept in parallel lists -------------------------------
#
# Whether a word is a keyword or a name, and whether it is a unit, depends on where it stands; the
# parser decides it and writes the terminal into ``kinds``.


WORD, NUMBER, STRING, BAD, SKIPPED = "WORD", "NUMBER", "STRING", "BAD", "SKIPPED"
_CLASSES = (None, WORD, NUMBER, NUMBER, None, STRING, BAD, BAD, BAD)
_PLAIN_NUMBER, _HASH = 2, 7
_SLIPS = frozenset({_PLAIN_NUMBER, _HASH})
_ENDS = frozenset({";", "{", "}"})
"""Tokens that end a regular expression."""

_TOKEN = re.compile(
    r"""(?:[ \t\r\n\f\v]+|//[^\n]*|/\*(?:[^*]|\*(?!/))*+\*/)*+
    (?:([A-Za-z_][A-Za-z0-9_]*)
      |([0-9]+\.(?![0-9A-Za-z_.])|(?<![A-Za-z0-9_.)\]])\.[0-9]+(?:[eE][+-]?[0-9]+)?)
      |([0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)
      |(::=|->|[<>=:!]=|=>|\*\*|&&|\|\||[-;:,.{}()\[\]=<>|*+?^%]|/(?!\*))
      |('[^'\n]*'|"[^"\n]*")
      |(/\*.*)
      |(\#[^\n]*)
      |(.)
      |\Z)""",
    re.DOTALL | re.VERBOSE,
)


@dataclass(slots=True)
class Tokens:
    """The tokens of a text in order; token ``i`` is ``text[starts[i]:ends[i]]``.

    ``kinds[i]`` is a class (WORD, NUMBER, STRING, BAD), the text of an operator or bracket, or what
    the parser has written: a terminal of the grammar, or SKIPPED if an earlier token (a unit)
    covers this one.  ``slips`` are comments that begin with ``#``, which are not tokens, and
    numbers without a digit before or after the point, which are.
    """

    text: str
    file: int
    kinds: list[str]
    starts: list[int]
    ends: list[int]
    slips: list[Span] = field(default_factory=list[Span])

    def __len__(self) -> int:
        return len(self.kinds)

    def at(self, index: int) -> str:
        """The text of a token."""
        return self.text[self.starts[index] : self.ends[index]]

    def span(self, first: int, last: int | None = None) -> Span:
        """The span from the start of one token to the end of another (by default the same)."""
        end = self.ends[first if last is None else last]
        return Span(self.starts[first], end, self.file)

    def on_new_line(self, index: int) -> bool:
        """Whether a line break lies between a token and the previous one."""
        if index == 0:
            return True
        stop = len(self.text) if index >= len(self) else self.starts[index]
        return "\n" in self.text[self.ends[index - 1] : stop]


def tokenise(text: str, file: int = 0) -> Tokens:
    """The tokens of a text, without comments and blanks; an unclosed comment is one BAD token."""
    kinds: list[str] = []
    starts: list[int] = []
    ends: list[int] = []
    slips: list[Span] = []
    regular = False
    for match in _TOKEN.finditer(text):
        index = match.lastindex
        if index is None:
            continue
        if index in _SLIPS:
            slips.append(Span(match.start(index), match.end(), file))
            if index == _HASH:
                continue
        kind = _CLASSES[index] or match[index]
        if kind == WORD:
            regular = regular or match[index] == "matches"
        elif kind in _ENDS:
            regular = False
        elif kind == "**" and regular:  # two marks of a regular expression
            kinds.append("*")
            starts.append(match.start(index))
            ends.append(match.start(index) + 1)
            kinds.append("*")
            starts.append(match.start(index) + 1)
            ends.append(match.end())
            continue
        kinds.append(kind)
        starts.append(match.start(index))
        ends.append(match.end())
    return Tokens(text, file, kinds, starts, ends, slips)


def unclosed_comment(tokens: Tokens) -> Span | None:
    """The ``/*`` that no ``*/`` closes; None if there is none."""
    last = len(tokens) - 1
    if last < 0 or not tokens.at(last).startswith("/*"):
        return None
    start = tokens.starts[last]
    return Span(start, start + 2, tokens.file)


# --- Split the tokens into top-level items, so that an error in one does not hide others ----------
#
# An item ends with a ``;`` outside all braces or with the ``}`` that closes its last brace.  If a
# brace or a ``;`` is missing, tokens that can only begin an item start a new one:
# ``KEYWORD NAME {``, and ``edge NAME`` or ``include "FILE"`` on a new line.


BLOCK_KEYWORDS = frozenset({"module", "grammar", "semantics", "workspace", "task", "mission"})
KEYWORDS = BLOCK_KEYWORDS | {"edge", "include"}


@dataclass(frozen=True, slots=True)
class RawItem:
    """The tokens ``first <= i < stop`` of an item; ``braces`` are its unclosed ``{``."""

    first: int
    stop: int
    braces: tuple[int, ...]


def _starts_item(tokens: Tokens, here: int, *, inside: bool) -> bool:
    """Whether an item begins here: ``KEYWORD NAME {``, ``edge NAME`` or ``include "…"``.

    Inside braces, only where a statement may begin; ``edge`` and ``include`` only on a new line.
    """
    kinds, word = tokens.kinds, tokens.at(here)
    if word not in KEYWORDS or (inside and kinds[here - 1] not in {";", "{", "}"}):
        return False
    if word not in BLOCK_KEYWORDS:
        follows = tokens.at(here + 1) if here + 1 < len(kinds) else ""
        named = follows[:1] in {"'", '"'} or (word == "edge" and follows.isidentifier())
        named = named or (word == "include" and follows == "std")
        return named and kinds[here - 1] != "," and tokens.on_new_line(here)
    brace = here + 2
    if word == "grammar" and kinds[brace : brace + 3] == [WORD, WORD, "{"]:
        brace += 2  # `from ports`
    return brace < len(kinds) and kinds[brace] == "{" and kinds[here + 1] == WORD


def cut(tokens: Tokens) -> Iterator[RawItem]:
    """The items in order; every token belongs to exactly one."""
    kinds = tokens.kinds
    braces: list[int] = []
    first = 0
    for here, kind in enumerate(kinds):
        if kind == WORD:
            if here > first and _starts_item(tokens, here, inside=bool(braces)):
                yield RawItem(first, here, tuple(braces))
                first, braces = here, []
        elif kind == "{":
            braces.append(here)
        elif kind == "}" or kind == ";":
            if kind == "}" and braces:
                braces.pop()
            if not braces:
                yield RawItem(first, here + 1, ())
                first = here + 1
    if first < len(kinds):
        yield RawItem(first, len(kinds), tuple(braces))

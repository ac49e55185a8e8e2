"""Tokens of a text, and the stretches of tokens that declarations are parsed from."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from grammar_lang.source import Span

# --- A text as tokens, found in one pass and kept in parallel lists -------------------------------
#
# What a word is (a keyword or a name) and whether a unit stands somewhere depends on the place; the
# parser decides it and writes the terminal into ``kinds``.


WORD, NUMBER, STRING, BAD, SKIPPED = "WORD", "NUMBER", "STRING", "BAD", "SKIPPED"
_CLASSES = (None, WORD, NUMBER, None, STRING, BAD, BAD)

_TOKEN = re.compile(
    r"""(?:[ \t\r\n\f\v]+|//[^\n]*|/\*(?:[^*]|\*(?!/))*+\*/)*+
    (?:([A-Za-z_][A-Za-z0-9_]*)
      |([0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?)
      |(->|[<>=]=|[-;:,.{}()\[\]=<>|*+?^%]|/(?!\*))
      |('[^'\n]*'|"[^"\n]*")
      |(/\*.*)
      |(.)
      |\Z)""",
    re.DOTALL | re.VERBOSE,
)


@dataclass(slots=True)
class Tokens:
    """The tokens of a text in order; token ``i`` is ``text[starts[i]:ends[i]]``.

    ``kinds[i]`` is a class (WORD, NUMBER, STRING, BAD), the text itself of an operator or bracket,
    or what the parser has found: a terminal of the grammar, or SKIPPED where an earlier token (a
    unit) covers this one.
    """

    text: str
    file: int
    kinds: list[str]
    starts: list[int]
    ends: list[int]

    def __len__(self) -> int:
        return len(self.kinds)

    def at(self, index: int) -> str:
        """The text of a token."""
        return self.text[self.starts[index] : self.ends[index]]

    def span(self, first: int, last: int | None = None) -> Span:
        """From the beginning of one token to the end of another (of itself)."""
        end = self.ends[first if last is None else last]
        return Span(self.starts[first], end, self.file)

    def on_new_line(self, index: int) -> bool:
        """Whether a line break lies between a token and the one before it."""
        if index == 0:
            return True
        stop = len(self.text) if index >= len(self) else self.starts[index]
        return "\n" in self.text[self.ends[index - 1] : stop]


def tokenise(text: str, file: int = 0) -> Tokens:
    """The tokens of a text; comments and blanks are none.  An unclosed comment is one BAD token."""
    kinds: list[str] = []
    starts: list[int] = []
    ends: list[int] = []
    for match in _TOKEN.finditer(text):
        index = match.lastindex
        if index is None:
            continue
        kinds.append(_CLASSES[index] or match[index])
        starts.append(match.start(index))
        ends.append(match.end())
    return Tokens(text, file, kinds, starts, ends)


def unclosed_comment(tokens: Tokens) -> Span | None:
    """The ``/*`` that no ``*/`` closes."""
    last = len(tokens) - 1
    if last < 0 or not tokens.at(last).startswith("/*"):
        return None
    start = tokens.starts[last]
    return Span(start, start + 2, tokens.file)


# --- Cuts tokens into top-level items, so that an error in one does not hide those in others ------
#
# An item ends with the ``;`` outside all braces or the ``}`` that closes its last brace.  Where a
# brace is missing, ``KEYWORD NAME {`` at the beginning of a statement starts a new item: no
# statement of the language looks like that.


BLOCK_KEYWORDS = frozenset({"module", "grammar", "semantics", "workspace", "task", "mission"})
KEYWORDS = BLOCK_KEYWORDS | {"edge", "include"}


@dataclass(frozen=True, slots=True)
class RawItem:
    """The tokens ``first <= i < stop`` of one item; ``braces`` are the ``{`` nothing closes."""

    first: int
    stop: int
    braces: tuple[int, ...]


def _starts_item(tokens: Tokens, here: int, *, inside: bool) -> bool:
    """Whether ``KEYWORD NAME {`` stands here, where a statement may begin."""
    kinds = tokens.kinds
    brace = here + 2
    if tokens.at(here) == "grammar" and kinds[brace : brace + 3] == [WORD, WORD, "{"]:
        brace += 2  # `from ports`
    if brace >= len(kinds) or kinds[here] != WORD or kinds[brace] != "{":
        return False
    if kinds[here + 1] != WORD or tokens.at(here) not in BLOCK_KEYWORDS:
        return False
    return not inside or kinds[here - 1] in {";", "{", "}"}


def cut(tokens: Tokens) -> Iterator[RawItem]:
    """The items in order; every token belongs to one."""
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

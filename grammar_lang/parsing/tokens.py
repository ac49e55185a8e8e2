"""A text as tokens, found in one pass and kept in parallel lists.

What a word is (a keyword or a name) and whether a unit stands somewhere depends on the place; the
parser decides it and writes the terminal into ``kinds``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from grammar_lang.source import Span

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

"""The comments of a text: what lies between its tokens, and where each of them belongs.

A comment is no token.  It lies in the gap before a token (or after the last one); the line breaks
around it say whether it ends a line, has one to itself or leads one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from grammar_lang.parsing.tokens import SKIPPED, Tokens

BLANKS = " \t\r\f\v"

_COMMENT = re.compile(r"//[^\n]*|/\*(?:[^*]|\*(?!/))*+\*/")
_LINE_END = re.compile(r"[ \t\r\f\v]+$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment without the blanks that end its lines.

    ``breaks`` counts the line breaks between it and what comes before it, 2 standing for more.
    """

    text: str
    breaks: int

    @property
    def to_line_end(self) -> bool:
        """Whether it is a ``//`` comment: nothing can follow it on its line."""
        return self.text.startswith("//")

    @property
    def of_lines(self) -> bool:
        """Whether it spans several lines."""
        return "\n" in self.text


@dataclass(frozen=True, slots=True)
class Gap:
    """What lies before a token: comments, then ``breaks`` line breaks (2 standing for more)."""

    comments: tuple[Comment, ...]
    breaks: int

    @property
    def counts(self) -> tuple[int, ...]:
        """The line breaks before each comment and after the last."""
        return (*(comment.breaks for comment in self.comments), self.breaks)


_PLAIN = (Gap((), 0), Gap((), 1), Gap((), 2))


def _gap(text: str) -> Gap:
    if "/" not in text:
        return _PLAIN[min(text.count("\n"), 2)]
    comments: list[Comment] = []
    end = 0
    for match in _COMMENT.finditer(text):
        breaks = min(text.count("\n", end, match.start()), 2)
        comments.append(Comment(_LINE_END.sub("", match[0]), breaks))
        end = match.end()
    return Gap(tuple(comments), min(text.count("\n", end), 2))


@dataclass(frozen=True, slots=True)
class Written:
    """The tokens of a parsed text: ``kinds[i]`` is the terminal of token ``i``.

    ``gaps[i]`` lies before it; there is one gap more, after the last token.
    """

    kinds: tuple[str, ...]
    texts: tuple[str, ...]
    gaps: tuple[Gap, ...]


def written(tokens: Tokens) -> Written:
    """Tokens and gaps of a text that has been parsed; a unit is one token."""
    kept = [i for i, kind in enumerate(tokens.kinds) if kind != SKIPPED]
    text, starts, ends = tokens.text, tokens.starts, tokens.ends
    gaps: list[Gap] = []
    end = 0
    for i in kept:
        gaps.append(_gap(text[end : starts[i]]))
        end = ends[i]
    gaps.append(_gap(text[end:]))
    texts = tuple(text[starts[i] : ends[i]] for i in kept)
    return Written(tuple(tokens.kinds[i] for i in kept), texts, tuple(gaps))


@dataclass(frozen=True, slots=True)
class Boundary:
    """The comments between two statements, by their places.

    ``trailing`` ends the line of the statement before.  ``above`` are lines of their own, each with
    whether a blank line goes before it.  ``leading`` are on the line of the next statement.
    ``blank`` says whether a blank line goes before that line.
    """

    trailing: str
    above: tuple[tuple[bool, str], ...]
    leading: tuple[str, ...]
    blank: bool

    def parted(self) -> Boundary:
        """With at least one blank line, the first possible."""
        if self.blank or any(blank for blank, _ in self.above):
            return self
        if not self.above:
            return Boundary(self.trailing, (), self.leading, blank=True)
        above = ((True, self.above[0][1]), *self.above[1:])
        return Boundary(self.trailing, above, self.leading, self.blank)


def boundary(gap: Gap, *, follows: bool, first: bool, last: bool) -> Boundary:
    """The comments of a gap between statements.

    Args:
        gap: the gap.
        follows: whether anything comes before it in the text.
        first: whether it begins a body, or the text.
        last: whether it ends a body, or the text.
    """
    if not gap.comments:
        return Boundary("", (), (), gap.breaks == 2 and not first and not last)
    counts = gap.counts
    begin = _trailing(counts, first=first, last=last) if follows else 0
    above: list[tuple[bool, str]] = []
    line: list[str] = []
    blank, parted = False, not first
    for i in range(begin, len(gap.comments)):
        if not line:
            blank = counts[i] == 2 and parted
        line.append(gap.comments[i].text)
        stays = counts[i + 1] == 0 and not gap.comments[i].of_lines
        if not stays or (last and i + 1 == len(gap.comments)):
            above.append((blank, " ".join(line)))
            line, parted = [], True
    if not line:
        blank = counts[-1] == 2 and parted and not last
    texts = (comment.text for comment in gap.comments[:begin])
    return Boundary(" ".join(texts), tuple(above), tuple(line), blank)


def _trailing(counts: tuple[int, ...], *, first: bool, last: bool) -> int:
    """How many comments end the line of the statement before: those before the first break."""
    for i, count in enumerate(counts):
        if count:
            return i
    return len(counts) - 1 if last and not first else 0

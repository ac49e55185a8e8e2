"""The comments of a text, and the token or line that each belongs to.

A comment is not a token.  It lies in the gap before a token (or after the last one).  The line
breaks around it decide whether it ends a line, stands on its own line or leads one.
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
    """A comment, without trailing spaces on its lines.

    ``breaks`` counts the line breaks between it and what comes before it; 2 stands for more.
    """

    text: str
    breaks: int

    @property
    def to_line_end(self) -> bool:
        """Whether it is a ``//`` comment, so that nothing can follow it on its line."""
        return self.text.startswith("//")

    @property
    def of_lines(self) -> bool:
        """Whether it spans several lines."""
        return "\n" in self.text


@dataclass(frozen=True, slots=True)
class Gap:
    """The comments before a token, then ``breaks`` line breaks (2 stands for more)."""

    comments: tuple[Comment, ...]
    breaks: int

    @property
    def counts(self) -> tuple[int, ...]:
        """The numbers of line breaks before each comment and after the last."""
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

    ``gaps[i]`` is the gap before it; there is one more gap, after the last token.
    """

    kinds: tuple[str, ...]
    texts: tuple[str, ...]
    gaps: tuple[Gap, ...]


def written(tokens: Tokens) -> Written:
    """The tokens and gaps of a parsed text; a unit is one token."""
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

    ``trailing`` ends the line of the previous statement.  ``above`` are comments on their own
    lines, each with whether a blank line goes before it.  ``leading`` are on the line of the next
    statement, and ``blank`` is whether a blank line goes before that line.
    """

    trailing: str
    above: tuple[tuple[bool, str], ...]
    leading: tuple[str, ...]
    blank: bool

    def parted(self) -> Boundary:
        """The same boundary with at least one blank line, at the first possible place."""
        if self.blank or any(blank for blank, _ in self.above):
            return self
        if not self.above:
            return Boundary(self.trailing, (), self.leading, blank=True)
        above = ((True, self.above[0][1]), *self.above[1:])
        return Boundary(self.trailing, above, self.leading, self.blank)


def boundary(gap: Gap, *, follows: bool, first: bool, last: bool) -> Boundary:
    """The comments of a gap between statements, sorted by their places.

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
    """The number of comments that end the line of the previous statement."""
    for i, count in enumerate(counts):
        if count:
            return i
    return len(counts) - 1 if last and not first else 0

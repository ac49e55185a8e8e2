"""Cuts a text into its top-level items, so that an error in one does not hide those in others.

An item ends with the ``;`` outside all braces or the ``}`` that closes its last brace.  Where a
brace is missing, ``KEYWORD NAME {`` at the beginning of a statement starts a new item: no
statement of the language looks like that.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from grammar_lang.source import Span

_TOKEN = re.compile(
    r"""(?P<blank>[ \t\r\n\f\v]+|//[^\n]*|/\*.*?\*/)
      | (?P<open>/\*)
      | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
      | (?P<other>'[^'\n]*'|"[^"\n]*"|.)""",
    re.DOTALL | re.VERBOSE,
)
_KEYWORDS = frozenset({"module", "grammar", "semantics", "workspace", "task"})


@dataclass(frozen=True, slots=True)
class RawItem:
    """The tokens of one item; ``braces`` are the ``{`` that nothing closes."""

    tokens: tuple[Span, ...]
    braces: tuple[Span, ...]

    @property
    def span(self) -> Span:
        """From the first token to the last."""
        return self.tokens[0].to(self.tokens[-1])

    def before(self, offset: int) -> Span:
        """The last token that ends at or before ``offset``, else the first token."""
        found = self.tokens[0]
        for token in self.tokens:
            if token.end > offset:
                break
            found = token
        return found


@dataclass(slots=True)
class _Cutter:
    text: str
    tokens: list[Span] = field(default_factory=list[Span])
    braces: list[Span] = field(default_factory=list[Span])

    def take(self) -> RawItem:
        item = RawItem(tuple(self.tokens), tuple(self.braces))
        self.tokens, self.braces = [], []
        return item

    def starts_item(self, here: int, spans: list[Span]) -> bool:
        """Whether ``KEYWORD NAME {`` stands here, where a statement may begin."""
        words = [self.text[p.start : p.end] for p in spans[here : here + 3]]
        if len(words) < 3 or words[0] not in _KEYWORDS or words[2] != "{":
            return False
        if not words[1].isidentifier():
            return False
        last = self.text[self.tokens[-1].start : self.tokens[-1].end]
        return not self.braces or last in {";", "{", "}"}

    def add(self, token: Span) -> bool:
        """Take a token in; whether the item is complete."""
        self.tokens.append(token)
        match self.text[token.start : token.end]:
            case "{":
                self.braces.append(token)
            case "}":
                if self.braces:
                    self.braces.pop()
                return not self.braces
            case ";":
                return not self.braces
            case _:
                pass
        return False


def unclosed_comment(text: str) -> Span | None:
    """The ``/*`` that no ``*/`` closes."""
    for match in _TOKEN.finditer(text):
        if match.lastgroup == "open":
            return Span(match.start(), match.end())
    return None


def cut(text: str) -> Iterator[RawItem]:
    """The items of a text in order; blanks and comments belong to none."""
    spans = [Span(m.start(), m.end()) for m in _TOKEN.finditer(text) if m.lastgroup != "blank"]
    cutter = _Cutter(text)
    for here, token in enumerate(spans):
        if cutter.tokens and cutter.starts_item(here, spans):
            yield cutter.take()
        if cutter.add(token):
            yield cutter.take()
    if cutter.tokens:
        yield cutter.take()

"""Text to abstract syntax: LALR(1) by lark, item by item, every item's first error reported."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

from lark import Lark, TextSlice, Token, UnexpectedCharacters, UnexpectedToken
from lark.lark import PostLex
from lark.lexer import PatternStr

from grammar_lang.codes import Code
from grammar_lang.diagnostics import Sink
from grammar_lang.items import RawItem, cut, unclosed_comment
from grammar_lang.source import Span
from grammar_lang.syntax_errors import Rejection, display_names, explain
from grammar_lang.syntax_tasks import File, Item
from grammar_lang.tree_builder import build, too_deep


class _Words(PostLex):
    """Lets the contextual lexer see whole words everywhere: ``planexy`` is not ``plane xy``."""

    always_accept = ("NAME",)

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        """The tokens as they are."""
        return stream


@cache
def _parser() -> Lark:
    return Lark(
        Path(__file__).with_name("srg.lark").read_text(encoding="utf-8"),
        start="item",
        parser="lalr",
        lexer="contextual",
        propagate_positions=True,
        maybe_placeholders=True,
        postlex=_Words(),
    )


@cache
def _display_names() -> dict[str, str]:
    terminals = _parser().terminals
    patterns = {
        t.name: t.pattern.value if isinstance(t.pattern, PatternStr) else None for t in terminals
    }
    return display_names({**patterns, "$END": None})


def _item(text: str, raw: RawItem, sink: Sink) -> Item | None:
    span = raw.span
    try:
        tree = _parser().parse(TextSlice(text, span.start, span.end))
    except UnexpectedToken as error:
        names = _display_names()
        expected = frozenset(names.get(t, t) for t in error.accepts or error.expected)
        start = error.token.start_pos
        offset = span.end if error.token.type == "$END" or start is None else start
        explain(text, raw, Rejection(offset, expected), sink)
        return None
    except UnexpectedCharacters as error:
        explain(text, raw, Rejection(int(vars(error)["pos_in_stream"]), None), sink)
        return None
    deep = too_deep(tree)
    if deep is not None:
        sink.error(
            Code.TOO_DEEP,
            "this is nested too deeply",
            Span(deep.start, deep.start + 1),
            "split it into constants or attributes",
        )
        return None
    return build(tree)


def parse(text: str, sink: Sink) -> File:
    """The items of ``text`` that can be read; whatever cannot is reported."""
    comment = unclosed_comment(text)
    if comment is not None:
        sink.error(Code.SYNTAX, "this comment is never closed", comment, "add `*/`")
        return File(())
    items = [_item(text, raw, sink) for raw in cut(text)]
    return File(tuple(item for item in items if item is not None))

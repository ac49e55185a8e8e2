"""The context of the cursor: the statement that has been begun, and what may follow.

The parser itself is asked, with the tokens up to the cursor, so that a keyword is offered exactly
where it is one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from grammar_lang.parsing.lalr import Parser
from grammar_lang.parsing.tables import tables
from grammar_lang.parsing.tokens import BAD, KEYWORDS, WORD, RawItem, Tokens, cut, tokenise
from grammar_lang.parsing.tree_builder import BUILDERS

_IN_WORD = re.compile(r"[A-Za-z0-9_]")
_OPENING = {"(": ")", "[": "]", "{": "}"}


@dataclass(frozen=True, slots=True)
class Cursor:
    """The position of a cursor and its context.

    ``start`` is the start of the word under the cursor; that word and everything after it count as
    not yet written.  ``item`` has the keyword and the name of the item around the cursor, empty if
    there is none; ``block`` is the label of the block in a semantics.  ``statement`` has the tokens
    of the unfinished statement, ``before`` those of the whole item.  ``expected`` has the terminals
    that may follow; ``quoted`` is the text of an open string, None outside strings.
    """

    start: int
    item: tuple[str, str]
    block: str
    statement: tuple[str, ...]
    before: tuple[str, ...]
    expected: frozenset[str]
    quoted: str | None = None
    silent: bool = False


def _nowhere(start: int) -> Cursor:
    """The context in a comment, where nothing is offered."""
    return Cursor(start, ("", ""), "", (), (), frozenset(), silent=True)


def _word_start(text: str, offset: int) -> int:
    """The start of the word before an offset; in ``5m`` that is ``m``, and ``5`` has no word."""
    start = offset
    while start > 0 and _IN_WORD.match(text, start - 1):
        start -= 1
    while start < offset and text[start].isdigit():
        start += 1
    return start


def _open_string(tokens: Tokens, offset: int) -> tuple[int, str] | None:
    """The start and the text of a string that the cursor is in."""
    for index in range(len(tokens) - 1, -1, -1):
        if tokens.kinds[index] == BAD and tokens.at(index) in {'"', "'"}:
            start = tokens.ends[index]
            text = tokens.text[start:offset]
            return None if "\n" in text else (start, text)
        if "\n" in tokens.text[tokens.starts[index] : offset]:
            break
    return None


def _in_comment(tokens: Tokens, offset: int) -> bool:
    end = tokens.ends[-1] if len(tokens) else 0
    if len(tokens) and tokens.kinds[-1] == BAD and tokens.at(len(tokens) - 1).startswith("/*"):
        return True
    line = tokens.text[end:offset].rpartition("\n")[2]
    return "//" in line or "#" in line


def _last_item(tokens: Tokens) -> RawItem | None:
    """The last item, unless it is finished."""
    items = list(cut(tokens))
    if not items:
        return None
    last = items[-1]
    ended = not last.braces and tokens.kinds[last.stop - 1] in {";", "}"}
    return None if ended else last


def _statement(tokens: Tokens, item: RawItem) -> tuple[int, list[int]]:
    """The start of the statement, and the braces that are open there."""
    start, braces = item.first, list[int]()
    inner = 0
    for index in range(item.first, item.stop):
        kind = tokens.kinds[index]
        if kind == "{" and not _is_set(tokens, index, item):
            braces.append(index)
            start = index + 1
        elif kind == "{":
            inner += 1
        elif kind == "}" and inner:
            inner -= 1
        elif kind == "}" and braces:
            braces.pop()
            start = index + 1
        elif kind == ";" and not inner:
            start = index + 1
    return start, braces


def _is_set(tokens: Tokens, index: int, item: RawItem) -> bool:
    """Whether a brace opens a set of values or inequalities rather than a block."""
    return index > item.first and tokens.at(index - 1) in {"in", "polytope"}


def cursor_at(text: str, offset: int) -> Cursor:
    """The context of a cursor in a text."""
    start = _word_start(text, offset)
    tokens = tokenise(text[:start])
    if _in_comment(tokens, start):
        return _nowhere(start)
    string = _open_string(tokens, start)
    if string is not None:
        whole = tokenise(text[: string[0] - 1])
        found = _placed(whole, string[0])
        return Cursor(
            string[0], found.item, found.block, found.statement, found.before,
            found.expected, text[string[0] : offset],
        )  # fmt: skip
    return _placed(tokens, start)


def _placed(tokens: Tokens, start: int) -> Cursor:
    item = _last_item(tokens)
    if item is None:
        return Cursor(start, ("", ""), "", (), (), KEYWORDS)
    words = [tokens.at(index) for index in range(item.first, item.stop)]
    first, braces = _statement(tokens, item)
    keyword = words[0] if words[0] in KEYWORDS else ""
    name = words[1] if len(words) > 1 and tokens.kinds[item.first + 1] == WORD else ""
    block = ""
    if keyword == "semantics" and len(braces) > 1:
        block = tokens.at(braces[1] - 1)
    statement = tuple(words[first - item.first :])
    # The parser changes the kinds of the tokens.
    expected = Parser(tables(), tokens, BUILDERS, lambda *_: True).expected(item)
    return Cursor(start, (keyword, name), block, statement, tuple(words), expected)


@dataclass(frozen=True, slots=True)
class OpenCall:
    """A call that is not closed: its name, and the number of its last argument.

    ``named`` are the names of the arguments so far; ``current`` is the name of the last one.
    """

    name: str
    argument: int
    named: tuple[str, ...]
    current: str = ""


def open_call(statement: Sequence[str]) -> OpenCall | None:
    """The innermost open call at the end of a statement."""
    depth = 0
    for index in range(len(statement) - 1, 0, -1):
        word = statement[index]
        if word in _OPENING.values():
            depth += 1
        elif word in _OPENING and depth:
            depth -= 1
        elif word == "(" and statement[index - 1].isidentifier():
            arguments = list(_arguments(statement[index + 1 :]))
            named = [a[0] if len(a) > 1 and a[1] == ":" else "" for a in arguments]
            given = tuple(filter(None, named))
            return OpenCall(statement[index - 1], len(arguments) - 1, given, named[-1])
        elif word in _OPENING:
            return None
    return None


def _arguments(words: Sequence[str]) -> Iterator[list[str]]:
    """The words of each argument; the last one is unfinished."""
    depth, argument = 0, list[str]()
    for word in words:
        if word in _OPENING:
            depth += 1
        elif word in _OPENING.values():
            depth -= 1
        if word == "," and not depth:
            yield argument
            argument = []
        else:
            argument.append(word)
    yield argument

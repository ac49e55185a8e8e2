"""Positions against Python's own codecs, and changes against a client's own edits."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from lsprotocol import types as lsp

from srgc.language_server.documents.line_map import LineMap
from srgc.language_server.documents.open_documents import Document, OpenDocuments, readable

TEXTS = st.text(alphabet="ab \t\r\n\u2028\x0b\u0301é\U0001f916{;", max_size=30)
SIZES = {"utf-8": 1, "utf-16": 2, "utf-32": 4}
CODECS = {"utf-8": "utf-8", "utf-16": "utf-16-le", "utf-32": "utf-32-le"}


def place(text: str, offset: int, encoding: str) -> tuple[int, int]:
    """The position of an offset, from the definition alone."""
    before = text[:offset]
    lines = before.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    last = lines[-1].encode(CODECS[encoding])
    return len(lines) - 1, len(last) // SIZES[encoding]


@pytest.mark.parametrize("encoding", SIZES)
@given(text=TEXTS, data=st.data())
def test_there_and_back(encoding: str, text: str, data: st.DataObject) -> None:
    offset = data.draw(st.integers(0, len(text)))
    if text[offset - 1 : offset + 1] == "\r\n":
        offset -= 1  # between CR and LF there is no position
    lines = LineMap(text, encoding)
    position = lines.position(offset)
    assert (position.line, position.character) == place(text, offset, encoding)
    assert lines.offset(position) == offset


@given(TEXTS, st.integers(0, 50), st.integers(0, 50))
def test_any_position_is_some_offset(text: str, line: int, character: int) -> None:
    offset = LineMap(text).offset(lsp.Position(line, character))
    assert 0 <= offset <= len(text)


def test_half_a_robot() -> None:
    """A position in the middle of a surrogate pair is before it; one beyond a line is its end."""
    lines = LineMap("a\U0001f916b\r\nc")
    assert [lines.offset(lsp.Position(0, n)) for n in range(7)] == [0, 1, 1, 2, 3, 3, 3]
    assert lines.position(2) == lsp.Position(0, 3)
    assert lines.offset(lsp.Position(9, 9)) == len(lines.text)


@given(TEXTS, st.lists(st.tuples(st.integers(0, 40), st.integers(0, 40), TEXTS), max_size=4))
def test_changes(text: str, edits: list[tuple[int, int, str]]) -> None:
    documents = OpenDocuments()
    documents.open("untitled:x", text, 1)
    now = text
    for first, second, new in edits:
        start, end = sorted((min(first, len(now)), min(second, len(now))))
        ends = [at - (now[at - 1 : at + 1] == "\r\n") for at in (start, end)]
        places = [lsp.Position(*place(now, at, "utf-16")) for at in ends]
        change = lsp.TextDocumentContentChangePartial(lsp.Range(*places), new)
        documents.change("untitled:x", 2, [change])
        now = now[: ends[0]] + new + now[ends[1] :]
    document = documents.get("untitled:x")
    assert document is not None
    assert document.lines.text == now


@given(TEXTS)
def test_what_the_parser_reads_has_every_character_at_its_place(text: str) -> None:
    made = readable(f"\ufeff{text}")
    assert len(made) == len(text) + 1
    assert "\r" not in made.replace("\r\n", "")
    assert Document("untitled:x", text, 1, "utf-16").text == readable(text)

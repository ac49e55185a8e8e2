"""No text, however broken, makes any request fail."""

from __future__ import annotations

import contextlib
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from lsprotocol import types as lsp

from srgc.language_server.completions.completion import completions, signature
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.open_documents import Document
from srgc.language_server.documents.places import definition, highlights, references
from srgc.language_server.documents.published import diagnostics_of
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.edits.quick_fixes import format_edits, quick_fixes
from srgc.language_server.edits.rename import RenameRefused, renamable, rename
from srgc.language_server.hovers.hover import hover
from srgc.language_server.outlines.outline import folding, include_links, outline, workspace_symbols
from srgc.language_server.outlines.semantic_tokens import semantic_tokens
from srgc.language_server.tasks.task_commands import task_lenses
from srgc.language_server.tasks.verdicts import Verdicts

ROOT = Path(__file__).parents[2]
SPECS = sorted((ROOT / "specs").glob("*.srg"))
PIECES = (
    "{", "}", ";", "(", ")", "[", "]", ".", ",", "->", "=", ":", '"', "'", "/*", "*/", "//", "\r",
    "\r\n", "\t", "\0", "\ufeff", "\U0001f916", "e\u0301", "1e999", "5 m", "L1", "this.", "rod(",
    "module ", "task T {", "include \"\";", "satisfy ", "from ", "fixed L.", "accept ", "\u2028",
)  # fmt: skip


def broken(text: str, chance: random.Random) -> str:
    """A text cut, or with something put in, taken out or exchanged."""
    here = chance.randrange(len(text) + 1)
    match chance.randrange(4):
        case 0:
            return text[:here]
        case 1:
            return text[:here] + chance.choice(PIECES) + text[here:]
        case 2:
            return text[:here] + text[here + chance.randrange(1, 40) :]
        case _:
            other = chance.randrange(len(text) + 1)
            return text[:here] + text[min(here, other) : max(here, other)][:200] + text[here:]


def check_position(lines: list[str], position: lsp.Position) -> None:
    assert 0 <= position.line < len(lines)
    size = len(lines[position.line].encode("utf-16-le", "surrogatepass")) // 2
    assert 0 <= position.character <= size


def check_range(lines: list[str], place: lsp.Range) -> None:
    check_position(lines, place.start)
    check_position(lines, place.end)
    ends = [(p.line, p.character) for p in (place.start, place.end)]
    assert ends == sorted(ends)


def lines_of(text: str) -> list[str]:
    """The lines of LSP, by a way of our own."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def ask_everything(path: Path, text: str, offsets: list[int], *, names: bool) -> None:
    """Every request, at these offsets; every range lies in the text."""
    uri = uri_of(path)
    document = Document(uri, text, 1, "utf-16")
    held = {document.real: document.data}
    analysis = analyse(str(path), document.text, held)
    _ = analysis.findings
    lines = lines_of(text)
    whole(analysis, document, lines)
    for offset in offsets:
        position = document.lines.position(offset)
        check_position(lines, position)
        here = document.lines.offset(position)
        assert 0 <= here <= len(text)
        at_place(analysis, document, here, lines)
        if names:
            with contextlib.suppress(RenameRefused):
                if renamable(analysis, 0, here) is not None:
                    rename([analysis], document.real, here, "Renamed", held, uri_of)


def whole(analysis: Analysis, document: Document, lines: list[str]) -> None:
    found = diagnostics_of([analysis], document.real, uri_of)
    for each in found:
        check_range(lines, each.range)
    quick_fixes(document.uri, document.text, document.lines.offset, found)
    for symbol in outline(analysis, 0):
        for one in (symbol, *(symbol.children or ())):
            check_range(lines, one.range)
            check_range(lines, one.selection_range)
    workspace_symbols([analysis], "a", uri_of)
    for fold in folding(document.text, document.lines):
        assert 0 <= fold.start_line < fold.end_line < len(lines)
    for edit in format_edits(document.text, document.lines):
        check_range(lines, edit.range)
    assert len(semantic_tokens(analysis, 0).data) % 5 == 0
    include_links(analysis, 0, uri_of)
    task_lenses(analysis, 0, document.uri, Verdicts(), {})


def at_place(analysis: Analysis, document: Document, here: int, lines: list[str]) -> None:
    told = hover(analysis, 0, here)
    if told is not None and told.range is not None:
        check_range(lines, told.range)
    definition(analysis, 0, here, uri_of)
    references([analysis], document.real, here, uri_of, declarations=True)
    highlights(analysis, 0, here)
    signature(document.text, here)
    for item in completions(analysis, document.text, here):
        assert isinstance(item.text_edit, lsp.TextEdit)
        check_range(lines, item.text_edit.range)
        assert item.label


def texts(seed: int, number: int) -> Iterator[tuple[Path, str, random.Random]]:
    chance = random.Random(seed)
    for _ in range(number):
        path = chance.choice(SPECS)
        text = path.read_text(encoding="utf-8")
        for _ in range(chance.randrange(1, 4)):
            text = broken(text, chance)
        yield path, text, chance


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_whole_specs(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    chance = random.Random(path.stem)
    ask_everything(path, text, [chance.randrange(len(text) + 1) for _ in range(6)], names=False)


def test_broken_specs() -> None:
    for path, text, chance in texts(1, 25):
        offsets = [chance.randrange(len(text) + 1) for _ in range(2)] if text else [0]
        ask_everything(path, text, offsets, names=False)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 12))
def test_many_broken_specs(seed: int) -> None:
    for path, text, chance in texts(seed, 200):
        offsets = [chance.randrange(len(text) + 1) for _ in range(8)] if text else [0]
        ask_everything(path, text, offsets, names=chance.random() < 0.2)


@pytest.mark.slow
def test_every_prefix_of_a_spec() -> None:
    path = ROOT / "specs" / "nested.srg"
    text = path.read_text(encoding="utf-8")
    for end in range(0, len(text) + 1, 3):
        ask_everything(path, text[:end], [end], names=False)

"""The face of this package: a file or a text in, a program or diagnostics out."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from grammar_lang import ir
from grammar_lang.codes import Code
from grammar_lang.diagnostics import Diagnostic, Sink
from grammar_lang.lower import lower
from grammar_lang.parse import parse
from grammar_lang.source import Source, Span

_NOTHING = re.compile(r"(?:\s|//[^\n]*|/\*.*?\*/)*", re.DOTALL)
_START = Span(0, 0)


@dataclass(frozen=True, slots=True)
class Loaded:
    """A program with its diagnostics; the program is None if and only if one is an error."""

    program: ir.Program | None
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


def load_text(text: str, name: str) -> Loaded:
    """Check a text; ``name`` is what diagnostics call it."""
    source = Source(name, text.removeprefix("\ufeff"))
    sink = Sink()
    program = _program(source, sink)
    failed = sink.has_errors
    return Loaded(None if failed else program, sink.sorted(), (source,))


def load(path: Path) -> Loaded:
    """Check a file; one that cannot be read gives one diagnostic, never an exception."""
    name = str(path)
    try:
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        return _unreadable(name, error)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig", errors="replace")
        source = Source(name, data.decode("utf-8-sig", errors="replace"))
        return _refused(
            source,
            Code.NOT_UTF8,
            f"the file is not UTF-8: byte 0x{data[error.start]:02x}",
            Span(len(before), len(before) + 1),
            "save it as UTF-8",
        )
    return load_text(text, name)


def _unreadable(name: str, error: OSError | ValueError) -> Loaded:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return _refused(
        Source(name, ""),
        Code.UNREADABLE_FILE,
        f"cannot read the file: {reason[:1].lower()}{reason[1:]}",
        _START,
        "give the path of an `.srg` file",
    )


def _refused(source: Source, code: Code, message: str, span: Span, hint: str) -> Loaded:
    sink = Sink()
    sink.error(code, message, span, hint)
    return Loaded(None, sink.sorted(), (source,))


def _program(source: Source, sink: Sink) -> ir.Program | None:
    text = source.text
    nul = text.find("\0")
    if nul >= 0:
        message = "a NUL character: this is not a text file"
        hint = "save it as plain UTF-8 text"
        sink.error(Code.UNEXPECTED_CHARACTER, message, Span(nul, nul + 1), hint)
        return None
    if _NOTHING.fullmatch(text):
        hint = "declare modules, a grammar, a workspace and a task"
        sink.error(Code.EMPTY_FILE, "the file declares nothing", _START, hint)
        return None
    file = parse(text, sink)
    return None if sink.has_errors else lower(file, source, sink)

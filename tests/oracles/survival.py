"""What every text must survive: each stage within a time, and findings that can be shown."""

from __future__ import annotations

import json
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity, Sink
from grammar_lang.diagnostics.render import to_json, to_text
from grammar_lang.formatting.expansion import expanded
from grammar_lang.formatting.formatter import canonical
from grammar_lang.ir import Program
from grammar_lang.load import load_text
from grammar_lang.parsing.parse import parse
from grammar_lang.source import Source, Span
from srgc.session import check_file, check_loaded

SECONDS = 50.0 if sys.gettrace() else 5.0
"""Of processor time, for one text; the slowest of them takes a tenth of it.  Python takes about ten
times as long while the branches taken are recorded."""


class TooSlow(Exception):
    """A text has used up its time."""


@contextmanager
def time_bound(seconds: float = SECONDS) -> Iterator[None]:
    """Raises TooSlow where the block takes more processor time; other processes do not count."""

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise TooSlow(f"more than {seconds} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _inside(span: Span, sources: Sequence[Source]) -> bool:
    """A span may end one character after its text, where something is missing."""
    return 0 <= span.start <= span.end <= len(sources[span.file].text) + 1


def _presentable(found: Diagnostic, sources: Sequence[Source]) -> None:
    assert found.hint, found
    assert not found.message.endswith("."), found
    for span in (found.span, *(span for span, _ in found.notes)):
        assert _inside(span, sources), found


def sound_findings(
    program: Program | None, diagnostics: Sequence[Diagnostic], sources: Sequence[Source]
) -> None:
    """An error if and only if there is no program; all of them fit to be shown."""
    failed = any(d.severity is Severity.ERROR for d in diagnostics)
    assert (program is None) == failed
    for found in diagnostics:
        _presentable(found, sources)
    shown = to_text(diagnostics, sources)
    assert shown.replace("\n", "").replace("\t", "").isprintable()
    assert shown.count("\n  hint: ") == len(diagnostics)
    records = json.loads(to_json(diagnostics, sources))
    assert [r["code"] for r in records] == [d.code.value for d in diagnostics]
    for r in records:
        assert (1, 1) <= (r["line"], r["column"]) <= (r["end_line"], r["end_column"]), r
        assert r["message"] == r["message"].strip(), r
        assert len(f"{r['message']}{r['hint']}".splitlines()) == 1, r


def load_survives(text: str) -> None:
    """Read, resolve and type a text."""
    loaded = load_text(text, "t.srg")
    sound_findings(loaded.program, loaded.diagnostics, loaded.sources)


def expansion_survives(text: str) -> None:
    """What grammars from ports stand for is canonical, and means the same when it is read again.

    Grammars of included files are left out where no task names them.
    """
    loaded = load_text(text, "t.srg")
    if loaded.program is None:
        return
    made = expanded(loaded)
    assert canonical(made, Sink()) == made
    again = load_text(made, "t.srg")
    assert again.program is not None, again.diagnostics
    assert again.program.grammars.items() <= loaded.program.grammars.items()
    named = {task.grammar for task in loaded.program.tasks.values()}
    for name, grammar in loaded.program.grammars.items():
        idle = grammar.span.file and named and name not in named
        assert idle or name in again.program.grammars, name
    assert again.program.tasks == loaded.program.tasks


def check_survives(text: str) -> None:
    """All of ``srgc check``, but for the disk."""
    checked = check_loaded(load_text(text, "t.srg"))
    sound_findings(checked.program, checked.diagnostics, checked.sources)


def file_survives(data: bytes, folder: Path) -> None:
    """All of ``srgc check``."""
    path = folder / "t.srg"
    path.write_bytes(data)
    checked = check_file(path)
    sound_findings(checked.program, checked.diagnostics, checked.sources)


def format_survives(text: str) -> None:
    """Formatting refuses syntax errors; else the text means the same, and is not changed again."""
    sink, again = Sink(), Sink()
    made = canonical(text, sink)
    assert (made is None) == sink.has_errors
    if made is not None:
        assert parse(made, again) == parse(text, again)
        assert not again.found
        assert canonical(made, again) == made

"""The spec in the editor of the page, analysed only once for all requests."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import Loaded, load_text
from grammar_lang.source import Span
from srgc.faults import Checked, SpecErrors
from srgc.session import check_loaded

if TYPE_CHECKING:
    from lsprotocol import types as lsp

    from srgc.language_server.documents.analysis import Analysis

NAME = "spec.srg"
"""The name of the text in diagnostics."""
SOLVER = ("numpy", "pysat")
"""The modules that checks of formulas need."""


@lru_cache(maxsize=2)
def spec_of(text: str) -> Spec:
    """The spec with that text; the last two are cached."""
    return Spec(text)


@dataclass(eq=False)
class Spec:
    """A text, and what is known about it; each part is computed when it is first needed."""

    text: str

    @cached_property
    def loaded(self) -> Loaded:
        """The result of reading; the text is treated as a file in an empty folder."""
        return load_text(self.text, NAME, Path())

    @cached_property
    def checked(self) -> Checked:
        """All diagnostics; those about formulas only if there is a solver."""
        return check_loaded(self.loaded, formulas=has_solver())

    @property
    def program(self) -> ir.Program:
        """The program of a text without errors.

        Raises:
            SpecErrors: the text has errors.
        """
        if self.checked.program is None:
            errors = (d for d in self.checked.diagnostics if d.severity is Severity.ERROR)
            raise SpecErrors(Checked(None, tuple(errors), self.checked.sources))
        return self.checked.program

    @property
    def unchecked(self) -> Iterator[str]:
        """What ``srgc check`` would check but this page does not, one sentence each."""
        if has_solver() or self.loaded.sound is None:
            return
        for name, task in self.loaded.sound.tasks.items():
            if task.satisfy:
                yield (
                    f"The formula of task `{name}` is not checked here, for want of NumPy and a "
                    "SAT solver: run `srgc check` on this file."
                )

    @cached_property
    def analysis(self) -> Analysis:
        """The program as the language server sees it."""
        from srgc.language_server.documents.analysis import Analysis
        from srgc.language_server.documents.line_map import UTF16

        return Analysis(self.loaded, NAME, UTF16)

    # --- Places: code points here, UTF-16 code units in the browser -----------------------------

    def code_units(self, offset: int) -> int:
        """The position in UTF-16 code units of an offset in code points."""
        if self.text.isascii():
            return offset
        return len(self.text[:offset].encode("utf-16-le", "surrogatepass")) // 2

    def offset(self, code_units: int) -> int:
        """The offset of a position in UTF-16 code units; within a surrogate pair, its start."""
        if self.text.isascii():
            return code_units
        before = self.text.encode("utf-16-le", "surrogatepass")[: 2 * code_units]
        return len(before.decode("utf-16-le", "ignore"))

    def place(self, span: Span) -> tuple[int, int] | None:
        """Start and end of a span in UTF-16 code units; None for a span of another file."""
        if span.file:
            return None
        return self.code_units(span.start), self.code_units(span.end)

    def code_units_of(self, found: lsp.Range) -> tuple[int, int]:
        """Start and end of a range in UTF-16 code units."""
        lines = self.analysis.lines(0)
        return self.code_units(lines.offset(found.start)), self.code_units(lines.offset(found.end))

    def start_of(self, offers: Sequence[lsp.CompletionItem]) -> int:
        """The start of the word that the given, non-empty list of completions replaces."""
        from lsprotocol import types as lsp

        edit = offers[0].text_edit
        return (
            self.analysis.lines(0).offset(edit.range.start) if isinstance(edit, lsp.TextEdit) else 0
        )


def has_solver() -> bool:
    """Whether formulas can be checked."""
    return all(find_spec(name) is not None for name in SOLVER)

"""The spec in the editor of the page: read once, however often something is asked about it."""

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
"""What the findings call the text."""
SOLVER = ("numpy", "pysat")
"""What the checks of formulas need."""


@lru_cache(maxsize=2)
def spec_of(text: str) -> Spec:
    """The spec with that text."""
    return Spec(text)


@dataclass(eq=False)
class Spec:
    """A text, and what is known of it; each part is made when it is first asked for."""

    text: str

    @cached_property
    def loaded(self) -> Loaded:
        """What was read; the text stands in an empty folder."""
        return load_text(self.text, NAME, Path())

    @cached_property
    def checked(self) -> Checked:
        """All findings, but for those about formulas where there is no solver."""
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
        """What ``srgc check`` looks at and this does not, a sentence for each."""
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

    # --- places: code points here, code units of UTF-16 in the browser --------------------------

    def code_units(self, offset: int) -> int:
        """A place as the browser counts it."""
        if self.text.isascii():
            return offset
        return len(self.text[:offset].encode("utf-16-le", "surrogatepass")) // 2

    def offset(self, code_units: int) -> int:
        """The place that the browser means; within a pair of surrogates the one before it."""
        if self.text.isascii():
            return code_units
        before = self.text.encode("utf-16-le", "surrogatepass")[: 2 * code_units]
        return len(before.decode("utf-16-le", "ignore"))

    def place(self, span: Span) -> tuple[int, int] | None:
        """Where a span of this text begins and ends; None for one of another file."""
        if span.file:
            return None
        return self.code_units(span.start), self.code_units(span.end)

    def code_units_of(self, found: lsp.Range) -> tuple[int, int]:
        """Where a range begins and ends."""
        lines = self.analysis.lines(0)
        return self.code_units(lines.offset(found.start)), self.code_units(lines.offset(found.end))

    def start_of(self, offers: Sequence[lsp.CompletionItem]) -> int:
        """Where the word begins that offers, which are not empty, replace."""
        from lsprotocol import types as lsp

        edit = offers[0].text_edit
        return (
            self.analysis.lines(0).offset(edit.range.start) if isinstance(edit, lsp.TextEdit) else 0
        )


def has_solver() -> bool:
    """Whether formulas can be checked."""
    return all(find_spec(name) is not None for name in SOLVER)

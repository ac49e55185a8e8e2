"""What srgc says where it has no result; light, so that every command can raise it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grammar_lang.diagnostics.diagnostic import Diagnostic
    from grammar_lang.ir import Program
    from grammar_lang.source import Source

MOST_FINDINGS = 200
"""So many findings about a file are printed for people, and all of them as JSON."""


class SrgcError(Exception):
    """What srgc says where it has no result: a fault of its input, or no answer in time."""


class UsageFault(SrgcError):
    """Arguments that cannot be used; exit status 2."""


class NoAnswer(SrgcError):
    """A command that had to end before it had an answer; exit status 4."""


@dataclass(frozen=True, slots=True)
class Checked:
    """A file after all checks; the program is None if and only if there is an error."""

    program: Program | None
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


class SpecErrors(SrgcError):
    """A spec with errors; exit status 5.  As a text it is the findings with their source lines."""

    def __init__(self, checked: Checked) -> None:
        super().__init__("the spec has errors")
        self.checked = checked

    def __str__(self) -> str:
        from grammar_lang.diagnostics.render import to_text

        findings = to_text(self.checked.diagnostics, self.checked.sources, most=MOST_FINDINGS)
        return f"the spec has errors\n{findings}".rstrip()

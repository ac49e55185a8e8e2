"""The exceptions of srgc, and the exit statuses; light, so that every command can raise them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grammar_lang.diagnostics.diagnostic import Code, Diagnostic
    from grammar_lang.ir import Program
    from grammar_lang.source import Source

MOST_FINDINGS = 200
"""The most findings about a file that are printed as text; JSON has all of them."""


class SrgcError(Exception):
    """The exception that srgc raises without a result: invalid input, or no answer in time.

    Attributes:
        code: a code for ``srgc explain``, like that of a finding; usually None.
    """

    code: Code | None = None


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument as a message names it on the command line and in Python."""

    option: str
    name: str


def argument(name: str, option: str | None = None) -> Argument:
    """An argument of a function, whose option is called alike unless it is given."""
    return Argument(option or f"--{name.replace('_', '-')}", f"`{name}`")


WITH_O = Argument(" with -o", "")
"""Behind the advice to write elsewhere; functions have different arguments for that."""


class UsageFault(SrgcError):
    """Arguments that cannot be used; exit status 2.

    Its arguments are the parts of the message; as a text it is that of the command line, with the
    ``hint``, how to mend it, on a line of its own.
    """

    def __init__(
        self, *parts: str | Argument, code: Code | None = None, hint: str | None = None
    ) -> None:
        super().__init__(*parts)
        self.code = code
        self.hint = hint

    def __str__(self) -> str:
        said = "".join(part.option if isinstance(part, Argument) else part for part in self.args)
        return said if self.hint is None else f"{said}\n  hint: {self.hint}"

    def finding(self, *, colour: bool = False) -> str:
        """What the command line prints."""
        code = "" if self.code is None else f"[{self.code.value}]"
        return f"error{code}: {self}"

    def in_python(self) -> str:
        """The message with arguments as functions have them, without the hint."""
        return "".join(part.name if isinstance(part, Argument) else part for part in self.args)


class NoAnswer(SrgcError):
    """A command that had to end before it had an answer; exit status 4."""


class SolversDisagree(SrgcError):
    """Two solvers contradict each other, of which one is wrong at least; exit status 70."""


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


# --- The exit statuses of the commands ------------------------------------------------------------


FOUND, REFUSED, USAGE, IMPOSSIBLE, UNKNOWN, SPEC_ERRORS, UNEXPECTED = 0, 1, 2, 3, 4, 5, 6
INTERNAL, INTERRUPTED, NO_READER = 70, 130, 141
VERDICT_STATUS = {"found": FOUND, "impossible": IMPOSSIBLE, "unknown": UNKNOWN}

"""The exceptions and exit statuses of srgc; light to import, as every command raises them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grammar_lang.diagnostics.diagnostic import Code, Diagnostic
    from grammar_lang.ir import Program
    from grammar_lang.source import Source

MOST_FINDINGS = 200
"""The number of findings about a file to print for people; JSON has all of them."""


class SrgcError(Exception):
    """The base of all errors that srgc raises: a fault in its input, or no answer in time.

    Attributes:
        code: what ``srgc explain`` explains, as the ``code`` of a finding; None for most errors.
    """

    code: Code | None = None


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument, as messages name it on the command line and in Python."""

    option: str
    name: str


def argument(name: str, option: str | None = None) -> Argument:
    """An argument of a function; its option has the same name unless ``option`` is given."""
    return Argument(option or f"--{name.replace('_', '-')}", f"`{name}`")


WITH_O = Argument(" with -o", "")
"""Follows the advice to write elsewhere; Python functions have different arguments for that."""


class UsageFault(SrgcError):
    """Arguments that cannot be used; exit status 2.

    ``args`` are the parts of the message.  ``str`` gives the message of the command line, followed
    by the ``hint``, which says how to fix it, on a line of its own.
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
        """The text that the command line prints."""
        code = "" if self.code is None else f"[{self.code.value}]"
        return f"error{code}: {self}"

    def in_python(self) -> str:
        """The message for Python, which names the arguments of functions and has no hint."""
        return "".join(part.name if isinstance(part, Argument) else part for part in self.args)


class NoAnswer(SrgcError):
    """A command ended before it had an answer; exit status 4."""


class SolversDisagree(SrgcError):
    """Two solvers contradict each other, so at least one is wrong; exit status 70."""


@dataclass(frozen=True, slots=True)
class Checked:
    """A file after all checks; the program is None if and only if there is an error."""

    program: Program | None
    diagnostics: tuple[Diagnostic, ...]
    sources: tuple[Source, ...]


class SpecErrors(SrgcError):
    """A spec with errors; exit status 5.  ``str`` gives the findings with their source lines."""

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

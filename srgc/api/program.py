"""A specification without errors."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import overload

from grammar_lang import ir
from grammar_lang.findings.diagnostics import Severity
from srgc.api.findings import Findings, checked
from srgc.api.spoken_faults import spoken
from srgc.faults import Checked, SpecErrors


@dataclass(frozen=True, slots=True)
class Program:
    """A checked specification, which everything else begins with.

    Attributes:
        ir: its modules, grammars, workspaces and tasks in full; not a stable interface.
        findings: the warnings and notes about it.
    """

    ir: ir.Program
    findings: Findings

    @property
    def name(self) -> str:
        """The name of the file."""
        return self.ir.sources[0].path

    @property
    def text(self) -> str:
        """The text of the file, without what it includes."""
        return self.ir.sources[0].text

    @property
    def modules(self) -> tuple[str, ...]:
        """The names of the modules."""
        return tuple(self.ir.modules)

    @property
    def grammars(self) -> tuple[str, ...]:
        """The names of the grammars."""
        return tuple(self.ir.grammars)

    @property
    def workspaces(self) -> tuple[str, ...]:
        """The names of the workspaces."""
        return tuple(self.ir.workspaces)

    @property
    def tasks(self) -> tuple[str, ...]:
        """The names of the tasks."""
        return tuple(self.ir.tasks)

    def __repr__(self) -> str:
        return f"<Program {self.name}: tasks {', '.join(self.tasks) or 'none'}>"

    def __str__(self) -> str:
        from srgc.displays.program_summary import program_text

        return program_text(self.ir)

    def _repr_html_(self) -> str:
        from srgc.displays.program_summary import program_html

        return program_html(self.ir)


@overload
def load(path: str | PathLike[str]) -> Program: ...
@overload
def load(*, text: str, folder: str | PathLike[str] | None = None) -> Program: ...
@spoken
def load(
    path: str | PathLike[str] | None = None,
    *,
    text: str | None = None,
    folder: str | PathLike[str] | None = None,
) -> Program:
    """Read a specification, and check it.

    Args:
        path: an ``.srg`` file.
        text: the specification itself, instead of a file.
        folder: where a text is taken to stand, for what it includes; by default it includes
            nothing.

    Returns:
        The program.

    Raises:
        SrgcError: the specification has errors, which the message shows, or cannot be read.
    """
    found = checked(path, text, folder)
    if found.program is None:
        errors = tuple(one for one in found.diagnostics if one.severity is Severity.ERROR)
        raise SpecErrors(Checked(None, errors, found.sources))
    return Program(found.program, Findings(found))

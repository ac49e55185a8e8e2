"""Specifications: load and check them, and list the words of their families."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias, overload

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity
from grammar_lang.diagnostics.render import records, to_text
from grammar_lang.load import load_text
from srgc.api.spoken_faults import spoken
from srgc.faults import MOST_FINDINGS, Checked, SpecErrors, UsageFault
from srgc.session import check_file, check_loaded, chosen
from srgc.text_reports.findings_text import summary

if TYPE_CHECKING:
    from srgc.api.builder.part import Part


@dataclass(frozen=True, slots=True)
class Program:
    """A specification that has been checked and has no errors.

    Attributes:
        ir: its modules, grammars, workspaces, tasks and missions in full; not a stable interface.
        findings: its warnings and notes.
    """

    ir: ir.Program
    findings: Findings

    @property
    def name(self) -> str:
        """The name of the file."""
        return self.ir.sources[0].path

    @property
    def text(self) -> str:
        """The text of the file, without included files."""
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

    @property
    def missions(self) -> tuple[str, ...]:
        """The names of the missions."""
        return tuple(self.ir.missions)

    def __repr__(self) -> str:
        return f"<Program {self.name}: tasks {', '.join(self.tasks) or 'none'}>"

    def __str__(self) -> str:
        from srgc.api.displays import program_text

        return program_text(self.ir)

    def _repr_html_(self) -> str:
        from srgc.api.displays import program_html

        return program_html(self.ir)


Source: TypeAlias = "Part | str | PathLike[str]"
"""A specification built in Python, or the path of an ``.srg`` file."""
Specification: TypeAlias = "Program | Part | str | PathLike[str]"
"""A return value or an argument of ``load``."""


@overload
def load(path: Source, *, folder: str | PathLike[str] | None = None) -> Program: ...
@overload
def load(*, text: str, folder: str | PathLike[str] | None = None) -> Program: ...
@spoken
def load(
    path: Source | None = None,
    *,
    text: str | None = None,
    folder: str | PathLike[str] | None = None,
) -> Program:
    """Read and check a specification.

    Args:
        path: an ``.srg`` file, or a specification built in Python, such as a ``Spec``.
        text: the text of a specification, instead of ``path``.
        folder: the folder in which ``include`` looks for files, for a text or a specification
            built in Python.  Without it, they cannot include files.

    Returns:
        The program.

    Raises:
        SrgcError: the specification cannot be read, or has errors; the message shows them.
    """
    return sound(checked(path, text, folder))


TEXT_NAME = "spec.srg"
"""The name of a specification without a file."""


# --- findings -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Findings(Sequence[Diagnostic]):
    """The diagnostics of a specification, in the order of the text: a sequence, false if empty.

    Attributes:
        checked: the specification after all checks.
    """

    checked: Checked

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The findings with the severity error; if there are any, there is no program."""
        found = self.checked.diagnostics
        return tuple(one for one in found if one.severity is Severity.ERROR)

    @property
    def ok(self) -> bool:
        """Whether there are no errors; there may be warnings and notes."""
        return self.checked.program is not None

    def records(self) -> list[dict[str, str | int | None]]:
        """The findings as ``srgc check --json`` prints them: code, location, message, hint."""
        return records(self.checked.diagnostics, self.checked.sources)

    @overload
    def __getitem__(self, index: int) -> Diagnostic: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Diagnostic]: ...
    def __getitem__(self, index: int | slice) -> Diagnostic | Sequence[Diagnostic]:
        return self.checked.diagnostics[index]

    def __len__(self) -> int:
        return len(self.checked.diagnostics)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.checked.diagnostics)

    def __repr__(self) -> str:
        return f"<Findings: {summary([self.checked])}>"

    def __str__(self) -> str:
        """The findings with source lines, carets and hints, as ``srgc check`` prints them."""
        text = to_text(self.checked.diagnostics, self.checked.sources, most=MOST_FINDINGS)
        return f"{text}{summary([self.checked])}"

    def _repr_html_(self) -> str:
        from srgc.api.displays import findings_html

        return findings_html(self.checked)


@overload
def check(path: Source, *, folder: str | PathLike[str] | None = None) -> Findings: ...
@overload
def check(*, text: str, folder: str | PathLike[str] | None = None) -> Findings: ...
@spoken
def check(
    path: Source | None = None,
    *,
    text: str | None = None,
    folder: str | PathLike[str] | None = None,
) -> Findings:
    """Check the names, units, grammars, semantics, geometry and tasks of a specification.

    Errors in the specification are returned, not raised.

    Args:
        path: an ``.srg`` file, or a specification built in Python, such as a ``Spec``.
        text: the text of a specification, instead of ``path``.
        folder: the folder in which ``include`` looks for files, for a text or a specification
            built in Python.  Without it, they cannot include files.

    Returns:
        All findings; ``ok`` is true if none of them is an error.

    Raises:
        SrgcError: the file cannot be read, or not exactly one of ``path`` and ``text`` is given.
    """
    return Findings(checked(path, text, folder))


def checked(path: Source | None, text: str | None, folder: str | PathLike[str] | None) -> Checked:
    """Check a file, a text or a specification built in Python; arguments as for ``check``.

    Raises:
        UsageFault: the file cannot be read, or not exactly one of ``path`` and ``text`` is given.
    """
    if (path is None) == (text is None):
        raise UsageFault("give the path of a file, or `text`")
    place = None if folder is None else Path(fspath(folder))
    if text is not None:
        return check_loaded(load_text(text, TEXT_NAME, place))
    from srgc.api.builder.part import Part

    if isinstance(path, Part):
        return check_loaded(load_text(path.to_srg(), TEXT_NAME, place))
    if folder is not None:
        raise UsageFault("`folder` goes with `text`: a file includes what is beside it")
    return check_file(Path(path or ""))


def program_of(specification: Specification) -> Program:
    """The program of a specification, which is loaded if necessary.

    Raises:
        SpecErrors: the specification has errors.
        UsageFault: it cannot be read.
    """
    if isinstance(specification, Program):
        return specification
    return sound(checked(specification, None, None))


def sound(found: Checked) -> Program:
    """The program of a specification that has been checked.

    Raises:
        SpecErrors: the specification has errors.
    """
    if found.program is None:
        errors = tuple(one for one in found.diagnostics if one.severity is Severity.ERROR)
        raise SpecErrors(Checked(None, errors, found.sources))
    return Program(found.program, Findings(found))


# --- words ----------------------------------------------------------------------------------------


@spoken
def words(
    program: Specification,
    *,
    grammar: str | None = None,
    max_length: int | None = None,
    limit: int = 100,
) -> list[str]:
    """List the first words of a family, shortest first; each word is a robot.

    Args:
        program: the specification, or the path of its file.
        grammar: the family; may be omitted if there is only one.
        max_length: the largest number of symbols in a word; by default there is no bound.
        limit: the largest number of words.

    Returns:
        The words; each consists of the symbols of its modules and edges, separated by blanks.

    Raises:
        SrgcError: there is no such grammar, or no grammar is named although there are several.
    """
    from srgc.text_reports.language_report import listed

    if limit < 0 or (max_length is not None and max_length < 0):
        raise UsageFault("`limit` and `max_length` are not negative")
    ir_program = program_of(program).ir
    family = chosen(ir_program.grammars, grammar, "grammar")
    return list(listed(ir_program, family, max_length, limit))


def symbols(word: str | Sequence[str]) -> tuple[str, ...]:
    """The symbols of a word given as a text with blanks, or as a sequence of symbols."""
    return tuple(word.split() if isinstance(word, str) else word)

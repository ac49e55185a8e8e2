"""Specifications: what a check finds in them, programs without errors, words of their families."""

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
    """A checked specification, which everything else begins with.

    Attributes:
        ir: its modules, grammars, workspaces, tasks and missions in full; not a stable interface.
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
"""A specification that was built, or the path of an ``.srg`` file."""
Specification: TypeAlias = "Program | Part | str | PathLike[str]"
"""What ``load`` gives or takes."""


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
    """Read a specification, and check it.

    Args:
        path: an ``.srg`` file, or what was built, as ``srgc.Spec``.
        text: the specification itself, instead of a file.
        folder: where a text or what was built is taken to stand, for what it includes; by default
            it includes nothing.

    Returns:
        The program.

    Raises:
        SrgcError: the specification has errors, which the message shows, or cannot be read.
    """
    return sound(checked(path, text, folder))


TEXT_NAME = "spec.srg"
"""What a specification is called that is no file."""


# --- findings -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Findings(Sequence[Diagnostic]):
    """All findings about a specification, in the order of the text; false if there are none.

    Attributes:
        checked: the specification after all checks.
    """

    checked: Checked

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """Those findings with which there is no program."""
        found = self.checked.diagnostics
        return tuple(one for one in found if one.severity is Severity.ERROR)

    @property
    def ok(self) -> bool:
        """Whether there is no error; there may be warnings and notes."""
        return self.checked.program is not None

    def records(self) -> list[dict[str, str | int | None]]:
        """The findings as ``srgc check --json`` prints them: code, place, message, hint."""
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
    """Check a specification: names, units, grammars, semantics, geometry, tasks; all at once.

    Args:
        path: an ``.srg`` file, or what was built, as ``srgc.Spec``.
        text: the specification itself, instead of a file.
        folder: where a text or what was built is taken to stand, for what it includes; by default
            it includes nothing.

    Returns:
        The findings; their ``ok`` says whether there is no error.

    Raises:
        SrgcError: the file cannot be read, or neither or both of path and text are given.
    """
    return Findings(checked(path, text, folder))


def checked(path: Source | None, text: str | None, folder: str | PathLike[str] | None) -> Checked:
    """A file, a text or what was built after all checks; arguments as of ``check``.

    Raises:
        UsageFault: the file cannot be read, or not one of path and text is given.
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
    """The program of a specification that is loaded already, or not yet.

    Raises:
        SpecErrors: it has errors.
        UsageFault: it cannot be read.
    """
    if isinstance(specification, Program):
        return specification
    return sound(checked(specification, None, None))


def sound(found: Checked) -> Program:
    """The program of what was checked.

    Raises:
        SpecErrors: it has errors.
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
    """The first words of a family, the shorter ones first; a word is a robot.

    Args:
        program: the specification, or the path of its file.
        grammar: the family; may be left out where there is one.
        max_length: no longer words than so many symbols.
        limit: how many words.

    Returns:
        Words, each the symbols of its modules and edges with blanks between them.

    Raises:
        SrgcError: there is no such grammar, or several and none is named.
    """
    from srgc.text_reports.language_report import listed

    if limit < 0 or (max_length is not None and max_length < 0):
        raise UsageFault("`limit` and `max_length` are not negative")
    ir_program = program_of(program).ir
    family = chosen(ir_program.grammars, grammar, "grammar")
    return list(listed(ir_program, family, max_length, limit))


def symbols(word: str | Sequence[str]) -> tuple[str, ...]:
    """The symbols of a word that is given as a text with blanks, or as its symbols."""
    return tuple(word.split() if isinstance(word, str) else word)

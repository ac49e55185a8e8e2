"""What a check finds in a specification."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import overload

from grammar_lang.findings.diagnostics import Diagnostic, Severity
from grammar_lang.findings.render import records, to_text
from grammar_lang.load import load_text
from srgc.api.spoken_faults import spoken
from srgc.faults import MOST_FINDINGS, Checked, UsageFault
from srgc.session import check_file, check_loaded
from srgc.text_reports.check_summary import summary

TEXT_NAME = "spec.srg"
"""What a specification is called that is no file."""


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
        from srgc.displays.findings_table import findings_html

        return findings_html(self.checked)


@overload
def check(path: str | PathLike[str]) -> Findings: ...
@overload
def check(*, text: str, folder: str | PathLike[str] | None = None) -> Findings: ...
@spoken
def check(
    path: str | PathLike[str] | None = None,
    *,
    text: str | None = None,
    folder: str | PathLike[str] | None = None,
) -> Findings:
    """Check a specification: names, units, grammars, semantics, geometry, tasks; all at once.

    Args:
        path: an ``.srg`` file.
        text: the specification itself, instead of a file.
        folder: where a text is taken to stand, for what it includes; by default it includes
            nothing.

    Returns:
        The findings; their ``ok`` says whether there is no error.

    Raises:
        SrgcError: the file cannot be read, or neither or both of path and text are given.
    """
    return Findings(checked(path, text, folder))


def checked(
    path: str | PathLike[str] | None, text: str | None, folder: str | PathLike[str] | None
) -> Checked:
    """A file or a text after all checks; arguments as of ``check``.

    Raises:
        UsageFault: the file cannot be read, or not one of path and text is given.
    """
    if (path is None) == (text is None):
        raise UsageFault("give the path of a file, or `text`")
    if path is not None:
        if folder is not None:
            raise UsageFault("`folder` goes with `text`: a file includes what is beside it")
        return check_file(Path(path))
    place = None if folder is None else Path(fspath(folder))
    return check_loaded(load_text(text or "", TEXT_NAME, place))

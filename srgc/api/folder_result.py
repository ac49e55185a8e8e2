"""A result in a folder, which may be temporary: its verdict, verification and report."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from srgc.api.spoken_faults import spoken
from srgc.api.verification import Verification, verify

if TYPE_CHECKING:
    from collections.abc import Callable

Kind = TypeVar("Kind", bound="FolderResult")


@dataclass(frozen=True)
class FolderResult:
    """A verdict with its evidence, in a folder; it can be used instead of the folder's path.

    Attributes:
        folder: the folder with its files; a temporary one unless another was requested.
        design: the content of its ``design.json``.
        keeper: the owner of a temporary folder, or None; the folder exists as long as its owner.
        answers: the answers of ``verify`` so far; the display of the result shows the last one.
    """

    folder: Path
    design: Mapping[str, Any] = field(repr=False)
    keeper: TemporaryFolder | None = field(default=None, repr=False, compare=False)
    answers: list[Verification] = field(default_factory=list, repr=False, compare=False)

    def __fspath__(self) -> str:
        return fspath(self.folder)

    def __reduce__(self) -> tuple[Callable[..., FolderResult], tuple[object, ...]]:
        """Pickle the result with the files of its temporary folder, which does not outlive it."""
        if self.keeper is None:
            return type(self), (self.folder, self.design, None, self.answers)
        place = self.folder.relative_to(self.keeper.path)
        return _unpickled, (type(self), self.keeper.files(), place, self.design, self.answers)

    @property
    def verdict(self) -> Literal["found", "impossible", "unknown"]:
        """``"found"``, ``"impossible"``, or ``"unknown"`` if neither is proved."""
        verdicts: dict[str, Literal["found", "impossible", "unknown"]] = {
            "found": "found", "impossible": "impossible", "unknown": "unknown",
        }  # fmt: skip
        return verdicts[self.design["verdict"]]

    @property
    def reason(self) -> str | None:
        """Why there is no design; None if there is one."""
        return None if self.design["reason"] is None else str(self.design["reason"])

    @spoken
    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Copy the files to a folder, as ``srgc synth -o`` writes them.

        Args:
            folder: a new or empty folder, or one with older results of the same synthesis.
            force: whether to replace the results of another synthesis.

        Returns:
            The path of the folder.

        Raises:
            SrgcError: the folder has other contents, or cannot be written.
        """
        from srgc.results.result_folder import copy_results

        return copy_results(self.folder, Path(folder), force=force)

    def verify(self, *, trust: str | None = None) -> Verification:
        """Check the result independently of the search, as ``srgc verify`` does.

        Args:
            trust: the SMT solvers to run and believe, as for ``srgc.verify``.

        Raises:
            SrgcError: the folder no longer exists.
        """
        answer = verify(self.folder, trust=trust)
        self.answers.append(answer)
        return answer

    @spoken
    def report(self, *, verify: bool = True) -> Page:
        """Make the page that ``srgc report`` writes; a notebook displays it.

        Args:
            verify: whether to check the certificates again and show what is proved.

        Raises:
            SrgcError: there are no results, or they have been altered.
        """
        return page_of(self.folder, verify=verify)


def _unpickled(
    kind: type[Kind],
    files: Mapping[str, bytes],
    place: PurePath,
    design: Mapping[str, Any],
    answers: list[Verification],
) -> Kind:
    """A result in a new temporary folder."""
    keeper = TemporaryFolder.made(files)
    return kind(keeper.path / place, design, keeper, answers)


# --- temporary folders and reports ----------------------------------------------------------------


@dataclass(frozen=True, slots=True, weakref_slot=True)
class TemporaryFolder:
    """A new folder that is removed when nothing refers to this object any more."""

    path: Path

    @classmethod
    def made(cls, files: Mapping[str, bytes] | None = None) -> TemporaryFolder:
        """Create a folder with these files."""
        folder = cls(Path(tempfile.mkdtemp(prefix="srgc-")))
        weakref.finalize(folder, shutil.rmtree, folder.path, ignore_errors=True)
        for name, content in (files or {}).items():
            place = folder.path / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
        return folder

    def files(self) -> dict[str, bytes]:
        """The content of all its files, by path."""
        return {
            path.relative_to(self.path).as_posix(): path.read_bytes()
            for path in sorted(self.path.rglob("*"))
            if path.is_file()
        }


@dataclass(frozen=True, slots=True)
class Page:
    """An HTML page; a notebook displays it in a frame.

    Attributes:
        html: the whole page; it loads no other files.
    """

    html: str

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the page to a file.

        Returns:
            The path of the file.

        Raises:
            SrgcError: the file cannot be written.
        """
        from srgc.paths import write_output

        write_output(Path(path), self.html)
        return Path(path)

    def __repr__(self) -> str:
        return f"<Page: {len(self.html.encode()) / 1000:.0f} kB of HTML>"

    def _repr_html_(self) -> str:
        from srgc.api.displays import page_frame

        return page_frame(self.html)


def page_of(folder: Path, *, verify: bool) -> Page:
    """The report of a result folder.

    Raises:
        UsageFault: there are no results, or they have been altered.
    """
    from srgc.report.page import report_page

    return Page(report_page(folder, verify=verify))

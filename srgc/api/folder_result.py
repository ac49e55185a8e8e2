"""A result as a folder: its verdict, and the temporary folder that it may live in."""

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
    """A verdict with its evidence, which is a folder, and can stand wherever its path can.

    Attributes:
        folder: where its files are; a temporary folder unless another was asked for.
        design: what its ``design.json`` says.
        keeper: what keeps a temporary folder.
        answers: what the verifier has said so far, which the display of the result shows.
    """

    folder: Path
    design: Mapping[str, Any] = field(repr=False)
    keeper: TemporaryFolder | None = field(default=None, repr=False, compare=False)
    answers: list[Verification] = field(default_factory=list, repr=False, compare=False)

    def __fspath__(self) -> str:
        return fspath(self.folder)

    def __reduce__(self) -> tuple[Callable[..., FolderResult], tuple[object, ...]]:
        """How it is pickled: with what a temporary folder holds, since that is removed with it."""
        if self.keeper is None:
            return type(self), (self.folder, self.design, None, self.answers)
        place = self.folder.relative_to(self.keeper.path)
        return _unpickled, (type(self), self.keeper.files(), place, self.design, self.answers)

    @property
    def verdict(self) -> Literal["found", "impossible", "unknown"]:
        """Whether there is a design, or it is proved that there is none, or neither."""
        verdicts: dict[str, Literal["found", "impossible", "unknown"]] = {
            "found": "found", "impossible": "impossible", "unknown": "unknown",
        }  # fmt: skip
        return verdicts[self.design["verdict"]]

    @property
    def reason(self) -> str | None:
        """Why there is no design; None where there is one."""
        return None if self.design["reason"] is None else str(self.design["reason"])

    @spoken
    def save(self, folder: str | PathLike[str], *, force: bool = False) -> Path:
        """Copy the files to a folder, as ``srgc synth -o`` writes them.

        Args:
            folder: a new or an empty one, or one with older results of the same synthesis.
            force: replace the results of another one.

        Raises:
            SrgcError: the folder holds something else, or cannot be written.
        """
        from srgc.results.result_folder import copy_results

        return copy_results(self.folder, Path(folder), force=force)

    def verify(self, *, trust: str | None = None) -> Verification:
        """Check the result independently, as ``srgc verify`` does."""
        answer = verify(self.folder, trust=trust)
        self.answers.append(answer)
        return answer

    @spoken
    def report(self, *, verify: bool = True) -> Page:
        """The report of ``srgc report``, as a page that shows itself in a notebook.

        Args:
            verify: whether to check the certificates again, and to show what is proved.
        """
        return page_of(self.folder, verify=verify)


def _unpickled(
    kind: type[Kind],
    files: Mapping[str, bytes],
    place: PurePath,
    design: Mapping[str, Any],
    answers: list[Verification],
) -> Kind:
    """A result in a temporary folder of its own."""
    keeper = TemporaryFolder.made(files)
    return kind(keeper.path / place, design, keeper, answers)


# --- where it may live, and its report -----------------------------------------------------------


@dataclass(frozen=True, slots=True, weakref_slot=True)
class TemporaryFolder:
    """A new folder, which is removed when nothing refers to this any more."""

    path: Path

    @classmethod
    def made(cls, files: Mapping[str, bytes] | None = None) -> TemporaryFolder:
        """A new one, with these files in it."""
        folder = cls(Path(tempfile.mkdtemp(prefix="srgc-")))
        weakref.finalize(folder, shutil.rmtree, folder.path, ignore_errors=True)
        for name, content in (files or {}).items():
            place = folder.path / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
        return folder

    def files(self) -> dict[str, bytes]:
        """All that is in it."""
        return {
            path.relative_to(self.path).as_posix(): path.read_bytes()
            for path in sorted(self.path.rglob("*"))
            if path.is_file()
        }


@dataclass(frozen=True, slots=True)
class Page:
    """A page of its own, which shows itself in a frame of a notebook.

    Attributes:
        html: the whole page; it loads nothing from elsewhere.
    """

    html: str

    def save(self, path: str | PathLike[str]) -> Path:
        """Write the page to a file.

        Raises:
            SrgcError: it cannot be written.
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

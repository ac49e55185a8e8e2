"""Arguments common to all functions that search: the folder for results, and numbers."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from srgc.api.folder_result import TemporaryFolder
from srgc.faults import UsageFault


def place_of(folder: str | PathLike[str] | None) -> tuple[Path, TemporaryFolder | None]:
    """The folder for results and, if it is temporary, its owner."""
    if folder is not None:
        return Path(folder), None
    keeper = TemporaryFolder.made()
    return keeper.path, keeper


def is_quiet(progress: bool | None) -> bool:  # noqa: FBT001 - as callers pass it
    """Whether progress is hidden; None shows it only in notebooks."""
    from srgc.results.progress_display import in_notebook

    return not (in_notebook() if progress is None else progress)


def refuse_numbers(
    seed: int, jobs: int, time_limit: float | None, *, cells: int | None = None
) -> None:
    """Refuse numbers that are too small.

    Raises:
        UsageFault: one of the numbers is too small.
    """
    if seed < 0:
        raise UsageFault("`seed` is not negative")
    if jobs < 1 or (cells is not None and cells < 1):
        raise UsageFault("`jobs` and `cells` count from 1")
    if time_limit is not None and not time_limit > 0:
        raise UsageFault("`time_limit` is a positive number of seconds")

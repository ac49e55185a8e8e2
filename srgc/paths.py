"""Paths that users give: impossible ones, suggestions for missing ones, and writing of files."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from pathlib import Path

from srgc.faults import WITH_O, Argument, UsageFault

# --------------------------------------------------------------------------------------------------
# Suggestions for paths that do not exist, and advice for paths that cannot be written.


RESULTS = ("design.json", "journal.jsonl")
"""Files of which a result folder has at least one, whether the run has finished or not."""
REFUSED = (errno.EACCES, errno.EPERM, errno.EROFS)
MOST = 2000
"""The number of names to look at in a folder."""


def holds_results(folder: Path) -> bool:
    """Whether a folder is one that ``srgc synth`` has written."""
    # ``os.path`` treats a folder that must not be read like one without such a file.
    return any(os.path.isfile(folder / name) for name in RESULTS)  # noqa: PTH113


def near_spec(path: Path) -> Path | None:
    """A spec with a name similar to that of a path, next to it or in a folder there."""
    found = [e for e in _around(path) if e.suffix == ".srg" and os.path.isfile(e)]  # noqa: PTH113
    return _near(path, found)


def no_folder(path: Path) -> UsageFault:
    """The error for a path that is not a result folder, with a suggestion of a similar name."""
    meant = _near(path, [each for each in _around(path) if holds_results(each)])
    return UsageFault(f"{path} is not a folder{'' if meant is None else f'; is it {meant}?'}")


def unwritable(path: Path, error: OSError) -> UsageFault:
    """The error for a file or folder that cannot be written."""
    advice: tuple[str | Argument, ...] = ()
    if error.errno == errno.ENOENT and not os.path.isdir(path.parent):  # noqa: PTH112
        advice = (f"; is there a folder {path.parent}?",)
    elif error.errno in REFUSED:
        advice = ("; choose another place", WITH_O)
    elif error.errno in (errno.EEXIST, errno.ELOOP) and path.is_symlink():
        advice = ("; it is a link that leads to no folder",)
    elif error.errno in (errno.EEXIST, errno.ENOTDIR):
        advice = ("; it is a file, and a folder is expected",)
    return UsageFault(f"{path}: {error.strerror}", *advice)


def _near(path: Path, candidates: list[Path]) -> Path | None:
    from difflib import get_close_matches

    by_name = {each.stem.lower(): each for each in reversed(candidates)}
    found = get_close_matches(path.stem.lower(), by_name, 1)
    return by_name[found[0]] if found else None


def _around(path: Path) -> Iterator[Path]:
    """The entries next to a path and in the folders there, by name, at most ``MOST`` per folder."""
    beside = _listed(path.parent)
    yield from beside
    for each in beside:
        if not each.name.startswith("."):
            yield from _listed(each)


def _listed(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir())[:MOST]
    except OSError:
        return []


# --------------------------------------------------------------------------------------------------
# Paths that no file can have, or that must not be looked at: refused before anything else.
#
# The system raises an exception in any call that takes such a path, even in those that only ask
# whether a file exists.


ABSENT = (errno.ENOENT, errno.ENOTDIR, errno.ELOOP)
"""Errors that only mean that nothing is there; each command reports that in its own words."""


def refuse_impossible(path: str | os.PathLike[str]) -> None:
    """Refuse a path that cannot be read from or written to.

    Args:
        path: a path as the user gives it; the file or folder need not exist.

    Raises:
        UsageFault: the path is empty, has a NUL character, cannot be encoded, is too long, ends in
            a slash but is a file, or lies in a folder that must not be read.
    """
    from grammar_lang.files.file_tree import shown

    text = os.fspath(path)
    if not text:
        raise UsageFault("an empty path names neither a file nor a folder")
    name = shown(text)
    if "\0" in text:
        raise UsageFault(f"{name}: no path has a NUL character")
    try:
        os.stat(text)  # noqa: PTH116 - a Path loses the slash at the end
    except UnicodeEncodeError:
        raise UsageFault(f"{name}: a path cannot contain such a character") from None
    except OSError as error:
        if error.errno == errno.ENOTDIR and text.endswith("/"):
            raise UsageFault(f"{name}: {error.strerror}") from None
        if error.errno not in ABSENT:
            raise UsageFault(f"{name}: {error.strerror}") from None


# --- Files that a user asks a command to write ----------------------------------------------------


def write_output(path: Path, content: str | bytes) -> None:
    """Write a file, text as UTF-8.

    Raises:
        UsageFault: it cannot be written.
    """
    refuse_impossible(path)
    try:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise unwritable(path, error) from None

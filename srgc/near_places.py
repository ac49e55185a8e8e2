"""What a user may have meant by a path that leads nowhere, and what to do about one in the way."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from pathlib import Path

from srgc.faults import WITH_O, Argument, UsageFault

RESULTS = ("design.json", "journal.jsonl")
"""What a result folder has, finished or not."""
REFUSED = (errno.EACCES, errno.EPERM, errno.EROFS)
MOST = 2000
"""So many names are looked at."""


def holds_results(folder: Path) -> bool:
    """Whether a folder is one that ``srgc synth`` writes."""
    # ``os.path`` tells no folder that must not be looked into from one without such a file.
    return any(os.path.isfile(folder / name) for name in RESULTS)  # noqa: PTH113


def near_spec(path: Path) -> Path | None:
    """A spec whose name is like that of a path: beside it, or in a folder there."""
    found = [e for e in _around(path) if e.suffix == ".srg" and os.path.isfile(e)]  # noqa: PTH113
    return _near(path, found)


def no_folder(path: Path) -> UsageFault:
    """What is said of a result folder that is none, with one whose name is like it."""
    meant = _near(path, [each for each in _around(path) if holds_results(each)])
    return UsageFault(f"{path} is not a folder{'' if meant is None else f'; is it {meant}?'}")


def unwritable(path: Path, error: OSError) -> UsageFault:
    """What is said of a file or folder that cannot be written."""
    advice: tuple[str | Argument, ...] = ()
    if error.errno == errno.ENOENT and not os.path.isdir(path.parent):  # noqa: PTH112
        advice = (f"; is there a folder {path.parent}?",)
    elif error.errno in REFUSED:
        advice = ("; choose another place", WITH_O)
    elif error.errno in (errno.EEXIST, errno.ELOOP) and path.is_symlink():
        advice = ("; it is a link that leads to no folder",)
    elif error.errno in (errno.EEXIST, errno.ENOTDIR):
        advice = ("; it is a file, and a folder is due",)
    return UsageFault(f"{path}: {error.strerror}", *advice)


def _near(path: Path, candidates: list[Path]) -> Path | None:
    from difflib import get_close_matches

    by_name = {each.stem.lower(): each for each in reversed(candidates)}
    found = get_close_matches(path.stem.lower(), by_name, 1)
    return by_name[found[0]] if found else None


def _around(path: Path) -> Iterator[Path]:
    """What is beside a path and in the folders there, by name; not too much of it."""
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

"""Results of an earlier version of a spec: the whole folder is moved beside its place, and kept.

A kill at any moment leaves them whole in one of the two places, since the move is one rename.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from srgc.faults import WITH_O, UsageFault, argument
from srgc.results.folder_writer import LOCK, OWN_FILES, OWN_FOLDERS, UNFINISHED

_OURS = frozenset((*OWN_FILES, *OWN_FOLDERS, *UNFINISHED))


def keep_aside(folder: Path) -> Path:
    """Move a result folder that this process has locked to ``FOLDER.1``, ``.2`` and so on.

    An empty folder takes its place, which nobody has locked.

    Returns:
        Where it is now.

    Raises:
        UsageFault: something in it is not srgc's, or it cannot be moved; it is as it was.
    """
    place = Path(os.path.realpath(folder))  # a link to a folder goes on leading to its place
    foreign = sorted(each.name for each in place.iterdir() if each.name not in _OURS)
    if foreign:
        raise _not_moved(folder, f"`{foreign[0]}`, which srgc did not write, is in it")
    # A process is in a folder, not at a path: what it writes would go where the folder has gone.
    here = Path(os.path.realpath(Path.cwd()))
    if place == here or place in here.parents:
        raise _not_moved(folder, "it is the folder that one is in")
    target = _next_name(place)
    try:
        place.rename(target)
        place.mkdir(exist_ok=True)
    except OSError as error:
        raise _not_moved(folder, f"to {target}: {error.strerror}") from None
    with suppress(OSError):
        (target / LOCK).unlink()
    return folder.with_name(target.name) if folder.name == place.name else target


def _next_name(place: Path) -> Path:
    """The first name behind all that are taken: a number that was given once keeps its folder."""
    numbers = (each.name.removeprefix(f"{place.name}.") for each in place.parent.iterdir())
    taken = (int(each) for each in numbers if each.isascii() and each.isdigit())
    return place.with_name(f"{place.name}.{1 + max(taken, default=0)}")


def _not_moved(folder: Path, why: str) -> UsageFault:
    return UsageFault(
        f"{folder} holds the results of another spec and cannot be kept aside: {why}; "
        "choose another folder",
        WITH_O,
        ", or ",
        argument("force"),
        " to replace them",
    )

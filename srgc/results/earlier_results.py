"""Keeps the results of an earlier version of a spec: the whole folder is moved next to its place.

The move is a single rename, so a kill at any moment leaves the results complete in one of the two
places.
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

    An empty folder, which nobody has locked, takes its place.

    Returns:
        The new path of the results.

    Raises:
        UsageFault: the folder contains something that srgc did not write, or cannot be moved; it is
            unchanged.
    """
    place = Path(os.path.realpath(folder))  # a link to the folder keeps pointing to its place
    foreign = sorted(each.name for each in place.iterdir() if each.name not in _OURS)
    if foreign:
        raise _not_moved(folder, f"`{foreign[0]}`, which srgc did not write, is in it")
    # A process stays in a moved folder, so its output would go to the new place.
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
    """The name with the first number after all that are taken, so no number changes its folder."""
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

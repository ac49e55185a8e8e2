"""What srgc calls its own in a result folder: plain files and folders, and no links.

A link leads to what is not ours.  Through one, a new result would be written over somebody's files,
and an old one removed with them.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from srgc.faults import UsageFault

JOURNAL = "journal.jsonl"
LOCK = ".lock"
"""There while a run writes to the folder; what is left of it after a kill locks nothing."""
OWN_FILES = (
    "design.json", "certificate.json", "trajectory.csv", "evaluations.csv", "landscape.csv",
    "pareto.csv", "pareto.json", "log.json", "report.html", JOURNAL,
)  # fmt: skip
OWN_FOLDERS = ("spec", "proofs", "figures", "designs")

_LONGEST = 60
_REPARSE_TAGS = tuple(
    getattr(stat, f"IO_REPARSE_TAG_{kind}") for kind in ("SYMLINK", "MOUNT_POINT")
    if hasattr(stat, f"IO_REPARSE_TAG_{kind}")
)  # fmt: skip
"""Of Windows: links and junctions, but not the files of a cloud that are not here yet."""


def part_name(name: str) -> str:
    """The name under which a file is written before it is moved to its place."""
    return f".{name[:_LONGEST]}.part"


UNFINISHED = (LOCK, *map(part_name, OWN_FILES))
"""What a kill may leave behind beside the results."""


def refuse_links(folder: Path) -> None:
    """Refuse a result folder in which anything of ours is a link, or of another kind than is due.

    Raises:
        UsageFault: there is such a thing, or a folder of ours cannot be listed.
    """
    for name in (*OWN_FILES, *UNFINISHED):
        refuse_other(folder / name, "file")
    pending = [folder / name for name in OWN_FOLDERS]
    for path in pending:
        refuse_other(path, "folder")
    while pending:
        pending += _folders_in(pending.pop())


def refuse_other(path: Path, due: str) -> None:
    """Refuse what is at a path, if anything is, where it is no plain ``file`` or ``folder``.

    Raises:
        UsageFault: it is not what is due, or one cannot see what it is.
    """
    try:
        status = path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    kind = _kind(status)
    if kind != due:
        raise UsageFault(
            f"{path} is {_NAMED[kind]}, and a plain {due} is due there: "
            "remove it, or use another result folder"
        )


_NAMED = {"link": "a link", "folder": "a folder", "file": "a file", "": "neither file nor folder"}


def _kind(status: os.stat_result) -> str:
    if stat.S_ISLNK(status.st_mode) or getattr(status, "st_reparse_tag", 0) in _REPARSE_TAGS:
        return "link"
    if stat.S_ISDIR(status.st_mode):
        return "folder"
    return "file" if stat.S_ISREG(status.st_mode) else ""


def _folders_in(folder: Path) -> list[Path]:
    """The folders in a folder of ours, all of whose entries are plain; none where it is not there.

    Raises:
        UsageFault: an entry is neither a plain file nor a folder.
    """
    found = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                path = Path(entry.path)
                is_folder = entry.is_dir(follow_symlinks=False)
                refuse_other(path, "folder" if is_folder else "file")
                if is_folder:
                    found.append(path)
    except FileNotFoundError:
        return []
    except OSError as error:
        raise UsageFault(f"{folder}: {error.strerror}") from None
    return found

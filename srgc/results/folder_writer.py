"""Files in a result folder: each is written completely or not at all, and never through a link."""

from __future__ import annotations

import os
import shutil
import stat
import sys
from collections.abc import Collection, Container, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from os.path import normpath, realpath
from pathlib import Path, PurePosixPath

from srgc.faults import WITH_O, UsageFault
from srgc.paths import unwritable, write_output

# --- The plain files and folders in a result folder that srgc owns --------------------------------
#
# A link leads to something that srgc does not own.  Through one, a new result would overwrite a
# user's files, and removing an old result would delete them.


JOURNAL = "journal.jsonl"
LOCK = ".lock"
"""Exists while a run writes to the folder; a file left after a kill locks nothing."""
OWN_FILES = (
    "design.json", "certificate.json", "trajectory.csv", "evaluations.csv", "landscape.csv",
    "nearest.csv", "pareto.csv", "pareto.json", "log.json", "report.html", "mission.json", JOURNAL,
)  # fmt: skip
NEAREST_PICTURE = "figures/nearest.svg"
"""Written for results without a design."""
OWN_FOLDERS = ("spec", "proofs", "figures", "designs", "tasks", "history")

_LONGEST = 60
_REPARSE_TAGS = tuple(
    getattr(stat, f"IO_REPARSE_TAG_{kind}") for kind in ("SYMLINK", "MOUNT_POINT")
    if hasattr(stat, f"IO_REPARSE_TAG_{kind}")
)  # fmt: skip
"""On Windows: links and junctions, but not files of a cloud that have not been downloaded."""


def part_name(name: str) -> str:
    """The temporary name of a file, which is then renamed to its final name."""
    return f".{name[:_LONGEST]}.part"


UNFINISHED = (LOCK, *map(part_name, OWN_FILES))
"""Names that a kill may leave behind in addition to the results."""


def refuse_links(folder: Path) -> None:
    """Refuse a result folder in which one of srgc's names is a link or has the wrong kind.

    Raises:
        UsageFault: there is such an entry, or one of srgc's folders cannot be listed.
    """
    for name in (*OWN_FILES, *UNFINISHED):
        refuse_other(folder / name, "file")
    pending = [folder / name for name in OWN_FOLDERS]
    for path in pending:
        refuse_other(path, "folder")
    while pending:
        pending += _folders_in(pending.pop())


def refuse_other(path: Path, due: str) -> None:
    """Refuse anything at a path other than a plain ``file`` or ``folder``, as ``due`` says.

    Raises:
        UsageFault: it is something else, or the system does not tell what it is.
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
            f"{path} is {_NAMED[kind]}, and a plain {due} is expected there: "
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
    """The subfolders of one of srgc's folders, if all its entries are plain; none if it is missing.

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


_APPEND = os.O_WRONLY | os.O_APPEND | os.O_CREAT
_NO_LINK = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


@dataclass(frozen=True, slots=True)
class FolderWriter:
    """Writes and removes files and folders by name below ``folder``, with ``/`` as separator.

    A file is written under a temporary name and then renamed, so that a kill at any moment leaves
    the old file, the new one or none; a hard link to an old file keeps the old content.

    All methods raise UsageFault if a link or anything of the wrong kind is in the way, or if the
    system refuses to write.
    """

    folder: Path
    prefix: str = ""

    def within(self, name: str) -> FolderWriter:
        """A writer for the subfolder with that name."""
        return FolderWriter(self.folder, f"{self.prefix}{name}/")

    def write(self, name: str, content: str | bytes) -> None:
        """Write a file, text as UTF-8, and make the folders that it is in."""
        target = self._place(name, "file", make=True)
        beside = target.with_name(part_name(target.name))
        refuse_other(beside, "file")
        data = content.encode() if isinstance(content, str) else content
        try:
            beside.unlink(missing_ok=True)
            with beside.open("xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            beside.replace(target)
        except OSError as error:
            with suppress(OSError):
                beside.unlink()
            raise unwritable(target, error) from None

    def append(self, name: str, text: str) -> None:
        """Append text to a file at once."""
        target = self._place(name, "file")
        try:
            with os.fdopen(os.open(target, _APPEND | _NO_LINK, 0o666), "ab") as file:
                file.write(text.encode())
        except OSError as error:
            raise unwritable(target, error) from None

    def discard(self, name: str) -> None:
        """Remove a file, or a folder with its contents, if it exists."""
        target = self._place(name, None)
        try:
            if target.is_dir():
                shutil.rmtree(target)
            else:
                target.unlink(missing_ok=True)
        except OSError as error:
            raise unwritable(target, error) from None

    def keep_only(self, name: str, paths: Container[str]) -> None:
        """Remove every file below a folder whose path in it is not among ``paths``."""
        top = self._place(name, "folder")
        for path in [*top.rglob("*")]:
            inner = path.relative_to(top).as_posix()
            if not path.is_dir() and inner not in paths:
                self.discard(f"{name}/{inner}")

    def _place(self, name: str, due: str | None, *, make: bool = False) -> Path:
        """The path of a name, through plain folders; for ``due`` None, anything but a link will do.

        With ``make``, the folders on the way are made.
        """
        *above, last = PurePosixPath(self.prefix + name).parts
        path = self.folder
        for part in above:
            path /= part
            refuse_other(path, "folder")
            if make:
                _make(path)
        path /= last
        refuse_other(path, due or ("folder" if path.is_dir() else "file"))
        return path


def _make(path: Path) -> None:
    try:
        path.mkdir(exist_ok=True)
    except OSError as error:
        raise unwritable(path, error) from None


# --- One writer at a time in a result folder ------------------------------------------------------
#
# The operating system holds the lock, on a file in the folder: it ends with the process that holds
# it, however that ends.  Source: the locks of ``flock(2)`` and ``LockFileEx``, used through
# filelock.


@contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Lock a folder in the block: nobody else, in this process or another, writes to it.

    Raises:
        UsageFault: somebody else has the lock, or the folder cannot be written.
    """
    from filelock import FileLock, Timeout

    place = folder / LOCK
    refuse_other(place, "file")
    lock = FileLock(place, timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise UsageFault(
            f"another srgc is writing to {folder}: wait until it ends, or use another folder"
        ) from None
    except OSError as error:
        raise unwritable(place, error) from None
    held = place.stat()
    try:
        yield
    finally:
        if sys.platform != "win32":  # on Windows, filelock removes the file
            with suppress(OSError):
                # During the block the folder may have been moved away and replaced by another.
                if os.path.samestat(held, place.stat()):
                    place.unlink()
        lock.release()


# --- Files that a command writes about a result folder: into it, or to a path of the user ---------


_OWN = {name.casefold() for name in (*OWN_FILES, *OWN_FOLDERS, *UNFINISHED)}
"""Casefolded, as on file systems that ignore case."""


@dataclass(frozen=True, slots=True)
class FolderOutput:
    """A file to write; ``name`` is its name in the folder, None if it is elsewhere.

    No link is followed inside the folder, as in ``synth``.
    """

    path: Path
    folder: Path
    name: str | None

    def write(self, content: str | bytes) -> None:
        """Write the file, text as UTF-8.

        Raises:
            UsageFault: it cannot be written, it is a link in the folder, or somebody else is
                writing to the folder.
        """
        if self.name is None:
            write_output(self.path, content)
            return
        with only_writer(self.folder):
            FolderWriter(self.folder).write(self.name, content)


def folder_output(folder: Path, path: Path, own: Collection[str] = ()) -> FolderOutput:
    """The output file of a command about a result folder.

    Args:
        folder: the result folder.
        path: the path that the user has named, or the default.
        own: the results that this command may write.

    Raises:
        UsageFault: the path, with links followed, is a place where other commands write results.
    """
    top = Path(realpath(folder))
    named = _below(*(Path(normpath(each.absolute())) for each in (folder, path)))
    placed = named or _below(top, Path(realpath(path.parent)) / path.name)
    for name in (named, placed, _below(top, Path(realpath(path)))):
        if name is not None and name not in own and name.split("/")[0].casefold() in _OWN:
            raise UsageFault(f"{path} is one of the results; name another place", WITH_O)
    return FolderOutput(path, folder, placed)


def _below(top: Path, path: Path) -> str | None:
    """The name of a path relative to a folder; None if it is outside."""
    return path.relative_to(top).as_posix() if top in path.parents else None

"""Finds the main file that a document belongs to, from the files on disk."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from grammar_lang.files.file_tree import IMAGE_LIMIT, TooLarge, read_file

# --- Reading from disk, whatever is there: unreadable folders, pipes, devices ---------------------


def is_folder(path: Path) -> bool:
    """Whether there is a folder; False if the path must not be read, where ``Path`` would raise."""
    return os.path.isdir(path)  # noqa: PTH112


def bytes_of(path: Path, limit: int = IMAGE_LIMIT) -> bytes | None:
    """The bytes of a file; None if it is not a file or cannot be read.

    A pipe is not read, because its end is not known and the server would wait for it.

    Args:
        path: the file.
        limit: the size in bytes above which a file is not read.
    """
    try:
        return read_file(path, limit)
    except (OSError, ValueError, TooLarge):
        return None


# --- The main file of a document: the one that includes it, directly or through others ------------
#
# A file that is included declares only a part of a program, so it is checked as that part.


_INCLUDE = re.compile(r"""\binclude\s*(?:"([^"\n]*)"|'([^'\n]*)')\s*;""")
# An unclosed comment extends to the end of the text, so that not every ``/*`` is tried.
_COMMENT = re.compile(r"""("[^"\n]*"|'[^'\n]*')|//[^\n]*|/\*(?s:.*?)(?:\*/|\Z)""")
MOST_FILES = 1000
"""The number of files below a folder to look at."""
MOST_ROOTS = 8
"""The number of programs to check for one document."""
_LARGEST = 2**20


def included(text: str) -> list[str]:
    """The paths that a text includes, as written."""
    bare = _COMMENT.sub(lambda found: found[1] or " ", text)
    return [found[1] or found[2] or "" for found in _INCLUDE.finditer(bare)]


def specs_below(folder: Path) -> Iterator[Path]:
    """The ``.srg`` files below a folder, without hidden folders and results, limited in number."""
    left = MOST_FILES
    for top, folders, names in os.walk(folder):
        folders[:] = sorted(n for n in folders if n[0] != "." and n not in {"out", "node_modules"})
        for name in sorted(names):
            left -= 1
            if name.endswith(".srg"):
                yield Path(top, name)
        if left < 0:
            return


@dataclass(slots=True)
class Projects:
    """The includes of the known files, read again if a file has changed."""

    _read: dict[str, tuple[float, list[str]]] = field(
        default_factory=dict[str, tuple[float, list[str]]]
    )

    def roots(
        self, place: str, folders: Iterable[Path], open_files: Mapping[str, list[str]]
    ) -> list[str]:
        """The files that include a file and are not included themselves; itself if there are none.

        Args:
            place: the resolved path of the file.
            folders: folders to search for including files, in addition to its own.
            open_files: the includes of open files, by their resolved paths.
        """
        parents = self._parents(place, folders, open_files)
        found: list[str] = []
        seen, waiting = {place}, [place]
        while waiting:
            here = waiting.pop()
            above = parents.get(here, [])
            if not above and _reaches(here, place):
                found.append(here)
            for each in above:
                if each not in seen:
                    seen.add(each)
                    waiting.append(each)
        return sorted(found)[:MOST_ROOTS] or [place]

    def _parents(
        self, place: str, folders: Iterable[Path], open_files: Mapping[str, list[str]]
    ) -> dict[str, list[str]]:
        """Maps every known file to the files that include it."""
        known = {os.path.realpath(p) for folder in folders for p in specs_below(folder)}
        beside = Path(place).parent
        if is_folder(beside):
            known |= {os.path.realpath(path) for path in sorted(beside.glob("*.srg"))[:MOST_FILES]}
        parents: dict[str, list[str]] = {}
        for name in sorted(known | set(open_files)):
            held = open_files.get(name)
            for path in self._of_file(name) if held is None else held:
                try:
                    target = os.path.realpath(posixpath.join(posixpath.dirname(name), path))
                except ValueError:  # no path has such characters
                    continue
                parents.setdefault(target, []).append(name)
        return parents

    def _of_file(self, name: str) -> list[str]:
        """The includes of a file on disk, read again if the file was modified."""
        path = Path(name)
        try:
            status = path.stat()
            known = self._read.get(name)
            if known is not None and known[0] == status.st_mtime:
                return known[1]
        except (OSError, ValueError):
            return []
        found = included((bytes_of(path, _LARGEST) or b"").decode("utf-8", errors="replace"))
        self._read[name] = (status.st_mtime, found)
        return found


def _reaches(parent: str, place: str) -> bool:
    """Whether a file may include another: only files in its own folder and below can be read."""
    return place.startswith(posixpath.join(posixpath.dirname(parent), ""))

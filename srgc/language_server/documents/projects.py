"""Which file a document belongs to, by what is on the disk."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from grammar_lang.files.file_tree import IMAGE_LIMIT, TooLarge, read_file

# --- What is on the disk, whatever it is: a folder that nobody may look into, a pipe, a device ----


def is_folder(path: Path) -> bool:
    """Whether there is a folder; not where nobody may look, which is an exception of ``Path``."""
    return os.path.isdir(path)  # noqa: PTH112


def bytes_of(path: Path, limit: int = IMAGE_LIMIT) -> bytes | None:
    """The bytes of a file; None if it is none, or cannot be read.

    A pipe is none: nobody knows when it ends, and the server would wait for it.

    Args:
        path: the file.
        limit: one that has more bytes is not read.
    """
    try:
        return read_file(path, limit)
    except (OSError, ValueError, TooLarge):
        return None


# --- Which file a document belongs to: the one that includes it, directly or through others -------
#
# A file that is included declares only a part of a program, so that it is judged as that part.


_INCLUDE = re.compile(r"""\binclude\s*(?:"([^"\n]*)"|'([^'\n]*)')\s*;""")
# A comment without an end goes to the end of the text: its beginnings are not tried one by one.
_COMMENT = re.compile(r"""("[^"\n]*"|'[^'\n]*')|//[^\n]*|/\*(?s:.*?)(?:\*/|\Z)""")
MOST_FILES = 1000
"""So many files below a folder are looked at."""
MOST_ROOTS = 8
"""So many programs are judged of which one document is a part."""
_LARGEST = 2**20


def included(text: str) -> list[str]:
    """The paths that a text includes, as written."""
    bare = _COMMENT.sub(lambda found: found[1] or " ", text)
    return [found[1] or found[2] or "" for found in _INCLUDE.finditer(bare)]


def specs_below(folder: Path) -> Iterator[Path]:
    """The ``.srg`` files below a folder, hidden folders and results left out; at most so many."""
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
    """The includes of the files that are known, read anew where a file has changed."""

    _read: dict[str, tuple[float, list[str]]] = field(
        default_factory=dict[str, tuple[float, list[str]]]
    )

    def roots(
        self, place: str, folders: Iterable[Path], open_files: Mapping[str, list[str]]
    ) -> list[str]:
        """The files without includer that include a file, itself if nothing does.

        Args:
            place: the path of the file, without links.
            folders: where includers are looked for, beside its own folder.
            open_files: what open files include, by their path without links.
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
        """For every file known the files that include it."""
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
        """The includes of a file on the disk, read again when it was written again."""
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
    """Whether a file may include another: nothing outside its own folder can be read."""
    return place.startswith(posixpath.join(posixpath.dirname(parent), ""))

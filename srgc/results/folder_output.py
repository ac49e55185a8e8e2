"""What a command writes about a result folder: into it, or wherever its user wants it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from os.path import normpath, realpath
from pathlib import Path

from srgc.faults import WITH_O, UsageFault
from srgc.paths import write_output
from srgc.results.folder_layout import OWN_FILES, OWN_FOLDERS, UNFINISHED
from srgc.results.folder_writer import FolderWriter, only_writer

_OWN = {name.casefold() for name in (*OWN_FILES, *OWN_FOLDERS, *UNFINISHED)}
"""As file systems compare names that do not tell capitals apart."""


@dataclass(frozen=True, slots=True)
class FolderOutput:
    """A file to be written; ``name`` is that below the folder, None if it is elsewhere.

    In the folder no link is followed, as ``synth`` follows none there.
    """

    path: Path
    folder: Path
    name: str | None

    def write(self, content: str | bytes) -> None:
        """Write the file, text as UTF-8.

        Raises:
            UsageFault: it cannot be written, is a link in the folder, or somebody else is writing
                to the folder.
        """
        if self.name is None:
            write_output(self.path, content)
            return
        with only_writer(self.folder):
            FolderWriter(self.folder).write(self.name, content)


def folder_output(folder: Path, path: Path, own: Collection[str] = ()) -> FolderOutput:
    """Where a command writes about a result folder.

    Args:
        folder: the result folder.
        path: what its user has named, or the default.
        own: the results that this command may write.

    Raises:
        UsageFault: the path is, links followed, a place where others write results.
    """
    top = Path(realpath(folder))
    named = _below(*(Path(normpath(each.absolute())) for each in (folder, path)))
    placed = named or _below(top, Path(realpath(path.parent)) / path.name)
    for name in (named, placed, _below(top, Path(realpath(path)))):
        if name is not None and name not in own and name.split("/")[0].casefold() in _OWN:
            raise UsageFault(f"{path} is one of the results; name another place", WITH_O)
    return FolderOutput(path, folder, placed)


def _below(top: Path, path: Path) -> str | None:
    """The name of a path below a folder, None where it is not there."""
    return path.relative_to(top).as_posix() if top in path.parents else None

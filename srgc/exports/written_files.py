"""Write the files of an export and create their folders: all of them, or none."""

from __future__ import annotations

import errno
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from srgc.paths import refuse_impossible, unwritable
from srgc.results.folder_writer import FolderOutput, part_name, refuse_other


def write_files(files: Sequence[tuple[FolderOutput, bytes]]) -> None:
    """Write files, each under a temporary name first; they are moved only when all are written.

    Anything but a plain file, such as a pipe or a link, is written directly, after the others.

    Raises:
        UsageFault: a file cannot be written; then none is written, and no folder is created.
    """
    _Writer().write(files)


@dataclass(slots=True)
class _Writer:
    made: list[Path] = field(default_factory=list[Path])
    beside: list[tuple[Path, Path]] = field(default_factory=list[tuple[Path, Path]])

    def write(self, files: Sequence[tuple[FolderOutput, bytes]]) -> None:
        others = list[tuple[FolderOutput, bytes]]()
        try:
            for output, content in files:
                if not self._put_beside(output, content):
                    others.append((output, content))
            for part, path in self.beside:
                try:
                    part.replace(path)
                except OSError as error:
                    raise unwritable(path, error) from None
            for output, content in others:
                output.write(content)
        except BaseException:
            self._take_back()
            raise

    def _put_beside(self, output: FolderOutput, content: bytes) -> bool:
        """Write a file under a temporary name; False if it has to be written in another way."""
        path = output.path
        if output.name is not None:  # in the result folder, which has its own rules
            refuse_other(output.folder / output.name, "file")
            return False
        refuse_impossible(path)
        self._make(path.parent)
        try:
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
            if path.is_symlink() or (path.exists() and not path.is_file()):
                return False
            if path.exists() and not os.access(path, os.W_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
            part = path.with_name(part_name(path.name))
            part.unlink(missing_ok=True)
            with part.open("xb") as file:
                self.beside.append((part, path))
                file.write(content)
        except OSError as error:
            raise unwritable(path, error) from None
        return True

    def _make(self, folder: Path) -> None:
        """Create a folder and its parents, and remember which were missing."""
        if folder.is_dir():
            return
        self._make(folder.parent)
        try:
            folder.mkdir()
        except OSError as error:
            raise unwritable(folder, error) from None
        self.made.append(folder)

    def _take_back(self) -> None:
        for part, _ in self.beside:
            with suppress(OSError):
                part.unlink(missing_ok=True)
        for folder in reversed(self.made):
            with suppress(OSError):
                folder.rmdir()

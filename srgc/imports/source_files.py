"""Files that an import may read: those below the folder of its file, and below packages given."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from grammar_lang.files.file_tree import TooLarge, read_file, reason, visible
from srgc.faults import UsageFault

LIMIT = 256 * 2**20
"""So many bytes may a file have that an import reads."""
TEXT_LIMIT = 16 * 2**20
"""So many may one of XML or JSON have."""


@dataclass(frozen=True, slots=True)
class SourceFiles:
    """The folder of the file that is imported, and folders of packages by name, without links."""

    main: Path
    folder: Path
    packages: Mapping[str, Path]

    def main_bytes(self) -> bytes:
        """The bytes of the file that is imported.

        Raises:
            UsageFault: it cannot be read, or is too large.
        """
        return _bytes(self.main, TEXT_LIMIT, str(self.main))

    def bytes_of(self, written: str, base: Path | None = None) -> bytes:
        """The bytes of a file that is named in another one.

        Args:
            written: a path relative to ``base``, ``package://NAME/...``, ``model://NAME/...`` or
                ``file://`` with either.
            base: the folder of the file in which it stands, that of the main file if None.

        Raises:
            UsageFault: it resolves nowhere, leads out of the folders, or cannot be read.
        """
        return _bytes(self.path_of(written, base), LIMIT, f"{self.main}: {visible(written)}")

    def path_of(self, written: str, base: Path | None = None) -> Path:
        """The file that a path or URI means, without links.

        Raises:
            UsageFault: it resolves nowhere, or leads out of the folders.
        """
        scheme, separator, rest = written.partition("://")
        if not separator:
            return self._below(base or self.folder, written, written)
        rest = unquote(rest)
        if scheme == "file":
            return self._below(Path("/") if rest.startswith("/") else self.folder, rest, written)
        if scheme not in ("package", "model"):
            raise UsageFault(
                f"{self.main}: `{visible(written)}`: only files are read, package:// and model://"
            )
        name, _, path = rest.lstrip("/").partition("/")
        place = self.packages.get(name) or self._found_above(name, path)
        if place is None:
            raise UsageFault(
                f"{self.main}: `{visible(written)}` resolves nowhere: say where the package is, "
                f"as in --package {visible(name)}=DIR"
            )
        return self._below(place, path, written)

    def _found_above(self, name: str, path: str) -> Path | None:
        """The folder of a package that the folder of the file is in, or that is beside it there.

        Only folders below that of the main file, and that folder itself, are looked at.
        """
        candidates = [self.folder / name, self.folder] if self.folder.name == name else [
            self.folder / name
        ]  # fmt: skip
        return next((each for each in candidates if (each / path).exists()), None)

    def _below(self, base: Path, path: str, written: str) -> Path:
        if "\0" in path:
            raise UsageFault(f"{self.main}: `{visible(written)}` is no path")
        joined = posixpath.normpath(posixpath.join(str(base), path))
        real = Path(os.path.realpath(joined))
        roots = [self.folder, *self.packages.values()]
        if not any(real.is_relative_to(root) for root in roots):
            raise UsageFault(
                f"{self.main}: `{visible(written)}` leads out of the folder of the file: put it "
                "there, or name the folder of its package by --package NAME=DIR"
            )
        if not real.is_file():
            raise UsageFault(f"{self.main}: `{visible(written)}`: there is no such file")
        return real


def source_files(path: Path, packages: Iterable[str] = ()) -> SourceFiles:
    """What may be read of an import.

    Args:
        path: the file that is imported.
        packages: each ``NAME=DIR``.

    Raises:
        UsageFault: a package is written otherwise, or its folder is not there.
    """
    found = dict[str, Path]()
    for text in packages:
        name, equals, folder = text.partition("=")
        if not equals or not name or not Path(folder).is_dir():
            raise UsageFault(f"--package {text}: write NAME=DIR with the folder of the package")
        found[name] = Path(os.path.realpath(folder))
    real = Path(os.path.realpath(path))
    return SourceFiles(path, real.parent, found)


def _bytes(path: Path, limit: int, name: str) -> bytes:
    try:
        return read_file(path, limit)
    except TooLarge as large:
        raise UsageFault(
            f"{name}: it has {large.size:,} bytes, more than {limit:,} are not read"
        ) from None
    except (OSError, ValueError) as error:
        raise UsageFault(f"{name}: it cannot be read: {reason(error)}") from None

"""Files that an import may read: those below the folder of its file or of a given package."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.files.file_tree import TooLarge, read_file, reason, visible
from grammar_lang.source import Source, Span
from srgc.faults import UsageFault
from srgc.imports.source_fault import WHOLE, SourceFault, file_fault

LIMIT = 200_000_000
"""The largest size of a file that an import reads, in bytes."""
XML_LIMIT = 50_000_000
"""The largest size of a mesh in XML, in bytes: its tree takes about ten times its size."""
TEXT_LIMIT = 16 * 2**20
"""The largest size of any other file of XML or JSON, in bytes."""
PACKED = {
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "packed with gzip",
    b"BZh": "packed with bzip2",
    b"\xfd7zXZ": "packed with xz",
    b"\x28\xb5\x2f\xfd": "packed with zstd",
}
"""How packed files begin, whatever their names are: they are never unpacked."""


def source_bytes(path: Path, limit: int = LIMIT) -> bytes:
    """The content of a file.

    Raises:
        SourceFault: the file cannot be read, is empty or packed, or has more than ``limit`` bytes.
    """
    try:
        content = read_file(path, limit)
    except TooLarge as large:
        message = f"it has {large.size:,} bytes, more than {limit:,} are not read"
        raise file_fault(path, message, "simplify it first") from None
    except (OSError, ValueError) as error:
        raise file_fault(path, f"it cannot be read: {reason(error)}") from None
    refuse_content(content, path, limit)
    return content


def refuse_content(content: bytes, path: Path, limit: int = LIMIT) -> None:
    """Reject the content of a file that messages call ``path``.

    Raises:
        SourceFault: the content is empty or packed, or has more than ``limit`` bytes.
    """
    if len(content) > limit:
        message = f"it has {len(content):,} bytes, more than {limit:,} are not read"
        raise file_fault(path, message, "simplify it first")
    if not content.strip(b"\0 \t\r\n"):
        raise file_fault(path, "it is empty")
    for start, what in PACKED.items():
        if content.startswith(start):
            raise file_fault(path, f"it is {what}", "unpack it first: that is not done here")


@dataclass(frozen=True, slots=True)
class SourceFiles:
    """The folder of the imported file, and folders of packages by name, with links resolved."""

    main: Path
    folder: Path
    packages: Mapping[str, Path]

    def main_bytes(self) -> bytes:
        """The bytes of the imported file.

        Raises:
            SourceFault: the file cannot be read, or is too large.
        """
        return source_bytes(self.main, TEXT_LIMIT)

    def bytes_of(self, written: str, base: Path | None = None) -> bytes:
        """The bytes of a file that another file names.

        Args:
            written: a path relative to ``base``, ``package://NAME/...``, ``model://NAME/...``, or
                ``file://`` and a path.
            base: the folder of the file that names it; if None, the folder of the main file.

        Raises:
            SourceFault: the path cannot be resolved, leads out of the folders, or cannot be read.
        """
        return source_bytes(self.path_of(written, base))

    def path_of(self, written: str, base: Path | None = None) -> Path:
        """The file that a path or URI refers to, with links resolved.

        Raises:
            SourceFault: the path cannot be resolved, or leads out of the folders.
        """
        scheme, separator, rest = written.partition("://")
        if not separator:
            return self._below(base or self.folder, written, written)
        rest = unquote(rest)
        if scheme == "file":
            return self._below(Path("/") if rest.startswith("/") else self.folder, rest, written)
        if scheme not in ("package", "model"):
            raise self._fault(written, "is not read", "paths, file://, package:// and model:// are")
        name, _, path = rest.lstrip("/").partition("/")
        place = self.packages.get(name) or self._found_above(name, path)
        if place is None:
            hint = f"say where the package is, as in --package {visible(name)}=DIR"
            raise self._fault(written, "resolves nowhere", hint)
        return self._below(place, path, written)

    def _found_above(self, name: str, path: str) -> Path | None:
        """Find the folder of a package in the folder of the main file, or that folder itself.

        No other folder is searched.
        """
        candidates = [self.folder / name, self.folder] if self.folder.name == name else [
            self.folder / name
        ]  # fmt: skip
        return next((each for each in candidates if (each / path).exists()), None)

    def _below(self, base: Path, path: str, written: str) -> Path:
        if "\0" in path:
            raise self._fault(written, "is no path")
        joined = posixpath.normpath(posixpath.join(str(base), path))
        real = Path(os.path.realpath(joined))
        roots = [self.folder, *self.packages.values()]
        if not any(real.is_relative_to(root) for root in roots):
            hint = "put the file there, or name the folder of its package by --package NAME=DIR"
            raise self._fault(written, "leads out of the folder of the file", hint)
        if not real.is_file():
            raise self._fault(written, "is no file that is there")
        return real

    def _fault(self, written: str, message: str, hint: str | None = None) -> SourceFault:
        """A fault of a path, placed where the main file has this path, if it does."""
        text = self.main_bytes().decode("utf-8-sig", errors="replace")
        place = re.search(rf"(?<=[\"'>\s]){re.escape(written)}(?=[\"'<\s])", text)
        source = Source(str(self.main), text if place else "")
        span = Span(*place.span()) if place else WHOLE
        said = f"`{visible(written)}` {message}"
        return SourceFault(Code.FOREIGN_PATH, said, source, span, hint)


def source_files(path: Path, packages: Iterable[str] = ()) -> SourceFiles:
    """The files that an import may read.

    Args:
        path: the file that is imported.
        packages: each ``NAME=DIR``.

    Raises:
        UsageFault: a package is not of this form, or its folder does not exist.
    """
    found = dict[str, Path]()
    for text in packages:
        name, equals, folder = text.partition("=")
        if not equals or not name or not Path(folder).is_dir():
            raise UsageFault(f"--package {text}: write NAME=DIR with the folder of the package")
        found[name] = Path(os.path.realpath(folder))
    real = Path(os.path.realpath(path))
    return SourceFiles(path, real.parent, found)

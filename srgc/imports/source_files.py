"""Files that an import may read: those below the folder of its file, and below packages given."""

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
"""So many bytes may a file have that an import reads."""
XML_LIMIT = 50_000_000
"""So many may a mesh in XML have: its tree takes about ten times its size."""
TEXT_LIMIT = 16 * 2**20
"""So many may another file of XML or JSON have."""
PACKED = {
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "packed with gzip",
    b"BZh": "packed with bzip2",
    b"\xfd7zXZ": "packed with xz",
    b"\x28\xb5\x2f\xfd": "packed with zstd",
}
"""How packed files begin, whatever their names say: they are never unpacked."""


def source_bytes(path: Path, limit: int = LIMIT) -> bytes:
    """The content of a file.

    Raises:
        SourceFault: it cannot be read, is empty, packed, or has more than ``limit`` bytes.
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
    """Refuse the content of a file, which is called ``path`` in messages.

    Raises:
        SourceFault: it is empty, packed, or has more than ``limit`` bytes.
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
    """The folder of the file that is imported, and folders of packages by name, without links."""

    main: Path
    folder: Path
    packages: Mapping[str, Path]

    def main_bytes(self) -> bytes:
        """The bytes of the file that is imported.

        Raises:
            SourceFault: it cannot be read, or is too large.
        """
        return source_bytes(self.main, TEXT_LIMIT)

    def bytes_of(self, written: str, base: Path | None = None) -> bytes:
        """The bytes of a file that is named in another one.

        Args:
            written: a path relative to ``base``, ``package://NAME/...``, ``model://NAME/...`` or
                ``file://`` with either.
            base: the folder of the file in which it stands, that of the main file if None.

        Raises:
            SourceFault: it resolves nowhere, leads out of the folders, or cannot be read.
        """
        return source_bytes(self.path_of(written, base))

    def path_of(self, written: str, base: Path | None = None) -> Path:
        """The file that a path or URI means, without links.

        Raises:
            SourceFault: it resolves nowhere, or leads out of the folders.
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
        """The folder of a package that the folder of the file is in, or that is beside it there.

        Only folders below that of the main file, and that folder itself, are looked at.
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
        """A fault of a path, at the place where the main file has it, if it does."""
        text = self.main_bytes().decode("utf-8-sig", errors="replace")
        place = re.search(rf"(?<=[\"'>\s]){re.escape(written)}(?=[\"'<\s])", text)
        source = Source(str(self.main), text if place else "")
        span = Span(*place.span()) if place else WHOLE
        said = f"`{visible(written)}` {message}"
        return SourceFault(Code.FOREIGN_PATH, said, source, span, hint)


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

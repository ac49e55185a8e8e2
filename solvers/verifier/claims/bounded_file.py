"""One file of a result folder, which anybody may have written: plain, and of a bounded size."""

from __future__ import annotations

from errno import ENOENT
from pathlib import Path

from grammar_lang.files.source_file import NoRegularFile, TooLarge, read_file

MOST_BYTES = 2**28
"""Far more than any result has; what is larger would only fill the memory."""


def bounded_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        OSError: it cannot be read, or is larger than any result.
    """
    try:
        return read_file(path, MOST_BYTES)
    except TooLarge as large:
        said = f"{path.name} has {large.size:,} bytes, more than {MOST_BYTES:,}"
        raise NoRegularFile(0, said) from None


def bounded_text(path: Path) -> str:
    """The same as text.

    Raises:
        OSError: as of :func:`bounded_bytes`.
        UnicodeDecodeError: it is not UTF-8.
    """
    return bounded_bytes(path).decode("utf-8")


def evidence_bytes(folder: Path, name: str) -> bytes:
    """A file below a folder by the name that a certificate, which may say anything, gives it.

    Raises:
        OSError: the name is none of a file in the folder, or it cannot be read.
    """
    try:
        inside = (folder / name).resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # a name too long, links in a circle, a NUL
        inside = False
    if not inside:
        raise FileNotFoundError(ENOENT, "it is no file of the folder")
    return bounded_bytes(folder / name)

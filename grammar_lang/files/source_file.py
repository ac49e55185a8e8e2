"""One file: from its path to its bytes, and from its bytes to a text.

A specification is UTF-8 text, with a byte order mark or without.  Its lines end with LF or CR LF;
a CR alone counts as LF.
"""

from __future__ import annotations

import re
import stat
from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.source import Span

_LONE_RETURN = re.compile(r"\r(?!\n)")

LIMIT = 8 * 2**20
"""So many bytes may the texts of a program have, all together."""


class NoRegularFile(OSError):
    """A folder, a device or a pipe where a file is due; ``strerror`` says which."""


class TooLarge(Exception):
    """A file of more bytes than are left; ``size`` counts them."""

    def __init__(self, size: int) -> None:
        super().__init__(f"{size} bytes")
        self.size = size


def read_file(path: Path, limit: int) -> bytes:
    """The bytes of a regular file.

    Raises:
        OSError, ValueError: it cannot be read; :func:`reason` says why.
        TooLarge: it has more than ``limit`` bytes; it has not been read then.
    """
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        what = "it is a folder" if stat.S_ISDIR(status.st_mode) else "it is no regular file"
        raise NoRegularFile(0, what)
    if status.st_size > limit:
        raise TooLarge(status.st_size)
    with path.open("rb") as file:
        data = file.read(limit + 1)
    if len(data) > limit:
        raise TooLarge(len(data))
    return data


def reason(error: OSError | ValueError) -> str:
    """Why a file could not be read, in lower case."""
    said = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return f"{said[:1].lower()}{said[1:]}"


def decoded(data: bytes, file: int, sink: Sink) -> tuple[str, bool]:
    """The text of a file, and whether it is sound; what is wrong with it is reported.

    Args:
        data: the bytes.
        file: the number of the file, for spans.
        sink: takes the errors.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        start = len(data[: error.start].decode("utf-8-sig", errors="replace"))
        message = f"the file is not UTF-8: byte 0x{data[error.start]:02x}"
        sink.error(Code.NOT_UTF8, message, Span(start, start + 1, file), "save it as UTF-8")
        return data.decode("utf-8-sig", errors="replace"), False
    return _LONE_RETURN.sub("\n", text), is_text(text, file, sink)


def is_text(text: str, file: int, sink: Sink) -> bool:
    """Whether a text has no NUL; the first one is reported."""
    nul = text.find("\0")
    if nul < 0:
        return True
    message = "a NUL character: this is not a text file"
    hint = "save it as plain UTF-8 text"
    sink.error(Code.UNEXPECTED_CHARACTER, message, Span(nul, nul + 1, file), hint)
    return False

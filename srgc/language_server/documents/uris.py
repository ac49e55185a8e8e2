"""URIs of documents and paths of files (RFC 8089)."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path
from urllib.parse import unquote, urlsplit

UriOf = Callable[[Path], str]


def path_of(uri: str) -> Path | None:
    """The path of a ``file:`` URI; None for untitled documents and the like.

    It is also None for a path that no file can have; such a document is a text without a path.
    """
    try:
        parts = urlsplit(uri)
        path = unquote(parts.path, errors="surrogateescape")
        if parts.scheme != "file" or not path.startswith("/"):
            return None
        return Path(path) if _is_possible(path) else None
    except ValueError:
        return None


def is_malformed(uri: str) -> bool:
    """Whether a text is not a URI at all."""
    try:
        urlsplit(uri)
    except ValueError:
        return True
    return False


def _is_possible(path: str) -> bool:
    """Whether a file with this path can exist; a ValueError also means that it cannot."""
    try:
        Path(path).lstat()
    except OSError as error:
        return error.errno != errno.ENAMETOOLONG
    return True


def uri_of(path: Path) -> str:
    """The URI of a file."""
    return path.absolute().as_uri()

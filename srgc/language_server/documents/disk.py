"""What is on the disk, whatever it is: a folder that nobody may look into, a pipe, a device."""

from __future__ import annotations

import os
from pathlib import Path

from grammar_lang.files.file_set import IMAGE_LIMIT
from grammar_lang.files.source_file import TooLarge, read_file


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

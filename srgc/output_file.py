"""A file that a user has asked a command to write."""

from __future__ import annotations

from pathlib import Path

from srgc.near_places import unwritable
from srgc.possible_path import refuse_impossible


def write_output(path: Path, content: str | bytes) -> None:
    """Write a file, text as UTF-8.

    Raises:
        UsageFault: it cannot be written.
    """
    refuse_impossible(path)
    try:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError as error:
        raise unwritable(path, error) from None

"""Standard input in place of a file, written `-`."""

from __future__ import annotations

from pathlib import Path

from grammar_lang.files.file_tree import LIMIT
from srgc.faults import UsageFault

DASH = Path("-")
STDIN = "<stdin>"
"""What diagnostics call it."""


def standard_input() -> bytes:
    """The bytes of standard input.

    Raises:
        UsageFault: it cannot be read, or is larger than a file may be.
    """
    try:
        with open(0, "rb", closefd=False) as stdin:
            data = stdin.read(LIMIT + 1)
    except OSError as error:
        raise UsageFault(f"standard input: {error.strerror}") from None
    if len(data) > LIMIT:
        raise UsageFault(f"standard input has more than {LIMIT} bytes")
    return data

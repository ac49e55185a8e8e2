"""What terminals get, but files and pipes do not: colours, and lines that are redrawn.

All commands decide with the functions of this module.
"""

from __future__ import annotations

import codecs
import os
import sys
from contextlib import suppress
from typing import TextIO

ESCAPED = "srgc.escaped"
"""The name of the error handler for characters that a stream cannot encode."""


def colours(stream: TextIO | None) -> bool:
    """Whether text for a stream is coloured.

    ``NO_COLOR`` (no-color.org) forbids it, else ``FORCE_COLOR`` asks for it; empty variables count
    as unset.  Without them, text is coloured on terminals, but not if ``TERM`` is ``dumb``.
    """
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return os.environ["FORCE_COLOR"] != "0"
    return redraws(stream)


def redraws(stream: TextIO | None) -> bool:
    """Whether a line of a stream can be redrawn: the stream is a terminal and not a dumb one."""
    if stream is None or os.environ.get("TERM") == "dumb":
        return False
    try:
        return stream.isatty()
    except ValueError:  # it has been closed
        return False


def out_colours() -> bool:
    """Whether text on standard output is coloured."""
    return colours(sys.stdout)


_RESET, _OPEN = "\033[0m", "\033[1;33m"
_VERDICTS = {
    **dict.fromkeys(("found", "valid"), "\033[1;32m"),
    **dict.fromkeys(("impossible", "no path", "refuted", "disagreement"), "\033[1;31m"),
}
"""Proved verdicts are green or red; all others are yellow."""


def with_verdict(text: str, verdict: str, stream: TextIO | None = None) -> str:
    """A text with its first ``verdict`` coloured, if the stream (default: standard output) is."""
    if not colours(sys.stdout if stream is None else stream):
        return text
    return text.replace(verdict, f"{_VERDICTS.get(verdict, _OPEN)}{verdict}{_RESET}", 1)


def silence(stream: TextIO | None) -> None:
    """Discard everything that is written to a stream from now on, because its device takes no more.

    Otherwise Python would write the rest of the buffer again at the end, and fail.
    """
    with suppress(OSError, ValueError, AttributeError):  # already closed, or a stand-in
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())  # type: ignore[union-attr]
        os.close(nowhere)


def escape_unencodable() -> None:
    r"""Let standard output and error write ``\u03c1`` where their encoding lacks the character."""
    codecs.register_error(ESCAPED, _escaped)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)  # stand-ins have none
        if reconfigure is not None:
            reconfigure(errors=ESCAPED)


def _escaped(error: UnicodeError) -> tuple[str, int]:
    """Escape characters as JSON and many languages do, so that JSON remains JSON."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    units = letters.encode("utf-16-be", "surrogatepass")
    pairs = (units[i : i + 2].hex() for i in range(0, len(units), 2))
    return "".join(f"\\u{pair}" for pair in pairs), error.end

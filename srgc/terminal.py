"""What a terminal is told that a file or a pipe is not: colours, and lines that are redrawn.

One place decides for all commands.
"""

from __future__ import annotations

import codecs
import os
import sys
from contextlib import suppress
from typing import TextIO

ESCAPED = "srgc.escaped"
"""The name of the handler of characters that a stream cannot encode."""


def colours(stream: TextIO | None) -> bool:
    """Whether text for a stream is coloured.

    ``NO_COLOR`` (no-color.org) forbids it, else ``FORCE_COLOR`` asks for it; a variable that is
    empty says nothing.  Without them: on terminals, but not where ``TERM`` is ``dumb``.
    """
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return os.environ["FORCE_COLOR"] != "0"
    return redraws(stream)


def redraws(stream: TextIO | None) -> bool:
    """Whether a line of a stream can be drawn again: it is a terminal that is not dumb."""
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
"""What is proved is green or red; all other verdicts are yellow."""


def with_verdict(text: str, verdict: str, stream: TextIO | None = None) -> str:
    """A text whose first words have a verdict, coloured where the stream (standard output) is."""
    if not colours(sys.stdout if stream is None else stream):
        return text
    return text.replace(verdict, f"{_VERDICTS.get(verdict, _OPEN)}{verdict}{_RESET}", 1)


def silence(stream: TextIO | None) -> None:
    """From now on what is written to a stream goes nowhere: its device takes no more.

    What is still in its buffer would otherwise be tried again at the end, and be a fault.
    """
    with suppress(OSError, ValueError, AttributeError):  # closed before, or a stand-in
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())  # type: ignore[union-attr]
        os.close(nowhere)


def escape_unencodable() -> None:
    r"""Let standard output and error write ``\u03c1`` where their encoding has no such letter."""
    codecs.register_error(ESCAPED, _escaped)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)  # there is none on a stand-in
        if reconfigure is not None:
            reconfigure(errors=ESCAPED)


def _escaped(error: UnicodeError) -> tuple[str, int]:
    """The letters as JSON and many languages escape them, so that JSON remains JSON."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letters = error.object[error.start : error.end]
    units = letters.encode("utf-16-be", "surrogatepass")
    pairs = (units[i : i + 2].hex() for i in range(0, len(units), 2))
    return "".join(f"\\u{pair}" for pair in pairs), error.end

"""What is wrong with a file of obstacles, and where in it."""

from __future__ import annotations

from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.ir import ObstacleMap
from grammar_lang.source import Span


class MapFault(Exception):
    """A map that cannot be used; ``start`` to ``end`` are offsets in its text, None: the image.

    ``message`` is one line, ``hint`` says what to do about it.
    """

    def __init__(
        self,
        message: str,
        hint: str,
        place: tuple[int, int] | None = (0, 1),
        code: Code = Code.UNREADABLE_REFERENCE,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint
        self.place = place
        self.code = code

    def span(self, found: ObstacleMap) -> Span:
        """Where it is, in the text of the map in which it was found."""
        if self.place is None:
            return found.image_span
        return Span(*self.place, found.file)

    def report(self, found: ObstacleMap, sink: Sink) -> None:
        """Record it as an error."""
        notes = [(found.span, "the map is named here")]
        sink.error(self.code, self.message, self.span(found), self.hint, notes)


# --- What is wrong with the image of a map, and how large one may be ------------------------------


PIXEL_LIMIT = 2**26
"""So many pixels may an image have."""

_HINT = "save it as PGM, or as PNG of 8 bits in shades of grey"


def image_fault(message: str) -> MapFault:
    """A fault of an image, which has no place in a text."""
    return MapFault(message, _HINT, None)


def check_size(width: int, height: int) -> None:
    """See to it that an image can be held.

    Args:
        width: pixels in a row.
        height: rows.

    Raises:
        MapFault: it has no pixels, or more than ``PIXEL_LIMIT``.
    """
    if not width or not height:
        raise image_fault("the image has no pixels")
    if width * height > PIXEL_LIMIT:
        message = f"the image has {width * height:,} pixels, more than {PIXEL_LIMIT:,}"
        hint = "cut it to the bounds of the workspace, or use a coarser map"
        raise MapFault(message, hint, None, Code.TOO_LARGE)

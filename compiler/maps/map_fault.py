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

"""The files that make up a program: each read once, numbered in the order of reading."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.files.file_tree import FileTree, Place, Refusal, shown
from grammar_lang.files.source_file import LIMIT, TooLarge, decoded
from grammar_lang.source import Source, Span
from grammar_lang.syntax import Ident

IMAGE_LIMIT = 64 * 2**20
"""So many bytes may the images of all maps have together."""


@dataclass(slots=True)
class FileSet:
    """The files read so far; ``tree`` is None where there is only a text, without a folder.

    ``left`` counts the bytes that further texts may have, ``left_images`` those of images.
    ``unsound`` are the numbers of texts that cannot be parsed.
    """

    tree: FileTree | None
    sink: Sink
    sources: list[Source]
    left: int
    left_images: int = IMAGE_LIMIT
    unsound: set[int] = field(default_factory=set[int])
    _numbers: dict[str, int] = field(init=False)

    def __post_init__(self) -> None:
        self._numbers = {source.path: number for number, source in enumerate(self.sources)}

    def place(self, written: Ident, base: int) -> Place | None:
        """The file that a path in the file number ``base`` means; a bad path is reported."""
        if self.tree is None:
            message = "a text has no folder in which this file could be"
            hint = "save the text as a file, and check that file"
            self.sink.error(Code.UNREADABLE_REFERENCE, message, written.span, hint)
            return None
        try:
            return self.tree.place(written.text, self.sources[base].path)
        except Refusal as refusal:
            self.sink.error(refusal.code, refusal.message, written.span, refusal.hint)
            return None

    def text(self, place: Place, written: Ident, suffixes: tuple[str, ...]) -> int | None:
        """The number of a text file, read at the first call; None if it cannot be read.

        Args:
            place: the file.
            written: its path as written.
            suffixes: how the names of such files end.
        """
        if place.path in self._numbers:
            return self._numbers[place.path]
        data = self._data(place, written, self.left, LIMIT, suffixes)
        if data is None:
            return None
        self.left -= len(data)
        number = self._numbers[place.path] = len(self.sources)
        text, sound = decoded(data, number, self.sink)
        if not sound:
            self.unsound.add(number)
        self.sources.append(Source(self._name(place), text, place.path, data))
        return number

    def image(self, place: Place, written: Ident) -> bytes | None:
        """The bytes of an image, read at the first call; None if it cannot be read."""
        if place.path in self._numbers:
            return self.sources[self._numbers[place.path]].data
        suffixes = (".pgm", ".png")
        data = self._data(place, written, self.left_images, IMAGE_LIMIT, suffixes)
        if data is None:
            return None
        self.left_images -= len(data)
        self._numbers[place.path] = len(self.sources)
        self.sources.append(Source(self._name(place), "", place.path, data))
        return data

    def twin(self, place: Place, number: int) -> None:
        """Note that a file was reached under another name than the one it was read by."""
        first = self.sources[number]
        if place.path == first.path or place.path in self._numbers:
            return
        self._numbers[place.path] = len(self.sources)
        name = self._name(place)
        self.sources.append(replace(first, name=name, path=place.path, twin=first.path))

    def _name(self, place: Place) -> str:
        return place.path if self.tree is None else self.tree.name(place.path)

    def _data(
        self, place: Place, written: Ident, left: int, limit: int, suffixes: tuple[str, ...]
    ) -> bytes | None:
        if self.tree is None:
            return None
        try:
            return self.tree.read(place, written.text, left, suffixes)
        except Refusal as refusal:
            self.sink.error(refusal.code, refusal.message, written.span, refusal.hint)
        except TooLarge as large:
            size = large.size + limit - left
            where = f"with {shown(written.text)} the files have"
            too_large(where, size, limit, written.span, self.sink)
        return None


def too_large(what: str, size: int, limit: int, span: Span, sink: Sink) -> None:
    """Report files of more bytes than a program may have; ``what`` begins the message."""
    message = f"{what} {size:,} bytes, more than {limit:,}"
    sink.error(Code.TOO_LARGE, message, span, "leave out what no task needs")

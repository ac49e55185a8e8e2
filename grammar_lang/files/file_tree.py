"""Reading files as texts, and the directory tree that holds all files of a program."""

from __future__ import annotations

import os
import posixpath
import re
import stat
from codecs import BOM_UTF8
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import nearest
from grammar_lang.source import Source, Span, node
from grammar_lang.syntax import Ident

# --- One file: from its path to its bytes, and from its bytes to a text ---------------------------
#
# A specification is UTF-8 text, with or without a byte order mark.  Its lines end with LF or CR LF;
# a lone CR counts as LF.


_LONE_RETURN = re.compile(r"\r(?!\n)")

LIMIT = 8 * 2**20
"""The most bytes that the texts of a program may have together."""


class NoRegularFile(OSError):
    """A folder, a device or a pipe instead of a file; ``strerror`` says which."""


class TooLarge(Exception):
    """The file has more bytes than may still be read; ``size`` is their number."""

    def __init__(self, size: int) -> None:
        super().__init__(f"{size} bytes")
        self.size = size


def read_file(path: Path, limit: int) -> bytes:
    """The bytes of a regular file.

    Raises:
        OSError, ValueError: it cannot be read; :func:`reason` says why.
        TooLarge: it has more than ``limit`` bytes.
    """
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        what = "it is a folder" if stat.S_ISDIR(status.st_mode) else "it is not a regular file"
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
    """Decode a file; return its text and whether it is valid, and report what is wrong.

    Args:
        data: the bytes.
        file: the number of the file, for spans.
        sink: collects the errors.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        mark = len(BOM_UTF8) if data.startswith(BOM_UTF8) else 0  # which `error` does not count
        start = len(data[mark : mark + error.start].decode("utf-8", errors="replace"))
        message = f"the file is not UTF-8: byte 0x{data[mark + error.start]:02x}"
        sink.error(Code.NOT_UTF8, message, Span(start, start + 1, file), "save it as UTF-8")
        return data.decode("utf-8-sig", errors="replace"), False
    return _LONE_RETURN.sub("\n", text), is_text(text, file, sink)


def is_text(text: str, file: int, sink: Sink) -> bool:
    """Whether a text has no NUL; the first NUL is reported."""
    nul = text.find("\0")
    if nul < 0:
        return True
    message = "a NUL character: this is not a text file"
    hint = "save it as plain UTF-8 text"
    sink.error(Code.UNEXPECTED_CHARACTER, message, Span(nul, nul + 1, file), hint)
    return False


# --- The directory tree of the file on the command line, and the paths that name files in it ------
#
# A path is written with ``/`` and is relative to the folder of the file in which it stands, under
# the name of that file before links are resolved: so a copy of the tree has the same meaning.  The
# targets of links are checked as well: nothing outside the tree is ever read.
#
# The library, which ``include std`` reads, appears in the tree as the folder ``@std``.  If the tree
# has no such file, the file of the package is read.  Results keep copies, which are read instead.


STD = "@std"
LIBRARY = os.path.realpath(Path(__file__).parent.parent / "library")

_MANY = 1000
"""The most files of a folder that are compared with a misspelt name."""
_SHOWN = 80


class Refusal(Exception):
    """A path does not name a readable file of the tree."""

    def __init__(self, code: Code, message: str, hint: str) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.hint = hint


@node
class Place:
    """A file of a tree: ``path`` is its normalised path below the top, ``real`` has no links."""

    path: str
    real: str


def visible(path: str) -> str:
    """A path for a message, with non-printable characters replaced."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in path)


def shown(path: str) -> str:
    """A path as a message quotes it, shortened if it is very long."""
    return f"`{visible(path)}`" if len(path) <= _SHOWN else f"`{visible(path[:_SHOWN])}…`"


def name_of(path: Path) -> str:
    """The name of a file in diagnostics; bytes that are not UTF-8 are replaced."""
    return str(path).encode("utf-8", "replace").decode("utf-8")


def _unencodable(path: str) -> bool:
    """Whether a text has characters that no file name can have."""
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        return True
    return False


def _written(path: str) -> None:
    """Reject a text that cannot be the path of a file, whatever the tree holds."""
    if not path:
        raise Refusal(Code.UNREADABLE_REFERENCE, "an empty path", "write the path of a file")
    if "\0" in path or _unencodable(path):
        message = f"cannot read {shown(path)}: a path cannot contain such a character"
        raise Refusal(Code.UNREADABLE_REFERENCE, message, "write the path of a file")
    if "\\" in path:
        better = shown(path.replace("\\", "/"))
        hint = f"folders are separated by `/`: {better}"
        raise Refusal(Code.UNREADABLE_REFERENCE, "a backslash in a path", hint)
    if path.startswith("/"):
        message = f"{shown(path)} is an absolute path"
        hint = "write it relative to the folder of this file"
        raise Refusal(Code.OUTSIDE_TREE, message, hint)
    if path.endswith("/") or path == ".":
        message = f"cannot read {shown(path)}: it is a folder"
        raise Refusal(Code.UNREADABLE_REFERENCE, message, "write the path of a file")


@node
class FileTree:
    """The tree below the folder of the main file: ``folder`` as the user names it, ``top`` real.

    ``open_files`` are the contents of files that an editor holds, by path with links resolved.
    """

    folder: Path
    top: str
    main: str
    open_files: Mapping[str, bytes] = field(
        default_factory=dict[str, bytes], compare=False, repr=False
    )

    def name(self, place: Place) -> str:
        """The name of a file of the tree in diagnostics."""
        if place.path.startswith(f"{STD}/") and place.real.startswith(f"{LIBRARY}{os.sep}"):
            return name_of(Path(place.real))
        return name_of(self.folder / place.path)

    def place(self, written: str, base: str, *, std: bool = False) -> Place:
        """Find the file that a path names.

        Args:
            written: the path as written.
            base: the path of the file in which it stands, below the top.
            std: whether the path is relative to the library.

        Raises:
            Refusal: it is not a path, or it leads out of the tree.
        """
        _written(written)
        folder = STD if std else posixpath.dirname(base)
        path = posixpath.normpath(posixpath.join(folder, written))
        if std and not path.startswith(f"{STD}/"):
            message = f"{shown(written)} is outside the library"
            hint = 'write a file of it: `include std "ur5.srg";`'
            raise Refusal(Code.OUTSIDE_TREE, message, hint)
        if path.startswith(f"{STD}/") and self._is_of_package(path):
            return Place(path, posixpath.join(LIBRARY, path.removeprefix(f"{STD}/")))
        if path == ".." or path.startswith("../"):
            message = f"{shown(written)} is outside the folder of {shown(self.main)}"
            hint = f"move it into that folder, or move {shown(self.main)} to a folder above both"
            raise Refusal(Code.OUTSIDE_TREE, message, hint)
        real = os.path.realpath(posixpath.join(self.top, path))
        if real != self.top and not real.startswith(posixpath.join(self.top, "")):
            message = (
                f"{shown(written)} leads out of the folder of {shown(self.main)} through a link"
            )
            raise Refusal(Code.OUTSIDE_TREE, message, "put a copy of the file into that folder")
        return Place(path, real)

    def _is_of_package(self, path: str) -> bool:
        """Whether the file of a library path has no copy in the tree."""
        copy = posixpath.join(self.top, path)
        return not os.path.lexists(copy) and os.path.realpath(copy) not in self.open_files

    def read(self, place: Place, written: str, limit: int, suffixes: tuple[str, ...]) -> bytes:
        """The bytes of a file of the tree.

        Args:
            place: the file.
            written: its path as written.
            limit: the most bytes it may have.
            suffixes: the possible extensions of the file, for hints.

        Raises:
            Refusal: it cannot be read.
            TooLarge: it has more than ``limit`` bytes.
        """
        held = self.open_files.get(place.real)
        if held is not None:
            if len(held) > limit:
                raise TooLarge(len(held))
            return held
        try:
            return read_file(Path(place.real), limit)
        except (OSError, ValueError) as error:
            message = f"cannot read {shown(written)}: {reason(error)}"
            missing = isinstance(error, FileNotFoundError | NotADirectoryError)
            hint = self._others(place, written, suffixes) if missing else _GIVE
            raise Refusal(Code.UNREADABLE_REFERENCE, message, hint) from None

    def _others(self, place: Place, written: str, suffixes: tuple[str, ...]) -> str:
        """A hint about which file may be meant."""
        folder, name = posixpath.split(written)
        kinds = " or ".join(f"`{suffix}`" for suffix in suffixes)
        try:
            with os.scandir(posixpath.dirname(place.real)) as entries:
                names = (entry.name for entry in entries)
                known = sorted(n for n in names if n.lower().endswith(suffixes) and n.isprintable())
        except OSError:
            return f"there is no folder {shown(folder)}" if folder else _GIVE
        stems = {posixpath.splitext(n)[0]: n for n in reversed(known[:_MANY])}
        close = nearest(posixpath.splitext(name)[0], sorted(stems))
        if close is not None:
            return f"did you mean {shown(posixpath.join(folder, stems[close]))}?"
        if not known:
            return f"that folder has no file that ends in {kinds}"
        few = ", ".join(shown(posixpath.join(folder, name)) for name in known[:6])
        return f"known: {few}{', …' if len(known) > 6 else ''}"


_GIVE = "give the path of a file that can be read"
_LIBRARY_ALONE = FileTree(Path(LIBRARY), LIBRARY, "")
"""For a text without a folder: it can include only files of the library."""


# --- The files that make up a program: each read once, numbered in the order of reading -----------


IMAGE_LIMIT = 64 * 2**20
"""The most bytes that the images and meshes of a program may have together."""


@dataclass(slots=True)
class FileSet:
    """The files read so far; ``tree`` is None for a text without a folder.

    Such a text can include only files of the library.

    ``left`` is the number of bytes that further texts may have, ``left_images`` that of images and
    meshes.  ``unsound`` are the numbers of texts that cannot be parsed.
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

    def place(self, written: Ident, base: int, *, std: bool = False) -> Place | None:
        """Find the file that a path in the file number ``base`` names; report a bad path.

        With ``std``, the path is relative to the library.
        """
        tree = self.tree
        if tree is None and (std or self.sources[base].path.startswith(f"{STD}/")):
            tree = _LIBRARY_ALONE
        if tree is None:
            message = "a text has no folder in which this file could be"
            hint = "save the text as a file, and check that file"
            self.sink.error(Code.UNREADABLE_REFERENCE, message, written.span, hint)
            return None
        try:
            return tree.place(written.text, self.sources[base].path, std=std)
        except Refusal as refusal:
            self.sink.error(refusal.code, refusal.message, written.span, refusal.hint)
            return None

    def text(self, place: Place, written: Ident, suffixes: tuple[str, ...]) -> int | None:
        """The number of a text file, read at the first call; None if it cannot be read.

        Args:
            place: the file.
            written: its path as written.
            suffixes: the possible extensions of the file, for hints.
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

    def binary(self, place: Place, written: Ident, suffixes: tuple[str, ...]) -> bytes | None:
        """The bytes of an image or a mesh, read at the first call; None if it cannot be read."""
        if place.path in self._numbers:
            return self.sources[self._numbers[place.path]].data
        data = self._data(place, written, self.left_images, IMAGE_LIMIT, suffixes)
        if data is None:
            return None
        self.left_images -= len(data)
        self._numbers[place.path] = len(self.sources)
        self.sources.append(Source(self._name(place), "", place.path, data))
        return data

    def twin(self, place: Place, number: int) -> None:
        """Record that a file was reached under another name than the first."""
        first = self.sources[number]
        if place.path == first.path or place.path in self._numbers:
            return
        self._numbers[place.path] = len(self.sources)
        name = self._name(place)
        self.sources.append(replace(first, name=name, path=place.path, twin=first.path))

    def _name(self, place: Place) -> str:
        return (self.tree or _LIBRARY_ALONE).name(place)

    def _data(
        self, place: Place, written: Ident, left: int, limit: int, suffixes: tuple[str, ...]
    ) -> bytes | None:
        try:
            return (self.tree or _LIBRARY_ALONE).read(place, written.text, left, suffixes)
        except Refusal as refusal:
            self.sink.error(refusal.code, refusal.message, written.span, refusal.hint)
        except TooLarge as large:
            size = large.size + limit - left
            where = f"with {shown(written.text)} the files have"
            too_large(where, size, limit, written.span, self.sink)
        return None


def too_large(what: str, size: int, limit: int, span: Span, sink: Sink) -> None:
    """Report that the files of a program are too large; ``what`` begins the message."""
    message = f"{what} {size:,} bytes, more than {limit:,}"
    sink.error(Code.TOO_LARGE, message, span, "leave out what no task needs")

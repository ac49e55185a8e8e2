"""Mesh files: the exact, distinct vertices of STL (text or binary) and OBJ.

Their hulls are computed elsewhere.  Sources: 3D Systems, *StereoLithography interface
specification* (1988); Wavefront, *Object files (.obj)*.
"""

from __future__ import annotations

import hashlib
import re
import struct
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.files.file_tree import FileSet
from grammar_lang.syntax import Ident

SUFFIXES = (".stl", ".obj")
VISUALS = (*SUFFIXES, ".dae", ".glb")
MOST = 500_000
"""The most vertices of a mesh; in STL, three per triangle."""
LARGEST = 1e12
"""The bound on the absolute value of coordinates, in the unit of the mesh."""
_LONGEST = 64
_HEADER, _TRIANGLE = 84, 50
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,2})?")

Vertices: TypeAlias = tuple[tuple[Fraction, ...], ...]


class MeshError(ValueError):
    """The file is not a mesh; the message says why."""


def read_mesh(path: Ident, base: int, files: FileSet) -> ir.Mesh | None:
    """Read the mesh at a path in the file number ``base``.

    Problems with the path or the file are reported; the result is then None.
    """
    place = files.place(path, base)
    if place is None:
        return None
    if not is_mesh(place.path):
        message = "this file extension is not that of a mesh"
        hint = "known: STL (`.stl`) and OBJ (`.obj`)"
        files.sink.error(Code.UNREADABLE_REFERENCE, message, path.span, hint)
        return None
    data = files.binary(place, path, SUFFIXES)
    if data is None:
        return None
    try:
        vertices = _lines(data, "v", "f") if is_obj(place.path) else _stl(data)
    except MeshError as error:
        message, hint = f"this is not a mesh: {error}", "export it again as STL or OBJ"
        files.sink.error(Code.UNREADABLE_REFERENCE, message, path.span, hint)
        return None
    return ir.Mesh(place.path, hashlib.sha256(data).hexdigest(), vertices)


def read_visual(path: Ident, base: int, files: FileSet) -> ir.VisualFile | None:
    """Read the file of a visual at a path in the file number ``base``, without parsing it.

    Problems with the path or the file are reported; the result is then None.
    """
    place = files.place(path, base)
    if place is None:
        return None
    if not place.path.lower().endswith(VISUALS):
        message = "this file extension is not that of a visual"
        hint = f"known: {', '.join(f'`{each}`' for each in VISUALS)}"
        files.sink.error(Code.UNREADABLE_REFERENCE, message, path.span, hint)
        return None
    data = files.binary(place, path, VISUALS)
    if data is None:
        return None
    return ir.VisualFile(place.path, hashlib.sha256(data).hexdigest(), data)


def is_mesh(path: str) -> bool:
    """Whether a file is a mesh that can be read, by its extension."""
    return path.lower().endswith(SUFFIXES)


def is_obj(path: str) -> bool:
    """Whether a mesh is OBJ, by its extension."""
    return path.lower().endswith(".obj")


def _stl(data: bytes) -> Vertices:
    binary = binary_triangles(data)
    if binary is None:
        return _lines(data, "vertex", "facet")
    found = dict.fromkeys(corner for triangle in binary for corner in triangle)
    return _distinct([tuple(map(Fraction, corner)) for corner in found])


def binary_triangles(data: bytes) -> Iterator[tuple[tuple[float, ...], ...]] | None:
    """The corners of each triangle of a binary STL file; None if the file is text.

    A file is binary if its size fits the number of triangles in its header, whatever it begins
    with.

    Raises:
        MeshError: there are too many triangles; or, during iteration, a corner is not finite or is
            out of range.
    """
    if len(data) < _HEADER:
        return None
    (count,) = struct.unpack_from("<I", data, 80)
    if len(data) != _HEADER + _TRIANGLE * count:
        return None
    if 3 * count > MOST:
        raise MeshError(f"it has {count:,} triangles, and may have {MOST // 3:,}")
    return _unpacked(data, count)


def _unpacked(data: bytes, count: int) -> Iterator[tuple[tuple[float, ...], ...]]:
    for number in range(count):
        values = struct.unpack_from("<9f", data, _HEADER + _TRIANGLE * number + 12)
        if not all(abs(value) < LARGEST for value in values):
            raise MeshError(
                f"triangle {number + 1} has a corner that is not finite, or too far off"
            )
        yield values[:3], values[3:6], values[6:]


def text_lines(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """The number, from 1 on, and the words of each non-empty line of a mesh in text form.

    Raises:
        MeshError: the data are not text.
    """
    if b"\0" in data:
        raise MeshError("it is neither binary of the size that its header says nor text")
    # Comments may be in any encoding.
    for number, line in enumerate(data.decode("utf-8-sig", errors="replace").splitlines(), 1):
        words = line.split()
        if words:
            yield number, words


def written_corner(number: int, words: Sequence[str]) -> tuple[Fraction, ...]:
    """The three numbers after the first word of a line.

    Raises:
        MeshError: there are no three such numbers.
    """
    try:
        corner = tuple(Fraction(word) for word in words[1:4] if _is_decimal(word))
    except ValueError:
        corner = ()
    if len(corner) != 3:
        what = words[0].lower()
        raise MeshError(f"line {number} does not have three numbers of a usual size after `{what}`")
    return corner


def _lines(data: bytes, word: str, piece: str) -> Vertices:
    """The numbers on lines that begin with ``word``; the file must also have ``piece`` lines."""
    found = dict[tuple[Fraction, ...], None]()
    pieces = corners = 0
    for number, words in text_lines(data):
        first = words[0].lower()
        pieces += first == piece
        if first != word:
            continue
        corners += 1
        found[written_corner(number, words)] = None
        if len(found) > MOST:
            raise MeshError(f"it has more than {MOST:,} vertices")
    if not pieces:
        raise MeshError(f"no line begins with `{piece}`")
    if piece == "facet" and corners != 3 * pieces:
        raise MeshError(f"it has {corners} corners of {pieces} triangles: it may have been cut off")
    return _distinct(list(found))


def _is_decimal(part: str) -> bool:
    """Whether a text is a number of usual size: a huge power would make an enormous fraction."""
    if len(part) > _LONGEST or _DECIMAL.fullmatch(part) is None:
        return False
    return abs(float(part)) < LARGEST


def _distinct(vertices: list[tuple[Fraction, ...]]) -> Vertices:
    found = tuple(sorted(set(vertices)))
    if not found:
        raise MeshError("it has no vertex")
    return found

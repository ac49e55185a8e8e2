"""Meshes as scenes: the triangles of STL and OBJ, grouped into objects.

In OBJ, the faces under one `o` (or `g`, if the file has no `o`) are an object.  Other faces, and
all of STL, are split into parts connected by common corners.  Sources: see
:mod:`grammar_lang.files.meshes`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import TypeAlias

from grammar_lang import ir
from grammar_lang.files import meshes
from grammar_lang.files.meshes import MeshError

OBJECT_LIMIT = 5_000
"""The most objects of a mesh."""
TRIANGLE_LIMIT = meshes.MOST // 3
"""The most triangles of a mesh; a face of k corners counts as k - 2."""
_LABEL = 60
_DROPPED = frozenset({"l", "p", "curv", "curv2", "surf"})
"""OBJ elements other than faces; leaving them out could leave out an obstacle."""

Corner: TypeAlias = tuple[Fraction, ...]
Written: TypeAlias = Corner | tuple[float, ...]
Triangle: TypeAlias = tuple[int, int, int]


@dataclass(slots=True)
class _Triangles:
    """The distinct corners, and the triangles by the name of their object.

    Corners stay floats if the file stores floats, because these compare far faster.
    """

    numbers: dict[Written, int] = field(default_factory=dict[Written, int])
    parts: dict[str | None, list[Triangle]] = field(
        default_factory=dict[str | None, list[Triangle]]
    )
    count: int = 0

    def number(self, corner: Written) -> int:
        return self.numbers.setdefault(corner, len(self.numbers))

    def add(self, name: str | None, triangle: Triangle) -> None:
        self.count += 1
        if self.count > TRIANGLE_LIMIT:
            raise MeshError(f"it has more than {TRIANGLE_LIMIT:,} triangles")
        self.parts.setdefault(name, []).append(triangle)


def scene_of(path: str, data: bytes, *, faces_alone: bool = True) -> ir.Scene:
    """The objects of a mesh, in the order in which they first occur.

    Args:
        path: the path of the file; its extension tells the format.
        data: the bytes of the file.
        faces_alone: whether anything but faces is an error; otherwise it is ignored.

    Raises:
        MeshError: the data are not a mesh, or too large a mesh.
    """
    found = _obj(data, faces_alone=faces_alone) if meshes.is_obj(path) else _stl(data)
    if not found.count:
        raise MeshError("it has no triangle")
    objects = tuple(_objects(found))
    if len(objects) > OBJECT_LIMIT:
        raise MeshError(f"it has {len(objects):,} objects, and may have {OBJECT_LIMIT:,}")
    return ir.Scene(hashlib.sha256(data).hexdigest(), objects)


def _objects(found: _Triangles) -> Iterator[ir.SceneObject]:
    """Named parts are objects; unnamed parts are split into connected components."""
    corners = [tuple(map(Fraction, corner)) for corner in found.numbers]
    for name, triangles in found.parts.items():
        if name is not None:
            label = name if len(name) <= _LABEL else f"{name[:_LABEL]}…"
            shown = "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in label)
            yield _object(f"`{shown}`", triangles, corners)
            continue
        for number, part in enumerate(_components(triangles), 1):
            yield _object(f"{number}", part, corners)


def _object(label: str, triangles: Sequence[Triangle], corners: Sequence[Corner]) -> ir.SceneObject:
    own: dict[int, int] = {}
    faces = tuple(
        (own.setdefault(a, len(own)), own.setdefault(b, len(own)), own.setdefault(c, len(own)))
        for a, b, c in triangles
    )
    return ir.SceneObject(label, tuple(corners[number] for number in own), faces)


def _components(triangles: Sequence[Triangle]) -> list[list[Triangle]]:
    """The components connected by common corners, in the order of their first triangles."""
    above: dict[int, int] = {}

    def top(corner: int) -> int:
        while above.setdefault(corner, corner) != corner:
            above[corner] = above[above[corner]]
            corner = above[corner]
        return corner

    for a, b, c in triangles:
        above[top(b)] = top(a)
        above[top(c)] = top(a)
    found: dict[int, list[Triangle]] = {}
    for triangle in triangles:
        found.setdefault(top(triangle[0]), []).append(triangle)
    return list(found.values())


# --- STL ----------------------------------------------------------------------------------------


def _stl(data: bytes) -> _Triangles:
    found = _Triangles()
    binary = meshes.binary_triangles(data)
    for corners in _facets(data) if binary is None else binary:
        a, b, c = map(found.number, corners)
        found.add(None, (a, b, c))
    return found


def _facets(data: bytes) -> Iterator[tuple[Corner, ...]]:
    """The corners of each facet of a text STL file."""
    corners: list[Corner] = []
    facets = solids = 0
    for number, words in meshes.text_lines(data):
        word = words[0].lower()
        if word == "vertex":
            corners.append(meshes.written_corner(number, words))
        elif word == "facet":
            facets += 1
        elif word == "endfacet":
            if len(corners) != 3:
                raise MeshError(f"the facet that ends in line {number} has {len(corners)} corners")
            yield tuple(corners)
            corners, facets = [], facets - 1
        else:
            solids += (word == "solid") - (word == "endsolid")
    if facets or corners:
        raise MeshError("its last facet does not end: it may have been cut off")
    if solids > 0:
        raise MeshError("it has no `endsolid`: it may have been cut off")


# --- OBJ ----------------------------------------------------------------------------------------


def _obj(data: bytes, *, faces_alone: bool) -> _Triangles:
    found = _Triangles()
    lines = list(_joined(data))
    kinds = {words[0] for _, words in lines}
    part = next((kind for kind in ("o", "g") if kind in kinds), None)
    vertices: list[int] = []
    name: str | None = None
    for number, words in lines:
        word = words[0]
        if word == "v":
            vertices.append(found.number(meshes.written_corner(number, words)))
            if len(vertices) > meshes.MOST:
                raise MeshError(f"it has more than {meshes.MOST:,} vertices")
        elif word == part:
            name = " ".join(words[1:]) or None
        elif word == "f":
            face = [_vertex(each, vertices, number) for each in words[1:]]
            if len(face) < 3:
                raise MeshError(f"the face in line {number} has fewer than three corners")
            for b, c in pairwise(face[1:]):
                found.add(name, (face[0], b, c))
        elif faces_alone and word in _DROPPED:
            raise MeshError(f"line {number} has `{word}`, which is not a face")
    return found


def _joined(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """The lines without comments; a backslash at the end of a line continues it on the next."""
    before: list[str] = []
    first = 0
    for number, words in meshes.text_lines(data):
        kept = _uncommented(words)
        first = first if before else number
        if kept and kept[-1].endswith("\\"):
            before += [*kept[:-1], kept[-1][:-1]]
            continue
        joined = [word for word in (*before, *kept) if word]
        before = []
        if joined:
            yield first, joined
    if before:
        raise MeshError("its last line goes on: it may have been cut off")


def _uncommented(words: Sequence[str]) -> list[str]:
    for place, word in enumerate(words):
        if "#" in word:
            kept = word[: word.index("#")]
            return [*words[:place], *([kept] if kept else [])]
    return list(words)


def _vertex(written: str, vertices: Sequence[int], number: int) -> int:
    """The vertex that a corner of a face names: from 1, or back from the last one if negative."""
    text = written.partition("/")[0]
    digits = text.removeprefix("-")
    if digits.isascii() and digits.isdigit() and len(digits) <= 9:
        place = int(text)
        if 0 < place <= len(vertices):
            return vertices[place - 1]
        if -len(vertices) <= place < 0:
            return vertices[place]
    raise MeshError(f"the face in line {number} names no vertex before it")

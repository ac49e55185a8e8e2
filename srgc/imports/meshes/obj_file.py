"""Read the faces of an OBJ file as triangles.

Source: Wavefront, *Object files (.obj)*.  Lines are parsed here, since the reader of trimesh 5
loses the order of objects and does not accept faces of different sizes in one.  Materials are not
opened.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import pairwise, takewhile
from pathlib import Path

import numpy as np

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.files.file_tree import visible
from grammar_lang.source import Source
from srgc.imports.meshes.exact_places import SHORT, ExactPlaces, longer_decimals
from srgc.imports.meshes.mesh import Floats, Ints, Mesh, MeshObject
from srgc.imports.meshes.mesh_limits import too_many
from srgc.imports.plain_numbers import plain_index, plain_number
from srgc.imports.source_fault import SourceFault, file_fault, line_span

FLAT = 1e-9
"""A corner that turns back by less than this share of the area counts as straight."""
Corners = list[tuple[float, float, float]]
HIGHEST = 2**31
"""No vertex has a number as large as this: no file may have so many."""
KNOWN = frozenset(
    {"vn", "vt", "vp", "s", "mg", "usemtl", "mtllib", "usemap", "maplib", "bevel", "lod"}
    | {"c_interp", "d_interp", "shadow_obj", "trace_obj", "cstype", "deg", "bmat", "step"}
    | {"parm", "trim", "hole", "scrv", "sp", "end", "con", "ctech", "stech"}
)
"""Statements that add nothing by themselves: appearance, and details of curves and surfaces."""
SHOWN = 8
TOGETHER = "groups (`g`) in an object (`o`), which is one with all of them"
"""A note for scenes, whose objects are obstacles; for a body nothing is lost."""


@dataclass(slots=True)
class _Lines:
    """The elements read so far; ``starts`` are the names of objects and their first triangles.

    ``polygons`` maps numbers of corners above three to faces with their first triangles.
    ``groups`` has for each object the names of its groups with faces, if objects are given by
    ``o``.  ``others`` counts the statements that are not read, by their first words.
    """

    path: Path
    text: str
    by_object: bool
    vertices: Corners = field(default_factory=Corners)
    longer: dict[tuple[int, int], Fraction] = field(default_factory=dict)
    triangles: list[tuple[int, int, int]] = field(default_factory=list)
    polygons: dict[int, list[tuple[int, list[int]]]] = field(default_factory=dict)
    starts: list[tuple[str, int]] = field(default_factory=list)
    groups: dict[int, set[str]] = field(default_factory=dict)
    group: str = ""
    left_out: int = 0
    others: dict[str, int] = field(default_factory=dict)

    def read(self, number: int, words: list[str]) -> None:
        match words[0]:
            case "v":
                self.vertices.append(self.vertex(number, words[1:4]))
                too_many(len(self.vertices) // 3, self.path)
            case "f":
                self.face(number, [*takewhile(lambda word: word[0] != "#", words[1:])])
            case "o" | "g" if self.by_object == (words[0] == "o"):
                self.starts.append((" ".join(words[1:]), len(self.triangles)))
            case "g":
                self.group = " ".join(words[1:])
            case word if word not in KNOWN and word not in {"o", "g"}:
                self.others[word] = self.others.get(word, 0) + 1

    def vertex(self, number: int, words: list[str]) -> tuple[float, float, float]:
        try:
            x, y, z = map(plain_number, words)
        except ValueError:
            raise self.fault(number, "a vertex has no three coordinates") from None
        if max(map(len, words)) > SHORT:
            made = longer_decimals([words], np.array([[x, y, z]]), partial(self.fault, number))
            self.longer |= {(len(self.vertices), axis): exact for (_, axis), exact in made.items()}
        return x, y, z

    def face(self, number: int, words: list[str]) -> None:
        """Add a polygon as a fan of triangles; negative indices count from the last vertex."""
        if len(words) < 3:
            self.left_out += 1
            return
        try:
            given = [plain_index(word.partition("/")[0]) for word in words]
        except ValueError:
            raise self.fault(number, "a face has a corner that is not a number") from None
        count = len(self.vertices)
        corners = [index - 1 if index > 0 else count + index for index in given]
        if 0 in given or not all(0 <= corner < HIGHEST for corner in corners):
            raise self.fault(number, "a face names a vertex that is not there")
        if len(corners) > 3:
            self.polygons.setdefault(len(corners), []).append((len(self.triangles), corners))
        self.triangles += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
        too_many(len(self.triangles), self.path)
        if self.by_object and self.group:
            self.groups.setdefault(len(self.starts), set()).add(self.group)

    def fault(self, number: int, said: str) -> SourceFault:
        source, span = Source(str(self.path), self.text), line_span(self.text, number)
        return SourceFault(Code.FOREIGN_FILE, said, source, span, "was the file cut off?")


def obj_mesh(content: bytes, path: Path) -> Mesh:
    """The mesh of an OBJ file; each ``o`` is an object, or each ``g`` if there is no ``o``.

    Raises:
        SourceFault: the file is not text, has no face or too many, or has a line that was cut off.
    """
    if b"\0" in content:
        raise file_fault(path, "it is not an OBJ file: it is not text")
    # Comments may be in any encoding.
    text = content.decode("utf-8-sig", errors="replace").replace("\r\n", "\n")
    rows = text.split("\n")
    lines = _Lines(path, text, any(row.split()[:1] == ["o"] for row in rows))
    held = list[str]()
    for number, row in enumerate(rows, 1):
        # A comment ends with its line, even if it ends in a backslash, as paths may.
        comment = not held and row.lstrip().startswith("#")
        held += [] if comment else row.split()
        if held and held[-1].endswith("\\") and number < len(rows):  # the next line goes on
            held[-1:] = filter(None, [held[-1][:-1]])
        elif held:
            lines.read(number, held)
            held = []
    if not lines.triangles:
        raise file_fault(path, "it has no triangle: no line is `f` with three corners")
    triangles: Ints = np.array(lines.triangles, dtype=np.int64)
    if triangles.max() >= len(lines.vertices):
        raise file_fault(path, "a face names a vertex that is not there", "was the file cut off?")
    vertices = np.array(lines.vertices, dtype=np.float64)
    for polygons in lines.polygons.values():
        _divide(vertices, triangles, polygons)
    places = ExactPlaces(vertices, longer=lines.longer)
    return Mesh(vertices, triangles, _objects(lines, path.stem), tuple(_notes(lines)), places)


def _notes(lines: _Lines) -> Iterator[str]:
    """What was not read."""
    name = lines.path.name
    if lines.left_out:
        yield f"{name}: {lines.left_out} faces of one or two corners: left out"
    if lines.others:
        said = [f"{count} `{visible(word[:20])}`" for word, count in lines.others.items()]
        more = ", ..." if len(said) > SHOWN else ""
        yield f"{name}: {', '.join(said[:SHOWN])}{more}: only faces (`f`) are read"
    if any(len(names) > 1 for names in lines.groups.values()):
        yield f"{name}: {TOGETHER}"


def _divide(vertices: Floats, triangles: Ints, polygons: list[tuple[int, list[int]]]) -> None:
    """Replace the fans of non-convex polygons with n corners by proper triangulations."""
    from manifold3d import triangulate

    corners = np.array([each for _, each in polygons])
    points = vertices[corners]
    points = points - points[:, :1]
    # Newell's normal, and how far each corner turns about it.
    following = np.roll(points, -1, axis=1)
    normals = np.cross(points, following).sum(axis=1)
    edges = following - points
    turns = np.einsum("ijk,ik->ij", np.cross(np.roll(edges, 1, axis=1), edges), normals)
    bent = (turns < -FLAT * (normals**2).sum(axis=1)[:, None]).any(axis=1)
    for number in np.flatnonzero(bent & np.isfinite(normals).all(axis=1)).tolist():
        start, own = polygons[number][0], corners[number]
        found = triangulate([_in_plane(points[number], normals[number])])
        if len(found) == len(own) - 2:
            triangles[start : start + len(found)] = own[np.asarray(found, dtype=np.int64)]


def _in_plane(points: Floats, normal: Floats) -> Floats:
    """The projections (n, 2) of points (n, 3) along a normal."""
    side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    side /= np.linalg.norm(side)
    across = np.cross(normal, side)
    found: Floats = np.column_stack([points @ side, points @ (across / np.linalg.norm(across))])
    return found


def _objects(lines: _Lines, stem: str) -> tuple[MeshObject, ...]:
    starts = lines.starts
    if not starts or starts[0][1] > 0:
        starts = [(stem, 0), *starts]
    ends = [*(start for _, start in starts[1:]), len(lines.triangles)]
    return tuple(
        MeshObject(name or stem, start, end)
        for (name, start), end in zip(starts, ends, strict=True)
        if end > start
    )

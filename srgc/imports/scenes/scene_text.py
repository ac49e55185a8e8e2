"""Write a scene as the text of a workspace, as a person would."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from grammar_lang.diagnostics.diagnostic import Code
from srgc.imports.comment_lines import comment_lines
from srgc.imports.meshes.convex_piece import decimal_text
from srgc.imports.meshes.decomposition import DETAIL, Pieces, decomposed
from srgc.imports.meshes.enclosing import THINNEST, Enclosed, enclosing
from srgc.imports.meshes.piece_files import pieces_text
from srgc.imports.names import Names, is_legible
from srgc.imports.scenes.scene import (
    BallShape,
    BoxShape,
    MeshShape,
    PointsShape,
    RodShape,
    Scene,
    SceneObject,
    Shape,
)
from srgc.imports.source_fault import file_fault
from srgc.imports.spec_text import canonical_text
from srgc.imports.written_import import Imported, mesh_folder
from srgc.version import VERSION

if TYPE_CHECKING:
    from collections.abc import Sequence

    from srgc.imports.meshes.convex_piece import ConvexPiece
    from srgc.imports.meshes.mesh import Floats

UNITS = {"m": 0, "cm": 2, "mm": 3}
"""The units of length, each with the power of ten that a metre is in it."""
DIGITS, FINER, SMALL = 6, 9, 1e-3
"""Coordinates are rounded to 10^-6 m, or to 10^-9 m if an object is smaller than a millimetre."""
EXACT = 20_000
"""A rotated box is rounded to its shortest edge divided by this."""
FEW = 8
"""A mesh that is one piece with at most this many corners is written into the spec."""
MARGIN = 0.25
"""The free margin around the scene, as a share of its size."""
THIN = "made thicker: it is thinner than 0.01 mm, or than a ten-thousandth of its size"
"""A note on an object whose shape, or the piece about it, was made thicker."""
LEAST_SHOWN = 1e-6
"""Corners that are less than this (mm) beyond a mesh are on it: the rest is rounding."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """Options of an import: for pieces see :func:`decomposed`.

    ``name`` is the name of the workspace, and ``stem`` the name of the spec without its extension.
    """

    detail: float = DETAIL
    pieces: int | None = None
    name: str | None = None
    stem: str | None = None


def scene_spec(scene: Scene, source: str, wanted: Wanted) -> Imported:
    """A workspace for a scene that was read from ``source``, with the files of its meshes.

    Raises:
        SourceFault: the scene has no obstacles.
    """
    if not scene.objects:
        hint = "; ".join(scene.dropped[:20]) or None
        raise file_fault(source, "nothing in it collides", hint, Code.FOREIGN_CONTENT)
    called = Names().name(wanted.name or scene.name, "scene")
    writer = _Writer(wanted, mesh_folder(wanted.stem or called))
    for item in scene.objects:
        writer.add(item)
    title = source if is_legible(scene.name) else f"`{scene.name}` of {source}"
    head = [f"{title}, imported by srgc {VERSION}."]
    if writer.rounded:
        head.append("Places are rounded to 0.001 mm.")
    if scene.dropped:
        head += ["Not carried over:", *(f"- {each}" for each in scene.dropped)]
    name = Names().camel(wanted.name or scene.name, "Scene")
    body = [*writer.bounds(scene.ground), *writer.lines]
    block = "\n".join([f"workspace {name} {{", "  space xyz;", *body, "}"])
    return Imported(
        name=called,
        text=canonical_text([comment_lines(head), block]),
        files=writer.files,
        remarks=(
            *scene.notes,
            *writer.notes,
            *(f"not carried over: {each}" for each in scene.dropped),
        ),
    )


class _Writer:
    """Collects the lines of obstacles."""

    def __init__(self, wanted: Wanted, folder: str) -> None:
        self.wanted, self.folder = wanted, folder
        self.lines: list[str] = []
        self.notes: list[str] = []
        self.files: dict[str, bytes] = {}
        self.rounded = False
        self.names = Names(ignore_case=True)
        self.lower, self.upper = np.full(3, np.inf), np.full(3, -np.inf)

    def add(self, item: SceneObject) -> None:
        """Write an object as obstacles."""
        name = self.names.name(item.name, "obstacle")
        if not (isinstance(item.shape, MeshShape) or item.note or _told(item.name, name)):
            self.lines.append(f"  {comment_lines([f'`{item.name}` in the file.'])}")
        if item.note:
            self.lines.append(f"  {comment_lines([f'{item.name} is {item.note}.'])}")
            self.notes.append(f"{item.name} is {item.note}")
        shape, thicker = _thick_enough(item.shape)
        if thicker:
            self._thicker(item)
        match shape:
            case BoxShape(size=size):
                self._box(name, item, size)
            case BallShape(radius=radius):
                self._round(name, "ball", item, np.zeros((1, 3)), radius)
            case RodShape(kind=kind, radius=radius, length=length):
                ends = np.array([[0, 0, -length / 2], [0, 0, length / 2]])
                self._round(name, kind, item, ends, radius)
            case PointsShape(points=points):
                self._enclosed(name, item, enclosing(item.pose.of(points)))
            case MeshShape():
                self._mesh(name, item, shape)

    def _thicker(self, item: SceneObject) -> None:
        said = f"{item.name} is {THIN}"
        if said not in self.notes[-1:]:
            self.lines.append(f"  {comment_lines([f'{said}.'])}")
            self.notes.append(said)

    def _enclosed(self, name: str, item: SceneObject, found: Enclosed) -> None:
        if found.thickened:
            self._thicker(item)
        self._piece(name, found.piece)

    def _mesh(self, name: str, item: SceneObject, shape: MeshShape) -> None:
        mesh = item.pose.of_mesh(shape.mesh)
        found = decomposed(
            mesh.vertices,
            mesh.triangles,
            detail=self.wanted.detail,
            pieces=self.wanted.pieces,
            places=mesh.places,
        )
        said = "; ".join([described(found), *found.notes])
        self.lines.append(f"  {comment_lines([f'{item.name} of {shape.source}: {said}.'])}")
        self.notes.append(f"{item.name}: {said}")
        if len(found.pieces) == 1 and len(found.pieces[0].corners) <= FEW:
            self._piece(name, found.pieces[0])
            return
        for piece in found.pieces:
            points = piece.points()
            self._reach(points.min(axis=0), points.max(axis=0))
        numbers = [f"piece_{number + 1}" for number in range(len(found.pieces))]
        path = f"{self.folder}/{name}.obj"
        origin = f"{_line(item.name)} of {_line(shape.source)}, in metres, by srgc {VERSION}"
        self.files[path] = pieces_text(found.pieces, numbers, [origin]).encode()
        self.lines.append(f'  obstacles from "{path}";')

    def _box(self, name: str, item: SceneObject, size: Sequence[float]) -> None:
        half = np.array(size) / 2
        signs = np.array([[(-1, 1)[i >> axis & 1] for axis in range(3)] for i in range(8)])
        points = item.pose.of(signs * half)
        if not item.pose.along_axes():
            self._enclosed(name, item, enclosing(points, EXACT))
            return
        lower, upper = points.min(axis=0), points.max(axis=0)
        self._reach(lower, upper)
        digits = FINER if min(size) < SMALL else DIGITS
        self._write(name, "box " + _sides(self._grid([lower, upper], digits), digits))

    def _round(self, name: str, kind: str, item: SceneObject, ends: Floats, radius: float) -> None:
        places = item.pose.of(ends)
        self._reach(places.min(axis=0) - radius, places.max(axis=0) + radius)
        length = float(np.linalg.norm(ends[-1] - ends[0])) or radius
        digits = FINER if min(radius, length) < SMALL else DIGITS
        *points, (wide, _, _) = self._grid([*places, np.array([radius, 0, 0])], digits)
        unit = _unit(np.abs([x for point in points for x in point]).max() * 10.0**-digits)
        shown = ", ".join(_point(point, digits, unit) for point in points)
        of_radius = _unit(radius)
        size = decimal_text(wide, digits - UNITS[of_radius])
        self._write(name, f"{kind} {shown} {unit} radius {size} {of_radius}")

    def _piece(self, name: str, piece: ConvexPiece) -> None:
        points = piece.points()
        self._reach(points.min(axis=0), points.max(axis=0))
        box = piece.box()
        if box is not None:
            self._write(name, "box " + _sides(box, piece.digits))
            return
        unit = _unit(float(np.abs(points).max()))
        shown = ", ".join(_point(corner, piece.digits, unit) for corner in piece.corners)
        self._write(name, f"hull {shown} {unit}")

    def _write(self, name: str, shape: str) -> None:
        self.lines.append(f"  obstacle {name} {shape};")

    def _grid(self, places: Sequence[Floats], digits: int) -> list[tuple[int, int, int]]:
        """Round points to steps of 10^-``digits`` m, and record whether that changed them."""
        found = list[tuple[int, int, int]]()
        for place in places:
            x, y, z = (round(float(value) * 10**digits) for value in place)
            self.rounded |= any(
                abs(step / 10**digits - float(value)) > 1e-12
                for step, value in zip((x, y, z), place, strict=True)
            )
            found.append((x, y, z))
        return found

    def _reach(self, lower: Floats, upper: Floats) -> None:
        self.lower, self.upper = np.minimum(self.lower, lower), np.maximum(self.upper, upper)

    def bounds(self, ground: float | None) -> list[str]:
        """A box with round numbers around all obstacles and the origin, with a margin."""
        lower, upper = np.minimum(self.lower, 0.0), np.maximum(self.upper, 0.0)
        size = float((upper - lower).max())
        step = 10.0 ** math.floor(math.log10(size)) / 2
        digits = max(0, 1 - math.floor(math.log10(step)))
        low = np.floor((lower - MARGIN * size) / step) * step
        high = np.ceil((upper + MARGIN * size) / step) * step
        if ground is not None and ground <= lower[2]:
            low[2] = ground
            digits = max(digits, DIGITS)
        places = [tuple(round(x * 10**digits) for x in row.tolist()) for row in (low, high)]
        return [
            "  // A box about everything, and some room; adapt it to your cell.",
            f"  bounds box {_sides(places, digits)};",
            "",
        ]


def _told(source: str, name: str) -> bool:
    """Whether a name shows what it was in the file: only other characters became ``_``."""
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", source).strip("_")
    return source.isascii() and plain == name.removeprefix("_")


def _line(text: str) -> str:
    """A text from a file without characters that would break a line."""
    return "".join(each if each.isprintable() else " " for each in text)


def _thick_enough(shape: Shape) -> tuple[Shape, bool]:
    """A shape that holds this one with no edge or diameter below ``THINNEST``; whether it differs.

    Points and meshes stay as they are: the pieces about them are made thick enough.
    """
    found: Shape
    match shape:
        case BoxShape(size=(x, y, z)):
            found = BoxShape((max(x, THINNEST), max(y, THINNEST), max(z, THINNEST)))
        case BallShape(radius=radius):
            found = BallShape(max(radius, THINNEST / 2))
        case RodShape(kind=kind, radius=radius, length=length):
            found = RodShape(kind, max(radius, THINNEST / 2), max(length, THINNEST))
        case _:
            return shape, False
    return found, found != shape


def described(found: Pieces) -> str:
    """Describe in words what the pieces add to a mesh."""
    number = len(found.pieces)
    said = [
        f"{number} convex piece{'' if number == 1 else 's'}",
        f"{100 * found.measures.added:.1f} % more volume",
    ]
    farthest = 1000 * found.measures.farthest
    if farthest >= LEAST_SHOWN:
        said.append(f"corners up to {farthest:.3g} mm beyond it")
    if found.thickened:
        said.append(f"{len(found.thickened)} made thicker")
    return ", ".join(said)


def _unit(size: float) -> str:
    """The unit that gives a length of this size a convenient number."""
    return "m" if size >= 1 else "cm" if size >= 0.1 else "mm"


def _point(point: Sequence[int], digits: int, unit: str) -> str:
    return f"({', '.join(decimal_text(x, digits - UNITS[unit]) for x in point)})"


def _sides(corners: Sequence[Sequence[int]], digits: int) -> str:
    unit = _unit(max(abs(x) for corner in corners for x in corner) * 10.0**-digits)
    shown = [
        f"[{decimal_text(a, digits - UNITS[unit])}, {decimal_text(b, digits - UNITS[unit])}]"
        for a, b in zip(*corners, strict=True)
    ]
    return f"{' x '.join(shown)} {unit}"

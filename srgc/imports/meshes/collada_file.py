"""Read the triangles of a COLLADA file with pycollada, with its unit and up axis."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from grammar_lang.files.file_tree import visible
from srgc.imports.meshes.exact_places import (
    LONGEST,
    ExactPlaces,
    exact_decimal,
    longer_decimals,
)
from srgc.imports.meshes.mesh import Floats, Ints, Mesh, joined
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.xml_source import Element, XmlFile, xml_file

UP: dict[str, tuple[tuple[int, int, int], ...]] = {
    "X_UP": ((0, -1, 0), (0, 0, -1), (1, 0, 0)),
    "Y_UP": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "Z_UP": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}
"""The rotation from each up axis to z up: COLLADA 1.4.1, element ``up_axis``."""
UNSAID = "Y_UP"
APPEARANCE = (
    "library_images",
    "library_effects",
    "library_materials",
    "library_lights",
    "library_cameras",
    "library_controllers",
    "library_animations",
    "bind_material",
    "instance_light",
    "instance_camera",
    "extra",
)
"""Elements that are removed before pycollada reads the file, so that it opens no image."""
LINES = ("lines", "linestrips")
"""Elements that hold no triangle; pycollada loses all of a geometry that has the second."""


def collada_mesh(content: bytes, path: Path, *, own_unit: bool, own_axes: bool) -> Mesh:
    """All triangles of the scene in a file, in metres if ``own_unit``, otherwise in its unit.

    With ``own_axes`` the axes of the file are kept, whatever its up axis; otherwise the mesh is
    rotated so that z is up.

    Raises:
        SourceFault: the file is not COLLADA, or has no scene with triangles.
    """
    import collada
    from lxml.etree import tostring

    file = xml_file(content, path)
    root = file.root
    if _tag(root) != "COLLADA":
        raise file.fault(root, f"it is not a COLLADA file: its root is `{visible(_tag(root))}`")
    scale, up = _asset(file)
    _strip(root, APPEARANCE)
    lines = _strip(root, LINES)
    faults = collada.common
    ignored = [faults.DaeUnsupportedError, faults.DaeBrokenRefError]
    try:
        read: Any = collada.Collada(io.BytesIO(tostring(root)), ignore=ignored)
        words = _in_doubles(read)
        parts = list(_parts(read, path))
    except SourceFault:
        raise
    except Exception as error:
        said = " ".join(str(error).split())[:120]
        raise file_fault(path, f"it cannot be read as COLLADA: {said}") from None
    notes = tuple(f"{path.name}: {' '.join(str(error).split())[:120]}" for error in read.errors)
    if lines:
        notes += (f"{path.name}: {lines} sets of lines: left out",)
    if own_axes and up and up != "Z_UP":
        notes += (f"{path.name}: `up_axis` {up} turns nothing, as in ROS and Gazebo",)
    whole = joined([(name, (points, faces)) for name, points, faces, _ in parts])
    longer, before = dict[tuple[int, int], Fraction](), 0
    for _, points, _, source in parts:
        rows = words.get(source or "", ())
        made = longer_decimals(rows, points, partial(file_fault, path))
        longer |= {(before + row, column): exact for (row, column), exact in made.items()}
        before += len(points)
    places = ExactPlaces(whole.vertices, longer=longer)
    places = places.placed(
        np.array(UP["Z_UP" if own_axes else up or UNSAID], dtype=np.float64), (Fraction(0),) * 3
    )
    if own_unit:
        places = places.scaled([scale] * 3)
    return Mesh(places.vertices(), whole.triangles, whole.objects, notes, places)


def _in_doubles(read: Any) -> dict[str, list[list[str]]]:
    """Replace the numbers of all sources, which pycollada reads in single precision, by doubles.

    Return the words of each source by its ID, in the rows of its data.
    """
    found = dict[str, list[list[str]]]()
    for geometry in read.geometries:
        doubles = dict[int, tuple[Any, Floats]]()
        for source in geometry.sourceById.values():
            data, node = getattr(source, "data", None), getattr(source, "xmlnode", None)
            array = None if node is None else node.find("{*}float_array")
            words = [] if array is None else (array.text or "").split()
            if not isinstance(data, np.ndarray) or len(words) != data.size or data.ndim != 2:
                continue
            source.data = np.array(words, dtype=np.float64).reshape(data.shape)
            doubles[id(data)] = (data, source.data)
            width = data.shape[1]
            rows = [words[i : i + width] for i in range(0, len(words), width)]
            found[source.id] = rows
        for primitive in geometry.primitives:
            vertex = getattr(primitive, "_vertex", None)
            primitive._vertex = doubles.get(id(vertex), (vertex, vertex))[1]  # noqa: SLF001
    return found


def _asset(file: XmlFile) -> tuple[Fraction, str]:
    """The unit in metres, and the up axis, empty if the file does not state it."""
    scale, up = Fraction(1), ""
    for element in file.root.iter():
        tag = _tag(element)
        if tag == "unit":
            text = element.get("meter", "1").strip()
            if 0 < _metres(text) < 1e6 and len(text) <= LONGEST:
                scale = exact_decimal(text)
            else:
                message = "its unit is not a positive number of metres"
                raise file.fault(element, message, "name one with --unit")
        elif tag == "up_axis":
            up = (element.text or "").strip().upper()
            if up not in UP:
                message = f"`{visible(up[:40])}` is not a valid up axis"
                raise file.fault(element, message, f"known: {', '.join(UP)}")
        elif tag.startswith("library_"):
            break
    return scale, up


def _metres(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")


def _tag(element: Element) -> str:
    return str(element.tag).rpartition("}")[2]


def _strip(root: Element, tags: Sequence[str]) -> int:
    """Remove all elements with these tags; how many there were."""
    count = 0
    for parent in list(root.iter()):
        for child in list(parent):
            if _tag(child) in tags:
                parent.remove(child)
                count += 1
    return count


def _parts(read: Any, path: Path) -> Iterator[tuple[str, Floats, Ints, str | None]]:
    """The name, transformed vertices and triangles of each primitive of the scene.

    The ID of the source of the vertices is added if no node transforms them.
    """
    if read.scene is None:
        raise file_fault(path, "it has no scene")
    for bound in read.scene.objects("geometry"):
        name = bound.original.name or bound.original.id or path.stem
        for primitive in bound.primitives():
            triangles = primitive.triangleset() if hasattr(primitive, "triangleset") else primitive
            index = getattr(triangles, "vertex_index", None)
            if index is None or len(index) == 0 or np.asarray(index).ndim != 2:
                continue
            faces = np.asarray(index, dtype=np.int64)
            points = np.asarray(triangles.vertex, dtype=np.float64)
            if faces.shape[1] != 3:
                continue
            if faces.min() < 0 or faces.max() >= len(points):
                raise file_fault(path, "a triangle names a vertex that is not there")
            still = np.array_equal(bound.matrix, np.eye(4))
            yield str(name), points, faces, _source(primitive) if still else None


def _source(primitive: Any) -> str | None:
    """The ID of the source of the vertices of a bound primitive."""
    inputs = getattr(primitive.original, "sources", {}).get("VERTEX", ())
    return inputs[0][4].id if inputs else None

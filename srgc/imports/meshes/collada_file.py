"""The triangles of a COLLADA file, by pycollada, with its unit and the axis that is up."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from grammar_lang.files.file_tree import visible
from srgc.imports.meshes.mesh import Floats, Ints, Mesh, joined
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.xml_source import Element, XmlFile, xml_file

UP: dict[str, tuple[tuple[int, int, int], ...]] = {
    "X_UP": ((0, -1, 0), (0, 0, -1), (1, 0, 0)),
    "Y_UP": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "Z_UP": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}
"""What turns a file with that axis up so that z is: COLLADA 1.4.1, element ``up_axis``."""
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
"""Elements that are taken away before pycollada sees them, so that it opens no image."""


def collada_mesh(content: bytes, path: Path, *, own_unit: bool) -> Mesh:
    """All triangles of the scene of a file, z up, in metres if ``own_unit``, else in its unit.

    Raises:
        SourceFault: it is no COLLADA file, or has no scene with triangles.
    """
    import collada
    from lxml.etree import tostring

    file = xml_file(content, path)
    root = file.root
    if _tag(root) != "COLLADA":
        raise file.fault(root, f"it is no COLLADA file: its root is `{visible(_tag(root))}`")
    scale, up = _asset(file)
    _strip(root)
    faults = collada.common
    ignored = [faults.DaeUnsupportedError, faults.DaeBrokenRefError]
    try:
        read: Any = collada.Collada(io.BytesIO(tostring(root)), ignore=ignored)
        parts = list(_parts(read, path))
    except SourceFault:
        raise
    except Exception as error:
        said = " ".join(str(error).split())[:120]
        raise file_fault(path, f"it cannot be read as COLLADA: {said}") from None
    notes = tuple(f"{path.name}: {' '.join(str(error).split())[:120]}" for error in read.errors)
    turn = np.array(UP[up], dtype=np.float64).T * (scale if own_unit else 1.0)
    whole = joined([(name, (points @ turn, faces)) for name, points, faces in parts])
    return Mesh(whole.vertices, whole.triangles, whole.objects, notes)


def _asset(file: XmlFile) -> tuple[float, str]:
    """The unit in metres, and the axis that is up."""
    scale, up = 1.0, "Y_UP"
    for element in file.root.iter():
        tag = _tag(element)
        if tag == "unit":
            scale = _metres(element.get("meter", "1"))
            if not 0 < scale < 1e6:
                message = "its unit is no positive number of metres"
                raise file.fault(element, message, "name one with --unit")
        elif tag == "up_axis":
            up = (element.text or "").strip().upper()
            if up not in UP:
                message = f"`{visible(up[:40])}` is no axis that can be up"
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


def _strip(root: Element) -> None:
    for parent in list(root.iter()):
        for child in list(parent):
            if _tag(child) in APPEARANCE:
                parent.remove(child)


def _parts(read: Any, path: Path) -> Iterator[tuple[str, Floats, Ints]]:
    """The name, vertices and triangles of each primitive of the scene, in its place."""
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
            yield str(name), points, faces

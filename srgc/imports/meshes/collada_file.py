"""The triangles of a COLLADA file, by pycollada, with its unit and the axis that is up."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import tostring

import numpy as np

from srgc.faults import UsageFault
from srgc.imports.limited_files import Xml, xml_of
from srgc.imports.meshes.mesh import Floats, Ints, Mesh, joined

UP: dict[str, tuple[tuple[int, int, int], ...]] = {
    "X_UP": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "Y_UP": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "Z_UP": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
}
"""What turns a file with that axis up so that z is."""
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
        UsageFault: it is no COLLADA file, or has no scene with triangles.
    """
    import collada

    root = xml_of(content, path)
    if root.tag.rpartition("}")[2] != "COLLADA":
        raise UsageFault(f"{path} is no COLLADA file: its root is `{root.tag.rpartition('}')[2]}`")
    scale, up = _asset(root, path)
    _strip(root)
    faults = collada.common
    ignored = [faults.DaeUnsupportedError, faults.DaeBrokenRefError]
    try:
        read: Any = collada.Collada(io.BytesIO(tostring(root)), ignore=ignored)
        parts = list(_parts(read, path))
    except UsageFault:
        raise
    except Exception as error:
        said = " ".join(str(error).split())[:120]
        raise UsageFault(f"{path} cannot be read as COLLADA: {said}") from None
    notes = tuple(f"{path.name}: {' '.join(str(error).split())[:120]}" for error in read.errors)
    turn = np.array(UP[up], dtype=np.float64).T * (scale if own_unit else 1.0)
    whole = joined([(name, (points @ turn, faces)) for name, points, faces in parts])
    return Mesh(whole.vertices, whole.triangles, whole.objects, notes)


def _asset(root: Xml, path: Path) -> tuple[float, str]:
    """The unit in metres, and the axis that is up."""
    scale, up = 1.0, "Y_UP"
    for element in root.iter():
        tag = element.tag.rpartition("}")[2]
        if tag == "unit":
            try:
                scale = float(element.get("meter", "1"))
            except ValueError:
                scale = float("nan")
        elif tag == "up_axis":
            up = (element.text or "").strip().upper()
        elif tag.startswith("library_"):
            break
    if not 0 < scale < 1e6:
        raise UsageFault(f"{path}: its unit is no positive number of metres; name one with --unit")
    if up not in UP:
        raise UsageFault(f"{path}: `{up}` is no axis that can be up; known: {', '.join(UP)}")
    return scale, up


def _strip(root: Xml) -> None:
    for parent in list(root.iter()):
        for child in list(parent):
            tag = child.tag.rpartition("}")[2]
            if tag in APPEARANCE:
                parent.remove(child)


def _parts(read: Any, path: Path) -> Iterator[tuple[str, Floats, Ints]]:
    """The name, vertices and triangles of each primitive of the scene, in its place."""
    if read.scene is None:
        raise UsageFault(f"{path} has no scene")
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
                raise UsageFault(f"{path}: a triangle names a vertex that is not there")
            yield str(name), points, faces

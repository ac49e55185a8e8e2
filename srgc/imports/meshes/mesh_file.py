"""Read meshes of STL, OBJ, COLLADA and binary glTF files, and reject hostile ones.

No other file is opened: neither the materials of an OBJ nor the images of a COLLADA file.
"""

from __future__ import annotations

import io
import re
import struct
import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from srgc.imports.meshes.exact_places import ExactPlaces, longer_decimals, rational
from srgc.imports.meshes.mesh import Floats, Ints, Mesh, joined
from srgc.imports.meshes.mesh_limits import LARGEST, too_many
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.source_files import LIMIT, XML_LIMIT, refuse_content, source_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping

SUFFIXES = (".stl", ".obj", ".dae", ".glb")
_HEADER, _TRIANGLE = 84, 50


def read_mesh(path: Path, unit: float | None = None, *, own_axes: bool = False) -> Mesh:
    """Read the mesh of a file, in metres.

    Args:
        path: a file whose name ends with one of :data:`SUFFIXES`.
        unit: the length unit of the file in metres.  If None, it is the unit that a COLLADA file
            states, and metres for others.
        own_axes: keep the axes of the file; otherwise the mesh is rotated so that z is up,
            according to the file or its format.

    Raises:
        SourceFault: the file is of another kind, is cut off, has too many triangles, or has
            vertices that are not finite or too far away.
    """
    return _mesh_of(source_bytes(path, _most_bytes(path)), path, unit, own_axes=own_axes)


def mesh_of(content: bytes, path: Path, *, own_axes: bool = False) -> Mesh:
    """Read the mesh from the content of a file in metres; ``path`` is its name.

    Raises:
        SourceFault: see :func:`read_mesh`.
    """
    refuse_content(content, path, _most_bytes(path))
    return _mesh_of(content, path, None, own_axes=own_axes)


def _most_bytes(path: Path) -> int:
    """The largest size of a mesh in bytes, by its extension.

    Raises:
        SourceFault: the extension is not that of a known mesh.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        message = "its file extension is not that of a supported mesh"
        known = "known: STL (.stl), OBJ (.obj), COLLADA (.dae), binary glTF (.glb)"
        raise file_fault(path, message, known)
    return XML_LIMIT if suffix == ".dae" else LIMIT


def _mesh_of(content: bytes, path: Path, unit: float | None, *, own_axes: bool) -> Mesh:
    try:
        # Warnings of libraries are meant for their maintainers.
        with warnings.catch_warnings(action="ignore"):
            mesh = _read(content, path, own_unit=unit is None, own_axes=own_axes)
    except (MemoryError, RecursionError):
        raise file_fault(path, "it is too large or too deeply nested") from None
    return _checked(mesh, 1.0 if unit is None else unit, path)


def _read(content: bytes, path: Path, *, own_unit: bool, own_axes: bool) -> Mesh:
    match path.suffix.lower():
        case ".stl":
            return _stl(content, path)
        case ".obj":
            from srgc.imports.meshes.obj_file import obj_mesh

            return obj_mesh(content, path)
        case ".glb":
            from srgc.imports.meshes.gltf_file import gltf_mesh

            return gltf_mesh(content, path, own_axes=own_axes)
        case _:
            from srgc.imports.meshes.collada_file import collada_mesh

            return collada_mesh(content, path, own_unit=own_unit, own_axes=own_axes)


def _checked(mesh: Mesh, unit: float, path: Path) -> Mesh:
    """Check a mesh and scale it to metres."""
    if not 0 < unit < LARGEST:
        raise file_fault(path, f"a unit of {unit} m is none")
    if len(mesh.triangles) == 0:
        raise file_fault(path, "it has no triangle")
    too_many(len(mesh.triangles), path)
    vertices = mesh.vertices
    if not np.isfinite(vertices).all():
        bad = int(np.argmin(np.isfinite(vertices).all(axis=1)))
        raise file_fault(path, f"vertex {bad + 1} has a coordinate that is not a finite number")
    if unit != 1.0:
        mesh = mesh.scaled([rational(unit)] * 3)
    if np.abs(mesh.vertices).max(initial=0.0) >= LARGEST:
        hint = "is the unit right? --unit mm reads millimetres"
        raise file_fault(path, f"a vertex is {LARGEST:g} m away or farther", hint)
    return mesh


# --- STL ------------------------------------------------------------------------------------------


def _stl(content: bytes, path: Path) -> Mesh:
    """Read STL; it is binary if its size fits its count of triangles, however it begins."""
    from trimesh.exchange.stl import load_stl_ascii, load_stl_binary

    if len(content) >= _HEADER:
        (count,) = struct.unpack_from("<I", content, 80)
        if len(content) == _HEADER + _TRIANGLE * count:
            too_many(count, path)
            return joined([(path.stem, _vertices(load_stl_binary(io.BytesIO(content)), path))])
    if not content.lstrip().lower().startswith(b"solid") or b"\0" in content:
        raise file_fault(path, "it is not an STL file, or was cut off: its size is wrong")
    lowered = content.lower()
    facets, corners = lowered.count(b"endfacet"), len(re.findall(rb"\bvertex\b", lowered))
    too_many(facets, path)
    if corners != 3 * facets or not lowered.rstrip().rpartition(b"\n")[2].lstrip().startswith(
        b"endsolid"
    ):
        raise file_fault(path, f"it was cut off: it has {corners} corners of {facets} triangles")
    try:
        loaded = load_stl_ascii(io.BytesIO(content))
    except Exception as error:
        raise _broken(path, "STL", error) from None
    parts = list(loaded["geometry"].values()) if "geometry" in loaded else [loaded]
    mesh = joined([(path.stem, _vertices(part, path)) for part in parts])
    if len(mesh.triangles) != facets:
        raise file_fault(path, f"{facets} triangles are begun and {len(mesh.triangles)} are read")
    words = re.findall(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", lowered)
    if len(words) != len(mesh.vertices):
        raise file_fault(path, "a corner has no three coordinates")
    rows = ([word.decode("ascii", "replace") for word in row] for row in words)
    longer = longer_decimals(rows, mesh.vertices, partial(file_fault, path))
    return replace(mesh, places=ExactPlaces(mesh.vertices, longer=longer))


# --- Results of loaders ---------------------------------------------------------------------------


def _vertices(loaded: Mapping[str, Any], path: Path) -> tuple[Floats, Ints]:
    vertices = np.asarray(loaded.get("vertices", ()), dtype=np.float64)
    triangles = np.asarray(loaded.get("faces", ()), dtype=np.int64)
    if vertices.ndim != 2 or triangles.ndim != 2 or triangles.shape[1] != 3:
        raise file_fault(path, "it has no triangle")
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise file_fault(path, "a triangle names a vertex that is not there")
    return vertices[:, :3], triangles


def _broken(path: Path, kind: str, error: Exception) -> SourceFault:
    said = " ".join(str(error).split())[:120]
    return file_fault(path, f"it cannot be read as {kind}: {said or type(error).__name__}")

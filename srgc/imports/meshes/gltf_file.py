"""Read the triangles of a binary glTF file.

Source: the Khronos specification of glTF 2.0.  No other file is opened; materials and animations
are ignored, and bones are refused, since they move vertices.
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from grammar_lang.files.file_tree import visible
from srgc.imports.meshes.collada_file import UP
from srgc.imports.meshes.mesh import Floats, Ints, Mesh, joined
from srgc.imports.meshes.mesh_limits import too_many
from srgc.imports.source_fault import SourceFault, file_fault
from srgc.imports.source_files import XML_LIMIT, refuse_content

MAGIC, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 0x4E4F534A, 0x004E4942
FLOAT = 5126
INDICES = {5121: "<u1", 5123: "<u2", 5125: "<u4"}
"""The component types of indices of vertices."""
TRIANGLES, STRIP, FAN = 4, 5, 6
PACKED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization")
"""Extensions that encode vertices in other ways."""
HARMLESS = re.compile(
    "(KHR_materials|KHR_texture|KHR_lights|KHR_xmp|KHR_animation|EXT_texture|EXT_lights"
    "|MSFT_texture)_[a-zA-Z0-9_]*"
)
"""Extensions of appearance and motion, which may be required: no vertex depends on them."""
INSTANCES = "EXT_mesh_gpu_instancing"
"""An extension by which one node places a mesh many times."""


def gltf_mesh(content: bytes, path: Path, *, own_axes: bool) -> Mesh:
    """All triangles of the scene in a file, in metres; each primitive is an object.

    With ``own_axes`` the axes of the file are kept, with y up; otherwise the mesh is rotated so
    that z is up.

    Raises:
        SourceFault: the file is not binary glTF 2.0, was cut off, needs another file or an
            extension that encodes vertices, or has too many triangles.
    """
    try:
        file = _File(*_chunks(content, path), path)
        _refuse_needed(file.json.get("extensionsRequired", ()), path)
        if INSTANCES in file.json.get("extensionsUsed", ()):
            raise file_fault(path, f"it has {INSTANCES}, which is not read", "write each mesh out")
        parts = list(file.parts())
    except SourceFault:
        raise
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, struct.error):
        raise file_fault(path, "it cannot be read as binary glTF 2.0", "was it cut off?") from None
    turn = np.array(UP["Z_UP" if own_axes else "Y_UP"], dtype=np.float64).T
    found = joined([(name, (points @ turn, faces)) for name, points, faces in parts])
    notes = tuple(f"{path.name}: {note}" for note in file.notes())
    return Mesh(found.vertices, found.triangles, found.objects, notes)


def _refuse_needed(needed: Iterable[str], path: Path) -> None:
    """Refuse a file that requires an extension by which its vertices may mean something else.

    Raises:
        SourceFault: it does.
    """
    for each in needed:
        if each in PACKED:
            raise file_fault(path, f"it needs {each}, which is not unpacked here")
        if each != INSTANCES and not HARMLESS.fullmatch(each):
            said = f"it needs {visible(each[:60])}, which is not known here"
            raise file_fault(path, said, "write it as plain glTF 2.0")


def _chunks(content: bytes, path: Path) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary buffer of a container."""
    magic, version, length = struct.unpack_from("<3I", content)
    if (magic, version) != (MAGIC, 2) or length > len(content):
        raise ValueError("another format, or cut off")
    found, at = dict[int, bytes](), 12
    while at < length:
        size, kind = struct.unpack_from("<2I", content, at)
        if at + 8 + size > length:
            raise ValueError("a chunk was cut off")
        found.setdefault(kind, content[at + 8 : at + 8 + size])
        at += 8 + size
    refuse_content(found[JSON_CHUNK], path, XML_LIMIT)
    document = json.loads(found[JSON_CHUNK])
    if not isinstance(document, dict):
        raise TypeError("the JSON is not an object")
    return document, found.get(BINARY_CHUNK, b"")


@dataclass(slots=True)
class _File:
    """The JSON of a file and its buffer.

    ``left_out`` counts primitives without triangles, ``odd`` those with vertices left over, and
    ``morphed`` nodes whose meshes are changed by the weights of their targets.
    """

    json: dict[str, Any]
    binary: bytes
    path: Path
    left_out: int = 0
    odd: int = 0
    morphed: int = 0

    def notes(self) -> Iterator[str]:
        """What was not read."""
        if self.left_out:
            yield f"{self.left_out} sets of points or lines: left out"
        if self.odd:
            told = "whose vertices are no multiple of three: the last ones are left out"
            yield f"{self.odd} sets of triangles {told}"
        if self.morphed:
            yield f"{self.morphed} nodes with weights of morph targets: read as without them"
        others = len(self.json["scenes"]) - 1
        if others:
            yield f"{others} scenes other than the default one: left out"

    def parts(self) -> Iterator[tuple[str, Floats, Ints]]:
        """The name, transformed vertices and triangles of each primitive."""
        count = 0
        for node, placed in self.nodes():
            if "mesh" not in node:
                continue
            mesh = self.json["meshes"][node["mesh"]]
            name = str(node.get("name") or mesh.get("name") or self.path.stem)
            if "skin" in node:
                said = f"bones move the vertices of `{visible(name[:60])}`, and are not followed"
                raise file_fault(self.path, said, "write the mesh without bones (`skin`)")
            targets = any(each.get("targets") for each in mesh["primitives"])
            self.morphed += targets and any(node.get("weights", mesh.get("weights", ())))
            for primitive in mesh["primitives"]:
                found = self.primitive(primitive)
                if found is None:
                    self.left_out += 1
                    continue
                points, faces = found
                count += len(faces)
                too_many(count, self.path)
                turned = faces[:, ::-1] if np.linalg.det(placed[:3, :3]) < 0 else faces
                yield name, points @ placed[:3, :3].T + placed[:3, 3], turned

    def nodes(self) -> Iterator[tuple[dict[str, Any], Floats]]:
        """The nodes of the scene, each with its transformation (4, 4) to the scene."""
        nodes, seen = self.json.get("nodes", []), set[int]()
        scene = self.json["scenes"][self.json.get("scene", 0)]
        todo = [(number, np.eye(4)) for number in reversed(scene.get("nodes", []))]
        while todo:
            number, above = todo.pop()
            if number in seen:
                raise ValueError("a node is in two places")
            seen.add(number)
            placed = above @ _place(nodes[number])
            yield nodes[number], placed
            todo += [(child, placed) for child in reversed(nodes[number].get("children", []))]

    def primitive(self, primitive: dict[str, Any]) -> tuple[Floats, Ints] | None:
        """The used vertices and the triangles of a primitive; None for points and lines."""
        mode = primitive.get("mode", TRIANGLES)
        if mode not in (TRIANGLES, STRIP, FAN):
            return None
        positions = self.numbers(primitive["attributes"]["POSITION"], {FLOAT: "<f4"}, "VEC3")
        order = None
        if "indices" in primitive:
            order = self.numbers(primitive["indices"], INDICES, "SCALAR")[:, 0]
        count = len(positions if order is None else order)
        too_many(count // (3 if mode == TRIANGLES else 1), self.path)
        self.odd += mode == TRIANGLES and count % 3 > 0
        used, numbers = np.unique(np.arange(count) if order is None else order, return_inverse=True)
        return positions[used].astype(np.float64), _faces(numbers.reshape(-1), mode)

    def numbers(self, number: int, types: dict[int, str], shape: str) -> Any:
        """The rows of an accessor, without a copy; numpy rejects rows beyond the buffer."""
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        buffer = self.json["buffers"][view["buffer"]]
        if "sparse" in accessor or accessor["type"] != shape or "uri" in buffer:
            raise ValueError("stored in another way")
        kind = np.dtype(types[accessor["componentType"]])
        width = 3 if shape == "VEC3" else 1
        start = view.get("byteOffset", 0)
        within = self.binary[start : start + view["byteLength"]]
        stride = view.get("byteStride", width * kind.itemsize)
        if stride < width * kind.itemsize:
            raise ValueError("rows overlap")
        rows = (accessor["count"], width)
        offset = accessor.get("byteOffset", 0)
        return np.ndarray(rows, kind, within, offset, (stride, kind.itemsize))


def _faces(numbers: Ints, mode: int) -> Ints:
    """The triangles (m, 3) of a sequence of vertices, with consistent winding also in strips."""
    count = len(numbers)
    if mode == TRIANGLES:
        return numbers[: count - count % 3].reshape(-1, 3)
    later = np.arange(2, max(count, 2))
    if mode == FAN:
        return np.column_stack([numbers[later * 0], numbers[later - 1], numbers[later]])
    odd = later % 2
    return np.column_stack([numbers[later - 2 + odd], numbers[later - 1 - odd], numbers[later]])


def _place(node: dict[str, Any]) -> Floats:
    """The transformation (4, 4) of a node to its parent."""
    from scipy.spatial.transform import Rotation

    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    found = np.eye(4)
    turn = Rotation.from_quat(node.get("rotation", (0, 0, 0, 1))).as_matrix()
    found[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), dtype=np.float64)
    found[:3, 3] = node.get("translation", (0, 0, 0))
    return found

"""Meshes of a module set as hulls: what becomes of them is decided here alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

import numpy as np

from srgc.faults import UsageFault
from srgc.imports.limited_files import FileTree, limited_bytes
from srgc.imports.module_set import Placement, Shape, steps_of
from srgc.imports.names import Names
from srgc.imports.timor.geometry_data import Geometry
from srgc.imports.timor.vrml_file import vrml_pieces

FOLDER = "meshes"
"""Where meshes stand beside the spec."""
MOST_MESH_BYTES = 50_000_000


class MeshHulls:
    """Copies meshes beside the spec, once each, and says how shapes name them."""

    def __init__(self, tree: FileTree) -> None:
        self.tree = tree
        self.files = dict[str, bytes]()
        self.remarks = list[str]()
        self._names = Names()
        self._done = dict[tuple[str, tuple[float, ...]], list[tuple[str, float]]]()

    def shapes(self, geometry: Geometry, body: str) -> Iterator[Shape]:
        """The hulls of a mesh that is fixed to the frame ``body``.

        Raises:
            UsageFault: the file is not below the folder of the set, or is no mesh that is known.
        """
        key = (geometry.file, geometry.size)
        if key not in self._done:
            self._done[key] = list(self._copied(geometry))
        for file, scale in self._done[key]:
            place = Placement(body, steps_of(geometry.pose))
            yield Shape("hull", place, (scale,), file)

    def _copied(self, geometry: Geometry) -> Iterator[tuple[str, float]]:
        place = geometry.place["parameters"]["file"]
        try:
            path = self.tree.found(geometry.file.removeprefix("package://"))
        except UsageFault as fault:
            raise place.fault(str(fault)) from None
        suffix = path.suffix.lower()
        stem = PurePosixPath(geometry.file).name.split(".")[0]
        even = len(set(geometry.size)) == 1
        if suffix in (".stl", ".obj") and even:
            name = f"{FOLDER}/{self._names.name(stem)}{suffix}"
            self.files[name] = limited_bytes(path, MOST_MESH_BYTES)
            self.remarks.append(
                f"{place.path}: {geometry.file} counts as its convex hull; "
                "take it apart into convex pieces where that is too much"
            )
            yield name, geometry.size[0]
            return
        if suffix != ".wrl":
            raise place.fault(
                f"{geometry.file} is no mesh that is read here; known are .stl, .obj, and .wrl as "
                "boundingmesh writes it" + ("" if even else "; its scales have to be equal")
            )
        for vertices in vrml_pieces(path):
            name = f"{FOLDER}/{self._names.name(stem)}.obj"
            self.files[name] = _points_file(vertices * np.array(geometry.size))
            yield name, 1.0


def _points_file(vertices: np.ndarray) -> bytes:
    """An OBJ file of points, whose hull is the piece; three of them make its only triangle."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    return ("\n".join([*lines, "f 1 2 3"]) + "\n").encode()

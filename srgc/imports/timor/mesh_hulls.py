"""Meshes that a JSON file names: pieces of VRML are kept, others decomposed as for URDF."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Sequence
from decimal import Decimal

import numpy as np

from srgc.imports.body_meshes import BodyMeshes
from srgc.imports.module_set import Placement, Shape, steps_of
from srgc.imports.names import legible
from srgc.imports.source_files import source_bytes
from srgc.imports.timor.geometry_data import Geometry
from srgc.imports.timor.vrml_file import vrml_pieces


class MeshHulls:
    """Makes hulls from meshes; ``meshes`` reads and writes their files."""

    def __init__(self, meshes: BodyMeshes) -> None:
        self.meshes = meshes
        self._pieces = dict[tuple[str, tuple[float, ...]], list[str]]()

    def shapes(self, geometry: Geometry, body: str) -> Iterator[Shape]:
        """The hulls of a mesh fixed to the frame ``body``.

        Raises:
            SourceFault: the file is not below the folder of the set, or is not a known kind of
                mesh.
        """
        place = Placement(body, steps_of(geometry.pose))
        if geometry.file.lower().endswith(".wrl"):
            yield from self._vrml(geometry, place)
        else:
            yield from self.meshes.hulls(geometry.place.path, geometry.file, geometry.size, place)

    def visuals(self, geometry: Geometry, body: str) -> Iterator[Shape]:
        """A mesh for pictures; nothing for other shapes."""
        if geometry.kind != "mesh":
            return
        place = Placement(body, steps_of(geometry.pose))
        yield from self.meshes.visual(geometry.place.path, geometry.file, geometry.size, place)

    def _vrml(self, geometry: Geometry, place: Placement) -> Iterator[Shape]:
        """A hull for each shape of a VRML file, each of which is a set of points."""
        key = (geometry.file, geometry.size)
        if key not in self._pieces:
            stem = legible(posixpath.basename(geometry.file).split(".")[0], "mesh")
            self._pieces[key] = []
            path = self.meshes.files.path_of(geometry.file)
            pieces = vrml_pieces(source_bytes(path), path)
            for number, points in enumerate(pieces):
                end = f"_{number + 1}" if len(pieces) > 1 else ""
                name = f"{self.meshes.folder}/{self.meshes.names.name(stem + end)}.obj"
                self.meshes.written[name] = _points_file(points, geometry.size)
                self._pieces[key].append(name)
        for name in self._pieces[key]:
            yield Shape("hull", place, (1.0,), name)


def _points_file(points: np.ndarray, scale: Sequence[float]) -> bytes:
    """An OBJ file of points whose hull is the piece; its only triangle joins the first three.

    The coordinates are the decimals of the file, times the scale.
    """
    factors = [Decimal(repr(each)) for each in scale]
    lines = [
        f"v {' '.join(_times(x, by) for x, by in zip(point, factors, strict=True))}"
        for point in points.tolist()
    ]
    return ("\n".join([*lines, "f 1 2 3"]) + "\n").encode()


def _times(value: float, factor: Decimal) -> str:
    return f"{(Decimal(repr(value)) * factor).normalize() + 0:f}"

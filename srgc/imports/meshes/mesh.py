"""Meshes of triangles in metres, with their named parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from srgc.imports.meshes.exact_places import ExactPlaces

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Bools: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class MeshObject:
    """A named part of a mesh: the triangles from ``start`` up to ``stop``, exclusive."""

    name: str
    start: int
    stop: int


@dataclass(frozen=True, slots=True)
class Mesh:
    """Vertices (n, 3) in metres, and triangles (m, 3) of their indices, in the order of the file.

    ``notes`` says what was not read from the file.  ``places`` are the vertices as rationals;
    without them the doubles are exact.
    """

    vertices: Floats
    triangles: Ints
    objects: tuple[MeshObject, ...] = ()
    notes: tuple[str, ...] = ()
    places: ExactPlaces | None = None

    def exact(self) -> ExactPlaces:
        """The vertices as rationals."""
        return ExactPlaces(self.vertices, binary=True) if self.places is None else self.places

    def moved(self, places: ExactPlaces) -> Mesh:
        """The mesh with other positions of its vertices."""
        return replace(self, vertices=places.vertices(), places=places)

    def scaled(self, factors: Sequence[Fraction]) -> Mesh:
        """The mesh with each axis scaled; if that mirrors it, the winding is reversed."""
        found = self.moved(self.exact().scaled(factors))
        mirrored = sum(factor < 0 for factor in factors) % 2
        return replace(found, triangles=found.triangles[:, ::-1]) if mirrored else found

    def part(self, item: MeshObject) -> Mesh:
        """The mesh of one object."""
        triangles = self.triangles[item.start : item.stop]
        used, inverse = np.unique(triangles, return_inverse=True)
        return Mesh(
            self.vertices[used],
            inverse.reshape(-1, 3).astype(np.int64),
            (MeshObject(item.name, 0, len(triangles)),),
            places=None if self.places is None else self.places.part(used),
        )

    def corners(self) -> Floats:
        """The corners of all triangles, (m, 3, 3)."""
        found: Floats = self.vertices[self.triangles]
        return found


def joined(parts: Sequence[tuple[str, tuple[Floats, Ints]]]) -> Mesh:
    """Concatenate parts: each is a name with vertices (n, 3) and triangles (m, 3)."""
    vertices, triangles, objects = list[Floats](), list[Ints](), list[MeshObject]()
    before = start = 0
    for name, (points, faces) in parts:
        vertices.append(points)
        triangles.append(faces + before)
        objects.append(MeshObject(name, start, start + len(faces)))
        before, start = before + len(points), start + len(faces)
    if not parts:
        return Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))
    return Mesh(np.concatenate(vertices), np.concatenate(triangles), tuple(objects))

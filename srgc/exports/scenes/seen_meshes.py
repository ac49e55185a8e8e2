"""Read the visuals of a robot as triangles in the frames of its links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from grammar_lang import ir
from srgc.exports.scenes.link_motion import plain_pose
from srgc.exports.scenes.triangles import Triangles
from srgc.exports.visual_meshes import VisualMesh
from srgc.faults import UsageFault
from srgc.imports.meshes.mesh_file import mesh_of


@dataclass(frozen=True, slots=True, eq=False)
class SeenMesh:
    """A visual in the frame of the link with this number."""

    link: int
    surface: Triangles

    @property
    def outline(self) -> Array:
        """Points (8, 3) whose hull contains it: the corners of its bounding box."""
        ends = np.stack([self.surface.corners.min(axis=0), self.surface.corners.max(axis=0)])
        choices = np.array([*product((0, 1), repeat=3)])
        found: Array = ends[choices, np.arange(3)]
        return found


@dataclass(frozen=True, slots=True, eq=False)
class SeenMeshes:
    """The visuals that can be read, and a note on each file that cannot."""

    meshes: tuple[SeenMesh, ...]
    notes: tuple[str, ...]


def seen_meshes(visuals: Sequence[VisualMesh]) -> SeenMeshes:
    """The surfaces of visuals; each file is read once.

    Raises:
        ValueError: a pose has no definite value.
    """
    read: dict[str, Triangles | None] = {}
    meshes, notes = list[SeenMesh](), list[str]()
    for visual in visuals:
        digest = visual.file.digest
        if digest not in read:
            try:
                read[digest] = _surface(visual.file)
            except UsageFault as fault:
                read[digest] = None
                notes.append(f"a visual is not drawn: {fault.in_python()}")
        surface = read[digest]
        if surface is not None:
            corners = plain_pose(visual.pose).points(surface.corners * float(visual.scale))
            meshes.append(SeenMesh(visual.link, Triangles(corners, surface.faces)))
    return SeenMeshes(tuple(meshes), tuple(notes))


def _surface(file: ir.VisualFile) -> Triangles:
    """The triangles of a file, with equal corners merged and degenerate triangles removed.

    Raises:
        UsageFault: the file cannot be read, or a library for it is missing.
    """
    try:
        mesh = mesh_of(file.data, Path(file.path), own_axes=True)
    except ModuleNotFoundError as error:
        said = f'{file.path} needs the library {error.name}: pip install "srgc[import]"'
        raise UsageFault(said) from None
    corners, numbers = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = numbers.reshape(-1)[mesh.triangles]
    one, two, three = faces.T
    return Triangles(corners, faces[(one != two) & (two != three) & (three != one)])

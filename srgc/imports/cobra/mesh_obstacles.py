"""Write obstacles that are meshes as convex pieces in OBJ files, which the workspace names."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from srgc.imports.cobra.task_data import Obstacle
from srgc.imports.comment_lines import printable
from srgc.imports.module_set import Move, Turn, steps_of
from srgc.imports.names import Names, is_legible
from srgc.imports.quantities import Quantities
from srgc.imports.source_fault import file_fault

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from srgc.imports.meshes.decomposition import Pieces
    from srgc.imports.source_files import SourceFiles
    from srgc.imports.timor.geometry_data import Geometry


@dataclass(slots=True)
class MeshObstacles:
    """Decomposes meshes into convex pieces.

    Attributes:
        files: the files that may be read.
        names: the names of obstacles in the workspace, which files share.
        pieces: the most convex pieces of a mesh.
        detail: the share of its volume that they may add.
        folder: the folder of the pieces, next to the spec.
        written: maps paths to the files of pieces.
    """

    files: SourceFiles
    names: Names
    remarks: list[str]
    write: Quantities
    pieces: int | None = None
    detail: float | None = None
    folder: str = "task_meshes"
    written: dict[str, bytes] = field(default_factory=dict)

    def statements(self, obstacle: Obstacle) -> Iterator[tuple[str, str, NDArray[np.float64]]]:
        """The name, ``obstacles from`` statement and corners (n, 3) in the world of each mesh.

        Raises:
            SourceFault: a mesh cannot be read.
        """
        for geometry in obstacle.shapes:
            if geometry.kind == "mesh":
                yield self._statement(geometry, obstacle)

    def _statement(
        self, geometry: Geometry, obstacle: Obstacle
    ) -> tuple[str, str, NDArray[np.float64]]:
        stem = posixpath.splitext(posixpath.basename(geometry.file))[0]
        name = self.names.name(Names().camel(obstacle.name or stem, "Obstacle"))
        text, points = self._cut(geometry)
        path = f"{self.folder}/{name}.obj"
        self.written[path] = text.encode()
        at = [
            f"move({self.write.vector(step.by)})"
            if isinstance(step, Move)
            else f"rot({step.axis}, {self.write.angle(step.angle)})"
            for step in steps_of(geometry.pose)
            if (isinstance(step, Move) and any(step.by))
            or (isinstance(step, Turn) and abs(step.angle) > 1e-12)
        ]
        place = f" at {' * '.join(at)}" if at else ""
        placed = points @ geometry.pose[:3, :3].T + geometry.pose[:3, 3]
        behind = "" if is_legible(obstacle.name) else f"  // `{printable(obstacle.name)}`"
        return name, f'obstacles from "{path}"{place};{behind}', placed

    def _cut(self, geometry: Geometry) -> tuple[str, NDArray[np.float64]]:
        """The OBJ file of the pieces of a mesh in metres, and the vertices of the mesh."""
        from srgc.imports.meshes.decomposition import DETAIL, decomposed
        from srgc.imports.meshes.exact_places import rational
        from srgc.imports.meshes.mesh_file import read_mesh
        from srgc.imports.meshes.mesh_limits import scaled_within
        from srgc.imports.meshes.piece_files import pieces_text

        file = self.files.path_of(geometry.file)
        factors = [rational(factor) for factor in geometry.size]
        mesh = scaled_within(read_mesh(file, own_axes=True), factors, partial(file_fault, file))
        found = decomposed(
            mesh.vertices,
            mesh.triangles,
            detail=DETAIL if self.detail is None else self.detail,
            pieces=self.pieces,
            places=mesh.places,
        )
        self.remarks += mesh.notes
        self.remarks += [f"{geometry.file}: {note}" for note in found.notes]
        self.remarks.append(_added(geometry.file, found))
        names = [f"piece_{number + 1}" for number in range(len(found.pieces))]
        origin = f"convex pieces of {printable(geometry.file)}"
        return pieces_text(found.pieces, names, [origin]), mesh.vertices


def _added(file: str, found: Pieces) -> str:
    """A remark on the volume that the pieces of a mesh add."""
    number, added = len(found.pieces), f"{100 * found.measures.added:.1f} %"
    if number == 1:
        return f"{file}: the convex piece that holds every triangle adds {added} to it"
    return f"{file}: {number} convex pieces that hold every triangle add {added} to it"

"""Meshes of bodies: convex pieces for collision checking, unchanged files for pictures."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

from grammar_lang.files.file_tree import visible
from srgc.imports.module_set import Placement, Shape
from srgc.imports.names import Names, legible
from srgc.imports.solid_moments import Moments
from srgc.imports.source_fault import file_fault
from srgc.imports.source_files import SourceFiles
from srgc.version import VERSION

if TYPE_CHECKING:
    from srgc.imports.meshes.decomposition import Pieces
    from srgc.imports.meshes.mesh import Mesh

VISUALS = (".stl", ".obj", ".dae", ".glb")


@dataclass(slots=True)
class BodyMeshes:
    """Reads the meshes that the description of a robot or scene names.

    ``folder`` is where they are written, relative to the spec, and ``written`` maps their paths to
    their bytes.  ``pieces`` bounds the number of convex pieces of a mesh, ``detail`` the share of
    its volume that they may add.
    """

    files: SourceFiles
    folder: str
    remarks: list[str]
    pieces: int | None = None
    detail: float | None = None
    written: dict[str, bytes] = field(default_factory=dict)
    names: Names = field(default_factory=lambda: Names(ignore_case=True))
    _cut: dict[tuple[str, tuple[float, float, float]], list[str]] = field(default_factory=dict)
    _looks: dict[str, str] = field(default_factory=dict)

    def hulls(
        self, owner: str, file: str, scale: Sequence[float], place: Placement
    ) -> Iterator[Shape]:
        """The convex pieces of a mesh after scaling along its axes."""
        key = (file, (scale[0], scale[1], scale[2]))
        if key not in self._cut:
            self._cut[key] = self._written_pieces(owner, file, scale)
        for name in self._cut[key]:
            yield Shape("hull", place, (1.0,), name)

    def _written_pieces(self, owner: str, file: str, scale: Sequence[float]) -> list[str]:
        from srgc.imports.meshes.decomposition import DETAIL, decomposed
        from srgc.imports.meshes.obj_file import TOGETHER
        from srgc.imports.meshes.piece_files import pieces_text

        mesh = self._mesh(file, scale)
        self.remarks += [note for note in mesh.notes if not note.endswith(TOGETHER)]
        detail = DETAIL if self.detail is None else self.detail
        cut = decomposed(
            mesh.vertices, mesh.triangles, detail=detail, pieces=self.pieces, places=mesh.places
        )
        stem = legible(posixpath.splitext(posixpath.basename(file))[0], "mesh")
        count = len(cut.pieces)
        wanted = [stem] if count == 1 else [f"{stem}_{number + 1}" for number in range(count)]
        names = [self.names.name(each, "mesh") for each in wanted]
        origin = f"of {visible(file)}, imported by srgc {VERSION}"
        for name, piece in zip(names, cut.pieces, strict=True):
            text = pieces_text([piece], [name], [origin])
            self.written[f"{self.folder}/{name}.obj"] = text.encode()
        self.remarks.append(_told(owner, file, cut))
        return [f"{self.folder}/{name}.obj" for name in names]

    def _mesh(self, file: str, scale: Sequence[float]) -> Mesh:
        """Read a mesh in metres, keeping the axes of its file.

        Raises:
            SourceFault: it cannot be read, or its scale makes it too large.
        """
        from srgc.imports.meshes.exact_places import rational
        from srgc.imports.meshes.mesh_file import read_mesh
        from srgc.imports.meshes.mesh_limits import scaled_within

        path = self.files.path_of(file)
        mesh = read_mesh(path, own_axes=True)
        return scaled_within(mesh, [rational(by) for by in scale], partial(file_fault, path))

    def moments(self, file: str, scale: Sequence[float]) -> Moments | None:
        """The moments of a mesh for a density of 1 kg/m^3; None if the mesh is not closed."""
        import numpy as np
        import trimesh

        scaled = self._mesh(file, scale)
        mesh = trimesh.Trimesh(scaled.vertices, scaled.triangles)
        if not mesh.is_volume:
            return None
        found = mesh.mass_properties
        return Moments(
            float(found["mass"]), np.array(found["center_mass"]), np.array(found["inertia"])
        )

    def visual(
        self, owner: str, file: str, scale: Sequence[float], place: Placement
    ) -> Iterator[Shape]:
        """A mesh for pictures, whose file is copied; none if it cannot be shown."""
        if not file.lower().endswith(VISUALS):
            self.remarks.append(f"{owner}: pictures of `{visible(file)}` are left out")
            return
        if len(set(scale)) != 1 or scale[0] <= 0:
            self.remarks.append(
                f"{owner}: the picture `{visible(file)}` is scaled differently along its axes, "
                "and left out"
            )
            return
        if file not in self._looks:
            stem, suffix = posixpath.splitext(posixpath.basename(file))
            called = self.names.name(stem, "mesh")
            name = f"{self.folder}/{called}{suffix.lower()}"
            self.written[name] = self.files.bytes_of(file)
            self._looks[file] = name
        yield Shape("visual", place, (scale[0],), self._looks[file])


def _told(owner: str, file: str, cut: Pieces) -> str:
    """A remark on the number of convex pieces of a mesh and the volume that they add."""
    one = len(cut.pieces) == 1
    count = "1 convex piece, which adds" if one else f"{len(cut.pieces)} convex pieces, which add"
    notes = "".join(f"; {note}" for note in cut.notes)
    share = 100 * cut.measures.added
    return f"`{visible(file)}` of {owner}: {count} {share:.1f} % to its volume{notes}"

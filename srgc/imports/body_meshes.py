"""Meshes of bodies: convex pieces to collide as, and the files as they are for pictures."""

from __future__ import annotations

import posixpath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from grammar_lang.files.file_tree import visible
from srgc.imports.module_set import Placement, Shape
from srgc.imports.names import Names
from srgc.imports.solid_moments import Moments
from srgc.imports.source_files import SourceFiles

VISUALS = (".stl", ".obj", ".dae", ".glb")


@dataclass(slots=True)
class BodyMeshes:
    """Reads the meshes that a description of bodies names.

    ``folder`` is where they are written, relative to the spec.  ``written`` holds their bytes by
    path.  ``pieces`` and ``detail`` bound how many convex pieces there are and what they add.
    """

    files: SourceFiles
    folder: str
    remarks: list[str]
    pieces: int | None = None
    detail: float | None = None
    written: dict[str, bytes] = field(default_factory=dict)
    names: Names = field(default_factory=Names)
    _cut: dict[tuple[str, tuple[float, float, float]], list[str]] = field(default_factory=dict)
    _looks: dict[str, str] = field(default_factory=dict)

    def hulls(
        self, owner: str, file: str, scale: Sequence[float], place: Placement
    ) -> Iterator[Shape]:
        """The convex pieces of a mesh whose lengths are scaled along its axes."""
        key = (file, (scale[0], scale[1], scale[2]))
        if key not in self._cut:
            self._cut[key] = self._written_pieces(owner, file, scale)
        for name in self._cut[key]:
            yield Shape("hull", place, (1.0,), name)

    def _written_pieces(self, owner: str, file: str, scale: Sequence[float]) -> list[str]:
        import io

        import trimesh

        mesh = trimesh.load(io.BytesIO(self.files.bytes_of(file)), file_type=file[-3:].lower(), force="mesh")
        mesh.apply_scale(scale)
        name = f"{self.folder}/{self.names.name(posixpath.splitext(posixpath.basename(file))[0])}.obj"
        self.written[name] = mesh.convex_hull.export(file_type="obj").encode()
        return [name]

    def moments(self, file: str, scale: Sequence[float]) -> Moments | None:
        """The moments of a closed mesh for a density of 1 kg/m^3, None of an open one."""
        raise NotImplementedError

    def visual(
        self, owner: str, file: str, scale: Sequence[float], place: Placement
    ) -> Iterator[Shape]:
        """A mesh for pictures, whose file is copied."""
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
            name = f"{self.folder}/{self.names.name(stem)}{suffix.lower()}"
            self.written[name] = self.files.bytes_of(file)
            self._looks[file] = name
        yield Shape("visual", place, (scale[0],), self._looks[file])

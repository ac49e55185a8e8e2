"""Import scenes from files; the extension gives the format."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from srgc.faults import UsageFault
from srgc.imports.meshes.decomposition import DETAIL
from srgc.imports.meshes.exact_places import exact_decimal, rational
from srgc.imports.meshes.mesh_file import SUFFIXES, read_mesh
from srgc.imports.scenes.moveit_scene import moveit_scene
from srgc.imports.scenes.scene import MeshShape, Pose, Scene, SceneObject
from srgc.imports.scenes.scene_text import Wanted, scene_spec
from srgc.imports.scenes.sdf_world import sdf_scene
from srgc.imports.source_fault import file_fault
from srgc.imports.source_files import source_files
from srgc.imports.written_import import Imported
from srgc.paths import refuse_impossible

LENGTHS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254}
FARTHEST = 1e6
WITHOUT_UNIT, HUGE = (".stl", ".obj"), 50.0
"""A file without a unit that would be larger than this, in metres, may be in millimetres."""
SCENE, WORLDS = ".scene", (".sdf", ".world")
_PLACE = re.compile(r"\(?([^(),]+),([^(),]+),([^(),]+?)\)?\s*(mm|cm|m)?")


def scene_import(
    path: Path,
    *,
    name: str | None = None,
    unit: str | None = None,
    at: str | None = None,
    packages: Sequence[str] = (),
    pieces: int | None = None,
    detail: float | None = None,
    stem: str | None = None,
) -> Imported:
    """A workspace with the obstacles of a scene.

    Args:
        path: a mesh, a MoveIt scene, or an SDF world, by its extension; see :func:`read_scene`.
        name: the name of the workspace, instead of that of the scene.
        unit: see :func:`read_scene`.
        at: see :func:`read_scene`.
        packages: the folders for ``package://NAME`` and ``model://NAME``, each ``NAME=DIR``.
        pieces: the most convex pieces of each mesh.
        detail: the share of the volume of a mesh that its pieces may add.
        stem: the name of the spec without its extension, from which the folder of meshes is named;
            if None, the name of the scene.

    Raises:
        UsageFault: the file is of another kind, has no obstacles, or cannot be read.
    """
    refuse_impossible(path)
    scene = read_scene(path, unit=unit, at=at, packages=packages)
    wanted = Wanted(DETAIL if detail is None else detail, pieces, name, stem)
    return scene_spec(scene, path.name, wanted)


def read_scene(
    path: Path, *, unit: str | None = None, at: str | None = None, packages: Sequence[str] = ()
) -> Scene:
    """Read a scene from a mesh, a MoveIt scene or an SDF world.

    Args:
        path: a file in STL, OBJ, COLLADA or binary glTF, or ``.scene``, ``.sdf`` or ``.world``.
        unit: one of :data:`LENGTHS`: the unit of an STL or OBJ file, or a replacement for the unit
            that another mesh states.
        at: the position of the file's origin in the world, such as ``(0.5, 0, 0) m``.
        packages: each ``NAME=DIR``.

    Raises:
        UsageFault: the file is of another kind, or cannot be read.
    """
    suffix = path.suffix.lower()
    place = Pose() if at is None else _place(at)
    if suffix in SUFFIXES:
        scene = _of_mesh(path, None if unit is None else LENGTHS[unit])
    elif suffix in (SCENE, *WORLDS):
        if unit is not None:
            raise UsageFault(f"{path} is in metres: --unit goes with STL, OBJ, DAE and GLB")
        scene = moveit_scene(path) if suffix == SCENE else sdf_scene(source_files(path, packages))
    else:
        known = ", ".join((*SUFFIXES, SCENE, *WORLDS))
        raise file_fault(path, "its file extension is not that of a scene", f"known: {known}")
    if at is not None and unit not in {None, "m"} and not at.rstrip().endswith("m"):
        scene.notes.append(f"--at {at} is in m; write `{at} {unit}` if it is in {unit}")
    scene.objects = [
        SceneObject(each.name, each.shape, place.then(each.pose), each.note)
        for each in scene.objects
    ]
    if scene.ground is not None:
        scene.ground += float(place.shift[2])
    return scene


def _of_mesh(path: Path, unit: float | None) -> Scene:
    mesh = read_mesh(path, unit)
    objects = [
        SceneObject(each.name or path.stem, MeshShape(mesh.part(each), path.name), Pose())
        for each in mesh.objects
        if each.stop > each.start
    ]
    notes = list[str]()
    size = float(np.ptp(mesh.vertices, axis=0).max())
    if unit is None and path.suffix.lower() in WITHOUT_UNIT and size > HUGE:
        notes.append(f"{path.name} is {size:.4g} m large; --unit mm if it is in millimetres")
    return Scene(path.stem, objects, list(mesh.notes), notes=notes)


def _place(text: str) -> Pose:
    """Parse a position into a pose.

    Raises:
        UsageFault: the text is not a position.
    """
    found = _PLACE.fullmatch(text.strip())
    try:
        if found is None:
            raise ValueError(text)
        *numbers, unit = found.groups()
        place = [float(number) * LENGTHS[unit or "m"] for number in numbers]
        words = [number.strip() for number in numbers]
        if not all(abs(x) < FARTHEST for x in place):
            raise UsageFault(f"`{text}` is not a position: its coordinates are less than 1000 km")
        x, y, z = (exact_decimal(word) * rational(LENGTHS[unit or "m"]) for word in words)
    except ValueError:
        raise UsageFault(f"`{text}` is not a position; write one such as `(0.5, 0, 0) m`") from None
    return Pose(shift=np.array(place), exact=(x, y, z))

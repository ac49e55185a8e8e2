"""Place the meshes of visuals in a robot's links, and write them as files for its export."""

from __future__ import annotations

import posixpath
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from compiler.rigid_links.ball_pose import Pose
from compiler.rigid_links.rigid_tree import fixed_frames
from compiler.robots.normal_form import family_of
from compiler.robots.pictured_robot import pictured_robot, visuals_of
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.files.meshes import MeshError, binary_triangles
from grammar_lang.files.scenes import scene_of

if TYPE_CHECKING:
    from srgc.results.found_design import FoundDesign

UNSAID = "visuals are files of their own; name a file with -o, and they stand beside it"
_READ_BY_MUJOCO = (".stl", ".obj")
_MOST_FACES, _LEAST_CORNERS = 200_000, 4
"""MuJoCo rejects an STL file with more faces, and a mesh with fewer corners."""
_HEADER, _TRIANGLE = struct.Struct("<80sI"), struct.Struct("<12fH")


@dataclass(frozen=True, slots=True)
class VisualMesh:
    """A mesh shown at a pose in a link; its unit is ``scale`` metres."""

    link: int
    pose: Pose
    file: ir.VisualFile
    scale: Fraction


def pictured_model(design: FoundDesign) -> RobotModel:
    """The robot of a design with the frames of its visuals.

    Its links are those of the design, followed by links that a coupled degree of freedom moves and
    that have nothing but visuals.
    """
    family = family_of(design.program, design.task)
    if not visuals_of(family, design.derivation):
        return design.model
    model = pictured_robot(family, design.derivation)
    if [dof.symbols for dof in model.dofs] != [dof.symbols for dof in design.model.dofs]:
        raise AssertionError("visuals have changed the joints of a robot")
    return replace(model, apart=design.model.apart)


def visual_meshes(design: FoundDesign, model: RobotModel) -> tuple[VisualMesh, ...]:
    """The visuals of a design in the links of its ``pictured_model``.

    Raises:
        RigidTreeError: the frame of a visual has no value.
    """
    visuals = visuals_of(family_of(design.program, design.task), design.derivation)
    if not visuals:
        return ()
    frames = fixed_frames(model, design.stated, model.seen)
    return tuple(
        VisualMesh(frame.link, frame.pose, visual.file, visual.scale)
        for frame, visual in zip(frames, visuals, strict=True)
    )


def visual_names(meshes: Sequence[VisualMesh], stem: str) -> dict[str, str]:
    """Map the digests of visuals to names of their files, which begin with ``stem``."""
    found: dict[str, str] = {}
    for mesh in meshes:
        if mesh.file.digest not in found:
            number, end = len(found) + 1, _suffix(mesh.file)
            found[mesh.file.digest] = f"{stem}.visual_{number}{end}"
    return found


def visual_files(meshes: Sequence[VisualMesh], names: Mapping[str, str]) -> dict[str, bytes]:
    """Map the names of visuals' files to their contents, which are unchanged except for text STL.

    That becomes binary, since MuJoCo does not read it.
    """
    return {names[mesh.file.digest]: _content(mesh.file) for mesh in meshes}


def mujoco_reads(file: ir.VisualFile) -> bool:
    """Whether MuJoCo loads the content of a file."""
    if _suffix(file) not in _READ_BY_MUJOCO:
        return False
    try:
        binary = _binary(file)
        if binary is None:
            objects = scene_of(file.path, file.data, faces_alone=False).objects
            return len({corner for each in objects for corner in each.corners}) >= _LEAST_CORNERS
        triangles = list(binary)
    except MeshError:
        return False
    corners = {corner for triangle in triangles for corner in triangle}
    return len(triangles) <= _MOST_FACES and len(corners) >= _LEAST_CORNERS


def unread_by_mujoco(meshes: Sequence[VisualMesh]) -> Iterator[str]:
    """A note on each visual that MJCF leaves out."""
    for file in dict.fromkeys(mesh.file for mesh in meshes):
        if not mujoco_reads(file):
            name = posixpath.basename(file.path)
            yield f"the visual {name} is left out of the MJCF, as MuJoCo does not read it"


def _suffix(file: ir.VisualFile) -> str:
    return posixpath.splitext(file.path)[1].lower()


def _binary(file: ir.VisualFile) -> Iterator[tuple[tuple[float, ...], ...]] | None:
    return binary_triangles(file.data) if _suffix(file) == ".stl" else None


def _content(file: ir.VisualFile) -> bytes:
    """The bytes of a file; text STL is converted to binary STL with the same triangles."""
    if _suffix(file) != ".stl":
        return file.data
    try:
        if _binary(file) is not None:
            return file.data
        objects = scene_of(file.path, file.data).objects
    except MeshError:
        return file.data
    triangles = [
        tuple(float(x) for number in face for x in each.corners[number])
        for each in objects
        for face in each.faces
    ]
    parts = (_TRIANGLE.pack(0, 0, 0, *triangle, 0) for triangle in triangles)
    return _HEADER.pack(b"", len(triangles)) + b"".join(parts)

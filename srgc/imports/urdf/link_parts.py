"""Read the parts of a URDF link: its body, its collision shapes, and meshes for pictures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from grammar_lang.files.file_tree import visible
from srgc.imports.body_meshes import BodyMeshes
from srgc.imports.module_set import Body, Move, Placement, Shape, Turn, joined
from srgc.imports.solid_moments import Moments, moments_of_shape
from srgc.imports.urdf.robot_model import UrdfRobot
from srgc.imports.xml_source import Element

if TYPE_CHECKING:
    from yourdfpy.urdf import Collision, Link, Mesh, Visual

NOISE = 1e-9
"""Rotations of an inertial frame below this are ignored (rad)."""


@dataclass(slots=True)
class LinkParts:
    """Reads links; ``remarks`` collects what cannot be carried over.

    If there is a ``density`` (kg/m^3), links without mass get the mass of their shapes.
    """

    robot: UrdfRobot
    meshes: BodyMeshes
    density: float | None
    remarks: list[str]
    massless: list[str] = field(default_factory=list)
    plain_looks: list[str] = field(default_factory=list)

    def bodies(self, name: str, frame: str) -> Iterator[Body]:
        """The body of a link in the frame of the given name.

        Raises:
            UsageFault: the mass or a principal moment of inertia is negative, or the inertia is
                missing.
        """
        link = self.robot.links[name]
        inertial = link.inertial
        if inertial is None or not inertial.mass:
            if inertial is not None and inertial.inertia is not None and np.any(inertial.inertia):
                self.remarks.append(
                    f"link `{visible(name)}` has moments of inertia and no mass: they are left out"
                )
            yield from self._of_density(link, frame)
            return
        element = self.robot.elements["link", name].find("inertial")
        if element is None or inertial.inertia is None:
            message = f"link `{visible(name)}` has a mass and no inertia"
            raise self.robot.fault("link", name, message)
        tensor = np.asarray(inertial.inertia, dtype=float)
        self._check(name, float(inertial.mass), tensor)
        steps = self.robot.steps(element)
        turned = any(isinstance(step, Turn) and abs(step.angle) > NOISE for step in steps)
        com = steps[0].by if steps and isinstance(steps[0], Move) else (0.0, 0.0, 0.0)
        xx, yy, zz = (float(value) for value in np.diagonal(tensor))
        six = (xx, yy, zz, float(tensor[0, 1]), float(tensor[0, 2]), float(tensor[1, 2]))
        if turned:
            yield Body(Placement(frame, steps), float(inertial.mass), (0.0, 0.0, 0.0), six)
        else:
            yield Body(Placement(frame), float(inertial.mass), com, six)

    def _check(self, name: str, mass: float, tensor: np.ndarray) -> None:
        said = f"link `{visible(name)}`"
        if mass < 0:
            raise self.robot.fault("link", name, f"{said} has the mass {mass:g} kg, below 0")
        moments = np.linalg.eigvalsh(tensor)
        if moments[0] < -1e-12 * max(1.0, abs(moments[2])):
            message = f"{said} has the principal moment {moments[0]:.3g} kg*m^2, which no body has"
            raise self.robot.fault("link", name, message)
        if moments[0] + moments[1] < moments[2] * (1 - 1e-9):
            self.remarks.append(
                f"{said}: no body has such moments of inertia (the two smaller principal ones are "
                "less than the third together); they are written as they are"
            )

    def _of_density(self, link: Link, frame: str) -> Iterator[Body]:
        """The body of a link from its collision shapes, if there is a density."""
        element = self.robot.elements["link", link.name]
        found = list[Moments]()
        if self.density is not None:
            for shape, written in zip(link.collisions, element.findall("collision"), strict=True):
                steps = self.robot.steps(written)
                moments = self._moments(shape, round_ends=_is_capsule(written))
                if moments is not None:
                    found.append(moments.placed(steps).times(self.density))
        if not found:
            self.massless.append(link.name)
            return
        whole = sum(found[1:], start=found[0])
        yield Body(Placement(frame), whole.mass, whole.com, whole.six, "of its shapes")

    def _moments(self, shape: Collision, *, round_ends: bool) -> Moments | None:
        geometry = shape.geometry
        if geometry.mesh is not None:
            return self.meshes.moments(geometry.mesh.filename, _scale(geometry.mesh))
        return moments_of_shape(geometry, round_ends=round_ends)

    # --- Shapes -----------------------------------------------------------------------------------

    def shapes(self, name: str, frame: str) -> Iterator[Shape]:
        """The collision shapes of a link, and its meshes for pictures."""
        link = self.robot.links[name]
        element = self.robot.elements["link", name]
        for shape, written in zip(link.collisions, element.findall("collision"), strict=True):
            place = Placement(frame, self.robot.steps(written))
            yield from self._shape(name, shape, place, round_ends=_is_capsule(written))
        for look, written in zip(link.visuals, element.findall("visual"), strict=True):
            yield from self._visual(name, look, Placement(frame, self.robot.steps(written)))

    def _shape(
        self, link: str, shape: Collision, place: Placement, *, round_ends: bool
    ) -> Iterator[Shape]:
        geometry = shape.geometry
        if geometry.box is not None:
            x, y, z = (float(value) for value in geometry.box.size)
            yield Shape("box", place, (x, y, z))
        elif geometry.sphere is not None:
            yield Shape("sphere", place, (float(geometry.sphere.radius),))
        elif geometry.cylinder is not None:
            radius, length = float(geometry.cylinder.radius), float(geometry.cylinder.length)
            below = Placement(place.base, joined(place.steps, (Move((0.0, 0.0, -length / 2)),)))
            yield Shape("capsule" if round_ends else "cylinder", below, (radius, length))
        elif geometry.mesh is not None:
            mesh = geometry.mesh
            yield from self.meshes.hulls(link, mesh.filename, _scale(mesh), place)

    def _visual(self, link: str, look: Visual, place: Placement) -> Iterator[Shape]:
        if look.geometry.mesh is not None:
            mesh = look.geometry.mesh
            yield from self.meshes.visual(link, mesh.filename, _scale(mesh), place)
        else:
            self.plain_looks.append(link)


def _is_capsule(written: Element) -> bool:
    """Whether a shape is a capsule; its length excludes the half-balls at its ends."""
    return written.find("geometry/capsule") is not None


def _scale(mesh: Mesh) -> tuple[float, float, float]:
    """The scale factors of a mesh along its axes."""
    if mesh.scale is None:
        return (1.0, 1.0, 1.0)
    values = np.broadcast_to(np.asarray(mesh.scale, dtype=float), (3,))
    return (float(values[0]), float(values[1]), float(values[2]))

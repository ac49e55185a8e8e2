"""Read geometries of SDF as shapes."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np

from srgc.imports.meshes.exact_places import ExactPlaces, exact_decimal
from srgc.imports.meshes.mesh import Mesh
from srgc.imports.meshes.mesh_file import SUFFIXES, read_mesh
from srgc.imports.meshes.mesh_limits import LARGEST, scaled_within
from srgc.imports.plain_numbers import plain_number
from srgc.imports.scenes.scene import (
    BallShape,
    BoxShape,
    Fault,
    MeshShape,
    PointsShape,
    Pose,
    RodShape,
    Scene,
    Shape,
    cone_points,
    ellipsoid_points,
    positive,
)
from srgc.imports.scenes.sdf_frames import is_true
from srgc.imports.source_fault import SourceFault
from srgc.imports.source_files import SourceFiles
from srgc.imports.xml_source import Element, XmlFile


class Geometries:
    """Reads geometries; meshes are below the folder of the file, or in the given packages."""

    def __init__(self, scene: Scene, files: SourceFiles) -> None:
        self.scene, self.files, self.folder = scene, files, files.folder

    def of(
        self, geometry: Element | None, name: str, pose: Pose, file: XmlFile
    ) -> Iterator[tuple[Shape, Pose, str]]:
        """The shapes of a geometry of ``file``, their poses in it, and notes on what changed.

        Raises:
            SourceFault: a number is missing or not positive, or a mesh cannot be read.
        """
        kinds = [] if geometry is None else [each for each in geometry if isinstance(each.tag, str)]
        if not kinds or kinds[0].tag == "empty":
            self.scene.dropped.append(f"{name}: an empty geometry")
            return
        for other in kinds[1:]:
            self.scene.dropped.append(f"{name}: a second shape in one geometry, {other.tag}")
        element = kinds[0]
        fault = partial(_fault, file, element, name)
        if element.tag == "mesh":
            yield from self._mesh(element, name, fault)
        elif element.tag == "plane":
            self._plane(element, name, pose, fault)
        elif element.tag == "polyline":
            yield _polyline(element, fault), Pose(), ""
        else:
            found = _simple(element, fault)
            if found is None:
                self.scene.dropped.append(f"{name}: a {element.tag} is not a known shape")
            else:
                yield found[0], Pose(), found[1]

    def _plane(self, element: Element, name: str, pose: Pose, fault: Fault) -> None:
        normal = pose.turn @ np.array(_numbers(element, "normal", 3, fault, "0 0 1"))
        self.scene.plane(name, normal, pose.shift)

    def _mesh(self, element: Element, name: str, fault: Fault) -> Iterator[tuple[Shape, Pose, str]]:
        uri = (element.findtext("uri") or "").strip()
        scale = _numbers(element, "scale", 3, fault, "1 1 1")
        if Path(uri).suffix.lower() not in SUFFIXES:
            self.scene.dropped.append(f"{name}: its mesh {uri or '(without an address)'}")
            return
        path = self.files.path_of(uri, self.folder)
        mesh = read_mesh(path, own_axes=True)
        part = element.find("submesh")
        if part is not None:
            wanted = (part.findtext("name") or "").strip()
            objects = [each for each in mesh.objects if each.name == wanted]
            if not objects:
                self.scene.dropped.append(f"{name}: {path.name} has no part `{wanted}`")
                return
            mesh = mesh.part(objects[0])
            if is_true(part.findtext("center")):
                mesh = mesh.moved(mesh.exact().placed(np.eye(3), _to_middle(mesh)))
        self.scene.dropped += mesh.notes
        if 0 in scale:
            raise fault("a scale of its mesh is zero")
        words = (element.findtext("scale") or "1 1 1").split()
        try:
            factors = [exact_decimal(word) for word in words]
        except ValueError as error:
            raise fault(f"its scale has {error}") from None
        yield MeshShape(scaled_within(mesh, factors, fault), path.name), Pose(), ""


def _to_middle(mesh: Mesh) -> list[Fraction]:
    """The translation that moves the centre of a mesh's bounding box, as Gazebo has it, to 0."""
    places, found = mesh.exact(), list[Fraction]()
    for axis, column in enumerate(mesh.vertices.T):
        low, high = (places.of(int(i))[axis] for i in (column.argmin(), column.argmax()))
        found.append(-(low + high) / 2)
    return found


def _fault(file: XmlFile, element: Element, name: str, said: str) -> SourceFault:
    return file.fault(element, f"{name}: {said}")


def _simple(element: Element, fault: Fault) -> tuple[Shape, str] | None:
    if element.tag == "box":
        x, y, z = _sizes(element, "size", 3, fault)
        return BoxShape((x, y, z)), ""
    if element.tag == "sphere":
        return BallShape(_sizes(element, "radius", 1, fault)[0]), ""
    if element.tag in {"cylinder", "capsule", "cone"}:
        radius, length = (_sizes(element, tag, 1, fault)[0] for tag in ("radius", "length"))
        if element.tag == "cone":
            return PointsShape(cone_points(radius, length)), "a cone: a pyramid about it"
        return RodShape(element.tag, radius, length), ""
    if element.tag == "ellipsoid":
        radii = _sizes(element, "radii", 3, fault)
        return PointsShape(ellipsoid_points(radii)), "an ellipsoid: a polytope about it"
    return None


def _polyline(element: Element, fault: Fault) -> Shape:
    """A polygon extruded upwards from its plane."""
    from trimesh.creation import extrude_triangulation

    from srgc.imports.scenes.polygons import triangulated

    (height,) = _sizes(element, "height", 1, fault)
    points = [_parsed(point.text or "", 2, "a point", fault) for point in element.findall("point")]
    if np.abs(points).max(initial=0.0) >= LARGEST:
        raise fault(f"a point is {LARGEST:g} m away or farther")
    corners, triangles = triangulated(points, fault)
    solid = extrude_triangulation(corners, triangles, height)
    vertices = np.asarray(solid.vertices, dtype=np.float64)
    faces = np.asarray(solid.faces, dtype=np.int64)
    return MeshShape(Mesh(vertices, faces, places=ExactPlaces(vertices)), "a polyline")


def _sizes(element: Element, tag: str, count: int, fault: Fault) -> list[float]:
    found = _numbers(element, tag, count, fault)
    positive(found, fault)
    return found


def _numbers(
    element: Element, tag: str, count: int, fault: Fault, default: str = ""
) -> list[float]:
    text = element.findtext(tag) or default
    return _parsed(text, count, f"the {tag} of its {element.tag}", fault)


def _parsed(text: str, count: int, what: str, fault: Fault) -> list[float]:
    try:
        found = [plain_number(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != count or not np.isfinite(found).all():
        raise fault(f"{what} is not a list of {count} finite numbers: `{text.strip()[:40]}`")
    return found

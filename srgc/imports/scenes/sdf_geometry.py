"""The geometries of SDF as shapes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from srgc.faults import UsageFault
from srgc.imports.limited_files import FileTree, Xml
from srgc.imports.meshes.mesh import Mesh
from srgc.imports.meshes.mesh_file import SUFFIXES, read_mesh
from srgc.imports.scenes.scene import (
    BallShape,
    BoxShape,
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


class Geometries:
    """Reads geometries; meshes are below the folder of the file, or in packages that were named."""

    def __init__(self, scene: Scene, tree: FileTree) -> None:
        self.scene, self.tree, self.folder = scene, tree, tree.root

    def of(self, geometry: Xml | None, name: str, pose: Pose) -> Iterator[tuple[Shape, Pose, str]]:
        """The shapes of a geometry, where they are in it, and what is to be said of them.

        Raises:
            UsageFault: a number is missing or not positive, or a mesh cannot be read.
        """
        kinds = [] if geometry is None else [each for each in geometry if isinstance(each.tag, str)]
        if not kinds or kinds[0].tag == "empty":
            self.scene.dropped.append(f"{name}: an empty geometry")
            return
        element = kinds[0]
        if element.tag == "mesh":
            yield from self._mesh(element, name)
        elif element.tag == "plane":
            self._plane(element, name, pose)
        elif element.tag == "polyline":
            yield _polyline(element, name), Pose(), ""
        else:
            found = _simple(element, name)
            if found is None:
                self.scene.dropped.append(f"{name}: a {element.tag} is no shape that is known")
            else:
                yield found[0], Pose(), found[1]

    def _plane(self, element: Xml, name: str, pose: Pose) -> None:
        normal = pose.turn @ np.array(_numbers(element, "normal", 3, name, "0 0 1"))
        self.scene.plane(name, normal, pose.shift)

    def _mesh(self, element: Xml, name: str) -> Iterator[tuple[Shape, Pose, str]]:
        uri = (element.findtext("uri") or "").strip()
        scale = np.array(_numbers(element, "scale", 3, name, "1 1 1"))
        path = self._found(uri)
        if path is None:
            self.scene.dropped.append(
                f"{name}: its mesh {uri or '(without an address)'} is nowhere"
            )
            return
        mesh = read_mesh(path)
        part = element.find("submesh")
        if part is not None:
            wanted = (part.findtext("name") or "").strip()
            objects = [each for each in mesh.objects if each.name == wanted]
            if not objects:
                self.scene.dropped.append(f"{name}: {path.name} has no part `{wanted}`")
                return
            mesh = mesh.part(objects[0])
        self.scene.dropped += mesh.notes
        if not np.isfinite(scale).all() or (scale == 0).any():
            raise UsageFault(f"{name}: a scale of its mesh is zero or not finite")
        triangles = mesh.triangles[:, ::-1] if np.prod(scale) < 0 else mesh.triangles
        yield MeshShape(Mesh(mesh.vertices * scale, triangles), path.name), Pose(), ""

    def _found(self, uri: str) -> Path | None:
        """The mesh of an address: beside the file that names it, or below the tree."""
        for reference in (uri, str(self.folder / uri)):
            if Path(uri).suffix.lower() not in SUFFIXES:
                return None
            try:
                return self.tree.found(reference)
            except UsageFault as fault:
                if "leads out of" in str(fault) or "network" in str(fault):
                    raise
        return None


def _simple(element: Xml, name: str) -> tuple[Shape, str] | None:
    if element.tag == "box":
        x, y, z = _sizes(element, "size", 3, name)
        return BoxShape((x, y, z)), ""
    if element.tag == "sphere":
        return BallShape(_sizes(element, "radius", 1, name)[0]), ""
    if element.tag in {"cylinder", "capsule", "cone"}:
        radius, length = (_sizes(element, tag, 1, name)[0] for tag in ("radius", "length"))
        if element.tag == "cone":
            return PointsShape(cone_points(radius, length)), "a cone: a pyramid about it"
        return RodShape(element.tag, radius, length), ""
    if element.tag == "ellipsoid":
        radii = _sizes(element, "radii", 3, name)
        return PointsShape(ellipsoid_points(radii)), "an ellipsoid: a polytope about it"
    return None


def _polyline(element: Xml, name: str) -> Shape:
    """A polygon that is extruded upwards from its plane."""
    from trimesh.creation import extrude_triangulation

    from srgc.imports.scenes.polygons import triangulated

    (height,) = _sizes(element, "height", 1, name)
    points = [
        _parsed(point.text or "", 2, f"{name}: a point") for point in element.findall("point")
    ]
    corners, triangles = triangulated(points, name)
    solid = extrude_triangulation(corners, triangles, height)
    return MeshShape(
        Mesh(np.asarray(solid.vertices, dtype=np.float64), np.asarray(solid.faces, dtype=np.int64)),
        "a polyline",
    )


def _sizes(element: Xml, tag: str, count: int, name: str) -> list[float]:
    found = _numbers(element, tag, count, name)
    positive(found, f"{name}: the {tag} of its {element.tag}")
    return found


def _numbers(element: Xml, tag: str, count: int, name: str, default: str = "") -> list[float]:
    text = element.findtext(tag) or default
    return _parsed(text, count, f"{name}: the {tag} of its {element.tag}")


def _parsed(text: str, count: int, what: str) -> list[float]:
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != count or not np.isfinite(found).all():
        raise UsageFault(f"{what} is no list of {count} finite numbers: `{text.strip()[:40]}`")
    return found

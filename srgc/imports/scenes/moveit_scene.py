"""Read the text format of MoveIt's planning scenes, as ``saveGeometryToStream`` writes it.

Source: moveit_core, ``planning_scene.cpp``, and geometric_shapes, ``shape_operations.cpp``.  Since
MoveIt 1.1 objects have their own pose and subframes.  In older files the number of shapes follows
the name of the first object.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.source import Source
from srgc.imports.meshes.exact_places import ExactPlaces, longer_decimals
from srgc.imports.meshes.mesh import Mesh
from srgc.imports.meshes.mesh_limits import LARGEST, too_many
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
    SceneObject,
    Shape,
    cone_points,
    positive,
    quaternion_pose,
)
from srgc.imports.source_fault import SourceFault, line_span
from srgc.imports.source_files import source_bytes

MOST_SHAPES = 10_000


class _Lines:
    """The lines of a file, the index of the next one, and the words of the numbers read last."""

    def __init__(self, path: Path) -> None:
        text = source_bytes(path).decode("utf-8-sig", errors="replace")
        text = text.replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n")
        self.path, self.source = path, Source(str(path), text)
        self.rows, self.at = text.split("\n"), 0
        self.words: list[str] = []

    def fault(self, said: str) -> SourceFault:
        span = line_span(self.source.text, min(self.at, len(self.rows)) or 1)
        return SourceFault(Code.FOREIGN_CONTENT, said, self.source, span)

    def fault_of(self, what: str) -> Fault:
        """A function that makes faults about ``what`` at the line read last."""
        return lambda said: self.fault(f"{what}: {said}")

    def line(self, due: str) -> str:
        if self.at >= len(self.rows):
            raise self.fault(f"the file ends where {due} is expected; was it cut off?")
        self.at += 1
        return self.rows[self.at - 1].strip()

    def peeked(self) -> str:
        return self.rows[self.at].strip() if self.at < len(self.rows) else ""

    def numbers(self, count: int, due: str) -> list[float]:
        """Read ``count`` finite numbers, which may be on several lines."""
        found = list[float]()
        self.words = []
        while len(found) < count:
            words = self.line(due).split()
            self.words += words
            try:
                found += [plain_number(word) for word in words]
            except ValueError:
                raise self.fault(f"{due} is expected, and no numbers stand here") from None
        if len(found) != count or not np.isfinite(found).all():
            raise self.fault(f"{due} is expected: {count} finite numbers")
        return found

    def count(self, due: str) -> int:
        (number,) = self.numbers(1, due)
        if number != int(number) or not 0 <= number <= 2**31:
            raise self.fault(f"{due} is expected: a number of things")
        return int(number)

    def pose(self, what: str) -> Pose:
        shift = self.numbers(3, f"the place of {what}")
        words = self.words
        turn = self.numbers(4, f"the quaternion of {what}")
        return quaternion_pose(shift, turn, self.fault_of(what), words)


def moveit_scene(path: Path) -> Scene:
    """The objects of a ``.scene`` file.

    Raises:
        SourceFault: the file is not a scene or was cut off; the fault names the line.
    """
    lines = _Lines(path)
    scene = Scene(lines.line("the name of the scene") or path.stem)
    new: bool | None = None
    while (head := lines.line("`*` with an object, or `.`")) != ".":
        if not head.startswith("*"):
            raise lines.fault(f"`* NAME` or `.` is expected, not `{head[:40]}`")
        name = head[1:].strip() or "object"
        new = len(lines.peeked().split()) == 3 if new is None else new
        _object(lines, scene, name, own_pose=new)
        if len(scene.objects) > MOST_SHAPES:
            raise lines.fault(f"there are more than {MOST_SHAPES:,} shapes")
    if any(map(str.strip, lines.rows[lines.at :])):
        scene.dropped.append("what stands behind the `.`, where the scene ends")
    return scene


def _object(lines: _Lines, scene: Scene, name: str, *, own_pose: bool) -> None:
    outer = lines.pose(name) if own_pose else Pose()
    count = lines.count(f"the number of shapes of {name}")
    for number in range(count):
        called = name if count == 1 else f"{name}_{number + 1}"
        kind = lines.line(f"a shape of {name}")
        found = _shape(lines, kind, called)
        pose = outer.then(lines.pose(called))
        lines.numbers(4, f"the colour of {called}")
        if isinstance(found, list):
            normal = np.array(found[:3])
            size = float(normal @ normal) or 1.0
            scene.plane(called, pose.turn @ normal, pose.of(-found[3] / size * normal[None])[0])
        else:
            shape, note = found
            scene.objects.append(SceneObject(called, shape, pose, note))
    if own_pose:
        subframes = lines.count(f"the number of subframes of {name}")
        for _ in range(subframes):
            frame = lines.line(f"a subframe of {name}")
            lines.pose(frame)
        if subframes:
            which = "a subframe, which is not an obstacle"
            if subframes > 1:
                which = f"{subframes} subframes, which are no obstacles"
            scene.dropped.append(f"{name}: {which}")


def _shape(lines: _Lines, kind: str, what: str) -> tuple[Shape, str] | list[float]:
    """A shape and a note on it, or the a, b, c, d of a plane ax + by + cz + d = 0."""
    fault = lines.fault_of(what)
    if kind == "box":
        x, y, z = lines.numbers(3, f"the edges of {what}")
        positive((x, y, z), fault)
        return BoxShape((x, y, z)), ""
    if kind == "sphere":
        (radius,) = lines.numbers(1, f"the radius of {what}")
        positive((radius,), fault)
        return BallShape(radius), ""
    if kind in {"cylinder", "cone"}:
        radius, length = lines.numbers(2, f"the radius and length of {what}")
        positive((radius, length), fault)
        if kind == "cylinder":
            return RodShape("cylinder", radius, length), ""
        return PointsShape(cone_points(radius, length)), "a cone: a pyramid about it"
    if kind == "plane":
        return lines.numbers(4, f"the plane of {what}")
    if kind == "mesh":
        return MeshShape(_mesh(lines, what), lines.path.name), ""
    raise lines.fault(
        f"`{kind[:40]}` is not a known shape: box, sphere, cylinder, cone, plane, mesh"
    )


def _mesh(lines: _Lines, what: str) -> Mesh:
    corners, count = (int(x) for x in lines.numbers(2, f"the vertices and triangles of {what}"))
    too_many(max(count, corners // 3), lines.path)
    if corners < 3 or count < 1:
        raise lines.fault(f"the mesh of {what} has no triangle")
    vertices, words = list[list[float]](), list[list[str]]()
    for _ in range(corners):
        vertices.append(lines.numbers(3, f"a vertex of {what}"))
        words.append(lines.words)
    triangles = [lines.numbers(3, f"a triangle of {what}") for _ in range(count)]
    numbers = np.array(triangles)
    if (numbers < 0).any() or (numbers >= corners).any() or (numbers % 1).any():
        raise lines.fault(f"a triangle of {what} names a vertex that is not there")
    if np.abs(vertices).max() >= LARGEST:
        raise lines.fault(f"a vertex of {what} is {LARGEST:g} m away or farther")
    places = np.array(vertices)
    longer = longer_decimals(words, places, lines.fault)
    return Mesh(places, numbers.astype(np.int64), places=ExactPlaces(places, longer=longer))

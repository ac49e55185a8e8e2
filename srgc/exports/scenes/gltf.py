"""Write a scene as binary glTF 2.0: a node for each link within its parent's, and an animation.

Source: the Khronos specification of glTF 2.0.  Its y axis is up; the world of a robot has z up, so
it is a rotated node.  The animation moves joints: between two instants a joint rotates about its
axis, so links keep their lengths.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from compiler.arrays import Array
from srgc.exports.exported_robot import origin
from srgc.exports.scenes.design_scene import (
    LINKS,
    REGIONS,
    SEEN_THROUGH,
    Colour,
    DesignScene,
    SceneRegion,
)
from srgc.exports.scenes.link_motion import Poses, plain_pose
from srgc.exports.scenes.triangles import Triangles
from srgc.faults import UsageFault
from srgc.version import VERSION

FLOAT, UNSIGNED = 5126, 5125
"""Component types: float and unsigned int, of four bytes each."""
CORNERS, INDICES = 34962, 34963
"""The targets of buffer views: ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER."""
SHAPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
MAGIC, VERSION_2, JSON_CHUNK, BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942
UPRIGHT = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
"""The quaternion (x, y, z, w) that rotates z up to y up."""
ROUGH = 0.7


def gltf_bytes(scene: DesignScene) -> bytes:
    """The scene as a ``.glb`` file with the robot at its start; lengths are in metres.

    Raises:
        UsageFault: a length is too large for single precision.
    """
    return _Writer(scene).document()


@dataclass
class _Writer:
    scene: DesignScene
    binary: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)
    materials: list[dict[str, Any]] = field(default_factory=list)
    meshes: list[dict[str, Any]] = field(default_factory=list)
    nodes: list[dict[str, Any]] = field(default_factory=list)

    def document(self) -> bytes:
        world = self.node("world", rotation=UPRIGHT)
        links = self.links(world)
        self.effectors(links)
        regions = self.node("regions")
        self.child(world, regions)
        for region in self.scene.regions:
            self.child(regions, self.region(region))
        content: dict[str, Any] = {
            "asset": {
                "version": "2.0",
                "generator": f"srgc {VERSION}",
                "extras": {"about": list(origin(self.scene.design))},
            },
            "scene": 0,
            "scenes": [{"name": self.scene.robot.name, "nodes": [world]}],
            "nodes": self.nodes,
        }
        animation = self.animation(links)
        content |= {"animations": [animation]} if animation["channels"] else {}
        lists = {"meshes": self.meshes, "materials": self.materials, "accessors": self.accessors}
        content |= {key: value for key, value in lists.items() if value}
        if self.binary:
            content |= {
                "bufferViews": self.views,
                "buffers": [{"byteLength": len(self.binary)}],
            }
        return _glb(content, bytes(self.binary))

    def node(self, name: str, **more: object) -> int:
        self.nodes.append({"name": name, **more})
        return len(self.nodes) - 1

    def child(self, parent: int, node: int) -> None:
        self.nodes[parent].setdefault("children", []).append(node)

    def links(self, world: int) -> list[int]:
        """Add the nodes of all links at the start, each within the node of its parent link."""
        robot, found = self.scene.robot, list[int]()
        for number, link in enumerate(robot.tree.links):
            place = _place(_at(self.scene.motion.joints, 0, number))
            surfaces = [each.surface for each in self.scene.drawn if each.link == number]
            name, colour = robot.names.links[number], LINKS[number % len(LINKS)]
            # It is not known which side of a visual is outside.
            both = number in self.scene.with_visuals
            mesh = self.mesh(name, surfaces, colour, 1.0, double_sided=both)
            found.append(self.node(name, **place, **mesh))
            self.child(world if link.joint is None else found[link.joint.parent], found[-1])
        return found

    def effectors(self, links: list[int]) -> None:
        robot = self.scene.robot
        for name, frame in zip(robot.names.effectors, robot.tree.effectors, strict=True):
            self.child(links[frame.link], self.node(name, **_place(plain_pose(frame.pose))))

    def region(self, region: SceneRegion) -> int:
        colour = REGIONS.get(region.kind, REGIONS["region"])
        mesh = self.mesh(region.name, [region.surface], colour, SEEN_THROUGH, double_sided=True)
        return self.node(region.name, **mesh)

    def mesh(
        self,
        name: str,
        surfaces: list[Triangles],
        colour: Colour,
        opacity: float,
        *,
        double_sided: bool,
    ) -> dict[str, int]:
        """The entry of a node for its mesh; empty if there are no surfaces."""
        surfaces = [surface for surface in surfaces if len(surface.faces)]
        if not surfaces:
            return {}
        material = self.material(colour, opacity, double_sided=double_sided)
        primitives = [
            {
                "attributes": {"POSITION": self.accessor(surface.corners, CORNERS)},
                "indices": self.accessor(surface.faces.reshape(-1, 1), INDICES),
                "material": material,
            }
            for surface in surfaces
        ]
        self.meshes.append({"name": name, "primitives": primitives})
        return {"mesh": len(self.meshes) - 1}

    def material(self, colour: Colour, opacity: float, *, double_sided: bool) -> int:
        factor = [round((part / 255) ** 2.2, 4) for part in colour]  # glTF has linear colours
        material: dict[str, Any] = {
            "pbrMetallicRoughness": {
                "baseColorFactor": [*factor, opacity],
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGH,
            }
        }
        if opacity < 1:
            material["alphaMode"] = "BLEND"
        if double_sided:
            material["doubleSided"] = True
        if material not in self.materials:
            self.materials.append(material)
        return self.materials.index(material)

    def accessor(self, rows: Array | Any, target: int | None = None) -> int:
        """Add numbers (m, c) to the buffer; all but indices get bounds for each column."""
        index = target == INDICES
        with np.errstate(over="ignore"):
            values = np.ascontiguousarray(rows, dtype="<u4" if index else "<f4")
        if not np.isfinite(values).all():
            raise UsageFault("a length is too large for glTF, whose numbers are single precision")
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.binary)}
        view |= {"byteLength": values.nbytes}
        view |= {"target": target} if target is not None else {}
        self.binary += values.tobytes()
        self.views.append(view)
        accessor: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": UNSIGNED if index else FLOAT,
            "count": len(values),
            "type": SHAPES[values.shape[1]],
        }
        if not index:
            accessor |= {
                "min": values.min(axis=0).astype(float).tolist(),
                "max": values.max(axis=0).astype(float).tolist(),
            }
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def animation(self, links: list[int]) -> dict[str, Any]:
        """The animation of the joints, linear (spherical for rotations) between instants."""
        scene = self.scene
        channels, samplers = list[dict[str, Any]](), list[dict[str, Any]]()
        carried = scene.robot.tree.carried() if len(scene.times) > 1 else ()
        times = np.array([[float(time)] for time in scene.times])
        clock = self.accessor(times) if carried else 0
        for number, joint in carried:
            if joint.kind == "prismatic":
                path, rows = "translation", scene.motion.joints.origins[:, number]
            else:
                path, rows = "rotation", _smooth(_at(scene.motion.joints, slice(None), number))
            samplers.append(
                {"input": clock, "interpolation": "LINEAR", "output": self.accessor(rows)}
            )
            channels.append(
                {"sampler": len(samplers) - 1, "target": {"node": links[number], "path": path}}
            )
        return {"name": "motion", "channels": channels, "samplers": samplers}


def _at(poses: Poses, instant: int | slice, number: int) -> Poses:
    return Poses(poses.turns[instant, number], poses.origins[instant, number])


def _place(pose: Poses) -> dict[str, Any]:
    """The entries of a node for its pose."""
    w, x, y, z = pose.quaternions().tolist()
    return {"translation": pose.origins.tolist(), "rotation": [x, y, z, w]}


def _smooth(poses: Poses) -> Array:
    """Quaternions (K, 4) as (x, y, z, w), with signs chosen so that neighbours are close."""
    turns = poses.quaternions()[:, [1, 2, 3, 0]]
    jumps = np.einsum("ij,ij->i", turns[1:], turns[:-1]) < 0
    signs = np.cumprod(np.where(jumps, -1.0, 1.0))
    turns[1:] *= signs[:, None]
    return turns


def _glb(content: dict[str, Any], binary: bytes) -> bytes:
    """The container: a header, the JSON and the buffer, padded to multiples of four bytes."""
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()
    chunks = _chunk(JSON_CHUNK, text, b" ")
    if binary:
        chunks += _chunk(BINARY_CHUNK, binary, b"\0")
    return struct.pack("<3I", MAGIC, VERSION_2, 12 + len(chunks)) + chunks


def _chunk(kind: int, content: bytes, filling: bytes) -> bytes:
    padded = content + filling * (-len(content) % 4)
    return struct.pack("<2I", len(padded), kind) + padded

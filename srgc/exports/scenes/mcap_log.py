"""Write the planned motion as a log: an MCAP file with JSON messages, for Foxglove.

Source: the MCAP specification (mcap.dev).  Times are those of the task, from 0 s on.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from compiler.arrays import Array
from compiler.rigid_links.link_shape import Geometry
from srgc.exports.exported_motion import ExportedMotion
from srgc.exports.exported_robot import origin
from srgc.exports.scenes.design_scene import (
    LINKS,
    REGIONS,
    SEEN_THROUGH,
    Colour,
    DesignScene,
    LinkShape,
)
from srgc.exports.scenes.foxglove_schemas import SCHEMAS, efforts_schema, schema_bytes
from srgc.exports.scenes.link_motion import Poses
from srgc.exports.scenes.triangles import Triangles
from srgc.exports.urdf import urdf_text
from srgc.faults import UsageFault
from srgc.version import VERSION

INSTALL = 'a log needs the library mcap: pip install "srgc[log]"'
NANO = 10**9
WORLD = "world"
MOST_SECONDS = 2**32
"""Foxglove's times have unsigned 32-bit seconds."""
STILL = {"x": 0.0, "y": 0.0, "z": 0.0}
UNTURNED = {**STILL, "w": 1.0}
Message = tuple[str, Fraction, Mapping[str, Any]]
"""A channel, a time in seconds, and the content."""


@dataclass(frozen=True, slots=True)
class MotionLog:
    """A log file, and notes on what it does not include."""

    content: bytes
    notes: tuple[str, ...]


def mcap_log(scene: DesignScene, motion: ExportedMotion) -> MotionLog:
    """The log of a motion.

    Its channels are ``/robot_description`` (URDF), ``/tf`` (poses of links and effectors in the
    world), ``/joint_states`` and ``/scene`` (shapes and regions) in the schemas of Foxglove, and
    ``/efforts`` with a number for each joint.  Poses are logged at all instants of the scene, joint
    states and efforts at the samples of the task.

    Raises:
        UsageFault: the library is missing, or the motion takes too long.
    """
    if motion.times[-1] >= MOST_SECONDS:
        raise UsageFault(f"a motion of {MOST_SECONDS} s or more cannot be a log")
    try:
        from mcap.writer import CompressionType, Writer
    except ModuleNotFoundError:
        raise UsageFault(INSTALL) from None
    description, notes = _description(scene)
    target = io.BytesIO()
    writer: Any = Writer(target, compression=CompressionType.NONE)
    writer.start(profile="", library=f"srgc {VERSION}")
    about = dict(zip(("robot", "spec", "exported"), origin(scene.design), strict=True))
    writer.add_metadata("srgc", about)
    names = {"/robot_description": "std_msgs/String", "/scene": "foxglove.SceneUpdate"}
    names |= {"/tf": "foxglove.FrameTransforms", "/joint_states": "foxglove.JointStates"}
    schemas = {channel: (name, SCHEMAS[name]) for channel, name in names.items()}
    schemas["/efforts"] = ("srgc.Efforts", efforts_schema(scene.robot.names.joints))
    channels = {}
    for channel, (name, schema) in schemas.items():
        number = writer.register_schema(name, "jsonschema", schema_bytes(schema))
        channels[channel] = writer.register_channel(channel, "json", number)
    sequence = dict.fromkeys(channels, 0)
    for channel, time, content in (*description, *_messages(scene, motion)):
        stamp = round(time * NANO)
        data = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        number = channels[channel]
        writer.add_message(number, stamp, data.encode(), stamp, sequence[channel])
        sequence[channel] += 1
    writer.finish()
    return MotionLog(target.getvalue(), notes)


def _description(scene: DesignScene) -> tuple[tuple[Message, ...], tuple[str, ...]]:
    """The message with the robot, with boxes around hulls, or a note why there is none."""
    try:
        return (("/robot_description", Fraction(0), {"data": urdf_text(scene.robot)}),), ()
    except ValueError as error:
        return (), (f"no /robot_description: {error}",)


def _messages(scene: DesignScene, motion: ExportedMotion) -> Iterator[Message]:
    """All other messages in order of time."""
    yield "/scene", Fraction(0), {"deletions": [], "entities": list(_entities(scene))}
    links, effectors = scene.motion.links, scene.motion.effectors
    turns = {"link": links.quaternions(), "effector": effectors.quaternions()}
    for instant, time in enumerate(scene.times):
        frames = [
            *zip(scene.robot.names.links, links.origins[instant], turns["link"][instant],
                 strict=True),
            *zip(scene.robot.names.effectors, effectors.origins[instant],
                 turns["effector"][instant], strict=True),
        ]  # fmt: skip
        yield "/tf", time, {"transforms": [_transform(time, *frame) for frame in frames]}
        sample, within = divmod(instant, scene.instants.parts)
        if not within:
            yield (
                "/joint_states",
                time,
                {"timestamp": _stamp(time), "joints": _joints(motion, sample)},
            )
            yield "/efforts", time, _by_name(motion, motion.effort[sample])


def _joints(motion: ExportedMotion, sample: int) -> list[dict[str, Any]]:
    columns = {
        "position": motion.position, "velocity": motion.velocity,
        "acceleration": motion.acceleration, "effort": motion.effort,
    }  # fmt: skip
    return [
        {"name": joint.name, **{key: float(table[sample, j]) for key, table in columns.items()}}
        for j, joint in enumerate(motion.joints)
    ]


def _by_name(motion: ExportedMotion, values: Array) -> dict[str, float]:
    return {joint.name: float(value) for joint, value in zip(motion.joints, values, strict=True)}


def _transform(time: Fraction, name: str, place: Array, turn: Array) -> dict[str, Any]:
    return {
        "timestamp": _stamp(time), "parent_frame_id": WORLD, "child_frame_id": name,
        "translation": _vector(place), "rotation": _quaternion(turn),
    }  # fmt: skip


def _stamp(time: Fraction) -> dict[str, int]:
    seconds, nanoseconds = divmod(round(time * NANO), NANO)
    return {"sec": seconds, "nsec": nanoseconds}


def _vector(values: Array | Sequence[float]) -> dict[str, float]:
    return dict(zip("xyz", (float(value) for value in values), strict=True))


def _quaternion(turn: Array) -> dict[str, float]:
    w, x, y, z = (float(value) for value in turn)
    return {"x": x, "y": y, "z": z, "w": w}


# --- Drawing --------------------------------------------------------------------------------------


def _entities(scene: DesignScene) -> Iterator[dict[str, Any]]:
    """The shapes of each link in its frame, and the regions in the world."""
    for number, name in enumerate(scene.robot.names.links):
        shapes = [shape for shape in scene.shapes if shape.link == number]
        colour = _colour(LINKS[number % len(LINKS)], 1.0)
        primitives: dict[str, list[Any]] = {}
        for shape in shapes:
            for kind, primitive in _primitives(shape, colour):
                primitives.setdefault(kind, []).append(primitive)
        if primitives:
            yield _entity(name, name, primitives)
    for region in scene.regions:
        colour = _colour(REGIONS.get(region.kind, REGIONS["region"]), SEEN_THROUGH)
        triangles = _triangles(region.surface, colour)
        yield _entity(WORLD, f"{region.kind} {region.name}", {"triangles": [triangles]})


def _entity(frame: str, name: str, primitives: Mapping[str, list[Any]]) -> dict[str, Any]:
    kinds = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
    return {
        "timestamp": {"sec": 0, "nsec": 0}, "frame_id": frame, "id": name,
        "lifetime": {"sec": 0, "nsec": 0}, "frame_locked": True, "metadata": [],
        **{kind: primitives.get(kind, []) for kind in kinds},
    }  # fmt: skip


def _primitives(shape: LinkShape, colour: dict[str, float]) -> Iterator[tuple[str, dict[str, Any]]]:
    """A shape as primitives of Foxglove; a capsule is a cylinder and two spheres."""
    size, pose = shape.shape.size, _pose(shape.pose)
    match shape.shape.kind:
        case "box":
            yield "cubes", {"pose": pose, "size": _vector(size), "color": colour}
        case "sphere":
            yield "spheres", {"pose": pose, "size": _vector(_wide(size[0])), "color": colour}
        case "cylinder" | "capsule":
            radius, length = size
            yield "cylinders", {
                "pose": pose, "size": _vector((2 * radius, 2 * radius, length)),
                "bottom_scale": 1.0, "top_scale": 1.0, "color": colour,
            }  # fmt: skip
            if shape.shape.kind == "capsule":
                for end in _ends(shape.shape, shape.pose):
                    yield "spheres", {"pose": end, "size": _vector(_wide(radius)), "color": colour}
        case "hull":
            yield "triangles", _triangles(shape.surface, colour)


def _ends(shape: Geometry, pose: Poses) -> list[dict[str, Any]]:
    half = shape.size[1] / 2
    return [_pose(Poses(pose.turns, pose.origins + side * half * pose.turns[:, 2]))
            for side in (-1, 1)]  # fmt: skip


def _wide(radius: float) -> tuple[float, float, float]:
    return 2 * radius, 2 * radius, 2 * radius


def _pose(pose: Poses) -> dict[str, Any]:
    return {
        "position": _vector(pose.origins),
        "orientation": _quaternion(pose.quaternions()),
    }


def _triangles(surface: Triangles, colour: dict[str, float]) -> dict[str, Any]:
    return {
        "pose": {"position": STILL, "orientation": UNTURNED},
        "points": [_vector(corner) for corner in surface.corners],
        "color": colour,
        "colors": [],
        "indices": surface.faces.ravel().tolist(),
    }


def _colour(colour: Colour, opacity: float) -> dict[str, float]:
    r, g, b = (round(part / 255, 4) for part in colour)
    return {"r": r, "g": g, "b": b, "a": opacity}

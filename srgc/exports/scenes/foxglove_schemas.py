"""JSON schemas of the messages in a log, by their names in Foxglove.

Source: the message schemas of the Foxglove SDK; items of unused fields are not specified.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

NUMBER: dict[str, Any] = {"type": "number"}
STRING: dict[str, Any] = {"type": "string"}
ANYTHING: dict[str, Any] = {"type": "array", "items": {"type": "object"}}


def _object(title: str, **fields: Mapping[str, Any]) -> dict[str, Any]:
    """The schema of an object whose fields are all required."""
    return {
        "title": title,
        "type": "object",
        "properties": dict(fields),
        "required": list(fields),
    }


def _list(items: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": dict(items)}


def _clock(title: str, least: Mapping[str, int]) -> dict[str, Any]:
    nanoseconds = {"type": "integer", "minimum": 0, "maximum": 999_999_999}
    return _object(title, sec={"type": "integer", **least}, nsec=nanoseconds)


TIME, DURATION = _clock("time", {"minimum": 0}), _clock("duration", {})
VECTOR = _object("foxglove.Vector3", x=NUMBER, y=NUMBER, z=NUMBER)
POINT = _object("foxglove.Point3", x=NUMBER, y=NUMBER, z=NUMBER)
QUATERNION = _object("foxglove.Quaternion", x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
COLOUR = _object("foxglove.Color", r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)
POSE = _object("foxglove.Pose", position=VECTOR, orientation=QUATERNION)
CUBE = _object("foxglove.CubePrimitive", pose=POSE, size=VECTOR, color=COLOUR)
SPHERE = _object("foxglove.SpherePrimitive", pose=POSE, size=VECTOR, color=COLOUR)
CYLINDER = _object(
    "foxglove.CylinderPrimitive", pose=POSE, size=VECTOR, bottom_scale=NUMBER, top_scale=NUMBER,
    color=COLOUR,
)  # fmt: skip
TRIANGLES = _object(
    "foxglove.TriangleListPrimitive", pose=POSE, points=_list(POINT), color=COLOUR,
    colors=_list(COLOUR), indices=_list({"type": "integer", "minimum": 0}),
)  # fmt: skip
ENTITY = _object(
    "foxglove.SceneEntity", timestamp=TIME, frame_id=STRING, id=STRING, lifetime=DURATION,
    frame_locked={"type": "boolean"},
    metadata=_list(_object("foxglove.KeyValuePair", key=STRING, value=STRING)),
    arrows=ANYTHING, cubes=_list(CUBE), spheres=_list(SPHERE), cylinders=_list(CYLINDER),
    lines=ANYTHING, triangles=_list(TRIANGLES), texts=ANYTHING, models=ANYTHING,
)  # fmt: skip
TRANSFORM = _object(
    "foxglove.FrameTransform", timestamp=TIME, parent_frame_id=STRING, child_frame_id=STRING,
    translation=VECTOR, rotation=QUATERNION,
)  # fmt: skip
JOINT = _object(
    "foxglove.JointState", name=STRING, position=NUMBER, velocity=NUMBER, acceleration=NUMBER,
    effort=NUMBER,
)  # fmt: skip

SCHEMAS: Mapping[str, dict[str, Any]] = {
    "std_msgs/String": _object("std_msgs/String", data=STRING),
    "foxglove.FrameTransforms": _object("foxglove.FrameTransforms", transforms=_list(TRANSFORM)),
    "foxglove.JointStates": _object("foxglove.JointStates", timestamp=TIME, joints=_list(JOINT)),
    "foxglove.SceneUpdate": _object(
        "foxglove.SceneUpdate", deletions=ANYTHING, entities=_list(ENTITY)
    ),
}


def efforts_schema(joints: tuple[str, ...]) -> dict[str, Any]:
    """The schema of motor efforts: a number for each joint, so that each can be plotted."""
    return _object("srgc.Efforts", **dict.fromkeys(joints, NUMBER))


def schema_bytes(schema: Mapping[str, Any]) -> bytes:
    """The bytes of a schema in a log file."""
    return json.dumps(schema, ensure_ascii=False, separators=(",", ":")).encode()

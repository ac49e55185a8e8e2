"""Binary glTF read with nothing but NumPy: what nodes there are, and where they are at a time."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

COMPONENTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
TYPES = {5126: "<f4", 5125: "<u4"}


@dataclass(frozen=True)
class GlbFile:
    """The JSON of a file and its buffer."""

    content: dict[str, Any]
    binary: bytes

    @classmethod
    def read(cls, data: bytes) -> GlbFile:
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        chunks, at = {}, 12
        while at < length:
            size, kind = struct.unpack_from("<I4s", data, at)
            assert size % 4 == 0
            chunks[kind] = data[at + 8 : at + 8 + size]
            at += 8 + size
        return cls(json.loads(chunks[b"JSON"]), chunks.get(b"BIN\0", b""))

    def table(self, accessor: int) -> np.ndarray:
        entry = self.content["accessors"][accessor]
        view = self.content["bufferViews"][entry["bufferView"]]
        count, width = entry["count"], COMPONENTS[entry["type"]]
        values = np.frombuffer(
            self.binary, TYPES[entry["componentType"]], count * width, view["byteOffset"]
        ).reshape(count, width)
        if "min" in entry:
            assert values.min(axis=0).tolist() == single(entry["min"])
            assert values.max(axis=0).tolist() == single(entry["max"])
        return values

    def node(self, name: str) -> int:
        (number,) = (i for i, node in enumerate(self.content["nodes"]) if node["name"] == name)
        return number

    def poses(self, time: float) -> dict[str, np.ndarray]:
        """All nodes as matrices in the scene, by name, while the animation is at a time."""
        local = [self._local(node) for node in self.content["nodes"]]
        for animation in self.content.get("animations", []):
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                assert sampler["interpolation"] == "LINEAR"
                times = self.table(sampler["input"])[:, 0].astype(float)
                rows = self.table(sampler["output"]).astype(float)
                at = float(np.clip(time, times[0], times[-1]))
                target = local[channel["target"]["node"]]
                if channel["target"]["path"] == "rotation":
                    target[:3, :3] = Slerp(times, Rotation.from_quat(rows))(at).as_matrix()
                else:
                    target[:3, 3] = [np.interp(at, times, column) for column in rows.T]
        found: dict[str, np.ndarray] = {}

        def walk(number: int, above: np.ndarray) -> None:
            node = self.content["nodes"][number]
            found[node["name"]] = above @ local[number]
            for child in node.get("children", []):
                walk(child, found[node["name"]])

        for root in self.content["scenes"][self.content["scene"]]["nodes"]:
            walk(root, np.eye(4))
        return found

    @staticmethod
    def _local(node: dict[str, Any]) -> np.ndarray:
        found = np.eye(4)
        found[:3, 3] = node.get("translation", (0, 0, 0))
        found[:3, :3] = Rotation.from_quat(node.get("rotation", (0, 0, 0, 1))).as_matrix()
        return found


def single(values: list[float]) -> list[float]:
    """Numbers of a document as the floats of a buffer."""
    return [float(np.float32(value)) for value in values]

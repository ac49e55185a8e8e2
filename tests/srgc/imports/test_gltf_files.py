"""Binary glTF: as trimesh writes it, by hand, and files that mean harm or were cut off."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from srgc.faults import UsageFault
from srgc.imports.meshes import mesh_limits
from srgc.imports.meshes.mesh_file import read_mesh

Content = dict[str, Any]
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0]], dtype="<f4")


def z_up(points: np.ndarray) -> np.ndarray:
    """The format has y up."""
    x, y, z = points.T
    return np.stack([x, -z, y], axis=1)


def glb(content: Content, binary: bytes = b"") -> bytes:
    """A container, its chunks filled up to whole groups of four bytes."""
    text = json.dumps(content).encode()
    chunks = b""
    for kind, data, filling in ((b"JSON", text, b" "), (b"BIN\0", binary, b"\0")):
        padded = data + filling * (-len(data) % 4)
        chunks += struct.pack("<I4s", len(padded), kind) + padded
    return struct.pack("<4s2I", b"glTF", 2, 12 + len(chunks)) + chunks


def square(mode: int, indices: list[int] | None = None, **node: Any) -> tuple[Content, bytes]:
    """A square in the plane xy of its node, its corners 16 bytes apart behind 4 bytes of others."""
    spread = np.zeros((4, 4), dtype="<f4")
    spread[:, :3] = SQUARE
    numbers = bytes(indices or [])
    binary = b"\xff" * 4 + spread.tobytes() + numbers
    primitive: Content = {"attributes": {"POSITION": 0}, "mode": mode}
    primitive |= {"indices": 1} if indices else {}
    return {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "plate", **node}],
        "meshes": [{"primitives": [primitive]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4, "byteOffset": 0},
            {"bufferView": 1, "componentType": 5121, "type": "SCALAR", "count": len(numbers)},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 4, "byteLength": 64, "byteStride": 16},
            {"buffer": 0, "byteOffset": 68, "byteLength": len(numbers)},
        ],
        "buffers": [{"byteLength": len(binary)}],
    }, binary


def written(tmp_path: Path, data: bytes) -> Path:
    (tmp_path / "part.glb").write_bytes(data)
    return tmp_path / "part.glb"


def test_nodes_of_nodes_as_trimesh_writes_them(tmp_path: Path) -> None:
    """Turned, shifted and scaled; the triangles of all, in metres."""
    scene = trimesh.Scene()
    ball, box = trimesh.creation.icosphere(subdivisions=1), trimesh.creation.box((1, 2, 3))
    first = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3), (0.1, 0.2, 0.3))
    second = trimesh.transformations.compose_matrix(
        scale=(2, 2, 2), translate=(1, 0, 4), angles=(0.3, -1, 2)
    )
    scene.add_geometry(box, node_name="box", transform=first)
    scene.add_geometry(ball, node_name="ball", parent_node_name="box", transform=second)
    mesh = read_mesh(written(tmp_path, scene.export(file_type="glb")))
    expected = np.concatenate([
        trimesh.transform_points(box.vertices, first)[box.faces],
        trimesh.transform_points(ball.vertices, first @ second)[ball.faces],
    ])  # fmt: skip
    found = mesh.corners()
    assert len(found) == len(expected)
    there = z_up(expected.reshape(-1, 3)).reshape(-1, 3, 3).mean(axis=1)
    gaps = np.linalg.norm(found.mean(axis=1)[:, None] - there, axis=2)
    assert gaps.min(axis=0).max() < 1e-5
    assert sorted(part.name for part in mesh.objects) == ["ball", "box"]
    assert volume(found) == pytest.approx(6 + 8 * ball.volume, rel=1e-5)


def volume(corners: np.ndarray) -> float:
    one, two, three = np.moveaxis(corners, 1, 0)
    return float(np.einsum("ij,ij->", one, np.cross(two, three)) / 6)


@pytest.mark.parametrize(
    ("mode", "indices"),
    [(4, [0, 1, 2, 0, 2, 3]), (4, [0, 1, 2, 0, 2, 3, 1]), (5, [3, 0, 2, 1]), (6, [0, 1, 2, 3]),
     (6, None)],
)  # fmt: skip
def test_strips_and_fans_are_the_same_square(
    tmp_path: Path, mode: int, indices: list[int] | None
) -> None:
    mesh = read_mesh(written(tmp_path, glb(*square(mode, indices))))
    one, two, three = np.moveaxis(mesh.corners(), 1, 0)
    normals = np.cross(two - one, three - one) / 2
    # z of the file is -y: both triangles are seen from there.
    assert normals.tolist() == [[0, -1, 0], [0, -1, 0]]
    assert {tuple(each) for each in mesh.vertices.tolist()} == {
        (0, 0, 0), (1, 0, 0), (1, 0, 2), (0, 0, 2),
    }  # fmt: skip


@pytest.mark.parametrize(
    "node",
    [
        {"scale": [-1, 1, 1], "translation": [3, 0, 0]},
        {"matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]},
    ],
)
def test_a_mirror_turns_triangles_round(tmp_path: Path, node: Content) -> None:
    mesh = read_mesh(written(tmp_path, glb(*square(6, None, **node))))
    one, two, three = np.moveaxis(mesh.corners(), 1, 0)
    assert (np.cross(two - one, three - one) / 2).tolist() == [[0, -1, 0], [0, -1, 0]]
    assert sorted({x for x, _, _ in mesh.vertices.tolist()}) == [2, 3]


def test_instances_are_not_dropped_in_silence(tmp_path: Path) -> None:
    """By EXT_mesh_gpu_instancing a node stands for its mesh in many places."""
    places = {"extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}
    content, binary = square(6, None, **places)
    path = written(tmp_path, glb(content | {"extensionsUsed": ["EXT_mesh_gpu_instancing"]}, binary))
    with pytest.raises(UsageFault, match="EXT_mesh_gpu_instancing"):
        read_mesh(path)


def test_lines_are_left_out_with_a_note(tmp_path: Path) -> None:
    content, binary = square(6)
    content["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    mesh = read_mesh(written(tmp_path, glb(content, binary)))
    assert len(mesh.triangles) == 2
    assert mesh.notes == ("part.glb: 1 sets of points or lines: left out",)


def needing(*names: str) -> Callable[[Content], object]:
    return lambda c: c.update(extensionsRequired=names)


def morphed(c: Content) -> None:
    c["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}]
    c["nodes"][0]["weights"] = [0.5]


def unmorphed(c: Content) -> None:
    morphed(c)
    c["nodes"][0]["weights"] = [0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda c: c["accessors"][1].update(count=5), "1 sets of triangles whose vertices are no"),
        (lambda c: c["scenes"].append({}), "1 scenes other than the default"),
        (morphed, "1 nodes with weights of morph targets"),
        (unmorphed, None),
        (needing("KHR_materials_unlit", "KHR_texture_transform"), None),
    ],
)
def test_what_is_left_out_is_noted(
    tmp_path: Path, change: Callable[[Content], object], said: str | None
) -> None:
    content, binary = square(4, [0, 1, 2, 0, 2, 3])
    change(content)
    notes = read_mesh(written(tmp_path, glb(content, binary))).notes
    assert [note.startswith(f"part.glb: {said}") for note in notes] == ([True] if said else [])


def changed(change: Callable[[Content], object]) -> bytes:
    content, binary = square(4, [0, 1, 2])
    change(content)
    return glb(content, binary)


HOSTILE: dict[str, tuple[Callable[[], bytes], str]] = {
    "text": (lambda: b"solid", "cannot be read"),
    "version 1": (lambda: struct.pack("<4s2I", b"glTF", 1, 12), "cannot be read"),
    "no chunk": (lambda: struct.pack("<4s2I", b"glTF", 2, 12), "cannot be read"),
    "cut off": (lambda: glb(*square(6))[:-9], "cut off"),
    "a chunk that is too long": (
        lambda: struct.pack("<4s2II4s", b"glTF", 2, 24, 2**31, b"JSON") + b"1234", "cannot be read"
    ),
    "no object": (lambda: glb([]), "cannot be read"),  # type: ignore[arg-type]
    "no scene": (lambda: changed(lambda c: c.pop("scenes")), "cannot be read"),
    "a node in itself": (
        lambda: changed(lambda c: c["nodes"][0].update(children=[0])), "cannot be read"
    ),
    "a node of another sort": (
        lambda: changed(lambda c: c["scenes"][0].update(nodes=["a", {}])), "cannot be read"
    ),
    "no vertex 255": (lambda: glb(*square(4, [0, 1, 255])), "cannot be read"),
    "beyond the buffer": (
        lambda: changed(lambda c: c["accessors"][0].update(count=10**9)), "cannot be read"
    ),
    "before the buffer": (
        lambda: changed(lambda c: c["accessors"][0].update(byteOffset=-16)), "cannot be read"
    ),
    "rows that overlap": (
        lambda: changed(lambda c: (c["bufferViews"][0].update(byteStride=0),
                                   c["accessors"][0].update(count=10**12))), "cannot be read"
    ),
    "another file": (
        lambda: changed(lambda c: c["buffers"][0].update(uri="../secret.bin")), "cannot be read"
    ),
    "sparse": (lambda: changed(lambda c: c["accessors"][0].update(sparse={})), "cannot be read"),
    "shorts": (
        lambda: changed(lambda c: c["accessors"][0].update(componentType=5122)), "cannot be read"
    ),
    "packed": (
        lambda: changed(lambda c: c.update(extensionsRequired=["KHR_draco_mesh_compression"])),
        "needs KHR_draco_mesh_compression",
    ),
    "an unknown extension": (
        lambda: changed(needing("EXT_other_places")), "needs EXT_other_places"
    ),
    "bones": (lambda: changed(lambda c: c["nodes"][0].update(skin=0)), "bones move .*`plate`"),
    "far off": (
        lambda: changed(lambda c: c["nodes"][0].update(translation=[1e300, 0, 0])), "farther"
    ),
    "no number": (
        lambda: changed(lambda c: c["nodes"][0].update(scale=[float("nan"), 1, 1])), "finite"
    ),
    "a turn that is none": (
        lambda: changed(lambda c: c["nodes"][0].update(rotation=[0, 0, 0, 0])), "cannot be read"
    ),
    "nothing": (lambda: changed(lambda c: c["nodes"][0].pop("mesh")), "no triangle"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_a_message_each(tmp_path: Path, name: str) -> None:
    made, says = HOSTILE[name]
    with pytest.raises(UsageFault, match=says) as caught:
        read_mesh(written(tmp_path, made()))
    assert len(str(caught.value).splitlines()) <= 2


def test_deep_json_is_refused(tmp_path: Path) -> None:
    text = b"[" * 400_000
    chunk = struct.pack("<I4s", len(text), b"JSON") + text
    data = struct.pack("<4s2I", b"glTF", 2, 12 + len(chunk)) + chunk
    with pytest.raises(UsageFault, match="deeply nested"):
        read_mesh(written(tmp_path, data))


def test_too_many_triangles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of a mesh count wherever it stands."""
    content, binary = square(6)
    content["nodes"] += [{"mesh": 0} for _ in range(5)]
    content["scenes"][0]["nodes"] = [*range(6)]
    path = written(tmp_path, glb(content, binary))
    assert len(read_mesh(path).triangles) == 12
    monkeypatch.setattr(mesh_limits, "MOST_TRIANGLES", 10)
    with pytest.raises(UsageFault, match="may have 10"):
        read_mesh(path)


def test_a_scene_of_it_is_imported(tmp_path: Path) -> None:
    from srgc.imports.scenes.scene_import import scene_import

    made = trimesh.creation.box((1, 2, 3)).export(file_type="glb")
    imported = scene_import(written(tmp_path, made), at="(0, 0, 1) m")
    # y of the file is up, and its z is -y.
    assert "box [-0.5, 0.5] x [-1.5, 1.5] x [0, 2] m" in imported.text

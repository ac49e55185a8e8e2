"""Files of JSON that are broken, or mean harm: one message each, with the file and the place."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import ROOT

FOLDER = ROOT / "specs" / "imports"
SET = json.loads((FOLDER / "scara_modules" / "modules.json").read_text(encoding="utf-8"))
TASK = json.loads((FOLDER / "sort_parts.json").read_text(encoding="utf-8"))

RAW = {
    "truncated": (b'{"modules": [', "given.json:1:14: error[SRG0801]: "),
    "empty": (b"", ""),
    "no text": (b'{"modules": "\xff"}', "UTF-8"),
    "deep": (b"[" * 200_000, "nested too deeply"),
    "deep objects": (b'{"a":' * 200_000, "nested too deeply"),
    "digits": (b'{"modules": ' + b"9" * 5000 + b"}", "of thousands of digits"),
    "twice": (b'{"modules": [], "modules": []}', "`modules` occurs twice"),
    "huge": (b'{"modules": "' + b"x" * (17 * 2**20) + b'"}', "bytes"),
    "zip": (b"PK\x03\x04" + b"\0" * 40, ""),
}

OF_SETS: dict[str, tuple[tuple[Any, ...], Any, str]] = {
    "NaN": (("modules", 0, "bodies", 0, "mass"), math.nan, "NaN"),
    "negative mass": (("modules", 0, "bodies", 0, "mass"), -1, "at least 0"),
    "infinite mass": (("modules", 0, "bodies", 0, "mass"), math.inf, "finite"),
    "beyond": (("modules", 0, "bodies", 0, "mass"), 1e300, "at most"),
    "text for a number": (("modules", 0, "bodies", 0, "mass"), "8 kg", "a number"),
    "number for a list": (("modules", 0, "bodies", 0, "r_com"), 3, "a list"),
    "null": (("modules", 0, "bodies", 0, "ID"), None, "a text"),
    "short pose": (
        ("modules", 0, "bodies", 0, "connectors", 0, "pose"),
        [[1, 0], [0, 1]],
        "4 rows",
    ),
    "no rotation": (
        ("modules", 0, "bodies", 0, "connectors", 0, "pose"),
        [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        "rotation",
    ),
    "mirror": (
        ("modules", 0, "bodies", 0, "connectors", 0, "pose"),
        [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
        "rotation",
    ),
    "asymmetric": (
        ("modules", 0, "bodies", 0, "inertia"),
        [[1, 2, 0], [0, 1, 0], [0, 0, 1]],
        "symmetric",
    ),
    "negative inertia": (
        ("modules", 0, "bodies", 0, "inertia"),
        [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "not negative",
    ),
    "same ID": (("modules", 1, "header", "ID"), "column", "already"),
    "same connector": (("modules", 0, "bodies", 0, "connectors", 1, "ID"), "floor", "already"),
    "gender": (("modules", 0, "bodies", 0, "connectors", 0, "gender"), "x", "f, m or h"),
    "no body": (("modules", 1, "joints", 0, "child"), "nobody", "no body"),
    "itself": (("modules", 1, "joints", 0, "child"), "pivot_stator", "itself"),
    "apart": (("modules", 1, "joints"), [], "no joint connects"),
    "limits": (("modules", 1, "joints", 0, "limits", "positionUpper"), -9, "below the lower"),
    "no angle": (
        ("modules", 1, "joints", 0, "limits"),
        {"positionLower": math.inf},
        "no position is above",
    ),
    "joint type": (("modules", 1, "joints", 0, "type"), "ball", "unknown joint"),
    "shape": (("modules", 0, "bodies", 0, "collision", 0, "type"), "torus", "unknown geometry"),
    "flat box": (("modules", 0, "bodies", 0, "collision", 0, "parameters", "x"), 0, "above 0"),
    "no modules": (("modules",), [], "at least one"),
    "wrong top": ((), "modules", "an object"),
}

OF_TASKS: dict[str, tuple[tuple[Any, ...], Any, str]] = {
    "goal type": (("goals", 0, "type"), "fly", "unknown goal"),
    "constraint": (("constraints", 0, "type"), "speedLimit", "unknown constraint"),
    "part": (("constraints", 0, "parts"), ["jerk"], "unknown limit"),
    "tolerances": (("goals", 0, "goalPose", "tolerance"), [[0, 1]], "one of each"),
    "interval": (("goals", 0, "goalPose", "tolerance", 0), [1, -1], "below"),
    "NaN": (("goals", 0, "goalPose", "tolerance", 0, 0), math.nan, "NaN"),
    "frame": (("goals", 0, "goalPose", "nominalParent"), "moon", "no frame"),
    "frames in a ring": (
        ("frames",),
        {"a": {"parent": "b"}, "b": {"parent": "a"}},
        "no frame of the world",
    ),
    "same goal": (("goals", 1, "ID"), "pick", "already"),
    "order": (("constraints", 4, "order"), ["pick", "rest"], "no goal"),
    "gravity": (("header", "gravity"), [0, 0], "3 numbers"),
    "no goals": (("goals",), None, "an object"),
    "missing": (("obstacles", 0, "collision"), [{"type": "box"}], "parameters"),
}


def changed(document: Any, path: tuple[Any, ...], value: Any) -> Any:
    """A copy with another value at a place."""
    found = json.loads(json.dumps(document))
    if not path:
        return value
    inner = found
    for step in path[:-1]:
        inner = inner[step]
    inner[path[-1]] = value
    return found


def shown(path: tuple[Any, ...]) -> str:
    """A place as messages have it; the last step may be that of what it should hold."""
    found = ""
    for step in path[:3]:
        found += f"[{step}]" if isinstance(step, int) else f".{step}"
    return found.lstrip(".")


def refused(ran: Any, file: Path, said: str) -> None:
    assert ran.status == 2, ran
    assert len(ran.err.strip().splitlines()) <= 4, ran.err
    assert file.name in ran.err
    assert said in " ".join(ran.err.split())


@pytest.mark.parametrize("kind", ["timor", "cobra"])
@pytest.mark.parametrize("name", RAW)
def test_no_json(kind: str, name: str, srgc: Callable[..., Any], tmp_path: Path) -> None:
    content, said = RAW[name]
    file = tmp_path / "given.json"
    file.write_bytes(content)
    refused(srgc("import", kind, file, "-o", "-"), file, said)


@pytest.mark.parametrize("name", OF_SETS)
def test_sets(name: str, srgc: Callable[..., Any], tmp_path: Path) -> None:
    path, value, said = OF_SETS[name]
    file = tmp_path / "given.json"
    file.write_text(json.dumps(changed(SET, path, value)), encoding="utf-8")
    ran = srgc("import", "timor", file, "-o", tmp_path / "out.srg")
    refused(ran, file, said)
    assert shown(path[:2]) in ran.err
    assert not (tmp_path / "out.srg").exists()


@pytest.mark.parametrize("name", OF_TASKS)
def test_tasks(name: str, srgc: Callable[..., Any], tmp_path: Path) -> None:
    path, value, said = OF_TASKS[name]
    file = tmp_path / "given.json"
    file.write_text(json.dumps(changed(TASK, path, value)), encoding="utf-8")
    ran = srgc("import", "cobra", file, "-o", tmp_path / "out.srg")
    refused(ran, file, said)
    assert shown(path[:1]) in ran.err
    assert not (tmp_path / "out.srg").exists()


@pytest.mark.parametrize(
    "named", ["../secret.stl", "/etc/hostname", "link.stl", "package://../secret.stl", "a\0b.stl"]
)
@pytest.mark.parametrize("kind", ["timor", "cobra"])
def test_nothing_is_read_outside_the_folder(
    kind: str, named: str, srgc: Callable[..., Any], tmp_path: Path
) -> None:
    (tmp_path / "secret.stl").write_text("solid secret\nendsolid\n", encoding="utf-8")
    folder = tmp_path / "given"
    folder.mkdir()
    (folder / "link.stl").symlink_to(tmp_path / "secret.stl")
    mesh = [{"type": "mesh", "parameters": {"file": named}}]
    path: tuple[Any, ...] = ("obstacles", 0, "collision")
    if kind == "timor":
        path = ("modules", 0, "bodies", 0, "collision")
    file = folder / "given.json"
    document = changed(SET if kind == "timor" else TASK, path, mesh)
    file.write_text(json.dumps(document), encoding="utf-8")
    ran = srgc("import", kind, file, "-o", "-")
    refused(ran, file, "error[SRG0802]: `")
    assert "secret" not in ran.out


def test_more_than_anybody_needs(srgc: Callable[..., Any], tmp_path: Path) -> None:
    """What would take minutes, or more levels than Python has, is refused at once."""
    body, goal = SET["modules"][0]["bodies"][0], TASK["goals"][0]
    nested: Any = {"type": "box"}
    for _ in range(400):
        nested = {"type": "composed", "geometries": [nested]}
    many = [
        ("timor", changed(SET, ("modules", 0, "bodies"), [body] * 501), "501 entries"),
        ("timor", changed(SET, ("modules",), SET["modules"][:1] * 2001), "2,001 entries"),
        ("timor", changed(SET, ("modules", 0, "bodies", 0, "collision"), [nested]), "composed"),
        ("timor", changed(SET, ("modules", 0, "bodies", 0, "r_com"), [0] * 20_001), "20,001"),
        ("cobra", changed(TASK, ("goals",), [goal] * 31), "31 entries"),
        ("cobra", changed(TASK, ("frames",), {str(i): {} for i in range(1001)}), "1,001 frames"),
    ]
    file = tmp_path / "given.json"
    for kind, document, said in many:
        file.write_text(json.dumps(document), encoding="utf-8")
        refused(srgc("import", kind, file, "-o", "-"), file, said)

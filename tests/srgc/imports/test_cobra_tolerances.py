"""Poses with tolerances against Timor: regions and turns are inside them, and equal where said."""

from __future__ import annotations

import json
import math
import random
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import srgc
from compiler.arrays import Array
from grammar_lang import ir
from srgc.imports.cobra.cobra_import import cobra_import
from tests.oracles.random_module_sets import pose
from tests.oracles.timor_sets import ask, needs_timor

pytestmark = [pytest.mark.slow, needs_timor]
FRAMES = {"tray": {"parent": "world", "transformation": pose(random.Random(5))}}
POSITIONS: list[tuple[list[str], list[list[float]], list[str], bool]] = [
    (["x", "y", "z"], [[-0.02, 0.03], [-0.01, 0.01], [-0.04, 0.02]], ["nominal"] * 3, True),
    (["x", "y", "z"], [[-0.02, 0.03], [-0.01, 0.01], [-0.04, 0.02]], ["world"] * 3, True),
    (
        ["x", "z", "y"],
        [[-0.02, 0.02], [-0.03, 0.01], [-0.02, 0.04]],
        ["tray", "world", "nominal"],
        True,
    ),
    (["x", "z"], [[-0.02, 0.02], [-0.03, 0.01]], ["nominal", "nominal"], True),
    (["r_sph"], [[0, 0.03]], ["nominal"], True),
    (["r_cyl", "z"], [[0, 0.02], [-0.01, 0.03]], ["nominal", "nominal"], True),
    (["r_cyl", "x"], [[0, 0.02], [-0.01, 0.03]], ["nominal", "world"], False),
    (["r_sph", "x"], [[0, 0.03], [-0.01, 0.01]], ["nominal", "nominal"], False),
]
TURNS: list[tuple[list[str], list[list[float]], bool]] = [
    ([], [], True),
    (["Theta_R"], [[0, 0.3]], True),
    (["Theta_R"], [[0, math.pi]], True),
    (["N_x", "N_y"], [[-0.3, 0.3], [-0.2, 0.25]], False),
    (["N_x", "N_y", "N_z"], [[-0.3, 0.3], [-0.2, 0.25], [-0.4, 0.4]], False),
]


def candidates(nominal: Array, rng: random.Random, count: int) -> list[Array]:
    """Poses near one: most of them a little off, in place and turn."""
    found = []
    for _ in range(count):
        other, near = np.array(pose(rng)), nominal.copy()
        near[:3, 3] += [rng.gauss(0, 0.015) for _ in range(3)]
        vector = np.array([rng.gauss(0, 0.15) for _ in range(3)])
        if rng.random() < 0.2:
            vector[2] = rng.uniform(-3, 3)
        near[:3, :3] = nominal[:3, :3] @ rotation(vector)
        if rng.random() < 0.1:
            near[:3, :3] = other[:3, :3]
        found.append(near)
    return found


def rotation(vector: Array) -> Array:
    """Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def inside(region: ir.Region, point: Array) -> float:
    """How far a point is inside a region (m), negative outside."""
    shape = region.shape
    if isinstance(shape, ir.Inequalities):
        return min(
            (float(row.offset) - np.array(row.normal, float) @ point)
            / float(np.linalg.norm(np.array(row.normal, float)))
            for row in shape.rows
        )
    assert isinstance(shape, ir.Round)
    points = np.array(shape.points, dtype=float)
    if shape.kind == "ball":
        return float(shape.radius) - float(np.linalg.norm(point - points[0]))
    axis = points[1] - points[0]
    length = float(np.linalg.norm(axis))
    along = float((point - points[0]) @ axis / length)
    off = float(np.linalg.norm(point - points[0] - along * axis / length))
    return min(float(shape.radius) - off, along, length - along)


def turned(text: str, frame: Array) -> float:
    """By how much a frame is turned less than the text allows (rad)."""
    room = math.pi
    for said, within, unit in re.findall(r"oriented (.*?) within ([\d.]+) (deg|rad)", text):
        wanted = np.eye(3)
        for axis, angle, of in re.findall(r"rot\((\w), (-?[\d.]+) (deg|rad)\)", said):
            value = float(angle) * (math.pi / 180 if of == "deg" else 1)
            wanted = wanted @ rotation(value * np.eye(3)["xyz".index(axis)])
        cosine = (np.trace(wanted.T @ frame) - 1) / 2
        most = float(within) * (math.pi / 180 if unit == "deg" else 1)
        room = min(room, most - math.acos(np.clip(cosine, -1, 1)))
    for axis, said, within, unit in re.findall(
        r"aligned (\w) to \((.*?)\) within ([\d.]+) (deg|rad)", text
    ):
        direction = np.array([float(value) for value in said.split(",")])
        cosine = frame[:, "xyz".index(axis)] @ direction / np.linalg.norm(direction)
        most = float(within) * (math.pi / 180 if unit == "deg" else 1)
        room = min(room, most - math.acos(np.clip(cosine, -1, 1)))
    return room


def imported(asked: dict[str, Any], folder: Path) -> tuple[ir.Region, str]:
    """The region and the clause of the last goal of a task."""
    elsewhere = {"nominal": np.eye(4).tolist(), "toleranceProjection": ["r_sph"]}
    goals = [
        {"ID": "here", "type": "at", "goalPose": elsewhere | {"tolerance": [[0, 0.1]]}},
        {"ID": "there", "type": "reach", "goalPose": asked},
    ]
    task = {"header": {"ID": "one", "taskName": "One"}, "frames": FRAMES, "goals": goals}
    file = folder / "one.json"
    file.write_text(json.dumps(task), encoding="utf-8")
    text = cobra_import(file, exact=True).text
    spec = folder / "one.srg"
    spec.write_text(text, encoding="utf-8")
    workspace = srgc.load(spec).ir.workspaces["One"]
    (clause,) = re.findall(r"reach There(.*?);", text, re.DOTALL)
    return workspace.region("There"), " ".join(clause.split())


def test_what_is_asked_for_is_within_the_tolerances(tmp_path: Path) -> None:
    rng = random.Random(11)
    asked, ours, equal = [], [], []
    for number in range(40):
        projections, intervals, frames, same = POSITIONS[number % len(POSITIONS)]
        turns, bounds, same_turn = TURNS[number % len(TURNS)]
        nominal = pose(rng)
        described = {
            "nominal": nominal,
            "toleranceProjection": [*projections, *turns],
            "tolerance": [*intervals, *bounds],
            "toleranceFrame": [*frames, *["nominal"] * len(turns)],
        }
        near = candidates(np.array(nominal), rng, 60)
        region, clause = imported(described, tmp_path)
        asked.append({"pose": described, "candidates": [each.tolist() for each in near]})
        ours.append(
            [min(inside(region, each[:3, 3]), turned(clause, each[:3, :3])) for each in near]
        )
        equal.append(same and same_turn)
    theirs = ask({"tolerated": asked, "frames": FRAMES})
    yes = 0
    for rooms, valid, same in zip(ours, theirs, equal, strict=True):
        for room, is_valid in zip(rooms, valid, strict=True):
            yes += is_valid
            if room > 1e-9:
                assert is_valid
            if same and room < -1e-9:
                assert not is_valid
    assert 200 < yes < 2000

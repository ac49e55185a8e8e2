"""Module sets in Timor's environment and here: the same assemblies, side by side."""

from __future__ import annotations

import json
import math
import random
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import srgc
from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from srgc.chosen_robot import RobotRequest, chosen_robot
from srgc.imports.timor.timor_import import timor_import
from srgc.imports.written_import import write_import
from tests.oracles.robots import evaluate

ROOT = Path(__file__).parents[2]
PYTHON = ROOT / ".venv" / "timor" / "bin" / "python"
GRAVITY = (Fraction(1, 3), Fraction(-2), Fraction(-981, 100))
TIP = re.compile(r"effector\(frame: (.*?)\);", re.DOTALL)

needs_timor = pytest.mark.skipif(
    not PYTHON.exists(), reason="Timor has an environment of its own: make .venv/timor/installed"
)


def ask(question: dict[str, Any]) -> Any:
    """What Timor answers, in a process of its own."""
    ran = subprocess.run(
        [PYTHON, str(ROOT / "tests" / "oracles" / "timor_answers.py")],
        input=json.dumps(question),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr[-2000:]
    return json.loads(ran.stdout.splitlines()[-1])


@dataclass(frozen=True)
class Assembly:
    """Modules by their IDs, and by their names in the language, and states of its joints.

    ``ends`` are of each module the connectors towards the base and away from it; ``signs`` is 1, or
    -1 for a joint that Timor turns the other way.
    """

    ids: tuple[str, ...]
    word: tuple[str, ...]
    states: tuple[tuple[list[float], list[float]], ...]
    ends: tuple[tuple[str, str], ...] = ()
    signs: tuple[int, ...] = ()

    def question(self) -> dict[str, Any]:
        asked: dict[str, Any] = {
            "modules": self.ids,
            "gravity": [float(value) for value in GRAVITY],
            "states": self.states,
        }
        if self.ends:
            asked["base"] = [0, self.ends[0][0]]
            asked["connections"] = [
                (i, before[1], i + 1, after[0])
                for i, (before, after) in enumerate(pairwise(self.ends))
            ]
        return asked


def states(
    rng: random.Random, count: int, dofs: int
) -> tuple[tuple[list[float], list[float]], ...]:
    """Coordinates and rates."""
    return tuple(
        (
            [rng.uniform(-3, 3) for _ in range(dofs)],
            [rng.uniform(-2, 2) for _ in range(dofs)],
        )
        for _ in range(count)
    )


class Imported:
    """A set after its import: its modules, with three more effectors beside each."""

    def __init__(self, file: Path, folder: Path, *, any_end: bool = False) -> None:
        found = timor_import(file, any_end=any_end)
        self.text = found.text
        path = folder / f"{found.name}.srg"
        write_import(found, path, force=True)
        self.checked = srgc.check(path)
        path.write_text(TIP.sub(_four, found.text), encoding="utf-8")
        self.program = srgc.load(path)

    def graph(self, word: Sequence[str]) -> RobotGraph:
        chosen = chosen_robot(self.program.ir, RobotRequest(tuple(word)))
        return robot_graph(chosen.model, GRAVITY)


def _four(match: re.Match[str]) -> str:
    """An effector, and one a metre along each of its axes."""
    frame = match.group(1)
    moved = [frame, *(f"{frame} * move({axis}, 1 m)" for axis in "xyz")]
    return " ".join(f"effector(frame: {each});" for each in moved)


def frame_of(positions: Array) -> Array:
    """The homogeneous matrix of a frame whose origin and three points are given (12,)."""
    origin, *ends = positions.reshape(4, 3)
    found = np.eye(4)
    found[:3, 3] = origin
    found[:3, :3] = np.array([end - origin for end in ends]).T
    return found


def agree(graph: RobotGraph, answer: dict[str, Any], given: Assembly, tolerance: float) -> float:
    """Compare frames, mass matrices and efforts; the largest difference, relative to their size."""
    none, worst = np.zeros(0), 0.0
    assert len(graph.model.dofs) == answer["dof"]
    signs = np.array(given.signs or (1,) * answer["dof"])
    for (q, dq), state in zip(given.states, answer["states"], strict=True):
        at, rate = signs * np.array(q), signs * np.array(dq)
        mass = evaluate(graph, "mass_matrix", at, none)
        found = {
            "frame": frame_of(evaluate(graph, "effectors", at, none)),
            "mass_matrix": signs[:, None] * mass * signs,
            "bias": signs * evaluate(graph, "bias", at, rate, none),
        }
        for name, value in found.items():
            expected = np.array(state[name])
            assert expected.shape == value.shape
            scale = max(1.0, float(np.abs(expected).max()))
            worst = max(worst, float(np.abs(value - expected).max()) / scale)
    assert worst < tolerance, f"{given.word}: {worst}"
    return worst


def names_by_id(text: str) -> dict[str, str]:
    """The names of modules by their IDs in the set, as comments have them."""
    found = dict[str, str]()
    for comment, name in re.findall(r"^// (.*)\nmodule (\w+)", text, re.MULTILINE):
        said = re.search(r"\(ID ([^)]*)\)", comment)
        found[said.group(1) if said else comment.partition(":")[0]] = name
    return found


# --- What a text says, read by patterns -----------------------------------------------------------


UNITS = {"rad": 1.0, "deg": math.pi / 180, "m": 1.0, "mm": 1e-3}


def blocks(text: str) -> dict[str, str]:
    """The text of each module by its name."""
    found = re.findall(r"^module (\w+) (\{.*?\}$)", text, re.MULTILINE | re.DOTALL)
    return dict(found)


def ports_of(block: str) -> dict[str, tuple[str, str | None]]:
    """The type and the gender of each port."""
    found = re.findall(r"port (\w+): (\w+)(?: (male|female))?;", block)
    return {name: (kind, gender or None) for name, kind, gender in found}


def limits_of(block: str) -> list[list[float]]:
    """Of each joint: range, rate, acceleration, effort, gear, rotor, dry and viscous friction."""
    drives = dict(re.findall(r"drive (\w+): (.*?);", block, re.DOTALL))
    found = list[list[float]]()
    for name, said in re.findall(r"dof (\w+): (.*?);", block, re.DOTALL):
        span = re.search(r"[xyz] in \[(.*?), (.*?)\] (\w+)", said)
        rate = re.search(r"rate in \[-(.*?), ", said)
        low, high = (
            (-math.inf, math.inf)
            if span is None
            else (float(span.group(i)) * UNITS[span.group(3)] for i in (1, 2))
        )
        bounds = [re.search(rf"{word} <= ([\d.]+)", said) for word in ("accel", "effort")]
        drive = drives.get(name, "")
        parts = [
            re.search(rf"{word} ([\d.]+)", drive)
            for word in ("gear", "rotor", "coulomb", "viscous")
        ]
        found.append(
            [low, high]
            + [math.inf if each is None else float(each.group(1)) for each in (rate, *bounds)]
            + [
                none if each is None else float(each.group(1))
                for each, none in zip(parts, (1.0, 0.0, 0.0, 0.0), strict=True)
            ]
        )
    return found

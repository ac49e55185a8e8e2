"""Module sets in Timor's environment and here: the same assemblies, side by side."""

from __future__ import annotations

import json
import random
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
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
    """Modules by their IDs, and by their names in the language, and states of its joints."""

    ids: tuple[str, ...]
    word: tuple[str, ...]
    states: tuple[tuple[list[float], list[float]], ...]

    def question(self) -> dict[str, Any]:
        return {
            "modules": self.ids,
            "gravity": [float(value) for value in GRAVITY],
            "states": self.states,
        }


def states(rng: random.Random, count: int, dofs: int) -> tuple[tuple[list[float], list[float]], ...]:
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

    def __init__(self, file: Path, folder: Path) -> None:
        found = timor_import(file, name=None, exact=False, any_end=False)
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
    for (q, dq), state in zip(given.states, answer["states"], strict=True):
        at, rate = np.array(q), np.array(dq)
        found = {
            "frame": frame_of(evaluate(graph, "effectors", at, none)),
            "mass_matrix": evaluate(graph, "mass_matrix", at, none),
            "bias": evaluate(graph, "bias", at, rate, none),
        }
        for name, value in found.items():
            expected = np.array(state[name])
            assert expected.shape == value.shape
            scale = max(1.0, float(np.abs(expected).max()))
            worst = max(worst, float(np.abs(value - expected).max()) / scale)
    assert worst < tolerance, f"{given.word}: {worst}"
    return worst

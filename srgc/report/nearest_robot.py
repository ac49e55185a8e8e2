"""Reads the nearest motion of a task without a design from its folder.

Nothing about it is proved.  A folder may have been altered; then there is nothing to show.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from compiler.arrays import Array
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.tasks.obstacle_pieces import expanded
from compiler.words.derivation import BadDerivation
from grammar_lang import ir
from solvers.verifier.claims.spec_copy import bounded_text

MOST_SAMPLES = 100_000


@dataclass(frozen=True, slots=True, eq=False)
class NearestRobot:
    """A robot, the values of its parameters, and its motion at the samples.

    Shapes: ``theta`` (p,) in SI units; ``t`` (k + 1,) in seconds; ``q`` and ``qd`` (k + 1, n).
    """

    model: RobotModel
    word: tuple[str, ...]
    theta: Array
    t: Array
    q: Array
    qd: Array


def nearest_robot(
    folder: Path, design: Mapping[str, Any], program: ir.Program, task: ir.Task
) -> NearestRobot | None:
    """The robot that came nearest and its motion; None if the folder has no consistent data.

    Args:
        folder: the folder of a result.
        design: its ``design.json``.
        program: the program of its specification, as written.
        task: the task, as written.
    """
    nearest = design.get("nearest")
    if not isinstance(nearest, dict):
        return None
    try:
        program, task = expanded(program, task)
        family = family_of(program, task)
        derivation = family.replay(tuple(map(str, nearest["derivation"])))
        model = robot_in_task(family, task.origin, derivation)
        theta = np.array([float(each["value"]) for each in nearest["parameters"]])
        table = _table(bounded_text(folder / "nearest.csv"))
        n = len(model.dofs)
        t = table["t"]
        q, qd = (_columns(table, [f"{name}{i + 1}" for i in range(n)]) for name in ("q", "qd"))
        step = float(task.step)
        if len(theta) != len(model.parameters) or not np.isfinite(theta).all():
            return None
        if len(t) < 2 or np.abs(np.diff(t) - step).max() > 1e-6 * step:
            return None
    except (OSError, ValueError, KeyError, TypeError, BadDerivation, SemanticsError, csv.Error):
        return None
    return NearestRobot(model, derivation.word, theta, t, q, qd)


def _table(content: str) -> dict[str, Array]:
    """The columns of a table of samples; only inputs may be empty in the last row."""
    rows = list(csv.DictReader(io.StringIO(content)))
    if not 0 < len(rows) <= MOST_SAMPLES:
        raise ValueError("no table of samples")
    return {
        name: np.array([float(row[name]) for row in rows])
        for name in rows[0]
        if name == "t" or name.removeprefix("q").removeprefix("d").isdigit()
    }


def _columns(table: Mapping[str, Array], names: Sequence[str]) -> Array:
    """The columns with these names (k + 1, n), all finite."""
    found = np.stack([table[name] for name in names], axis=1)
    if not np.isfinite(found).all():
        raise ValueError("a sample has no value")
    return found

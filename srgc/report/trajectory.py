"""``trajectory.csv`` of a result folder, read back: the sampled motion."""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from srgc.faults import UsageFault

Array = NDArray[np.float64]

_COLUMN = re.compile(r"q[1-9]\d*|qd[1-9]\d*|s[1-9]\d*|u[1-9]\d*|e[1-9]\d*_[xyz]|t")


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """A motion at its samples, in SI units.

    Shapes: ``t`` (k + 1,), ``q`` and ``qd`` (k + 1, n), ``s`` (k + 1, states of the modules' own),
    ``u`` (k, inputs): row i holds from ``t[i]`` to ``t[i + 1]``; ``effectors`` (k + 1, e, d).
    """

    t: Array
    q: Array
    qd: Array
    s: Array
    u: Array
    effectors: Array


def read_trajectory(path: Path, dofs: int, effectors: int, dimension: int) -> Trajectory:
    """The table that ``srgc synth`` has written of a robot with so many degrees of freedom.

    Raises:
        UsageFault: there is none, or it is not of this robot.
    """
    try:
        return _trajectory(path.read_text(encoding="utf-8"), dofs, effectors, dimension)
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    except (ValueError, csv.Error):
        raise UsageFault(f"{path} is not a trajectory of this robot") from None


def _trajectory(text: str, dofs: int, effectors: int, dimension: int) -> Trajectory:
    head, *rows = csv.reader(io.StringIO(text))
    if not all(_COLUMN.fullmatch(name) for name in head) or head[0] != "t" or len(rows) < 2:
        raise ValueError(head)
    table = np.array([[float(cell) if cell else 0.0 for cell in row] for row in rows])
    groups = [_group(name) for name in head]
    parts = {
        key: table[:, [i for i, group in enumerate(groups) if group == key]]
        for key in ("t", "q", "qd", "s", "u", "e")
    }
    if not (
        np.isfinite(table).all()
        and parts["q"].shape[1] == parts["qd"].shape[1] == dofs
        and parts["e"].shape[1] == effectors * dimension
        and (np.diff(parts["t"][:, 0]) > 0).all()
    ):
        raise ValueError(head)
    tips = parts["e"].reshape(len(table), effectors, dimension)
    return Trajectory(parts["t"][:, 0], parts["q"], parts["qd"], parts["s"], parts["u"][:-1], tips)


def _group(name: str) -> str:
    """The letters that a column's name begins with."""
    return "e" if name.startswith("e") else name.rstrip("0123456789")

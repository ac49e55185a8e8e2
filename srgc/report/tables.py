"""The tables of a result folder: evaluations and trajectory."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.verifier.claims.spec_copy import bounded_text
from srgc.exports.exported_motion import planned_inputs, planned_motion
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign

# --- ``evaluations.csv`` and ``landscape.csv``: parameter values with their robustness ------------


@dataclass(frozen=True, slots=True)
class Evaluation:
    """One evaluation; ``theta`` maps the parameters' names, ``symbol.name``, to SI values."""

    structure: int
    path: int
    theta: dict[str, float]
    robustness: float
    feasible: bool


def evaluations(path: Path) -> tuple[Evaluation, ...]:
    """All evaluations in order; empty if the table is missing.

    A landscape has neither structure nor path: both are 0.

    Raises:
        UsageFault: the file is not a table of evaluations.
    """
    try:
        content = bounded_text(path)
        return tuple(map(_evaluation, csv.DictReader(io.StringIO(content))))
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError, csv.Error):
        raise UsageFault(f"{path} is not a table of evaluations") from None


def _evaluation(row: dict[str, str]) -> Evaluation:
    theta = {name: float(value) for name, value in row.items() if "." in name and value}
    if not all(map(isfinite, (*theta.values(), float(row["rho"])))):
        raise ValueError(row)
    return Evaluation(
        int(row.get("structure", 0)),
        int(row.get("path", 0)),
        theta,
        float(row["rho"]),
        bool(int(row["feasible"])),
    )


def varied(samples: Sequence[Evaluation]) -> tuple[str, ...]:
    """The parameters that have more than one value."""
    names = dict.fromkeys(name for each in samples for name in each.theta)
    return tuple(name for name in names if len({each.theta.get(name) for each in samples}) > 1)


# --- The motion of a design at its samples, simulated again from its certificate ------------------
#
# ``trajectory.csv`` has the same numbers, but no digest: the report shows the motion of the
# certificate, whatever happened to that file.


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


def planned_trajectory(found: FoundDesign) -> Trajectory:
    """The sampled motion that the inputs of a certificate cause, as ``srgc synth`` writes it.

    Raises:
        UsageFault: the inputs do not fit the task, or the motion has no finite values in doubles.
    """
    planned, step, n = planned_inputs(found), found.task.step, len(found.model.dofs)
    numeric = NumericRobot(robot_graph(found.model, found.task.gravity))
    with np.errstate(all="ignore"):
        moved = planned_motion(found, numeric)
        x = moved.x
        tips = numeric.places(x[:, :n], planned.theta)
    if not (np.isfinite(x).all() and np.isfinite(tips).all()):
        raise UsageFault("the motion of the certificate cannot be simulated in doubles")
    times = np.array([float(i * step) for i in range(len(x))])
    return Trajectory(times, x[:, :n], x[:, n : 2 * n], x[:, 2 * n :], moved.u, tips)

"""The motion of a design at its samples, integrated anew from its certificate.

``trajectory.csv`` has the same numbers, but no digest: what is in a report is the motion of the
certificate, whatever became of that file.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.fine_motion import fine_motion
from srgc.exports.exported_motion import planned_inputs
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign


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
        UsageFault: the inputs are not those of the task, or the motion has no values in doubles.
    """
    planned, step, n = planned_inputs(found), found.task.step, len(found.model.dofs)
    numeric = NumericRobot(robot_graph(found.model, found.task.gravity))
    with np.errstate(all="ignore"):
        x = fine_motion(numeric, planned, float(step)).x
        tips = numeric.points(x[:, :n], planned.theta).value[:, : len(found.model.effectors)]
    if not (np.isfinite(x).all() and np.isfinite(tips).all()):
        raise UsageFault("the motion of the certificate cannot be simulated in doubles")
    times = np.array([float(i * step) for i in range(len(x))])
    return Trajectory(times, x[:, :n], x[:, n : 2 * n], x[:, 2 * n :], planned.u, tips)

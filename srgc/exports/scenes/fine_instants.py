"""The planned motion of a design at instants that include ones within its steps."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from solvers.trajectory.fine_motion import fine_motion
from solvers.trajectory.trajectory import Trajectory
from srgc.exports.exported_motion import planned_inputs, planned_motion
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign

MOST_INSTANTS = 6000


@dataclass(frozen=True, slots=True, eq=False)
class FineInstants:
    """A motion at K instants, which include the samples of the task.

    Attributes:
        times: (K,) exact, in seconds.
        parts: the number of instants from one sample to the next.
        q, v: (K, n) coordinates and rates of the joints, SI.
    """

    times: tuple[Fraction, ...]
    parts: int
    q: Array
    v: Array

    def at(self, time: float) -> Array:
        """The coordinates (1, n) at a time in seconds; after the end, the last ones.

        Between instants they are cubic polynomials with the rates there (Hermite interpolation).
        """
        ends = np.array([float(each) for each in self.times])
        if len(ends) == 1 or time >= ends[-1]:
            return self.q[-1:]
        i = max(int(np.searchsorted(ends, time, side="right")) - 1, 0)
        h = ends[i + 1] - ends[i]
        s = float(np.clip((time - ends[i]) / h, 0.0, 1.0))
        found: Array = (
            (1 + 2 * s) * (1 - s) ** 2 * self.q[i]
            + s * (1 - s) ** 2 * h * self.v[i]
            + s**2 * (3 - 2 * s) * self.q[i + 1]
            + s**2 * (s - 1) * h * self.v[i + 1]
        )
        return found[None, :]


def fine_instants(design: FoundDesign, frequency: int, most: int = MOST_INSTANTS) -> FineInstants:
    """The motion of a design, integrated from each sample of its task to the next.

    Args:
        design: the design.
        frequency: the least number of instants per second, unless that gives too many.
        most: about the greatest number of instants.

    Raises:
        UsageFault: the motion has numbers that are not finite doubles.
    """
    step, steps = design.task.step, len(design.claim.inputs)
    parts = max(1, min(ceil(step * frequency), most // max(steps, 1)))
    with np.errstate(all="ignore"):
        x = _integrated(design, parts)
    if not np.isfinite(x).all():
        raise UsageFault("the motion cannot be simulated in doubles")
    n = len(design.model.dofs)
    times = tuple(step * k / parts for k in range(steps * parts + 1))
    return FineInstants(times, parts, x[:, :n], x[:, n : 2 * n])


def _integrated(design: FoundDesign, parts: int) -> Array:
    """The states (K, N); errors within one step do not carry over to the next."""
    numeric = NumericRobot(robot_graph(design.model, design.task.gravity))
    theta = planned_inputs(design).theta
    moved = planned_motion(design, numeric)
    if parts == 1 or not len(moved.u):
        return moved.x
    dt = float(design.task.step / parts)
    found = []
    for x, u in zip(moved.x[:-1], moved.u, strict=True):
        held = Trajectory(x[None, :], np.repeat(u[None, :], parts, axis=0), theta)
        found.append(fine_motion(numeric, held, dt).x[:parts])
    return np.concatenate([*found, moved.x[-1:]])

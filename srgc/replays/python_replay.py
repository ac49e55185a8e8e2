"""The planned inputs held in a Runge-Kutta method of order eight, in doubles.

Source: Dormand & Prince's DOP853, of SciPy (Hairer, Norsett & Wanner, *Solving Ordinary
Differential Equations I*, II.5).  It integrates the same equations of motion as the verifier, the
modules' own dynamics included, by another method, in other numbers.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import scipy
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from srgc.exports.planned_inputs import planned_inputs
from srgc.faults import UsageFault
from srgc.replays.replayed_motion import ReplayedMotion
from srgc.results.found_design import FoundDesign

RELATIVE, ABSOLUTE = 1e-13, 1e-15
INSTANTS = 8
"""Of every step of the task."""


def replay_in_python(design: FoundDesign) -> ReplayedMotion:
    """The motion under the inputs of a design, each held for its step.

    Raises:
        UsageFault: it has numbers that are no doubles, or the method finds no steps.
    """
    planned = planned_inputs(design)
    numeric = NumericRobot(robot_graph(design.model, design.task.gravity))
    n, step = len(design.model.dofs), design.task.step

    def rate(_time: float, x: Array, u: Array) -> Array:
        rest = numeric.acceleration(x[None, :], u[None, :], planned.theta)[0][0]
        return np.concatenate([x[n : 2 * n], rest])

    within = np.linspace(0.0, float(step), INSTANTS + 1)
    times, states = [0.0], [planned.x[0]]
    for number, u in enumerate(planned.u):
        solution = solve_ivp(
            rate, (0.0, within[-1]), states[-1], "DOP853", within[1:], args=(u,),
            rtol=RELATIVE, atol=ABSOLUTE,
        )  # fmt: skip
        if not solution.success or not np.isfinite(solution.y).all():
            raise UsageFault(f"the integration fails in step {number}: {solution.message}")
        states += list(solution.y.T)
        times += [float((number + i / Fraction(INSTANTS)) * step) for i in range(1, INSTANTS + 1)]
    found = np.array(states)
    tips = numeric.points(found[:, :n], planned.theta).value[:, : len(design.model.effectors)]
    return ReplayedMotion(
        "SciPy", scipy.__version__, "DOP853", None, np.array(times), found[:, : 2 * n], tips,
        INSTANTS,
    )  # fmt: skip

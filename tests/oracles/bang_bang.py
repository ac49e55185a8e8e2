"""Fastest motions of one joint: full torque one way, then the other way."""

from __future__ import annotations

from math import sin, sqrt

from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def swing_up(torque: float, weight: float, inertia: float, angle: float) -> float:
    """The least time in which a pendulum goes from hanging to rest at an angle, in s.

    I x'' = u - w sin x with |u| <= torque and torque > w: full torque up to an instant, then the
    same downwards until it rests; the instant is such that it rests at the angle.
    """

    def rests(instant: float) -> tuple[float, float]:
        """The time and the angle at which it comes to rest."""

        def going(u: float):
            return lambda _, x: (x[1], (u - weight * sin(x[0])) / inertia)

        def stops(_: float, x) -> float:
            return x[1]

        stops.terminal, stops.direction = True, -1
        exact = {"rtol": 1e-11, "atol": 1e-12, "max_step": 0.05}
        up = solve_ivp(going(torque), (0, instant), (0.0, 0.0), **exact)
        down = solve_ivp(
            going(-torque), (instant, instant + 99), up.y[:, -1], events=stops, **exact
        )
        return float(down.t[-1]), float(down.y[0, -1])

    longest = 4 * sqrt(2 * inertia * angle / (torque - weight))
    instant = brentq(lambda at: rests(at)[1] - angle, 1e-6, longest, xtol=1e-12)
    return rests(instant)[0]

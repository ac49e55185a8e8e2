"""The arm of two uniform rods in the plane, simulated without any code of the project."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from compiler.arrays import Array

FINE = 2000
"""A step is looked at so many times."""


def rates(
    _t: float, state: Array, lengths: Sequence[float], torque: Sequence[float]
) -> list[float]:
    """Two uniform rods of 1 kg/m with relative angles (any robotics textbook)."""
    (l1, l2), (_, q2, v1, v2) = lengths, state
    m1, m2 = l1, l2
    near, far, cross = m1 * l1**2 / 3 + m2 * l1**2, m2 * l2**2 / 3, m2 * l1 * l2 / 2
    m11, m12, m22 = near + far + 2 * cross * np.cos(q2), far + cross * np.cos(q2), far
    pull = cross * np.sin(q2)
    b1 = torque[0] + pull * (2 * v1 * v2 + v2 * v2)
    b2 = torque[1] - pull * v1 * v1
    determinant = m11 * m22 - m12 * m12
    return [v1, v2, (m22 * b1 - m12 * b2) / determinant, (m11 * b2 - m12 * b1) / determinant]


def tip(lengths: Sequence[float], q1: Array, q2: Array) -> Array:
    l1, l2 = lengths
    return np.array(
        [l1 * np.cos(q1) + l2 * np.cos(q1 + q2), l1 * np.sin(q1) + l2 * np.sin(q1 + q2)]
    )


def simulated(certificate: Mapping[str, Any]) -> tuple[Array, Array, Array]:
    """Times, states and tips along the motion, by a Runge-Kutta method of order eight."""
    lengths = [float(p["value"]) for p in certificate["parameters"]]
    state = np.array([float(x) for x in certificate["start"]])
    dt = float(Fraction(certificate["step"]))
    times, states = [0.0], [state]
    for number, row in enumerate(certificate["inputs"]):
        torque = [float(x) for x in row]
        grid = np.linspace(0, dt, FINE + 1)
        answer = solve_ivp(
            rates, (0, dt), state, method="DOP853", rtol=1e-11, atol=1e-12,
            args=(lengths, torque), dense_output=True,
        )  # fmt: skip
        assert answer.success
        times += list(number * dt + grid[1:])
        states += list(answer.sol(grid[1:]).T)
        state = answer.y[:, -1]
    states = np.array(states)
    return np.array(times), states, tip(lengths, states[:, 0], states[:, 1])

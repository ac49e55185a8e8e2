"""The motion of an arm put together by hand, by a Runge-Kutta method of order eight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from tests.oracles.hand_arms import SimulatedArm


@dataclass(frozen=True)
class SampledMotion:
    """States (q, v, s) at ``fine`` samples per step and at the end, and where the points are."""

    fine: int
    dt: float
    states: Array
    tips: Array
    bodies: Array

    @property
    def at_steps(self) -> Array:
        """The effectors at the ends of the steps: (steps + 1, effectors, 3)."""
        return self.tips[:: self.fine]


class Diverges(ArithmeticError):
    """The motion leaves everything that a task allows."""


def sampled_motion(
    arm: SimulatedArm, start: Array, inputs: Sequence[Array], dt: float, fine: int
) -> SampledMotion:
    """The motion under inputs held for ``dt`` each; ``start`` holds coordinates and rates."""
    state = np.concatenate([start, arm.own_states])
    states = [state]
    grid = np.linspace(0, dt, fine + 1)
    for u in inputs:
        answer = solve_ivp(
            lambda _t, x, u=u: arm.slope(x, u), (0, dt), state,
            method="DOP853", rtol=1e-11, atol=1e-12, dense_output=True,
        )  # fmt: skip
        if not answer.success or not np.abs(answer.y).max() < 1e6:
            raise Diverges
        states += list(answer.sol(grid[1:]).T)
        state = answer.y[:, -1]
    found = np.array(states)
    tips, bodies = arm.points(found[:, : len(arm.joints)])
    return SampledMotion(fine, dt, found, tips, bodies)

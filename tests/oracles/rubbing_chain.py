"""A chain of rods with dry friction, by an integrator that stops where a joint changes its mode.

Between these events every joint slides with a sign, or is at rest; at one, all that joints at rest
may do is tried, and what agrees with the law of Coulomb is what they do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from tests.oracles.planar_chain import chain_dynamics

STILL = 1e-11
"""Rates below this are those of joints at rest."""
MOST_EVENTS = 200


@dataclass(frozen=True)
class RubbingChain:
    """Rods, friction (n,) in N m, the acceleration of gravity in m/s^2, densities (n,) in kg/m."""

    lengths: Array
    pull: Sequence[float]
    friction: Array
    densities: Array | None = None

    def accelerations(self, x: Array, u: Array, signs: Sequence[int]) -> tuple[Array, Array]:
        """The accelerations (n,), and the efforts of friction (n,), where 0 says at rest."""
        n = len(self.lengths)
        densities = np.ones(n) if self.densities is None else self.densities
        mass, turned, weight = chain_dynamics(
            self.lengths, densities, x[:n], x[n:], list(self.pull)
        )
        moving, still = np.flatnonzero(signs), np.flatnonzero(np.equal(signs, 0))
        push = u - turned - weight - self.friction * np.array(signs)
        pull = np.zeros(n)
        pull[moving] = np.linalg.solve(mass[np.ix_(moving, moving)], push[moving])
        held = np.zeros(n)
        held[still] = (mass @ pull - push)[still]
        held[moving] = -self.friction[moving] * np.array(signs)[moving]
        return pull, held

    def signs(self, x: Array, u: Array) -> tuple[int, ...]:
        """What each joint does next: the only choice that the law allows."""
        n = len(self.lengths)
        choices = [(int(np.sign(v)),) if abs(v) > STILL else (0, 1, -1) for v in x[n:]]
        best, found = np.inf, tuple[int, ...]()
        for signs in product(*choices):
            pull, held = self.accelerations(x, u, signs)
            wrong = [0.0]
            for joint, sign in enumerate(signs):
                if sign == 0:
                    wrong.append(abs(held[joint]) - self.friction[joint])
                elif abs(x[n + joint]) <= STILL:
                    wrong.append(-sign * pull[joint])
            if max(wrong) < best:
                best, found = max(wrong), signs
        return found

    def moved(self, x: Array, u: Array, seconds: float) -> Array:
        """The state after so many seconds under inputs (n,) that are held."""
        n, time = len(self.lengths), 0.0
        for _ in range(MOST_EVENTS):
            signs = self.signs(x, u)
            x = x.copy()
            x[n:][np.equal(signs, 0)] = 0.0

            def slope(t: float, y: Array, signs: tuple[int, ...] = signs) -> Array:
                return np.concatenate([y[n:], self.accelerations(y, u, signs)[0]])

            events = list[Callable[[float, Array], float]]()
            for joint, sign in enumerate(signs):
                events.append(self._event(joint, sign, signs, u))
            found = solve_ivp(
                slope, (time, seconds), x, "DOP853", rtol=1e-11, atol=1e-13, events=events,
                max_step=seconds / 20,
            )  # fmt: skip
            x, time = found.y[:, -1], float(found.t[-1])
            if found.status == 0:
                return x
            for joint, times in enumerate(found.t_events):
                if len(times) and signs[joint]:
                    x[n + joint] = 0.0
        raise AssertionError("too many events")

    def _event(
        self, joint: int, sign: int, signs: tuple[int, ...], u: Array
    ) -> Callable[[float, Array], float]:
        n = len(self.lengths)
        if sign:
            # From rest the rate has grown a little before it is looked at.
            def event(_: float, y: Array) -> float:
                return float(sign * y[n + joint] + STILL / 10)
        else:

            def event(_: float, y: Array) -> float:
                held = self.accelerations(y, u, signs)[1]
                return float(self.friction[joint] + 1e-12 - abs(held[joint]))

        event.terminal = True  # type: ignore[attr-defined]
        event.direction = -1  # type: ignore[attr-defined]
        return event

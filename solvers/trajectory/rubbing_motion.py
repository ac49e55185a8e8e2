"""The motion of a robot with dry friction, in floats, from event to event.

Between events every joint either slides with a sign or rests.  An event is a joint that comes to
rest, or one that friction no longer holds.  What joints at rest do next is the choice that agrees
best with Coulomb's law.  This is for tables, pictures and comparisons: no proof rests on it.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.state_and_input import dry_friction
from compiler.time_limits.time_limit import is_late
from solvers.trajectory.friction_inputs import AT_REST, joint_friction
from solvers.trajectory.trajectory import Trajectory

STILL = 1e-11
"""A joint whose rate is below this, in SI, is at rest."""
SPARE = 1e-12
"""A holding effort may exceed friction by this, in N m or N, before the joint moves."""
RELATIVE, ABSOLUTE = 1e-11, 1e-13
CLOSE, MOST_CORRECTIONS = 1e-9, 6
"""The accuracy of rates at the end of a step, in SI; how often inputs are corrected."""
MOST_EVENTS = 200
"""The most events in a step."""

Signs: TypeAlias = tuple[int, ...]
"""The state of each joint: 1 and -1 slide, 0 rests."""


def rubbing_motion(
    numeric: NumericRobot, trajectory: Trajectory, dt: float, parts: int = 1
) -> Array:
    """The states (k parts + 1, N) from the first one under inputs (k, m), held for ``dt`` s each.

    They are NaN from where integration fails, and stay constant once time is up.
    """
    robot = _RubbingRobot(numeric, trajectory.theta)
    states = [trajectory.x[0]]
    for u in trajectory.u:
        if is_late():
            states += [states[-1]] * parts
            continue
        for _ in range(parts):
            states.append(robot.moved(states[-1], u, dt / parts))
    return np.array(states)


def rubbing_inputs(
    numeric: NumericRobot,
    planned: Trajectory,
    added: Array,
    gains: Array,
    dt: float,
    substeps: int,
    final: int,
) -> Array:
    """Inputs (k, m) under which a robot moves as planned without dry friction, if possible.

    If a joint reverses within a step, the friction compensation ``added`` (k, m) is too much or too
    little.  It is corrected until the rates at the end of each step are those without friction,
    with feedback that keeps the motion to the plan; at the last samples, until they are as planned.

    Args:
        numeric: the robot.
        planned: a motion without dry friction.
        added: the first estimate of the friction compensation.
        gains: of feedback from sample to sample, (k, m, N).
        dt: the time of a step, in seconds.
        substeps: the number of parts of a step without friction.
        final: the number of last samples at which rates are as planned, wherever the robot is.
    """
    robot, x = _RubbingRobot(numeric, planned.theta), planned.x[0]
    n, found = numeric.n, np.array(planned.u)
    rates = slice(n, 2 * n)
    for k, wanted in enumerate(planned.x[:-1]):
        last = k >= len(found) - final
        u = planned.u[k] if last else planned.u[k] - gains[k] @ (x - wanted)
        free = numeric.step(x[None, :], u[None, :], planned.theta, dt, substeps)
        target = planned.x[k + 1, rates] if last else free.value[0, rates]
        back = np.linalg.pinv(free.input[0, rates])
        best, u, following = np.inf, u + added[k], x
        for _ in range(MOST_CORRECTIONS):
            end = robot.moved(x, u, dt)
            off = end[rates] - target
            # No input makes a joint that friction holds move at such a small rate.
            off[(np.abs(end[rates]) <= STILL) & (np.abs(target) <= AT_REST)] = 0.0
            if not np.max(np.abs(off)) < best:
                break
            best, found[k], following = float(np.max(np.abs(off))), u, end
            if best < CLOSE:
                break
            u = u - back @ off
        if is_late() or not np.isfinite(best):
            return planned.u + added
        x = following
    return found


def rubbing_loop(
    numeric: NumericRobot, reference: Trajectory, gains: Array, dt: float
) -> Trajectory:
    """The motion under feedback, with the inputs it commands; ``gains`` are (k, m, N)."""
    robot, states = _RubbingRobot(numeric, reference.theta), [reference.x[0]]
    inputs = list[Array]()
    for u, gain, wanted in zip(reference.u, gains, reference.x[:-1], strict=True):
        inputs.append(u - gain @ (states[-1] - wanted))
        states.append(robot.moved(states[-1], inputs[-1], dt))
    return Trajectory(np.array(states), np.array(inputs), reference.theta)


def rates_of_change(numeric: NumericRobot, x: Array, u: Array, theta: Array) -> Array:
    """The derivatives (k, N) of states (k, N) just after inputs (k, m) are applied."""
    if not dry_friction(numeric.graph.model):
        n, rates = numeric.n, numeric.acceleration(x, u, theta)[0]
        return np.concatenate([x[:, n : 2 * n], rates], axis=1)
    robot = _RubbingRobot(numeric, theta)
    return np.array([robot.rates(*each) for each in zip(x, u, strict=True)])


class _RubbingRobot:
    """A robot with its parameters; friction (n,) is in N m or N."""

    def __init__(self, numeric: NumericRobot, theta: Array) -> None:
        self._numeric, self._theta, self._n = numeric, theta, numeric.n
        self._friction = joint_friction(numeric.graph.model)
        self._rubbing = np.flatnonzero(self._friction)

    def _rates(self, x: Array, u: Array, signs: Signs) -> tuple[Array, Array]:
        """The derivative (N,) of a state, and the efforts (n,) that hold joints at rest."""
        n = self._n
        free = self._numeric.acceleration(x[None, :], u[None, :], self._theta)[0][0]
        mass = self._numeric.mass_matrix(x[None, :n], self._theta, u[None, :])[0]
        rests = np.equal(signs, 0) & (self._friction > 0)
        push = mass @ free[:n] - self._friction * np.array(signs)
        pull, moving = np.zeros(n), np.flatnonzero(~rests)
        pull[moving] = np.linalg.solve(mass[np.ix_(moving, moving)], push[moving])
        held = np.where(rests, mass @ pull - push, 0.0)
        return np.concatenate([np.where(rests, 0.0, x[n : 2 * n]), pull, free[n:]]), held

    def rates(self, x: Array, u: Array) -> Array:
        """The derivative (N,) of a state."""
        return self._rates(x, u, self._next_signs(x, u))[0]

    def _next_signs(self, x: Array, u: Array) -> Signs:
        """The signs of the joints' motion from here on."""
        rates = x[self._n : 2 * self._n]
        choices = [
            (0,) if not size else (int(np.sign(v)),) if abs(v) > STILL else (0, 1, -1)
            for v, size in zip(rates, self._friction, strict=True)
        ]
        best, found = np.inf, tuple(each[0] for each in choices)
        for signs in product(*choices):
            wrong = self._wrong(x, u, signs)
            if wrong < best:
                best, found = wrong, signs
            if best <= 0:
                break
        return found

    def _wrong(self, x: Array, u: Array, signs: Signs) -> float:
        """The largest violation of Coulomb's law by joints at rest; 0 if there is none."""
        n = self._n
        rates, held = self._rates(x, u, signs)
        wrong = [0.0]
        for joint in self._rubbing:
            if signs[joint] == 0:
                wrong.append(abs(held[joint]) - self._friction[joint])
            elif abs(x[n + joint]) <= STILL:
                wrong.append(-signs[joint] * rates[n + joint])
        return float(max(wrong))

    def moved(self, x: Array, u: Array, seconds: float) -> Array:
        """The state after ``seconds``; NaN if integration fails."""
        from scipy.integrate import solve_ivp

        time, n = 0.0, self._n
        for _ in range(MOST_EVENTS):
            signs = self._next_signs(x, u)
            x = x.copy()
            for joint in self._rubbing:
                if signs[joint] == 0:
                    x[n + joint] = 0.0

            def slope(_: float, y: Array, signs: Signs = signs) -> Array:
                return self._rates(y, u, signs)[0]

            events = [self._event(joint, u, signs) for joint in self._rubbing.tolist()]
            found = solve_ivp(
                slope, (time, seconds), x, "DOP853", rtol=RELATIVE, atol=ABSOLUTE, events=events
            )
            if found.status < 0:
                break
            x, time = np.asarray(found.y[:, -1]), float(found.t[-1])
            if found.status == 0:
                return x
            for joint, times in zip(self._rubbing, found.t_events, strict=True):
                if len(times) and signs[joint]:
                    x[n + joint] = 0.0
        return np.full_like(x, np.nan)

    def _event(self, joint: int, u: Array, signs: Signs) -> Callable[[float, Array], float]:
        n, sign = self._n, signs[joint]

        def event(_: float, y: Array) -> float:
            if sign:
                # The offset keeps a joint that starts from rest from triggering at once.
                return float(sign * y[n + joint] + STILL / 10)
            held = self._rates(y, u, signs)[1]
            return float(self._friction[joint] + SPARE - abs(held[joint]))

        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        return event

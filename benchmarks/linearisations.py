"""Ways to linearise an arm over all steps: ours, CasADi's expansion, and a loop over Pinocchio."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any, TypeAlias

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import RobotModel
from tests.oracles.robots import constants_of

Jacobians: TypeAlias = tuple[Array, ...]
"""Value (K, N), then Jacobians in x, u and, where computed, theta: (K, N, columns)."""

DT = 0.125
SHORTEST = 0.005
"""Seconds; calls are repeated until a measurement takes so long."""


@dataclass(frozen=True)
class Samples:
    """States (K, 2n), inputs (K, n) and the lengths (n,)."""

    x: Array
    u: Array
    theta: Array


def samples(links: int, steps: int) -> Samples:
    """The same for everybody, drawn with a fixed seed."""
    rng = np.random.default_rng(links)
    x = rng.uniform(-1, 1, (steps, 2 * links))
    return Samples(x, rng.uniform(-3, 3, (steps, links)), rng.uniform(1, 2, links))


@dataclass(frozen=True)
class Competitor:
    """A way to linearise, and the seconds that making it took, with its first call."""

    call: Callable[[], Jacobians]
    built: float


def _made(make: Callable[[], Callable[[], Jacobians]]) -> Competitor:
    started = time.perf_counter()
    call = make()
    call()
    return Competitor(call, time.perf_counter() - started)


def ours(model: RobotModel, at: Samples) -> Competitor:
    """``NumericRobot.step``: always with the Jacobian in theta."""

    def make() -> Callable[[], Jacobians]:
        numeric = NumericRobot(robot_graph(model))

        def call() -> Jacobians:
            found = numeric.step(at.x, at.u, at.theta, DT, 1)
            return found.value, found.state, found.input, found.parameter

        return call

    return _made(make)


def disagreement(first: Jacobians, second: Jacobians) -> float:
    """The largest difference of what both compute, relative to the largest entry."""
    pairs = list(zip(first, second, strict=False))
    return max(float(np.abs(a - b).max() / max(1.0, np.abs(a).max())) for a, b in pairs)


def duration(call: Callable[[], object]) -> float:
    """Seconds a call, over as many as it takes to measure them."""
    repeats, elapsed = 1, 0.0
    while True:
        started = time.perf_counter()
        for _ in range(repeats):
            call()
        elapsed = time.perf_counter() - started
        if elapsed >= SHORTEST:
            return elapsed / repeats
        repeats *= 4


# --- CasADi --------------------------------------------------------------------------------------


def expansion(model: RobotModel, at: Samples, *, theta: bool, cse: bool) -> Competitor:
    """One Runge-Kutta step as an SX graph, its Jacobians by CasADi, mapped over the samples.

    The accelerations are our graph's: elementary operations and no pivoting, which is faster than
    ``ca.solve``.  Called without conversions, through ``Function.buffer``.
    """

    def make() -> Callable[[], Jacobians]:
        graph, count = robot_graph(model), len(at.x)
        n = len(model.dofs)
        x, u, p = ca.SX.sym("x", 2 * n), ca.SX.sym("u", n), ca.SX.sym("p", n)

        def slope(at_x: ca.SX) -> ca.SX:
            rates = graph.acceleration(at_x[:n], at_x[n:], u, p, constants_of(graph))
            return ca.vertcat(at_x[n:], rates)

        first = slope(x)
        second = slope(x + DT / 2 * first)
        third = slope(x + DT / 2 * second)
        fourth = slope(x + DT * third)
        after = x + DT / 6 * (first + 2 * second + 2 * third + fourth)
        outputs = [after, *(ca.jacobian(after, s) for s in ((x, u, p) if theta else (x, u)))]
        outputs = [ca.densify(item) for item in outputs]
        step = ca.Function("step", [x, u, p], ca.cse(outputs) if cse else outputs).map(count)
        buffer, run = step.buffer()
        lengths = np.tile(at.theta, (count, 1))
        results = [np.empty((count, item.size2(), 2 * n)) for item in outputs]

        def call() -> Jacobians:
            for i, item in enumerate((at.x, at.u, lengths)):
                buffer.set_arg(i, memoryview(np.ascontiguousarray(item)))
            for i, item in enumerate(results):
                buffer.set_res(i, memoryview(item))
            run()
            value, *jacobians = results
            return value[:, 0, :], *(item.transpose(0, 2, 1) for item in jacobians)

        return call

    return _made(make)


def best_expansion(model: RobotModel, at: Samples, *, theta: bool) -> Competitor:
    """With or without elimination of common subexpressions, whichever is faster here."""
    both = [expansion(model, at, theta=theta, cse=cse) for cse in (False, True)]
    return min(both, key=lambda made: median(duration(made.call) for _ in range(3)))


# --- Pinocchio -----------------------------------------------------------------------------------


def pinocchio_arm(pin: Any, lengths: Array) -> Any:
    """The arm of uniform rods of 1 kg/m as a Pinocchio model."""
    model, parent, place = pin.Model(), 0, pin.SE3.Identity()
    model.gravity.linear = np.zeros(3)
    for i, length in enumerate(lengths):
        parent = model.addJoint(parent, pin.JointModelRZ(), place, f"q{i}")
        about = length**3 / 12
        inertia = pin.Inertia(length, np.array([length / 2, 0, 0]), np.diag([0.0, about, about]))
        model.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        place = pin.SE3(np.eye(3), np.array([length, 0, 0]))
    return model


def pinocchio_loop(pin: Any, at: Samples) -> Competitor:
    """computeABADerivatives at every stage, the variational equations in numpy; no theta."""

    def make() -> Callable[[], Jacobians]:
        model = pinocchio_arm(pin, at.theta)
        data, n = model.createData(), model.nv
        identity = np.eye(2 * n, 3 * n)

        def slope(x: Array, u: Array, s: Array) -> tuple[Array, Array]:
            pin.computeABADerivatives(model, data, x[:n], x[n:], u)
            moved = np.empty_like(s)
            moved[:n] = s[n:]
            moved[n:] = data.ddq_dq @ s[:n]
            moved[n:] += data.ddq_dv @ s[n:]
            moved[n:, 2 * n :] += data.Minv
            return np.concatenate([x[n:], data.ddq]), moved

        def step(x: Array, u: Array) -> tuple[Array, Array]:
            k1, s1 = slope(x, u, identity)
            k2, s2 = slope(x + DT / 2 * k1, u, identity + DT / 2 * s1)
            k3, s3 = slope(x + DT / 2 * k2, u, identity + DT / 2 * s2)
            k4, s4 = slope(x + DT * k3, u, identity + DT * s3)
            after = x + DT / 6 * (k1 + 2 * (k2 + k3) + k4)
            return after, identity + DT / 6 * (s1 + 2 * (s2 + s3) + s4)

        def call() -> Jacobians:
            found = [step(x, u) for x, u in zip(at.x, at.u, strict=True)]
            value, s = (np.array(part) for part in zip(*found, strict=True))
            return value, s[:, :, : 2 * n], s[:, :, 2 * n :]

        return call

    return _made(make)

r"""The discrete step of a controlled system, and its derivatives, as functions of one sample.

The step is the classical Runge-Kutta method with inputs held (Kutta 1901), its derivatives the
variational equations carried along, so exactly those of the step (Hairer, Norsett & Wanner,
*Solving Ordinary Differential Equations I*, I.14).  Written for q' = v (as Nystrom did, ibid.,
II.14): the stages of q are known polynomials in the accelerations, and so are their derivatives,
which leaves only those of w' to be solved for.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import casadi as ca

from compiler.discretisation.batched_function import on_lanes
from compiler.dynamics.controlled_system import ControlledSystem

Graph = TypeVar("Graph", ca.SX, ca.MX)

NODES = (0.0, 0.5, 0.5, 1.0)


def rates_of_change(system: ControlledSystem) -> ca.Function:
    """``(x, u, (theta, k))`` to w' and its derivatives in (x, u, theta), side by side.

    Shape (n + r, 1 + 2n + r + m + p), x = (q, w).
    """
    n, x, u, theta, k = _symbols(system)
    mass, forces = system.forces(x[:n], x[n:], u, theta, k)
    rate = system.accelerate(mass, forces)
    by_all = system.differential(x[:n], x[n:], rate[:n], u, theta, k)
    both = ca.horzcat(rate, system.accelerate(mass, by_all))
    return ca.Function("rates", [x, u, ca.vertcat(theta, k)], [ca.densify(both)])


def step_map(system: ControlledSystem, lanes: int) -> ca.Function:
    """``(x, u, (theta, k, h))`` to the states a time h later and their derivatives, on lanes.

    Shape (N, 1 + N + m + p), N = 2n + r.  The stages share their programs, which would not stay in
    the processor's cache if they were written out four times.
    """
    n, size = system.coordinates, 2 * system.coordinates + system.states
    height = size - n
    x, u = ca.MX.sym("x", lanes, size), ca.MX.sym("u", lanes, system.inputs)
    shared = ca.MX.sym("shared", system.parameters + len(system.constants) + 1)
    h = shared[-1]
    heart, carry_w, carry_q, solve, finish = (
        on_lanes(f, lanes)
        for f in (_heart(system), *_carries(system), _solution(system), _finish(system))
    )
    none = ca.MX(0, 1)
    rates: list[ca.MX] = []
    slopes: list[ca.MX] = []
    for stage, node in enumerate(NODES):
        found = heart(*_stage(x, h, n, rates), u, shared[:-1])
        rate, mass, moved = ca.horzsplit(found, [0, height, height + n * n, found.size2()])
        by_q, by_v, rest = ca.horzsplit(moved, [0, height * n, 2 * height * n, moved.size2()])
        if stage:
            by_w = moved[:, height * n : height * size]
            moved = ca.horzcat(by_q, by_v + node * h * by_q, rest)
            moved += carry_w(by_w, node * h * slopes[-1], none)
        if stage > 1:
            moved += carry_q(by_q, node * NODES[stage - 1] * h**2 * slopes[-2], none)
        rates.append(rate)
        slopes.append(ca.horzcat(rate, solve(mass, moved, none)))
    return ca.Function("step", [x, u, shared], [finish(x, *_sums(slopes, h), h)])


def _heart(system: ControlledSystem) -> ca.Function:
    """The derivatives of w, M, and dR in (x, u, theta) at one stage, as one column."""
    n, x, u, theta, k = _symbols(system)
    q, w = x[:n], x[n:]
    mass, forces = system.forces(q, w, u, theta, k)
    rates = system.accelerate(mass, forces)
    by_all = system.differential(q, w, rates[:n], u, theta, k)
    parts = ca.vertcat(*(ca.vec(ca.densify(item)) for item in (rates, mass, by_all)))
    return ca.Function("heart", [q, w, u, ca.vertcat(theta, k)], [parts])


def _carries(system: ControlledSystem) -> tuple[ca.Function, ca.Function]:
    """What slopes of w before add to dR through w, and through q."""
    n, height = system.coordinates, system.coordinates + system.states
    width = system.coordinates + height + system.inputs + system.parameters
    slopes = ca.SX.sym("s", height, 1 + width)
    by_w, by_q = ca.SX.sym("w", height, height), ca.SX.sym("q", height, n)
    found = by_w @ slopes[:, 1:], by_q @ slopes[:n, 1:]
    columns = ca.vec(by_w), ca.vec(by_q)
    through_w, through_q = (
        ca.Function("carry", [column, ca.vec(slopes), ca.SX(0, 1)], [ca.densify(value)])
        for column, value in zip(columns, found, strict=True)
    )
    return through_w, through_q


def _solution(system: ControlledSystem) -> ca.Function:
    """N^-1 dR."""
    n, height = system.coordinates, system.coordinates + system.states
    mass = ca.SX.sym("m", n, n)
    moved = ca.SX.sym("d", height, n + height + system.inputs + system.parameters)
    found = ca.densify(system.accelerate(mass, moved))
    return ca.Function("solve", [ca.vec(mass), ca.vec(moved), ca.SX(0, 1)], [found])


def _finish(system: ControlledSystem) -> ca.Function:
    """The state and its derivatives from the weighted sums of the slopes."""
    n, height = system.coordinates, system.coordinates + system.states
    width = 1 + n + height + system.inputs + system.parameters
    x, h = ca.SX.sym("x", n + height), ca.SX.sym("h")
    lead, total = ca.SX.sym("l", height, width), ca.SX.sym("t", height, width)
    size = n + height
    start = ca.horzcat(x, ca.SX.eye(size), ca.SX(size, width - 1 - size))
    after = start + ca.vertcat(h * start[n : 2 * n, :] + lead[:n, :], total)
    return ca.Function("finish", [x, ca.vec(lead), ca.vec(total), h], [ca.densify(after)])


def value_map(system: ControlledSystem) -> ca.Function:
    """``(x, (u, theta, k, h))`` to the state a time h later, shape (N,), without derivatives."""
    n, x, u, theta, k = _symbols(system)
    h = ca.SX.sym("h")
    rates: list[ca.SX] = []
    for _ in NODES:
        place, speed = _stage(x.T, h, n, rates)
        mass, forces = system.forces(place, speed, u, theta, k)
        rates.append(system.accelerate(mass, forces).T)
    lead, total = _sums(rates, h)
    after = x + ca.vertcat(h * x[n : 2 * n] + lead.T[:n], total.T)
    return ca.Function("step", [x, ca.vertcat(u, theta, k, h)], [ca.densify(after)])


def _stage(x: Graph, h: Graph, n: int, rates: Sequence[Graph]) -> tuple[Graph, Graph]:
    """Where the next stage is evaluated: q and w, in a row per sample, as are the rates of w."""
    node, place, speed = NODES[len(rates)] * h, x[:, :n], x[:, n:]
    if rates:
        place = place + node * x[:, n : 2 * n]
        speed = speed + node * rates[-1]
    if len(rates) > 1:
        place = place + node * NODES[len(rates) - 1] * h * rates[-2][:, :n]
    return place, speed


def _sums(slopes: Sequence[Graph], h: Graph) -> tuple[Graph, Graph]:
    """The slopes of w as they move q and w at the end."""
    first, second, third, fourth = slopes
    lead = first + second + third
    return h**2 / 6 * lead, h / 6 * (lead + second + third + fourth)


def _symbols(system: ControlledSystem) -> tuple[int, ca.SX, ca.SX, ca.SX, ca.SX]:
    """n, and the symbols of (x, u, theta, k)."""
    n = system.coordinates
    sizes = (2 * n + system.states, system.inputs, system.parameters, len(system.constants))
    x, u, theta, k = (ca.SX.sym(*item) for item in zip("xutk", sizes, strict=True))
    return n, x, u, theta, k

"""The same control problem as a nonlinear program for IPOPT, by multiple shooting in CasADi.

Waechter & Biegler, *On the implementation of an interior-point filter line-search algorithm*
(2006).  The Runge-Kutta step is an SX graph with our accelerations (elementary operations, no
pivoting), mapped over the steps; derivatives are CasADi's, exact Hessian included.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np

from compiler.arrays import Array
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.step_program import rate_bounds
from solvers.trajectory.subproblem import Weights
from solvers.trajectory.trajectory import Trajectory

OPTIONS = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.max_iter": 1000,
}
INFINITE = 1e20


@dataclass(frozen=True)
class Answer:
    """Where IPOPT ended; ``margin`` is rho, ``status`` its own word."""

    solved: bool
    trajectory: Trajectory
    margin: float
    status: str
    iterations: int


@dataclass(frozen=True)
class IpoptProblem:
    """The nonlinear program, made once; ``theta`` (p,) are the parameters unless they are free."""

    problem: ControlProblem
    steps: int
    theta: Array | None
    solver: ca.Function
    bounds: dict[str, Array]

    def solve(self, seed: Trajectory) -> Answer:
        """The local optimum that IPOPT finds from a seed."""
        margin = max(0.0, min(group.margin(seed.u) for group in self.problem.groups))
        free = seed.theta if self.theta is None else np.zeros(0)
        start = np.concatenate([seed.x.ravel(), seed.u.ravel(), [margin], free])
        found = self.solver(x0=start, **self.bounds)
        stats = self.solver.stats()
        k, size, m = self.steps, self.problem.numeric.size, self.problem.numeric.m
        at = np.asarray(found["x"]).ravel()
        x, u, rest = np.split(at, [(k + 1) * size, (k + 1) * size + k * m])
        theta = rest[1:] if self.theta is None else self.theta
        trajectory = Trajectory(x.reshape(k + 1, size), u.reshape(k, m), theta)
        status, count = str(stats["return_status"]), int(stats["iter_count"])
        return Answer(status == "Solve_Succeeded", trajectory, float(rest[0]), status, count)


def ipopt_problem(
    problem: ControlProblem,
    rows: PositionRows,
    steps: int,
    parameters: Array | tuple[Array, Array],
    options: Mapping[str, object] | None = None,
) -> IpoptProblem:
    """Minimise the peak effort, plus the square of the inputs that our convex step has.

    As there, rho is the least margin of an input: the peak is the bound minus rho.  ``parameters``
    are given, or unknowns in a box; ``options`` are IPOPT's besides the usual ones.
    """
    given = None if isinstance(parameters, tuple) else parameters
    numeric, weight = problem.numeric, Weights().quadratic
    x = ca.MX.sym("x", numeric.size, steps + 1)
    u = ca.MX.sym("u", numeric.m, steps)
    rho = ca.MX.sym("rho")
    theta = ca.MX.sym("theta", numeric.p if given is None else 0)
    step, places = step_function(problem, given), place_function(problem, given)
    after = step.map("steps", "serial", steps, [2], [])(x[:, :-1], u, theta)
    at = places.map("all", "serial", steps + 1, [1], [])(x[: numeric.n, :], theta)
    halves = _half_planes(rows, numeric.d, at)
    inputs = [
        part
        for group in problem.groups
        for one in [u[list(group.inputs), :]]
        for part in (ca.vec(one) + rho - group.upper, -ca.vec(one) + rho + group.lower)
    ]
    below = ca.vertcat(halves, *inputs)
    equal = ca.vec(after - x[:, 1:])
    objective = -rho / problem.scale + weight * ca.sumsqr(u / problem.scale)
    unknowns = ca.vertcat(ca.vec(x), ca.vec(u), rho, theta)
    program = {"x": unknowns, "f": objective, "g": ca.vertcat(equal, below)}
    solver = ca.nlpsol("control", "ipopt", program, {**OPTIONS, **(options or {})})
    none = np.zeros(0), np.zeros(0)
    lower, upper = _bounds(problem, steps, parameters if isinstance(parameters, tuple) else none)
    bounds = {
        "lbx": lower,
        "ubx": upper,
        "lbg": np.concatenate([np.zeros(equal.numel()), np.full(below.numel(), -np.inf)]),
        "ubg": np.zeros(equal.numel() + below.numel()),
    }
    return IpoptProblem(problem, steps, given, solver, bounds)


def step_function(problem: ControlProblem, given: Array | None) -> ca.Function:
    """(x, u, theta) to the state after a step: the classical Runge-Kutta method with substeps."""
    graph, n = problem.numeric.graph, problem.numeric.n
    constants = ca.DM(problem.numeric.constants)
    x, u = ca.SX.sym("x", 2 * n), ca.SX.sym("u", problem.numeric.m)
    free, theta = _parameters(problem, given)
    h, at = problem.dt / problem.substeps, x

    def slope(state: ca.SX) -> ca.SX:
        rates = graph.acceleration(state[:n], state[n:], u, theta, constants)
        return ca.vertcat(state[n:], rates)

    for _ in range(problem.substeps):
        first = slope(at)
        second = slope(at + h / 2 * first)
        third = slope(at + h / 2 * second)
        fourth = slope(at + h * third)
        at = at + h / 6 * (first + 2 * second + 2 * third + fourth)
    return ca.Function("step", [x, u, free], [ca.cse(at)])


def _parameters(problem: ControlProblem, given: Array | None) -> tuple[ca.SX, ca.SX]:
    """What of the parameters is unknown, and all of them."""
    if given is not None:
        return ca.SX.sym("theta", 0), ca.SX(ca.DM(given))
    free = ca.SX.sym("theta", problem.numeric.p)
    return free, free


def place_function(problem: ControlProblem, given: Array | None) -> ca.Function:
    """(q, theta) to the positions of all points, in a column."""
    numeric, pose = problem.numeric, ca.SX.sym("q", problem.numeric.n)
    free, theta = _parameters(problem, given)
    at = numeric.graph.points(pose, theta, ca.DM(numeric.constants))
    return ca.Function("places", [pose, free], [at])


def _half_planes(rows: PositionRows, dimension: int, at: ca.MX) -> ca.MX:
    """normal . p - offset of every row, for positions with a column per sample."""
    flat, height = ca.vec(at), at.size1()
    total = -ca.DM(rows.offset)
    for axis in range(dimension):
        picked = flat[(rows.sample * height + rows.point * dimension + axis).tolist()]
        total = total + ca.DM(rows.normal[:, axis]) * picked
    return total


def unknown_bounds(problem: ControlProblem, steps: int) -> tuple[Array, Array]:
    """Bounds of all states, (k + 1, N) each."""
    limits, n, size = problem.limits, problem.numeric.n, problem.numeric.size
    lower, upper = np.full((steps + 1, size), -np.inf), np.full((steps + 1, size), np.inf)
    lower[:, :n], upper[:, :n] = limits.lower, limits.upper
    lower[:, n : 2 * n], upper[:, n : 2 * n] = rate_bounds(limits, steps)
    for sample, bound in ((0, limits.start_rates), (steps, limits.final_rates)):
        if bound == 0.0:
            lower[sample, n : 2 * n] = upper[sample, n : 2 * n] = 0.0
    if limits.start_values is not None:
        lower[0, :n] = upper[0, :n] = limits.start_values
    return lower, upper


def _bounds(
    problem: ControlProblem, steps: int, parameters: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Bounds of all unknowns."""
    lower, upper = unknown_bounds(problem, steps)
    inputs = np.full(steps * problem.numeric.m, np.inf)
    widest = min(group.widest_margin for group in problem.groups)
    return (
        np.concatenate([lower.ravel(), -inputs, [0.0], parameters[0]]),
        np.concatenate([upper.ravel(), inputs, [widest], parameters[1]]),
    )

"""The same control problem written stage by stage, for FATROP and IPOPT.

Vanroye, Sathya, De Schutter & Decre, *FATROP: A Fast Constrained Optimal Control Problem Solver for
Robot Trajectory Optimization and Control* (2023).  Unknowns and constraints are ordered by sample,
and rho is a state that does not change, so that the solver sees an optimal control problem whose
stages are joined by the dynamics alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
from control_ipopt import Answer, place_function, step_function, unknown_bounds

from compiler.arrays import Array
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.subproblem import Weights
from solvers.trajectory.trajectory import Trajectory

SOLVERS: Mapping[str, Mapping[str, object]] = {
    "fatrop": {"print_time": False, "fatrop.print_level": 0, "fatrop.max_iter": 1000},
    "ipopt": {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.max_iter": 1000,
        "ipopt.mu_strategy": "adaptive",
    },
}


@dataclass(slots=True)
class _Constraints:
    """Constraints in order, with their bounds, and which of them are equations."""

    values: list[ca.MX] = field(default_factory=list[ca.MX])
    lower: list[float] = field(default_factory=list[float])
    upper: list[float] = field(default_factory=list[float])
    equal: list[bool] = field(default_factory=list[bool])

    def add(self, value: ca.MX, lower: Array | float, upper: Array | float) -> None:
        size = value.numel()
        low, high = (np.broadcast_to(bound, size).tolist() for bound in (lower, upper))
        self.values.append(value)
        self.lower += low
        self.upper += high
        self.equal += [a == b for a, b in zip(low, high, strict=True)]


@dataclass(frozen=True)
class StagedProblem:
    """The nonlinear program, made once."""

    problem: ControlProblem
    steps: int
    theta: Array
    solver: ca.Function
    bounds: dict[str, list[float]]

    def solve(self, seed: Trajectory) -> Answer:
        """The local optimum that the solver finds from a seed."""
        size, m = self.problem.numeric.size, self.problem.numeric.m
        margin = max(0.0, min(group.margin(seed.u) for group in self.problem.groups))
        full = np.full((self.steps + 1, size + 1 + m), margin)
        full[:, :size], full[:-1, size + 1 :] = seed.x, seed.u
        found = self.solver(x0=full.ravel()[:-m], **self.bounds)
        at = np.append(np.asarray(found["x"]).ravel(), np.zeros(m)).reshape(full.shape)
        stats = self.solver.stats()
        trajectory = Trajectory(at[:, :size], at[:-1, size + 1 :], self.theta)
        solved, count = bool(stats["success"]), int(stats["iter_count"])
        return Answer(solved, trajectory, float(at[-1, size]), str(stats["return_status"]), count)


def staged_problem(
    problem: ControlProblem,
    rows: PositionRows,
    steps: int,
    theta: Array,
    solver: str,
    options: Mapping[str, object] | None = None,
) -> StagedProblem:
    """The objective and the constraints of ``ipopt_problem``, for given parameters (p,)."""
    numeric, scale = problem.numeric, problem.scale
    size, none = numeric.size, ca.MX(0, 1)
    step, places = step_function(problem, theta), place_function(problem, theta)
    x = [ca.MX.sym(f"x{i}", size + 1) for i in range(steps + 1)]
    u = [ca.MX.sym(f"u{i}", numeric.m) for i in range(steps)]
    lower, upper = unknown_bounds(problem, steps)
    widest = min(group.widest_margin for group in problem.groups)
    unknowns, low, high = list[ca.MX](), list[float](), list[float]()
    constraints, objective = _Constraints(), -x[-1][size] / scale
    for i in range(steps + 1):
        unknowns.append(x[i])
        low += [*lower[i].tolist(), 0.0]
        high += [*upper[i].tolist(), widest]
        if i < steps:
            unknowns.append(u[i])
            low += [-np.inf] * numeric.m
            high += [np.inf] * numeric.m
            after = ca.vertcat(step(x[i][:size], u[i], none), x[i][size])
            constraints.add(x[i + 1] - after, 0.0, 0.0)
            for group in problem.groups:
                some, rho = u[i][list(group.inputs)], x[i][size]
                constraints.add(some + rho, -np.inf, group.upper)
                constraints.add(some - rho, group.lower, np.inf)
            objective += Weights().quadratic * ca.sumsqr(u[i] / scale)
        here = np.flatnonzero(rows.sample == i)
        if len(here):
            at = places(x[i][: numeric.n], none)
            matrix = np.zeros((len(here), at.numel() // numeric.d, numeric.d))
            matrix[np.arange(len(here)), rows.point[here]] = rows.normal[here]
            flat = ca.DM(matrix.reshape(len(here), -1))
            constraints.add(flat @ at, -np.inf, rows.offset[here])
    chosen = {**SOLVERS[solver], **(options or {})}
    if solver == "fatrop":
        chosen |= {"structure_detection": "auto", "equality": constraints.equal}
    program = {
        "x": ca.vertcat(*unknowns), "f": objective, "g": ca.vertcat(*constraints.values),
    }  # fmt: skip
    bounds = {"lbx": low, "ubx": high, "lbg": constraints.lower, "ubg": constraints.upper}
    return StagedProblem(
        problem, steps, theta, ca.nlpsol("stages", solver, program, chosen), bounds
    )

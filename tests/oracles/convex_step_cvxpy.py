r"""The convex step of the control synthesis, written down once more in cvxpy.

Given a reference (x^, u^, theta^), the linearised step

.. math:: f_i + A_i (x_i - \hat x_i) + B_i (u_i - \hat u_i) + C_i (\theta - \hat\theta),

the linearised positions p(i, j) and unit fictitious inputs B'_i, this solves

.. math::
    \max_{x, u, v, \theta, V, \sigma, \rho}\quad & \rho - w_V V - w_\sigma \sigma
        - \varepsilon \sum_i \lVert u_i \rVert_2^2 \\
    \text{s.t.}\quad & x_{i+1} = \text{(the above)} + B'_i v_i,
        \qquad \lVert v_i \rVert_\infty \le V \\
    & |u_{ij}| \le \bar u_g - \rho \ (j \in g) \quad\text{or}\quad
        \lVert u_{ig} \rVert_2 \le \bar u_g - \rho, \qquad \rho \le \min_g \bar u_g \\
    & n_r \cdot p(i_r, j_r) \le b_r + \sigma, \qquad \sigma \ge 0 \\
    & q_{\min} \le q_i \le q_{\max} \text{ (but where given)}, \quad
        \dot q_{\min} \le \dot q_i \le \dot q_{\max} \\
    & q_0 = q_s \text{ (where given)}, \quad |\dot q_0| \le r_0, \quad |\dot q_k| \le r_k \\
    & |q_i - \hat q_i| \le R, \quad
        |\theta_j - \hat\theta_j| \le R \max(|\hat\theta_j|, 0.1), \quad
        \theta_{\min} \le \theta \le \theta_{\max}.

Without a box for the parameters, theta is theta^.  With epsilon (Problem 4 and C.6) there is one
slack per step instead of V and no reward for rho:

.. math::
    \min\ w_V \sum_i g_i + w_\sigma \sigma + \varepsilon \sum_i \lVert u_i \rVert_2^2, \qquad
    \lVert v_i \rVert_\infty \le g_i, \quad \epsilon \sum_{l<i} g_l \le g_i, \quad \rho \ge 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from solvers.motions.convex_step import Model, PositionRows, Weights
from solvers.motions.motion_limits import InputGroup, MotionLimits

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reference:
    """The optimum: objective (to be maximised), and what attains it."""

    value: float
    x: Array
    u: Array
    v: Array
    theta: Array
    fictitious: float
    slack: float
    margin: float


def _bounded(rates: cp.Expression, bound: float) -> list[cp.Constraint]:
    if np.isinf(bound):
        return []
    return [cp.abs(rates) <= bound]


def _between(values: cp.Expression, lower: Array, upper: Array) -> list[cp.Constraint]:
    constraints = []
    for j in range(len(lower)):
        if np.isfinite(lower[j]):
            constraints.append(values[:, j] >= lower[j])
        if np.isfinite(upper[j]):
            constraints.append(values[:, j] <= upper[j])
    return constraints


def _inputs(
    u: cp.Variable, rho: cp.Variable, groups: tuple[InputGroup, ...]
) -> list[cp.Constraint]:
    constraints = []
    for group in groups:
        inputs = u[:, list(group.inputs)]
        if group.norm2:
            constraints += [cp.norm(inputs, 2, axis=1) <= group.upper - rho, rho <= group.upper]
            continue
        constraints += [inputs <= group.upper - rho, inputs >= group.lower + rho]
        constraints.append(2 * rho <= group.upper - group.lower)
    return constraints or [rho <= 0]


def _limits(x: cp.Variable, limits: MotionLimits) -> list[cp.Constraint]:
    n = len(limits.lower)
    first = 0 if limits.start_values is None else 1
    constraints = _between(x[first:, :n], limits.lower, limits.upper)
    v = x[:, n : 2 * n]
    constraints += _between(v, limits.rate_lower, limits.rate_upper)
    constraints += _bounded(v[0], limits.start_rates) + _bounded(v[-1], limits.final_rates)
    if len(limits.own_start):
        constraints.append(x[0, 2 * n :] == limits.own_start)
    if limits.start_values is not None:
        constraints.append(x[0, :n] == limits.start_values)
    return constraints


def solve_reference(
    model: Model,
    rows: PositionRows,
    limits: MotionLimits,
    groups: tuple[InputGroup, ...],
    radius: float,
    theta_box: tuple[Array, Array] | None,
    weights: Weights,
    epsilon: float | None = None,
) -> Reference:
    about, dynamics, points = model.about, model.dynamics, model.points
    (k, m), n, size = about.u.shape, len(limits.lower), about.x.shape[1]
    x, u, v = cp.Variable((k + 1, size)), cp.Variable((k, m)), cp.Variable((k, size))
    largest, sigma, rho = cp.Variable(), cp.Variable(nonneg=True), cp.Variable()
    change: cp.Expression = cp.Constant(np.zeros(len(about.theta)))
    constraints: list[cp.Constraint] = []
    if theta_box is not None:
        change = cp.Variable(len(about.theta))
        reach = radius * np.maximum(np.abs(about.theta), 0.1)
        constraints += [about.theta + change >= theta_box[0], about.theta + change <= theta_box[1]]
        constraints += [cp.abs(change) <= reach]
    for i in range(k):
        after = dynamics.value[i] + dynamics.state[i] @ (x[i] - about.x[i])
        after += dynamics.input[i] @ (u[i] - about.u[i]) + model.fictitious[i] @ v[i]
        if len(about.theta):
            after += dynamics.parameter[i] @ change
        constraints.append(x[i + 1] == after)
    g = cp.Variable(k)
    if epsilon is None:
        constraints += [cp.abs(v) <= largest]
    else:
        constraints += [cp.max(cp.abs(v), axis=1) <= g, rho >= 0, largest == 0]
        constraints += [epsilon * cp.sum(g[:i]) <= g[i] for i in range(1, k)]
    for sample, point, normal, offset in zip(
        rows.sample, rows.point, rows.normal, rows.offset, strict=True
    ):
        q = x[int(sample), :n] - about.x[sample, :n]
        position = points.value[sample, point] + points.by_q[sample, point] @ q
        if len(about.theta):
            position += points.by_theta[sample, point] @ change
        constraints.append(normal @ position <= offset + sigma)
    constraints += _inputs(u, rho, groups) + _limits(x, limits)
    constraints.append(cp.abs(x[:, :n] - about.x[:, :n]) <= radius)
    objective = rho - weights.fictitious * largest - weights.position * sigma
    objective -= weights.quadratic * cp.sum_squares(u)
    if epsilon is not None:
        objective -= rho + weights.fictitious * cp.sum(g)
    problem = cp.Problem(cp.Maximize(objective), constraints)
    problem.solve(solver=cp.CLARABEL)
    if problem.status != cp.OPTIMAL:
        raise ArithmeticError(problem.status)
    theta = about.theta + np.asarray(change.value).ravel()
    return Reference(
        float(problem.value), x.value, u.value, v.value, theta,
        float(largest.value), float(sigma.value), float(rho.value),
    )  # fmt: skip

r"""One convex step as written on paper, in cvxpy: the reference for the sparse one.

About a trajectory :math:`\hat x, \hat u, \hat\theta`, with the step linearised there
(:math:`f_i, A_i, B_i, C_i`), unit fictitious inputs :math:`B'_i` and points :math:`p(i, j)`,

.. math::
    \max_{x, u, v, \theta, V, \sigma, \rho}\quad & (\rho - w_V V) / S - w_\sigma \sigma
        - w_u \lVert u / S \rVert^2 - w_q \lVert q - \hat q \rVert^2
        - w_q (k + 1) \lVert (\theta - \hat\theta) / \bar\theta \rVert^2 \\
    \text{(C.1)}\quad & n_r \cdot p(i_r, j_r) \le b_r + \sigma, \qquad \sigma \ge 0 \\
    \text{(C.2)}\quad & x_{i+1} = f_i + A_i (x_i - \hat x_i) + B_i (u_i - \hat u_i)
        + C_i (\theta - \hat\theta) + B'_i v_i \\
    \text{(C.3)}\quad & \underline u + w_j \rho \le u_{ij} \le \bar u - w_j \rho
        \quad\text{or}\quad \lVert u_{ig} \rVert_2 \le \bar u - w_g \rho, \qquad \rho \ge 0 \\
    \text{(C.4), (C.5)}\quad & \lVert v_i \rVert_\infty \le V

within the limits of the motion and the trust region.  With :math:`\epsilon` (Problem 4) every step
has its own slack, the sum of the slacks has a price, and rho has no weight:

.. math::
    \text{(C.6)}\quad \lVert v_i \rVert_\infty \le g_i, \qquad \epsilon \sum_{l<i} g_l \le g_i.

S is the largest margin of any input, and w that of one input over S.  If rates have a price
:math:`w_v`, it times the sum of their squares is subtracted.  If mobility has a price
:math:`w_\varphi`, it times the linearised change of the sum of :math:`\varphi_i` is subtracted;
likewise prices of parameters times their changes.
The same tiny multiple of the square of every other unknown makes the optimum unique.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import cvxpy as cp
import numpy as np

from compiler.arrays import Array
from solvers.backends.conic import NotSolved
from solvers.backends.cvxpy_solvers import solved
from solvers.trajectory.linear_model import Model, PositionRows
from solvers.trajectory.subproblem import LEAST, StepResult, SubproblemSpec, TrustRegion
from solvers.trajectory.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class ReferenceStep:
    """The convex steps of one question, each written and solved from scratch."""

    question: SubproblemSpec
    solver: str = "CLARABEL"

    def solve(
        self,
        model: Model,
        rows: PositionRows,
        region: TrustRegion,
        accuracy: float = 1e-8,
        *,
        fictitious: bool = True,
    ) -> StepResult | NotSolved:
        """The optimum of the step about a trajectory; without ``fictitious`` inputs v is 0."""
        step = _Step(self.question, model, rows, region, fictitious)
        problem = cp.Problem(cp.Maximize(step.objective()), step.constraints())
        failure = solved(problem, self.solver, accuracy)
        return step.result() if failure is None else failure


@dataclass(slots=True)
class _Step:
    """The unknowns of one step, and their constraints."""

    question: SubproblemSpec
    model: Model
    rows: PositionRows
    region: TrustRegion
    fictitious: bool
    x: cp.Variable = field(init=False)
    u: cp.Variable = field(init=False)
    v: cp.Variable = field(init=False)
    theta: cp.Expression = field(init=False)
    g: cp.Variable = field(init=False)
    largest: cp.Variable = field(init=False)
    sigma: cp.Variable = field(init=False)
    rho: cp.Variable = field(init=False)

    def __post_init__(self) -> None:
        about = self.model.about
        k = len(about.u)
        self.x, self.u = cp.Variable(about.x.shape), cp.Variable(about.u.shape)
        self.v, self.g = cp.Variable(about.x[1:].shape), cp.Variable(k)
        self.largest, self.sigma, self.rho = (cp.Variable(nonneg=True) for _ in range(3))
        if self.free:
            self.theta = cp.Variable(len(about.theta))
        else:
            self.theta = cp.Constant(about.theta)

    @property
    def free(self) -> bool:
        """Whether the parameters are unknowns."""
        return self.question.theta_box is not None and len(self.model.about.theta) > 0

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return self.question.limits.joints

    # --- the objective --------------------------------------------------------------------------

    def objective(self) -> cp.Expression:
        """The expression to maximise."""
        weights, scale, about = self.question.weights, self.question.scale, self.model.about
        moves = cp.sum_squares(self.x[:, : self.n] - about.x[:, : self.n])
        if self.free:
            size = np.maximum(np.abs(about.theta), LEAST)
            moves += len(about.x) * cp.sum_squares((self.theta - about.theta) / size)
        if self.question.epsilon is None:
            worth = (self.rho - weights.fictitious * self.largest) / scale
        else:
            worth = -weights.fictitious * cp.sum(self.g) / scale
        rest = [self.x[:, self.n :], self.v, self.g, self.largest, self.sigma, self.rho]
        return (
            worth
            - weights.position * self.sigma
            - weights.quadratic * cp.sum_squares(self.u / scale)
            - self.region.proximal * moves
            - weights.regular / 2 * sum(cp.sum_squares(unknown) for unknown in rest)
            - weights.rates * cp.sum_squares(self.x[:, self.n : 2 * self.n])
            - weights.mobility * self.pushed()
            - self.paid()
        )

    def paid(self) -> cp.Expression:
        """The price of what the parameters grow by."""
        prices = self.question.weights.parameters
        if not prices:
            return cp.Constant(0.0)
        return np.array(prices) @ (self.theta - self.model.about.theta)

    def pushed(self) -> cp.Expression:
        """The growth of phi, summed over the samples, to first order."""
        given, about = self.model.mobility, self.model.about
        if given is None:
            return cp.Constant(0.0)
        grown = cp.sum(cp.multiply(given.by_q, (self.x - about.x)[:-1, : self.n]))
        return grown + given.by_theta.sum(axis=0) @ (self.theta - about.theta)

    # --- the constraints ------------------------------------------------------------------------

    def constraints(self) -> list[cp.Constraint]:
        """All constraints."""
        return [
            *self.positions(),
            *self.dynamics(),
            *self.inputs(),
            *self.slacks(),
            *self.limits(),
            *self.trust(),
            *self.holding(),
        ]

    def positions(self) -> list[cp.Constraint]:
        """C.1: points in the half-planes of the path and of the separations."""
        rows, points, about = self.rows, self.model.points, self.model.about
        if not len(rows.sample):
            return []
        normal, pick = rows.normal[:, None, :], (rows.sample, rows.point)
        value = np.einsum("rd,rd->r", rows.normal, points.value[pick])
        by_q = (normal @ points.by_q[pick])[:, 0, :]
        at = value + _rowwise(by_q, (self.x - about.x)[rows.sample, : self.n])
        if self.free:
            at += (normal @ points.by_theta[pick])[:, 0, :] @ (self.theta - about.theta)
        return [at <= rows.offset + self.sigma]

    def holding(self) -> list[cp.Constraint]:
        """Inputs that balance the robot at its start are within their bounds."""
        rows, about = self.model.holding, self.model.about
        if rows is None:
            return []
        used = rows.by_q @ (self.x[0, : self.n] - about.x[0, : self.n])
        if self.free:
            used += rows.by_theta @ (self.theta - about.theta)
        return [used <= rows.slack + self.sigma]

    def dynamics(self) -> list[cp.Constraint]:
        """C.2: the linearised step, one entry of the state after the other."""
        about, step = self.model.about, self.model.dynamics
        dx, du = self.x[:-1] - about.x[:-1], self.u - about.u
        found = []
        for j in range(about.x.shape[1]):
            after = step.value[:, j] + _rowwise(step.state[:, j], dx)
            after += _rowwise(step.input[:, j], du) + _rowwise(self.model.fictitious[:, j], self.v)
            if self.free:
                after += step.parameter[:, j] @ (self.theta - about.theta)
            found.append(self.x[1:, j] == after)
        return found

    def inputs(self) -> list[cp.Constraint]:
        """C.3: inputs keep equal shares of their widest margins; rho is that of the largest one."""
        free = any(group.widest_margin > 0 for group in self.question.groups)
        found = [] if free else [self.rho <= 0]
        for group in self.question.groups:
            u = self.u[:, list(group.inputs)]
            weight = group.weight(self.question.scale)
            found += [self.rho <= group.widest_margin / weight] if weight else []
            if group.norm2:
                found.append(cp.norm(u, 2, axis=1) <= group.upper - weight * self.rho)
            else:
                room = weight * self.rho
                found += [u <= group.upper - room, u >= group.lower + room]
            if group.kept.size:
                lower, upper = (np.broadcast_to(end, u.shape) for end in group.bounds())
                found += [cp.norm(u, 2, axis=1) <= upper[:, 0]] if group.norm2 else []
                found += [] if group.norm2 else [u >= lower, u <= upper]
        return found

    def slacks(self) -> list[cp.Constraint]:
        """C.4 and C.5: fictitious inputs up to V; or C.6, which moves slacks to the end."""
        epsilon = self.question.epsilon
        if not self.fictitious:
            return [self.v == 0, self.g == 0, self.largest == 0]
        if epsilon is None:
            return [cp.abs(self.v) <= self.largest, self.g == 0]
        earlier = np.tri(len(self.model.about.u), k=-1)
        own = [cp.abs(self.v[:, j]) <= self.g for j in range(self.v.shape[1])]
        return [*own, epsilon * (earlier @ self.g) <= self.g, self.largest == 0]

    def limits(self) -> list[cp.Constraint]:
        """Limits of joints and rates, and conditions at the two ends."""
        limits, n = self.question.limits, self.n
        first = 0 if limits.start_values is None else 1
        q, rates, own = self.x[:, :n], self.x[:, n : 2 * n], self.x[0, 2 * n :]
        found = _between(q, limits.lower, limits.upper, first)
        found += _between(rates, limits.rate_lower, limits.rate_upper)
        if self.model.rises is not None:
            moved = rates[1:] - rates[:-1]
            up, down = self.model.rises
            found += _between(moved, -down, up)
        final = rates[-limits.final_samples :]
        for end, bound in (rates[0], limits.start_rates), (final, limits.final_rates):
            if np.isfinite(bound):
                found.append(cp.abs(end) <= bound)
        if limits.start_values is not None:
            found.append(q[0] == limits.start_values)
        if len(limits.own_start):
            found.append(own == limits.own_start)
        if limits.loop is not None:
            found.append(self.x[-1] == self.x[limits.loop] + limits.turned)
        return found

    def trust(self) -> list[cp.Constraint]:
        """The trust region, and the box of the parameters."""
        limits, radius, about = self.question.limits, self.region.radius, self.model.about
        first = 0 if limits.start_values is None else 1
        centre = np.clip(about.x[:, : self.n], limits.lower, limits.upper)[first:]
        found = [cp.abs(self.x[first:, : self.n] - centre) <= radius]
        box = self.question.theta_box
        if self.free and box is not None:
            reach = radius * np.maximum(np.abs(about.theta), LEAST)
            found += [self.theta >= box[0], self.theta <= box[1]]
            found.append(cp.abs(self.theta - about.theta) <= reach)
        return found

    # --- the answer -----------------------------------------------------------------------------

    def result(self) -> StepResult:
        """The values of the unknowns."""
        x, u, theta = (np.array(part.value) for part in (self.x, self.u, self.theta))
        v = np.array(self.v.value) if self.fictitious else np.zeros_like(x[1:])
        return StepResult(
            Trajectory(x, u, theta),
            v,
            float(np.max(np.abs(v), initial=0.0)),
            max(0.0, float(self.sigma.value)),
            float(self.rho.value),
        )


def _rowwise(matrix: Array, unknown: cp.Expression) -> cp.Expression:
    """The products of corresponding rows."""
    return cp.sum(cp.multiply(matrix, unknown), axis=1)


def _between(
    values: cp.Expression, lower: Array, upper: Array, first: int = 0
) -> list[cp.Constraint]:
    """Columns within bounds, from row ``first`` on, if the bounds are finite."""
    found = []
    ends = (np.broadcast_to(end, values.shape)[first:].T for end in (lower, upper))
    for j, (low, high) in enumerate(zip(*ends, strict=True)):
        found += [values[first:, j] >= low] if np.isfinite(low).all() else []
        found += [values[first:, j] <= high] if np.isfinite(high).all() else []
    return found

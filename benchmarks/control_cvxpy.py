"""The same control problem by sequential convex programming as one writes it with cvxpy.

Penalised trust regions: Mao, Szmuk & Acikmese, *Successive convexification of non-convex optimal
control problems and its convergence properties* (CDC 2016); Malyuta et al., *Convex optimization
for trajectory generation* (2022).  The robot is linearised by our own code, which is quicker than
what one would write.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import cvxpy as cp
import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import Linearisation
from solvers.trajectory.control_problem import ControlProblem, input_margin
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.subproblem import Weights
from solvers.trajectory.trajectory import Trajectory

VIRTUAL, SLACK = 50.0, 100.0
"""Prices of virtual controls (rad or rad/s) and of metres outside a half-plane."""
WORSE, BETTER = 0.25, 0.7
"""Ratios of actual to predicted gain at which the trust region shrinks and grows."""
RADIUS, LARGEST = 0.5, 2.0
GAIN = 1e-5
"""The iteration ends where the convex step promises no more, in units of the effort bound."""
ITERATIONS = 200


@dataclass(frozen=True)
class Answer:
    """Where the loop ended; ``violation`` is the largest of defects and excesses, SI."""

    trajectory: Trajectory
    margin: float
    violation: float
    iterations: int


class Form(Enum):
    """How the convex steps are written."""

    BY_STEP = "a constraint per step, rebuilt"
    AT_ONCE = "all steps at once, rebuilt"
    PARAMETRISED = "all steps at once, parameters"


@dataclass
class CvxpyLoop:
    """A loop for one problem without limits of rates, in one of the ways to write it."""

    problem: ControlProblem
    rows: PositionRows
    steps: int
    form: Form
    _program: _Program | None = field(default=None, init=False)

    def prepare(self, seed: Trajectory) -> None:
        """Compile the parametrised program, by solving it once."""
        if self.form is Form.PARAMETRISED:
            self._program = _Program(self, None)
            self._step(seed, self._linearised(seed), RADIUS)

    def solve(self, seed: Trajectory) -> Answer:
        """Iterate from a seed until no gain is promised."""
        at, radius, used = seed, RADIUS, 0
        dynamics = self._linearised(at)
        value = self._value(at, dynamics)
        while used < ITERATIONS:
            used += 1
            trial, promised = self._step(at, dynamics, radius)
            if value - promised <= GAIN:
                break
            after = self._linearised(trial)
            reached = self._value(trial, after)
            share = (value - reached) / (value - promised)
            if share > 0:
                at, dynamics, value = trial, after, reached
            if share < WORSE:
                radius /= 2
            elif share > BETTER:
                radius = min(2 * radius, LARGEST)
        defect = float(np.max(np.abs(at.x[1:] - dynamics.value)))
        violation = max(defect, self._excess(at))
        margin = input_margin(self.problem.groups, at.u)
        return Answer(at, margin, violation, used)

    def _linearised(self, at: Trajectory) -> Linearisation:
        problem = self.problem
        return problem.numeric.step(at.x[:-1], at.u, at.theta, problem.dt, problem.substeps)

    def _excess(self, at: Trajectory) -> float:
        points = self.problem.numeric.points(at.x[:, : self.problem.numeric.n], at.theta)
        return max(0.0, float(np.max(self.rows.excess(points))))

    def _value(self, at: Trajectory, dynamics: Linearisation) -> float:
        """The objective of the robot itself with its violations, which are to sink."""
        scale = self.problem.scale
        defects = float(np.sum(np.abs(at.x[1:] - dynamics.value)))
        efforts = Weights().quadratic * float(np.sum((at.u / scale) ** 2))
        margin = input_margin(self.problem.groups, at.u)
        return -margin / scale + efforts + VIRTUAL * defects + SLACK * self._excess(at)

    def _step(
        self, at: Trajectory, dynamics: Linearisation, radius: float
    ) -> tuple[Trajectory, float]:
        """The optimum of the convex step and what it promises."""
        numbers = self._numbers(at, dynamics, radius)
        program = self._program
        if program is None:
            program = _Program(self, numbers)
        else:
            program.give(numbers)
        program.problem.solve(solver=cp.CLARABEL)
        if program.problem.status not in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
            raise SystemExit(f"cvxpy: {program.problem.status}")
        found = Trajectory(np.array(program.x.value), np.array(program.u.value), at.theta)
        return found, float(program.problem.value)

    def _numbers(self, at: Trajectory, dynamics: Linearisation, radius: float) -> dict[str, Array]:
        """All that changes from step to step."""
        n, rows = self.problem.numeric.n, self.rows
        points = self.problem.numeric.points(at.x[:, :n], at.theta)
        pick = (rows.sample, rows.point)
        by_q = (rows.normal[:, None, :] @ points.by_q[pick])[:, 0, :]
        here = np.einsum("rd,rd->r", rows.normal, points.value[pick])
        moved = np.einsum("rn,rn->r", by_q, at.x[rows.sample, :n])
        rest = dynamics.value - np.einsum("kij,kj->ki", dynamics.state, at.x[:-1])
        rest -= np.einsum("kij,kj->ki", dynamics.input, at.u)
        named = {"rest": rest, "by_q": by_q, "room": rows.offset - here + moved}
        limits = self.problem.limits
        named["low"] = np.maximum(limits.lower, np.minimum(at.x[:, :n], limits.upper) - radius)
        named["high"] = np.minimum(limits.upper, np.maximum(at.x[:, :n], limits.lower) + radius)
        for j in range(2 * n):
            named[f"A{j}"], named[f"B{j}"] = dynamics.state[:, j], dynamics.input[:, j]
        return named


class _Program:
    """The convex step in cvxpy, of numbers or, without any, of parameters."""

    def __init__(self, loop: CvxpyLoop, numbers: dict[str, Array] | None) -> None:
        numeric, k = loop.problem.numeric, loop.steps
        self.x, self.u = cp.Variable((k + 1, numeric.size)), cp.Variable((k, numeric.m))
        self.v = cp.Variable((k, numeric.size))
        self.rho, self.sigma = cp.Variable(nonneg=True), cp.Variable(nonneg=True)
        self.parameters = {} if numbers is not None else self._declared(loop)
        self.problem = self._written(loop, numbers or self.parameters)

    def give(self, numbers: dict[str, Array]) -> None:
        """New numbers for the parameters."""
        for name, value in numbers.items():
            self.parameters[name].value = value

    @staticmethod
    def _declared(loop: CvxpyLoop) -> dict[str, Any]:
        numeric, k, rows = loop.problem.numeric, loop.steps, len(loop.rows.sample)
        shapes = {"rest": (k, numeric.size), "by_q": (rows, numeric.n), "room": (rows,)}
        shapes |= {"low": (k + 1, numeric.n), "high": (k + 1, numeric.n)}
        for j in range(numeric.size):
            shapes |= {f"A{j}": (k, numeric.size), f"B{j}": (k, numeric.m)}
        return {name: cp.Parameter(shape) for name, shape in shapes.items()}

    def _written(self, loop: CvxpyLoop, given: dict[str, Any]) -> Any:
        problem, n = loop.problem, loop.problem.numeric.n
        limits, scale = problem.limits, problem.scale
        x, u, v = self.x, self.u, self.v
        if loop.form is Form.BY_STEP:
            constraints = self._by_step(loop.steps, given)
        else:
            constraints = [
                x[1:, j] == _rowwise(given[f"A{j}"], x[:-1]) + _rowwise(given[f"B{j}"], u)
                + given["rest"][:, j] + v[:, j]
                for j in range(2 * n)
            ]  # fmt: skip
        at = _rowwise(given["by_q"], x[loop.rows.sample, :n])
        constraints += [at <= given["room"] + self.sigma]
        constraints += [x[:, :n] >= given["low"], x[:, :n] <= given["high"]]
        for group in problem.groups:
            own = u[:, list(group.inputs)]
            constraints += [own <= group.upper - self.rho, own >= group.lower + self.rho]
        for end, bound in (x[0], limits.start_rates), (x[-1], limits.final_rates):
            if np.isfinite(bound):
                constraints.append(cp.abs(end[n:]) <= bound)
        objective = (
            -self.rho / scale
            + Weights().quadratic * cp.sum_squares(u / scale)
            + VIRTUAL * cp.sum(cp.abs(v))
            + SLACK * self.sigma
        )
        return cp.Problem(cp.Minimize(objective), constraints)

    def _by_step(self, steps: int, given: dict[str, Any]) -> list[Any]:
        size = self.x.shape[1]
        a, b = (np.stack([given[f"{name}{j}"] for j in range(size)], axis=1) for name in "AB")
        return [
            self.x[i + 1] == a[i] @ self.x[i] + b[i] @ self.u[i] + given["rest"][i] + self.v[i]
            for i in range(steps)
        ]


def _rowwise(matrix: Any, unknown: Any) -> Any:
    """The products of corresponding rows."""
    return cp.sum(cp.multiply(matrix, unknown), axis=1)

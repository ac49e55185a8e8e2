r"""One convex step: the dynamics and positions linearised about a trajectory, as a sparse program.

.. math::
    \max\ \rho - w_V V - w_\sigma \sigma - \varepsilon \lVert u \rVert^2
    \quad\text{s.t.}\quad
    x_{i+1} = A_i x_i + B_i u_i + C_i \theta + r_i + B'_i v_i,\quad
    \lVert u_i \rVert \le \bar u - \rho,\quad \lVert v_i \rVert_\infty \le V

with the path's half-planes (C.1) softened by ``sigma``.  Definition 7 of the paper with the
fictitious input kept apart from the effort, so that it can never hide in a sum.  Matrices are built
from arrays.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from compiler.discretisation.float_reading import FloatReading, Linearisation, Points
from solvers.backends.conic import ConicProgram, NotSolved, solve
from solvers.motions.motion_limits import InputGroup, MotionLimits

Array: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class PositionRows:
    """Constraints ``normal . p(sample, point) <= offset``, metres, one per entry.

    Shapes: sample, point, offset (R,), normal (R, d), unit normals.
    """

    sample: Indices
    point: Indices
    normal: Array
    offset: Array

    def excess(self, points: Points) -> Array:
        """Signed violation of each row, metres; positive where violated."""
        at = points.value[self.sample, self.point]
        return np.asarray(np.einsum("rd,rd->r", self.normal, at) - self.offset)


@dataclass(frozen=True, slots=True)
class Trajectory:
    """States (k + 1, N), inputs (k, m) and parameters (p,) of a robot; N = 2n + r."""

    x: Array
    u: Array
    theta: Array


@dataclass(frozen=True, slots=True)
class Weights:
    """Penalties of the convex step, per unit of effort (V) and per metre (sigma)."""

    fictitious: float = 20.0
    position: float = 2000.0
    quadratic: float = 1e-6


@dataclass(frozen=True, slots=True)
class StepResult:
    """The optimum of a convex step."""

    trajectory: Trajectory
    fictitious: Array
    largest_fictitious: float
    position_slack: float
    margin: float


@dataclass(slots=True)
class _Rows:
    """Collects sparse rows in coordinate form, one cone at a time."""

    count: int = 0
    row: list[Indices] = field(default_factory=list[Indices])
    column: list[Indices] = field(default_factory=list[Indices])
    value: list[Array] = field(default_factory=list[Array])
    right: list[Array] = field(default_factory=list[Array])

    def add(self, right: Array, *blocks: tuple[Indices, Array]) -> None:
        """Rows ``sum(values * z[columns]) (+ slack) = right``; blocks have shape (rows, width)."""
        rows = np.arange(self.count, self.count + len(right))
        for columns, values in blocks:
            self.row.append(np.broadcast_to(rows[:, None], columns.shape).ravel())
            self.column.append(columns.ravel())
            self.value.append(np.broadcast_to(values, columns.shape).ravel())
        self.right.append(right)
        self.count += len(right)

    def add_bounds(self, columns: Indices, lower: Array, upper: Array) -> None:
        """``lower <= z[columns] <= upper`` where finite."""
        for bound, sign in ((upper, 1.0), (lower, -1.0)):
            keep = np.isfinite(bound)
            values = np.full((int(keep.sum()), 1), sign)
            self.add(sign * bound[keep], (columns[keep][:, None], values))


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where each unknown lives in the vector z: x, u, v, theta, three scalars, slacks.

    ``n`` coordinates, states of ``width`` entries, ``m`` inputs, ``k`` steps, ``p`` parameters.
    """

    n: int
    width: int
    m: int
    k: int
    p: int
    slacks: int = 0

    @property
    def x(self) -> Indices:
        return np.arange((self.k + 1) * self.width).reshape(self.k + 1, self.width)

    @property
    def u(self) -> Indices:
        start = (self.k + 1) * self.width
        return start + np.arange(self.k * self.m).reshape(self.k, self.m)

    @property
    def v(self) -> Indices:
        start = (self.k + 1) * self.width + self.k * self.m
        return start + np.arange(self.k * self.width).reshape(self.k, self.width)

    @property
    def theta(self) -> Indices:
        return self._motion + np.arange(self.p)

    @property
    def scalars(self) -> tuple[int, int, int]:
        """V, sigma, rho."""
        start = self._motion + self.p
        return start, start + 1, start + 2

    @property
    def g(self) -> Indices:
        """One slack per step, where they are asked for."""
        return self._motion + self.p + 3 + np.arange(self.slacks)

    @property
    def size(self) -> int:
        return self._motion + self.p + 3 + self.slacks

    @property
    def _motion(self) -> int:
        """How many unknowns the motion takes: x, u and v."""
        return (2 * self.k + 1) * self.width + self.k * self.m


def fictitious_inputs(reading: FloatReading, trajectory: Trajectory, dt: float) -> Array:
    """B' of C.2, shape (k, N, N): a unit slack is the effort that causes it within a step.

    An effort f held for dt moves a coordinate by dt^2/2 M^-1 f and its rate by dt M^-1 f.  A state
    of a module's own is moved by dt in its own unit.
    """
    n, k = reading.n, len(trajectory.u)
    inverse = np.linalg.inv(reading.mass_matrix(trajectory.x[:-1, :n], trajectory.theta))
    matrix = np.zeros((k, reading.size, reading.size))
    matrix[:, :n, :n] = dt**2 / 2 * inverse
    matrix[:, n : 2 * n, n : 2 * n] = dt * inverse
    own = np.arange(2 * n, reading.size)
    matrix[:, own, own] = dt
    return matrix


@dataclass(frozen=True, slots=True)
class Model:
    """Everything linearised about one trajectory."""

    about: Trajectory
    dynamics: Linearisation
    points: Points
    fictitious: Array


def convex_step(
    model: Model,
    rows: PositionRows,
    limits: MotionLimits,
    groups: tuple[InputGroup, ...],
    radius: float,
    theta_box: tuple[Array, Array] | None,
    weights: Weights,
    epsilon: float | None = None,
    accuracy: float = 1e-8,
) -> StepResult | NotSolved:
    """Solve one convex step; ``theta_box`` None keeps the parameters as they are.

    ``radius`` is the trust region: on coordinates (rad or m) and, relative, on parameters.
    With ``epsilon`` the sum of one slack per step is minimised under C.6 instead, to find the
    shortest prefix that cannot be followed (Problem 4 of the paper's appendix).
    """
    about = model.about
    k, m = about.u.shape
    p = 0 if theta_box is None else len(about.theta)
    sizes_of = len(limits.lower), about.x.shape[1], m, k, p
    layout = _Layout(*sizes_of, slacks=0 if epsilon is None else k)
    equalities, inequalities = _Rows(), _Rows()
    _dynamics_rows(equalities, layout, model)
    _limit_rows(equalities, inequalities, layout, limits)
    _position_rows(inequalities, layout, model, rows)
    _trust_rows(inequalities, layout, about, radius, theta_box)
    cones, sizes = _input_rows(inequalities, layout, groups)
    big, sigma, rho = layout.scalars
    _fictitious_rows(inequalities, layout, epsilon)
    inequalities.add(np.zeros(2), (np.array([[big], [sigma]]), np.array([[-1.0]])))
    linear = np.zeros(layout.size)
    linear[[big, sigma]] = weights.fictitious, weights.position
    linear[rho] = -1.0 if epsilon is None else 0.0
    linear[layout.g] = weights.fictitious
    diagonal = np.full(layout.size, 1e-9)
    diagonal[layout.u.ravel()] = 2 * weights.quadratic
    program = _assemble(layout.size, diagonal, linear, (equalities, inequalities, cones), sizes)
    optimum = solve(program, (accuracy, 100 * accuracy))
    if isinstance(optimum, NotSolved):
        return optimum
    z = optimum.point
    theta = about.theta if theta_box is None else z[layout.theta]
    found = Trajectory(z[layout.x], z[layout.u], theta)
    return StepResult(found, z[layout.v], float(z[big]), max(0.0, float(z[sigma])), float(z[rho]))


def _assemble(
    size: int,
    diagonal: Array,
    linear: Array,
    blocks: tuple[_Rows, _Rows, _Rows],
    second_order: tuple[int, ...],
) -> ConicProgram:
    """Stack the rows of the three kinds of cones into one program."""
    starts = np.cumsum([0] + [block.count for block in blocks])
    row = [part + start for block, start in zip(blocks, starts, strict=False) for part in block.row]
    column = [part for block in blocks for part in block.column]
    value = [part for block in blocks for part in block.value]
    right = [part for block in blocks for part in block.right]
    shape = (int(starts[-1]), size)
    places = (np.concatenate(row), np.concatenate(column))
    matrix = csc_matrix((np.concatenate(value), places), shape=shape)
    steps = np.arange(size)
    quadratic = csc_matrix((diagonal, (steps, steps)), shape=(size, size))
    counts = blocks[0].count, blocks[1].count
    return ConicProgram(quadratic, linear, matrix, np.concatenate(right), *counts, second_order)


def _dynamics_rows(rows: _Rows, layout: _Layout, model: Model) -> None:
    """C.2: one block of N equalities per step."""
    k, width, about, lin = layout.k, layout.width, model.about, model.dynamics
    known = lin.value - np.einsum("kij,kj->ki", lin.state, about.x[:-1])
    known -= np.einsum("kij,kj->ki", lin.input, about.u)
    blocks = [(layout.x[:-1], lin.state), (layout.u, lin.input), (layout.v, model.fictitious)]
    if layout.p:
        known -= lin.parameter @ about.theta
        blocks.append((np.broadcast_to(layout.theta, (k, layout.p)), lin.parameter))
    wide = [
        (np.repeat(columns, width, axis=0), values.reshape(k * width, -1))
        for columns, values in blocks
    ]
    after = (layout.x[1:].reshape(-1, 1), np.array([[-1.0]]))
    rows.add(-known.ravel(), *wide, after)


def _limit_rows(
    equalities: _Rows, inequalities: _Rows, layout: _Layout, limits: MotionLimits
) -> None:
    """Start and final rates, joint limits and rate limits, initial states of modules' own."""
    n, x = layout.n, layout.x
    equalities.add(limits.own_start, (x[0, 2 * n :, None], np.array([[1.0]])))
    if limits.start_values is None:
        inequalities.add_bounds(x[0, :n], limits.lower, limits.upper)
    else:
        equalities.add(limits.start_values, (x[0, :n][:, None], np.array([[1.0]])))
    count = layout.k
    lower, upper = (np.tile(bound, count) for bound in (limits.lower, limits.upper))
    inequalities.add_bounds(x[1:, :n].ravel(), lower, upper)
    shape = (count + 1, n)
    lower = np.array(np.broadcast_to(limits.rate_lower, shape))
    upper = np.array(np.broadcast_to(limits.rate_upper, shape))
    for sample, bound in ((0, limits.start_rates), (count, limits.final_rates)):
        if bound == 0.0:
            equalities.add(np.zeros(n), (x[sample, n : 2 * n, None], np.array([[1.0]])))
            lower[sample], upper[sample] = -np.inf, np.inf
            continue
        lower[sample] = np.maximum(lower[sample], -bound)
        upper[sample] = np.minimum(upper[sample], bound)
    inequalities.add_bounds(x[:, n : 2 * n].ravel(), lower.ravel(), upper.ravel())


def _position_rows(rows: _Rows, layout: _Layout, model: Model, wanted: PositionRows) -> None:
    """C.1: half-planes on positions linearised in the coordinates and parameters."""
    n, about, points = layout.n, model.about, model.points
    pick = (wanted.sample, wanted.point)
    by_q = np.einsum("rd,rdn->rn", wanted.normal, points.by_q[pick])
    value = np.einsum("rd,rd->r", wanted.normal, points.value[pick])
    right = wanted.offset - value + np.einsum("rn,rn->r", by_q, about.x[wanted.sample, :n])
    sigma = np.full((len(right), 1), layout.scalars[1])
    blocks = [(layout.x[wanted.sample, :n], by_q), (sigma, np.array([[-1.0]]))]
    if layout.p:
        by_theta = np.einsum("rd,rdp->rp", wanted.normal, points.by_theta[pick])
        right = right + by_theta @ about.theta
        blocks.append((np.broadcast_to(layout.theta, by_theta.shape), by_theta))
    rows.add(right, *blocks)


def _trust_rows(
    rows: _Rows,
    layout: _Layout,
    about: Trajectory,
    radius: float,
    theta_box: tuple[Array, Array] | None,
) -> None:
    """The box in which the linearisation is believed."""
    n = layout.n
    centre = about.x[:, :n].ravel()
    rows.add_bounds(layout.x[:, :n].ravel(), centre - radius, centre + radius)
    if theta_box is not None:
        lower, upper = theta_box
        reach = radius * np.maximum(np.abs(about.theta), 0.1)
        near = np.maximum(lower, about.theta - reach), np.minimum(upper, about.theta + reach)
        rows.add_bounds(layout.theta, *near)


def _fictitious_rows(rows: _Rows, layout: _Layout, epsilon: float | None) -> None:
    """C.4 and C.5: |v_i| is at most V, or its own slack g_i, which C.6 then binds."""
    v, bound = layout.v, np.full_like(layout.v, layout.scalars[0])
    if epsilon is not None:
        bound = np.broadcast_to(layout.g[:, None], v.shape)
    pair = np.stack([v.ravel(), bound.ravel()], axis=1)
    for sign in (1.0, -1.0):
        rows.add(np.zeros(v.size), (pair, np.array([[sign, -1.0]])))
    if epsilon is not None:
        order = epsilon * np.tri(layout.k, k=-1) - np.eye(layout.k)
        rows.add(np.zeros(layout.k), (np.tile(layout.g, (layout.k, 1)), order))
        # Inputs within their bounds: the slacks are all there is to complain with.
        rows.add(np.zeros(1), (np.array([[layout.scalars[2]]]), np.array([[-1.0]])))


def _input_rows(
    rows: _Rows, layout: _Layout, groups: tuple[InputGroup, ...]
) -> tuple[_Rows, tuple[int, ...]]:
    """C.3: every input, or the norm of a group of inputs, within its bound less the margin."""
    rho, u = layout.scalars[2], layout.u
    cones, sizes = _Rows(), []
    for group in groups:
        columns = u[:, list(group.inputs)]
        if not group.norm2:
            flat = columns.reshape(-1, 1)
            pair = np.concatenate([flat, np.full_like(flat, rho)], axis=1)
            for sign, bound in ((1.0, group.upper), (-1.0, -group.lower)):
                rows.add(np.full(len(flat), bound), (pair, np.array([[sign, 1.0]])))
            continue
        for step in columns:
            cones.add(np.array([group.upper]), (np.array([[rho]]), np.array([[1.0]])))
            cones.add(np.zeros(len(step)), (step[:, None], np.array([[-1.0]])))
            sizes.append(1 + len(step))
    widest = min((group.widest_margin for group in groups), default=0.0)
    rows.add(np.array([widest]), (np.array([[rho]]), np.array([[1.0]])))
    return cones, tuple(sizes)

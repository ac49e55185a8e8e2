"""The convex step as sparse arrays: the structure is built once, then only numbers are filled in.

States and parameters are deviations from those of the trajectory, so that no accuracy is lost to
rounding near the fixpoint; inputs are absolute.

The structure depends on the robot, the limits, the grid and the sample of every position row.  It
is rebuilt when one of these changes.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csc_matrix

from compiler.arrays import Array
from solvers.backends.conic import Cones, ConvexProgram
from solvers.trajectory.linear_model import LinearRows, Model
from solvers.trajectory.subproblem import LEAST, Indices, StepLayout, SubproblemSpec, TrustRegion
from solvers.trajectory.task_limits import MotionLimits


@dataclass(slots=True)
class StepProgram:
    """The structure of the convex steps of one question about trajectories of one size."""

    question: SubproblemSpec
    layout: StepLayout
    samples: Indices
    """The sample of each position row, (R,)."""
    _equal: EntryPattern = field(init=False)
    _given: Indices = field(init=False)
    """Indices of the fixed states within the flattened states."""
    _given_values: Array = field(init=False)
    _less: EntryPattern = field(init=False)
    _less_tail: Array = field(init=False)
    _less_right: Array = field(init=False)
    _changes: int = field(init=False)
    """The index of the first inequality on changes of rates."""
    _cones: Cones | None = field(init=False)
    _columns: Array = field(init=False)
    """The sizes of the unknowns, by which a program scales them."""
    _rows: Array = field(init=False)
    """The sizes of the inequalities."""

    def __post_init__(self) -> None:
        self._lay_equalities()
        self._lay_inequalities()
        self._cones = self._second_order()
        self._lay_sizes()

    # --- structure ------------------------------------------------------------------------------

    @property
    def _fictitious(self) -> tuple[Indices, Indices]:
        """The places in B' (N, N) that may be nonzero."""
        n, own = self.layout.n, np.arange(2 * self.layout.n, self.layout.width)
        row, column = np.divmod(np.arange(n * n), n)
        return np.concatenate([row, n + row, own]), np.concatenate([column, n + column, own])

    def _lay_equalities(self) -> None:
        """C.2, one block of N rows per step, then fixed values at the ends, and a closed loop."""
        layout, limits = self.layout, self.question.limits
        k, width, n = layout.k, layout.width, layout.n
        entries = EntryList()
        wide = [layout.x[:-1], layout.u]
        if layout.p:
            wide.append(np.broadcast_to(layout.theta, (k, layout.p)))
        blocks = [np.repeat(columns, width, axis=0) for columns in wide]
        entries.add(*blocks, layout.x[1:].reshape(-1, 1))
        if layout.fictitious:
            row, column = self._fictitious
            steps = np.arange(k)[:, None]
            entries.row.append((steps * width + row).ravel())
            entries.column.append(layout.v[:, column].ravel())
        given = [(layout.x[0, 2 * n :], limits.own_start)]
        if limits.start_values is not None:
            given.append((layout.x[0, :n], limits.start_values))
        for samples, bound in _end_rates(limits, k):
            if bound == 0.0:
                columns = layout.x[samples, n : 2 * n].ravel()
                given.append((columns, np.zeros(len(columns))))
        for columns, _ in given:
            entries.add(columns[:, None])
        if limits.loop is not None:
            entries.add(layout.x[k][:, None], layout.x[limits.loop][:, None])
        self._equal = entries.compressed(layout.size)
        self._given = np.concatenate([columns for columns, _ in given])
        self._given_values = np.concatenate([values for _, values in given])

    def _lay_inequalities(self) -> None:
        """C.1, then C.4 and C.5 with C.6, then C.3, then bounds on accelerations."""
        layout, question = self.layout, self.question
        entries, tail, right = EntryList(), list[Array](), list[Array]()
        rows = len(self.samples)
        at = [layout.x[self.samples, : layout.n]]
        if layout.p:
            at.append(np.broadcast_to(layout.theta, (rows, layout.p)))
        entries.add(*at, np.full((rows, 1), layout.sigma))
        if layout.fictitious:
            bound = np.full_like(layout.v, layout.largest)
            if layout.slacks:
                bound = np.broadcast_to(layout.g[:, None], layout.v.shape)
            for sign in (1.0, -1.0):
                entries.add(layout.v.reshape(-1, 1), bound.reshape(-1, 1))
                tail += [np.full(bound.size, sign), np.full(bound.size, -1.0)]
                right.append(np.zeros(bound.size))
        if layout.slacks:
            entries.add(np.tile(layout.g, (layout.k, 1)))
            tail.append(
                ((question.epsilon or 0.0) * np.tri(layout.k, k=-1) - np.eye(layout.k)).ravel()
            )
            right.append(np.zeros(layout.k))
        for group in question.groups:
            if group.norm2:
                continue
            columns = layout.u[:, list(group.inputs)].reshape(-1, 1)
            for sign, end in ((1.0, group.upper), (-1.0, -group.lower)):
                entries.add(columns, np.full_like(columns, layout.rho))
                weight = group.weight(question.scale)
                tail += [np.full(len(columns), sign), np.full(len(columns), weight)]
                right.append(np.full(len(columns), end))
        self._changes = entries.rows
        rates = layout.x[:, layout.n + question.limits.accelerated]
        for sign in (1.0, -1.0):
            entries.add(rates[1:].reshape(-1, 1), rates[:-1].reshape(-1, 1))
            tail += [np.full(rates[1:].size, sign), np.full(rates[1:].size, -sign)]
        self._less = entries.compressed(layout.size)
        self._less_tail = np.concatenate([*tail, np.zeros(0)])
        self._less_right = np.concatenate([*right, np.zeros(0)])

    def _second_order(self) -> Cones | None:
        """C.3 for groups of inputs with a bounded norm: |u|_2 <= bound - w rho.

        If inputs keep a distance from the bound, also |u|_2 <= bound - kept.
        """
        layout, sizes = self.layout, list[int]()
        entries, values, right = EntryList(), list[Array](), list[Array]()
        for group in self.question.groups:
            if not group.norm2:
                continue
            for columns in layout.u[:, list(group.inputs)]:
                entries.add(np.array([[layout.rho]]))
                entries.add(columns[:, None])
                weight = group.weight(self.question.scale)
                values += [np.full(1, weight), np.full(len(columns), -1.0)]
                right.append(np.array([group.upper, *np.zeros(len(columns))]))
                sizes.append(1 + len(columns))
            for columns, kept in zip(layout.u[:, list(group.inputs)], group.kept, strict=False):
                entries.add(np.zeros((1, 0), dtype=np.int64))
                entries.add(columns[:, None])
                values.append(np.full(len(columns), -1.0))
                right.append(np.array([group.upper - kept, *np.zeros(len(columns))]))
                sizes.append(1 + len(columns))
        if not sizes:
            return None
        matrix = entries.compressed(layout.size).matrix(values)
        return Cones(matrix, np.concatenate(right), tuple(sizes))

    def _lay_sizes(self) -> None:
        """Scale lengths and efforts to about one in a program, whatever the size of the robot."""
        layout, (length, effort) = self.layout, self.question.sizes
        self._columns, self._rows = np.ones(layout.size), np.ones(self._less.empty.shape[0])
        self._columns[layout.u] = self._columns[layout.v] = effort
        self._columns[layout.g] = self._columns[layout.rho] = effort
        if layout.fictitious:
            self._columns[layout.largest] = effort
        self._columns[layout.sigma] = length
        self._rows[: len(self.samples)] = length
        self._rows[len(self.samples) : self._changes] = effort

    def point(self, scaled: Array) -> Array:
        """The unknowns (N,), in SI, from the optimum (N,) of a program."""
        return scaled * self._columns

    # --- numbers --------------------------------------------------------------------------------

    def program(self, model: Model, rows: LinearRows, region: TrustRegion) -> ConvexProgram:
        """The program about a trajectory."""
        values, right = self._dynamics(model)
        row_values = [rows.by_q.ravel(), *([rows.by_theta.ravel()] if self.layout.p else [])]
        row_values.append(np.full(len(rows.slack), -1.0))
        lower, upper = self._bounds(model, region.radius)
        quadratic, linear = self._objective(model, region.proximal)
        columns, ones = self._columns, np.ones(len(right))
        less = self._less.matrix([*row_values, self._less_tail])
        return ConvexProgram(
            quadratic * columns**2, linear * columns,
            _divided(self._equal.matrix(values), ones, columns), right,
            _divided(less, self._rows, columns),
            np.concatenate([rows.slack, self._less_right, *rate_steps(self.question.limits, model)])
            / self._rows,
            lower / columns, upper / columns, self._scaled_cones(), self,
        )  # fmt: skip

    def _scaled_cones(self) -> Cones | None:
        cones, effort = self._cones, self.question.sizes[1]
        if cones is None or effort == 1.0:
            return cones
        rows = np.full(len(cones.right), effort)
        return replace(
            cones, matrix=_divided(cones.matrix, rows, self._columns), right=cones.right / rows
        )

    def _dynamics(self, model: Model) -> tuple[list[Array], Array]:
        layout, about, lin = self.layout, model.about, model.dynamics
        known = about.x[1:] - lin.value
        known += np.matmul(lin.input, about.u[:, :, None])[:, :, 0]
        values = [lin.state.ravel(), lin.input.ravel()]
        if layout.p:
            values.append(lin.parameter.ravel())
        values.append(np.full(layout.k * layout.width, -1.0))
        if layout.fictitious:
            values.append(model.fictitious[:, *self._fictitious].ravel())
        values.append(np.ones(len(self._given)))
        given = self._given_values - about.x.ravel()[self._given]
        limits = self.question.limits
        if limits.loop is None:
            return values, np.concatenate([known.ravel(), given])
        values += [np.ones(layout.width), np.full(layout.width, -1.0)]
        back = about.x[limits.loop] + limits.turned - about.x[-1]
        return values, np.concatenate([known.ravel(), given, back])

    def _bounds(self, model: Model, radius: float) -> tuple[Array, Array]:
        """Limits and trust region combined; a centre outside the limits is moved onto them."""
        layout, question, about = self.layout, self.question, model.about
        n, limits = layout.n, question.limits
        lower, upper = np.full(layout.size, -np.inf), np.full(layout.size, np.inf)
        shape = layout.k + 1, n
        low = np.array(np.broadcast_to(limits.lower, shape))
        high = np.array(np.broadcast_to(limits.upper, shape))
        if limits.start_values is not None:
            low[0] = high[0] = limits.start_values
        q, v = about.x[:, :n], about.x[:, n : 2 * n]
        centre = np.clip(q, low, high)
        lower[layout.x[:, :n]] = np.maximum(low, centre - radius) - q
        upper[layout.x[:, :n]] = np.minimum(high, centre + radius) - q
        if limits.start_values is not None:  # fixed by an equality
            lower[layout.x[0, :n]], upper[layout.x[0, :n]] = -np.inf, np.inf
        low, high = rate_bounds(limits, layout.k)
        lower[layout.x[:, n : 2 * n]], upper[layout.x[:, n : 2 * n]] = low - v, high - v
        for group in question.groups:
            if group.kept.size and not group.norm2:
                columns = layout.u[:, list(group.inputs)]
                lower[columns], upper[columns] = group.bounds()
        if question.theta_box is not None:
            reach, box = radius * np.maximum(np.abs(about.theta), LEAST), question.theta_box
            lower[layout.theta] = np.maximum(box[0] - about.theta, -reach)
            upper[layout.theta] = np.minimum(box[1] - about.theta, reach)
        lower[layout.sigma] = lower[layout.rho] = 0.0
        upper[layout.rho] = max((group.widest_margin for group in question.groups), default=0.0)
        if layout.fictitious:
            lower[layout.largest] = 0.0
        return lower, upper

    def _objective(self, model: Model, proximal: float) -> tuple[Array, Array]:
        layout, question = self.layout, self.question
        weights, scale = question.weights, question.scale
        linear, quadratic = np.zeros(layout.size), weights.regular / self._columns**2
        linear[layout.sigma] = weights.position
        if layout.fictitious:
            linear[layout.largest] = weights.fictitious / scale
        if layout.slacks:
            linear[layout.g] = weights.fictitious / scale
        else:
            linear[layout.rho] = -1.0 / scale
        quadratic[layout.u] = 2 * weights.quadratic / scale**2
        quadratic[layout.x[:, : layout.n]] = 2 * proximal
        if weights.rates:
            rates = layout.x[:, layout.n : 2 * layout.n]
            quadratic[rates] = 2 * weights.rates
            linear[rates] = 2 * weights.rates * model.about.x[:, layout.n : 2 * layout.n]
        pushed = model.mobility
        if pushed is not None:
            linear[layout.x[:-1, : layout.n]] = weights.mobility * pushed.by_q
        if layout.p:
            if pushed is not None:
                linear[layout.theta] = weights.mobility * pushed.by_theta.sum(axis=0)
            if weights.parameters:
                linear[layout.theta] += weights.parameters
            # A parameter affects every sample.
            size = np.maximum(np.abs(model.about.theta), LEAST)
            quadratic[layout.theta] = 2 * proximal * (layout.k + 1) / size**2
        return quadratic, linear


def _divided(matrix: csc_matrix, rows: Array, columns: Array) -> csc_matrix:
    """A matrix for unknowns divided by their sizes, with its rows divided by theirs."""
    if np.all(rows == 1.0) and np.all(columns == 1.0):
        return matrix
    found = copy(matrix)
    found.data = matrix.data * np.repeat(columns, np.diff(matrix.indptr)) / rows[matrix.indices]
    return found


def rate_bounds(limits: MotionLimits, steps: int) -> tuple[Array, Array]:
    """Bounds on the rates (k + 1, n); infinite at ends at rest, which equalities fix."""
    shape = (steps + 1, limits.joints)
    low = np.array(np.broadcast_to(limits.rate_lower, shape))
    high = np.array(np.broadcast_to(limits.rate_upper, shape))
    for samples, bound in _end_rates(limits, steps):
        if bound == 0.0:
            low[samples], high[samples] = -np.inf, np.inf
        else:
            low[samples] = np.maximum(low[samples], -bound)
            high[samples] = np.minimum(high[samples], bound)
    return low, high


def rate_steps(limits: MotionLimits, model: Model) -> list[Array]:
    """The further rise of rates allowed in a step, relative to a trajectory, and the fall, (s,).

    Only joints with bounded accelerations are included; empty if there are none.
    """
    if model.rises is None:
        return []
    bound = limits.accelerated
    moved = np.diff(model.about.x[:, limits.joints + bound], axis=0)
    up, down = model.rises[:, :, bound]
    return [(up - moved).ravel(), (down + moved).ravel()]


def _end_rates(limits: MotionLimits, steps: int) -> tuple[tuple[slice, float], ...]:
    """The samples at the two ends, with the bounds on their rates."""
    final = slice(steps + 1 - limits.final_samples, steps + 1)
    return (slice(0, 1), limits.start_rates), (final, limits.final_rates)


# --- A sparse matrix with a fixed pattern, whose values are filled in later -----------------------


@dataclass(slots=True)
class EntryList:
    """Places of entries, block by block; every place occurs once."""

    rows: int = 0
    row: list[Indices] = field(default_factory=list[Indices])
    column: list[Indices] = field(default_factory=list[Indices])

    def add(self, *blocks: Indices) -> None:
        """Add rows, with one entry in each of the columns of blocks of shape (rows, width)."""
        count = len(blocks[0])
        numbers = np.arange(self.rows, self.rows + count)
        for columns in blocks:
            self.row.append(np.broadcast_to(numbers[:, None], columns.shape).ravel())
            self.column.append(columns.ravel())
        self.rows += count

    def compressed(self, width: int) -> EntryPattern:
        """The pattern of a matrix with ``width`` columns."""
        none = np.zeros(0, dtype=np.int64)
        row = np.concatenate([*self.row, none])
        column = np.concatenate([*self.column, none])
        order = np.lexsort((row, column))
        starts = np.searchsorted(column[order], np.arange(width + 1))
        shape = (self.rows, width)
        empty = csc_matrix((np.zeros(len(order)), row[order], starts), shape=shape)
        return EntryPattern(order, empty)


@dataclass(frozen=True, slots=True)
class EntryPattern:
    """A compressed-column pattern, filled with values in the order of the list."""

    order: Indices
    empty: csc_matrix
    """The pattern with zero values."""

    def matrix(self, values: Sequence[Array]) -> csc_matrix:
        """The matrix with values (entries,), block by block as the entries were listed."""
        flat = np.concatenate([*values, np.zeros(0)])
        # The pattern is valid, and copying it is forty times as fast as building a new one.
        matrix = copy(self.empty)
        matrix.data = flat[self.order]
        return matrix

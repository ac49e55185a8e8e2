r"""Positive definiteness of M from the velocities of the bodies, without their masses.

.. math:: v'Mv = \sum_b m_b |J_b v|^2 + (W_b v)' I_b (W_b v)

If no term is negative, v'Mv = 0 means that every body of positive mass is at rest: its points, and
the components of its rotation that have inertia. So M is positive definite where the matrix A of
these velocities has full column rank, whatever the masses and lengths.

The rates are shown to be zero group by group. A group of joints needs only bodies that are moved by
no other joints than those of the group and of earlier groups. The joints before the first of the
group rotate and translate these bodies as a whole, which does not matter. So a chain in which every
joint carries a body of its own is proved joint by joint, and its coordinates drop out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.dynamics.kinematics import Kinematics, kinematics, own_coordinates, rotation
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluators.balls import constant_ball
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape
from compiler.mass_matrix.boxes import Box, halves, hull, middle
from compiler.robots.robot import Body, Joint, PointBody, RobotModel, RodBody, SolidBody, Turn
from compiler.time_limits.time_limit import check_time

SHARPEST = 1e-3
UNBOUNDED = 1e30
"""Stands for an infinite radius when enclosures are compared."""


@dataclass(frozen=True, slots=True)
class Velocities:
    """Rows J of one body: v'Mv = 0 implies J v = 0 if all of ``positive`` are above zero."""

    body: int
    rows: ca.SX
    positive: tuple[ca.SX, ...]


@dataclass(frozen=True, slots=True)
class BodyMotions:
    """The velocities of all bodies.

    ``variables`` are q then theta. If no entry of ``weights`` is negative, no term of v'Mv is.
    """

    model: RobotModel
    variables: ca.SX
    symbols: ca.SX
    constants: tuple[Constant | PiConstant, ...]
    velocities: tuple[Velocities, ...]
    weights: tuple[ca.SX, ...]

    def moved_by(self, body: int) -> tuple[int, ...]:
        """The degrees of freedom that move a body."""
        steps = self.model.steps(self.model.bodies[body].frame)
        return tuple(sorted({step.dof for step in steps if isinstance(step, Joint)}))


def body_motions(model: RobotModel) -> BodyMotions:
    """The velocities of the bodies of a robot as expressions in q, theta and the constants."""
    n = len(model.dofs)
    q, theta = ca.SX.sym("q", n), ca.SX.sym("theta", len(model.parameters))
    constants = SymbolicEvaluator()
    at = kinematics(model, q, theta, constants, own_coordinates(model))
    velocities: list[Velocities] = []
    weights: list[ca.SX] = []
    for number, body in enumerate(model.bodies):
        rows, signs = _of_body(number, body, at, q, constants)
        velocities += rows
        weights += signs
    symbols = constants.vector()
    return BodyMotions(
        model,
        ca.vertcat(q, theta),
        symbols,
        tuple(constants.symbols),
        tuple(velocities),
        tuple(weights),
    )


def _of_body(
    number: int, body: Body, at: Kinematics, q: ca.SX, constants: SymbolicEvaluator
) -> tuple[list[Velocities], list[ca.SX]]:
    d = at.model.dimension

    def rates(vector: ca.SX) -> ca.SX:
        return ca.jacobian(vector[:d], q)

    def literal(scalar: int) -> ca.SX:
        # Products of literals would be folded in doubles.
        return constants.unfolded(at.scalars[scalar])

    match body:
        case RodBody(frame, axis, _, length, density, _):
            # A mass above zero implies a non-zero length: both ends are at rest, so the direction
            # is.
            mass = literal(density) * literal(length)
            rows = ca.vertcat(rates(at.origins[frame]), rates(at.axis(frame, axis)))
            return [Velocities(number, rows, (mass,))], [mass]
        case PointBody(frame):
            mass = at.mass(body)
            return [Velocities(number, rates(at.origins[frame]), (mass,))], [mass]
        case SolidBody(frame, scalar, com, inertia):
            mass = at.scalars[scalar]
            shift = Velocities(number, rates(at.point(frame, com)), (mass,))
            spin = _spin(at, frame, constants, q)
            moments = [literal(i) for i in inertia]
            turns, signs = _rotation(number, spin, moments)
            return [shift, *turns], [mass, *signs]


def _spin(at: Kinematics, frame: int, constants: SymbolicEvaluator, q: ca.SX) -> ca.SX:
    """The angular velocity in the axes of a frame, shape (3, n), from the frame inwards."""
    columns, back = ca.SX.zeros(3, q.numel()), ca.SX.eye(3)
    for node in reversed(at.model.chain(frame)):
        match at.model.frames[node].step:
            case Turn(axis, angle):
                back = back @ rotation(axis, constants.unfolded(at.scalars[angle])).T
            case Joint(dof, axis, sign) if at.model.dofs[dof].kind == "revolute":
                columns[:, dof] += sign * back[:, axis]
                back = back @ rotation(axis, sign * q[dof]).T
            case _:
                pass
    return columns


def _rotation(
    number: int, spin: ca.SX, moments: Sequence[ca.SX]
) -> tuple[list[Velocities], list[ca.SX]]:
    """The rows of a rotation, and the terms that must not be negative: all principal minors."""
    if len(moments) == 1:
        return [Velocities(number, spin[2, :], (moments[0],))], [moments[0]]
    xx, yy, zz, xy, xz, yz = moments
    diagonal = all(moment.is_zero() for moment in (xy, xz, yz))
    if diagonal:
        own = [Velocities(number, spin[i, :], (moments[i],)) for i in range(3)]
        return own, [xx, yy, zz]
    minors = [xx * yy - xy * xy, xx * zz - xz * xz, yy * zz - yz * yz]
    whole = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    return [Velocities(number, spin, (xx, minors[0], whole))], [xx, yy, zz, *minors, whole]


@dataclass(frozen=True, slots=True)
class RestProof:
    """How far a proof got: the boxes examined, and a part that is not proved, or None."""

    boxes: int
    left: Box | None


@dataclass(slots=True)
class RestTest:
    """Whether the rates of a group of joints are zero when its bodies are at rest.

    ``rows`` times the rates of the group are the velocities of the bodies. Row i counts if the
    expressions ``needs[i]`` of ``signs`` are above zero; the first ``weights`` of these must not be
    negative.
    """

    motions: BodyMotions
    rows: ca.SX
    signs: ca.SX
    needs: tuple[tuple[int, ...], ...]
    weights: int
    active: tuple[int, ...] = field(init=False)
    _values: Tape = field(init=False)
    _slopes: Tape | None = field(init=False)
    _numeric: ca.Function = field(init=False)
    _constants: list[Ends] = field(init=False)

    def __post_init__(self) -> None:
        inputs = [self.motions.variables, self.motions.symbols]
        rows = ca.densify(self.rows)
        entries = ca.vertcat(ca.vec(rows), ca.densify(self.signs))
        self._values = tape(ca.Function("values", inputs, [ca.cse(entries)]))
        self._numeric = ca.Function("rows", inputs, [rows])
        pattern = ca.jacobian_sparsity(entries, self.motions.variables)
        self.active = tuple(sorted({int(column) for column in pattern.get_triplet()[1]}))
        self._constants = [around(constant_ball(each)) for each in self.motions.constants]
        slopes = [ca.jacobian(ca.vec(rows), self.motions.variables[i]) for i in self.active]
        try:
            self._slopes = tape(
                ca.Function("slopes", inputs, [ca.cse(ca.densify(ca.vertcat(*slopes)))])
            )
        except ValueError:  # derivatives with constants that are not integers
            self._slopes = None

    def proof(self, box: Box, budget: int) -> RestProof:
        """Examine a box and its parts, at most ``budget``, until one cannot be proved."""
        waiting, boxes = [box], 0
        while waiting:
            part = waiting.pop()
            if boxes == budget:
                return RestProof(boxes, part)
            boxes += 1
            check_time()
            left = self.inverse(part)
            if left is not None and self.holds(part, left):
                continue
            parts = self.divided(part, left)
            if parts is None:
                return RestProof(boxes, part)
            waiting += parts
        return RestProof(boxes, None)

    def inverse(self, box: Box) -> Array | None:
        """An approximate left inverse L (c, r) of the r rows on a box; None if there is none.

        Columns of L are zero for rows that do not count there. Rows with sharp enclosures get more
        weight.
        """
        table, signs = self._enclosed([hull(side) for side in box])
        centre = self._at([middle(side) for side in box])
        sharp = np.zeros(len(table))
        for i, row in enumerate(table):
            finite = all(entry.finite for entry in row) and np.all(np.isfinite(centre[i]))
            if finite and all(signs[need].low > 0 for need in self.needs[i]):
                size = SHARPEST * (float(np.abs(centre[i]).max()) or 1.0)
                sharp[i] = 1 / (size + max(_radius(entry) for entry in row))
        weighed = np.where(sharp[:, None] > 0, sharp[:, None] * centre, 0.0)
        known = all(sign.low >= 0 for sign in signs[: self.weights])
        if not known or np.linalg.matrix_rank(weighed) < self.rows.shape[1]:
            return None
        return np.asarray(np.linalg.pinv(weighed) * sharp)

    def holds(self, box: Box, left: Array) -> bool:
        """Whether L A is regular on the box, with L = ``left`` (c, r), by either of two enclosures.

        L is zero for the rows that do not count there. The enclosures are L A(X), and the mean
        value form L A(c) + sum_i L dA/dx_i(X) (x_i - c_i).
        """
        sides = [hull(side) for side in box]
        before = arb_mat([[arb(float(item)) for item in row] for row in left])
        kept = np.any(left != 0, axis=0)

        def product(table: list[list[Ends]]) -> arb_mat:
            rows = [
                [entry.ball() if used else arb(0) for entry in row]
                for row, used in zip(table, kept, strict=True)
            ]
            return before * arb_mat(rows)

        if _regular(product(self._enclosed(sides)[0])):
            return True
        if self._slopes is None or not all(sides[i].finite for i in self.active):
            return False
        # The centres must be within the intervals of the slopes: a ball has its own centre.
        balls = {i: sides[i].ball() for i in self.active}
        wide, point = list(sides), list(sides)
        for i, whole in balls.items():
            wide[i], point[i] = around(whole), around(whole.mid())
        total = product(self._enclosed(point)[0])
        slopes = self._slopes.evaluate([*wide, *self._constants], INTERVALS)
        height, columns = self.rows.shape
        for number, i in enumerate(self.active):
            own = slopes[number * height * columns :]
            if not all(entry.finite for entry in own[: height * columns]):
                return False
            table = [[own[j * height + k] for j in range(columns)] for k in range(height)]
            total += product(table) * (balls[i] - balls[i].mid())
        return _regular(total)

    def divided(self, box: Box, left: Array | None) -> list[Box] | None:
        """Two parts, cut at the variable that widens enclosures most; unlimited variables first.

        ``left`` is the result of ``inverse``, (c, r) or None. None if no variable can be cut.
        """
        cuts = {i: pair for i in self.active if (pair := halves(box[i])) is not None}
        if not cuts:
            return None
        i = min(cuts, key=lambda index: self._blur(box, index, left))
        return [(*box[:i], half, *box[i + 1 :]) for half in cuts[i]]

    def _blur(self, box: Box, known: int, left: Array | None) -> float:
        """The width of ``L A``, or of all enclosures without L, if one variable were known."""
        sides = [hull(side) for side in box]
        if not sides[known].finite:
            return -1.0
        centre = arb(middle(box[known]))
        sides[known] = Ends(centre, centre)
        table, signs = self._enclosed(sides)
        radii = np.array([[_radius(entry) for entry in row] for row in table])
        if left is not None:
            return float((np.abs(left) @ radii).sum())
        return float(radii.sum()) + sum(_radius(sign) for sign in signs)

    def _enclosed(self, sides: Sequence[Ends]) -> tuple[list[list[Ends]], list[Ends]]:
        """The rows and the signs over a box."""
        height, columns = self.rows.shape
        found = self._values.evaluate([*sides, *self._constants], INTERVALS)
        table = [[found[j * height + i] for j in range(columns)] for i in range(height)]
        return table, found[height * columns :]

    def _at(self, point: Sequence[float]) -> Array:
        """The rows in floating point, for choosing an inverse."""
        constants = [float(constant.low) for constant in self._constants]
        return np.asarray(self._numeric(ca.DM(list(point)), ca.DM(constants)).full())


def _radius(entry: Ends) -> float:
    return float(entry.ball().rad()) if entry.finite else UNBOUNDED


def _regular(matrix: arb_mat) -> bool:
    """Whether every matrix within the balls is regular.

    It is proved by a positive vector d with ``m_ii d_i > sum_j |m_ij| d_j`` for all rows i: the
    matrix with its columns scaled by d is strictly diagonally dominant.
    """
    n = int(matrix.nrows())
    sizes = np.array([[float(matrix[i, j].abs_upper()) for j in range(n)] for i in range(n)])
    comparison = np.diag([float(matrix[i, i].lower()) for i in range(n)]) - sizes
    comparison += np.diag(np.diag(sizes))
    if not np.all(np.isfinite(comparison)) or np.linalg.matrix_rank(comparison) < n:
        return False
    scales = [arb(float(scale)) for scale in np.linalg.solve(comparison, np.ones(n))]
    off = [
        sum((matrix[i, j] * scales[j]).abs_upper() for j in range(n) if j != i) for i in range(n)
    ]
    return all(scales[i] > 0 and matrix[i, i] * scales[i] > off[i] for i in range(n))


def rest_test(motions: BodyMotions, group: Sequence[int], bodies: Sequence[int]) -> RestTest:
    """The test for a group of degrees of freedom, and bodies moved only by these and known ones."""
    signs, needs = list(motions.weights), list[tuple[int, ...]]()
    blocks = [ca.SX(0, len(group))]
    for velocity in motions.velocities:
        if velocity.body in bodies:
            indices = tuple(range(len(signs), len(signs) + len(velocity.positive)))
            signs += velocity.positive
            needs += [indices] * int(velocity.rows.size1())
            blocks.append(velocity.rows[:, list(group)])
    rows = ca.vertcat(*blocks)
    still = still_joints(motions.model, group, bodies)
    if still:
        chosen = motions.variables[list(still)]
        rows = ca.substitute(rows, chosen, ca.SX.zeros(len(still)))
    return RestTest(motions, rows, ca.vertcat(*signs), tuple(needs), len(motions.weights))


def still_joints(model: RobotModel, group: Sequence[int], bodies: Sequence[int]) -> list[int]:
    """Joints that move these bodies as a whole, no later than the first joint of the group.

    Their coordinates change no distance and no angle between velocities, so they may be set to
    zero.
    """
    chains = [model.chain(model.bodies[body].frame) for body in bodies]
    used = Counter(
        step.dof
        for frame in {frame for chain in chains for frame in chain}
        if isinstance(step := model.frames[frame].step, Joint)
    )
    found: list[int] = []
    for frames in zip(*chains, strict=False):
        step = model.frames[frames[0]].step
        if len(set(frames)) > 1:
            break
        if isinstance(step, Joint):
            if used[step.dof] > 1:
                break
            found.append(step.dof)
            if step.dof in group:
                break
    return found

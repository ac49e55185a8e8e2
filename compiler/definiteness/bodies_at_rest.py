r"""Positive definiteness of M from the velocities of the bodies, without their masses.

.. math:: v'Mv = \sum_b m_b |J_b v|^2 + (W_b v)' I_b (W_b v)

Where no term is negative, v'Mv = 0 puts every body of positive mass at rest: its points, and what
of its rotation has inertia.  So M is positive definite where the matrix A of those velocities has
full column rank, however the masses and lengths are.

The rates are shown to be zero group by group.  A group of joints needs only bodies that no other
joints move but those of the groups before; what the joints before the first of the group do turns
and shifts these bodies as a whole, and does not matter.  So a chain whose every joint carries a
body of its own is proved joint by joint, and its coordinates drop out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.definiteness.box_search import Examined, widest_effect
from compiler.definiteness.boxes import Box
from compiler.definiteness.enclosed_matrix import EnclosedMatrix
from compiler.dynamics.absolute_angles import own_coordinates
from compiler.dynamics.kinematics import Kinematics, kinematics, rotation
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluators.intervals import Ends
from compiler.expressions.scalars import Constant, PiConstant
from compiler.robots.robot import Body, Joint, PointBody, RobotModel, RodBody, SolidBody, Turn

SHARPEST = 1e-3


@dataclass(frozen=True, slots=True)
class Velocities:
    """Rows J of one body: v'Mv = 0 implies J v = 0 where all of ``positive`` are above zero."""

    body: int
    rows: ca.SX
    positive: tuple[ca.SX, ...]


@dataclass(frozen=True, slots=True)
class BodyMotions:
    """The velocities of all bodies.

    ``variables`` are q then theta.  Where none of ``weights`` is negative, no term of v'Mv is.
    """

    model: RobotModel
    variables: ca.SX
    symbols: ca.SX
    constants: tuple[Constant | PiConstant, ...]
    velocities: tuple[Velocities, ...]
    weights: tuple[ca.SX, ...]

    def enclosed(self, matrix: ca.SX) -> EnclosedMatrix:
        """A matrix of these expressions."""
        return EnclosedMatrix(matrix, self.variables, self.symbols, self.constants)

    def moved_by(self, body: int) -> tuple[int, ...]:
        """The degrees of freedom before a body."""
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
            # Mass above zero means a length other than zero: both ends at rest, so the direction.
            mass = literal(density) * literal(length)
            rows = ca.vertcat(rates(at.origins[frame]), rates(at.axis(frame, axis)))
            return [Velocities(number, rows, (mass,))], [mass]
        case PointBody(frame, scalar):
            mass = at.scalars[scalar]
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
    """The rows of a rotation, and what must not be negative: all principal minors."""
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
class RestTest:
    """Whether the rates of a group of joints are zero when its bodies are at rest, on one box.

    Row i of ``rows`` counts where the entries ``needs[i]`` of ``signs`` are above zero; the first
    ``weights`` entries must not be negative.
    """

    rows: EnclosedMatrix
    signs: EnclosedMatrix
    needs: tuple[tuple[int, ...], ...]
    weights: int

    @property
    def active(self) -> tuple[int, ...]:
        """The variables that matter."""
        return tuple(sorted({*self.rows.active, *self.signs.active}))

    def examine(self, box: Box) -> Examined:
        """Whether an approximate left inverse times the rows is regular on the box."""
        sides = [side.ends for side in box]
        signs, natural = self.signs.enclosed(sides), self.rows.enclosed(sides)
        height, columns = self.rows.shape
        middle = self.rows.at([float(side.middle) for side in box])
        kept = [
            i
            for i in range(height)
            if all(signs[need].low > 0 for need in self.needs[i])
            and all(natural[j * height + i].finite for j in range(columns))
            and np.all(np.isfinite(middle[i]))
        ]
        left = self._left_inverse(middle, kept, natural)
        ordinary = all(sign.low >= 0 for sign in signs[: self.weights])
        if left is not None and ordinary:
            proved = self.rows.regular(box, left, np.eye(columns), natural, kept)
            if proved:
                return Examined(proved=True)
        score = self._score(middle, [entry.low for entry in signs])
        return Examined(proved=False, score=score, split=lambda: self._split(box, kept, left))

    def _left_inverse(self, middle: Array, kept: list[int], natural: list[Ends]) -> Array | None:
        """The weighted pseudo-inverse of the rows: those known sharply weigh more."""
        height, columns = self.rows.shape
        if len(kept) < columns:
            return None
        matrix = middle[kept]
        radii = [
            max(float(natural[j * height + i].ball().rad()) for j in range(columns)) for i in kept
        ]
        largest = float(np.abs(matrix).max())
        weights = 1 / (np.array(radii) + SHARPEST * (largest or 1.0)) ** 2
        normal = matrix.T @ (weights[:, None] * matrix)
        if np.linalg.matrix_rank(normal) < columns:
            return None
        return np.asarray(np.linalg.solve(normal, matrix.T * weights))

    def _score(self, middle: Array, lows: list[arb]) -> float:
        """The least singular value of the rows, columns scaled to length one."""
        if any(low < 0 for low in lows[: self.weights]):
            return -2.0
        matrix = middle[np.all(np.isfinite(middle), axis=1)]
        lengths = np.linalg.norm(matrix, axis=0)
        if len(matrix) < matrix.shape[1] or not np.all(lengths > 0):
            return -1.0
        return float(np.linalg.svd(matrix / lengths, compute_uv=False)[-1])

    def _split(self, box: Box, kept: list[int], left: Array | None) -> int | None:
        height = self.rows.shape[0]
        rows = list(range(height)) if left is None else kept
        before = np.eye(height) if left is None else left
        signs = self.signs.shape[0]

        def effect(i: int) -> float:
            blur = self.rows.blur(box, i, before, rows)
            if left is None:
                blur += self.signs.blur(box, i, np.eye(signs), range(signs))
            return -blur

        return widest_effect(box, self.active, effect)


def rest_test(motions: BodyMotions, group: Sequence[int], bodies: Sequence[int]) -> RestTest:
    """The test for a group of degrees of freedom and bodies that only these and known ones move."""
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
    return RestTest(
        motions.enclosed(rows),
        motions.enclosed(ca.vertcat(*signs)),
        tuple(needs),
        len(motions.weights),
    )


def still_joints(model: RobotModel, group: Sequence[int], bodies: Sequence[int]) -> list[int]:
    """Joints that move these bodies as a whole, no later than the first joint of the group.

    Their coordinates change no distance and no angle between velocities, so they may be zero.
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

"""Whether inputs within their bounds balance a robot at its start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import BALLS, ball, below, closed_ball, column
from compiler.expressions.tape import tape
from compiler.robots.payloads import loads_of
from compiler.robots.state_and_input import InputBound, dry_friction, input_bounds, robot_states
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.effort_bounds import distance
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.tube_checks import Status

HELD = "start held"
TINY = 1e-300
NOT_KNOWN = "no inputs are known to balance the robot"
ROUNDS = 4
"""Steps of Newton's method in floats."""
WIDTHS = (1e15, 1e-6)
"""Widths of the boxes of inputs around those in floats, in their units; the first is vast, since
forces are mostly affine."""


def held_start(scene: Scene, state: Sequence[arb], tail: Sequence[arb]) -> CheckedCondition:
    """Check that some inputs within their bounds leave all joints without acceleration.

    The joints' forces b(u) have a zero if S encloses their slopes over a box of inputs about u0 and
    u0 - S^-1 b(u0) is within the box; the zero is there and is the only one in the box (interval
    Newton; Neumaier, *Interval methods for systems of equations*, 1990). The margin is the least
    share of a bound that the inputs leave unused. If there are more inputs than joints, some keep
    the values that balance the robot in floats. Forces that no input changes have to be zero. Dry
    friction may balance a robot; a failure of the inputs alone then refutes nothing.

    Args:
        scene: the robot in its task.
        state: coordinates (n,); further entries are ignored, since the robot is at rest.
        tail: theta and k.
    """
    bounds = input_bounds(scene.model, scene.task)
    inputs, unique = _Balance(scene, state, tail, bounds).inputs()
    unique = unique and not dry_friction(scene.model)
    if inputs is None:
        status = Status.FAILS if unique else Status.UNDECIDED
        why = "no input pushes against what moves a joint" if unique else NOT_KNOWN
        return CheckedCondition(HELD, status, -NO_MARGIN, "1", 0.0, why=why)
    least = arb(1)
    for bound in bounds:
        if bound.widest_margin > 0:
            least = least.min(distance(bound, inputs) / ball(bound.widest_margin))
    margin = below(least)
    status = Status.HOLDS if margin >= 0 else Status.UNDECIDED
    if unique and bool(least < 0):
        status, margin = Status.FAILS, float(least.mid())
    return CheckedCondition(HELD, status, margin, "1", 0.0)


@dataclass(frozen=True)
class _Balance:
    """The joints' forces of a robot at rest as a function of its inputs."""

    scene: Scene
    state: Sequence[arb]
    tail: Sequence[arb]
    bounds: Sequence[InputBound]

    def inputs(self) -> tuple[list[arb] | None, bool]:
        """Inputs (m,) that balance the robot, or None; and whether no others do."""
        middle, weights = self._middle_and_weights()
        centre = self._balls(middle)
        anything = [arb(value, WIDTHS[0]) for value in middle.tolist()]
        slopes, forces = self._slopes(anything), self._forces(centre)
        live = []
        for joint in range(slopes.nrows()):
            # A slope that only may be zero decides nothing; exact zeros do.
            if not all(slopes[joint, j].is_zero() for j in range(len(centre))):
                live.append(joint)
            elif not forces[joint, 0].is_zero():
                return None, not forces[joint, 0].contains(0)
        free = int(np.count_nonzero(weights))
        if not live:
            return centre, free == 0
        about = self._zero(middle, weights, live) if free >= len(live) else None
        if about is None:
            return None, False
        here = _floats(self._slopes(self._balls(about)))[live] * weights
        chosen = _independent(here)
        for width in WIDTHS:
            found = self._enclosed(about, live, chosen, width)
            if found is not None:
                return found, free == len(live) and width == WIDTHS[0]
        return None, False

    def _middle_and_weights(self) -> tuple[Array, Array]:
        """The middles of the bounds of the inputs, and the widest margins, (m,) each."""
        count = self.scene.graph.parts.u.numel()
        middle, weights = np.zeros(count), np.ones(count)
        weights[count - len(loads_of(self.scene.model)) :] = 0.0
        for bound in self.bounds:
            inputs = list(bound.inputs)
            weights[inputs] = float(bound.widest_margin)
            middle[inputs] = 0.0 if bound.norm2 else float((bound.lower + bound.upper) / 2)
        return middle, weights

    def _balls(self, u: Array) -> list[arb]:
        """Inputs (m,) as balls; inputs with a single possible value have exactly that value."""
        found = [arb(value) for value in u.tolist()]
        for bound in self.bounds:
            if bound.widest_margin == 0 and not bound.norm2:
                for place in bound.inputs:
                    found[place] = ball(bound.lower)
        return found

    def _zero(self, u: Array, weights: Array, live: Sequence[int]) -> Array | None:
        """Inputs near others, relative to their bounds, at which forces vanish in floats."""
        for _ in range(ROUNDS):
            balls = self._balls(u)
            forces, slopes = (_floats(part(balls))[live] for part in (self._forces, self._slopes))
            if not (np.isfinite(forces).all() and np.isfinite(slopes).all()):
                return None
            u = u - weights * np.linalg.lstsq(slopes * weights, forces[:, 0], rcond=None)[0]
        return u

    def _enclosed(
        self, about: Array, live: Sequence[int], chosen: Sequence[int], width: float
    ) -> list[arb] | None:
        """Balls about a zero in a box of the chosen inputs, with all others unchanged."""
        centre = self._balls(about)
        box = list(centre)
        for j in chosen:
            box[j] = arb(about[j], width)
        over, forces = self._slopes(box), self._forces(centre)
        square = arb_mat([[over[i, j] for j in chosen] for i in live])
        try:
            moves = square.solve(column([forces[i, 0] for i in live])).entries()
        except ZeroDivisionError:
            return None
        for j, move in zip(chosen, moves, strict=True):
            centre[j] = centre[j] - move
        return centre if all(bool(box[j].contains(centre[j])) for j in chosen) else None

    def _arguments(self, u: Sequence[arb]) -> list[arb]:
        n, own = len(self.scene.model.dofs), robot_states(self.scene.model)
        initial = [arb(0) if s.initial is None else closed_ball(s.initial) for s in own]
        return [*self.state[:n], *[arb(0)] * n, *initial, *u, *self.tail]

    def _forces(self, u: Sequence[arb]) -> arb_mat:
        n, flat = len(self.scene.model.dofs), tape(self.scene.graph.balance)
        return column(flat.evaluate(self._arguments(u), BALLS)[n * n : n * n + n])

    def _slopes(self, u: Sequence[arb]) -> arb_mat:
        """The Jacobian of the forces in the inputs, (n, m)."""
        n, m = len(self.scene.model.dofs), len(u)
        flat = tape(self.scene.graph.input_slopes).evaluate(self._arguments(u), BALLS) if m else []
        height = len(flat) // max(m, 1)
        return arb_mat(n, m, [flat[j * height + i] for i in range(n) for j in range(m)])


def _floats(matrix: arb_mat) -> Array:
    return np.array([[float(item) for item in row] for row in matrix.tolist()])


def _independent(slopes: Array) -> list[int]:
    """As many columns of a matrix (n, m) as it has rows, each farthest from those before."""
    rest, chosen = slopes.copy(), list[int]()
    for _ in range(len(slopes)):
        sizes = np.linalg.norm(rest, axis=0)
        sizes[chosen] = -1.0
        chosen.append(int(np.argmax(sizes)))
        direction = rest[:, chosen[-1]] / max(sizes[chosen[-1]], TINY)
        rest -= np.outer(direction, direction @ rest)
    return sorted(chosen)

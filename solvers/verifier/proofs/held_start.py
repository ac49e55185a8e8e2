"""Whether some inputs within their bounds balance a robot where it starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import BALLS, ball, below, closed_ball, column
from compiler.expressions.tape import tape
from compiler.robots.state_and_input import InputBound, input_bounds, robot_states
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.effort_bounds import distance
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.tube_checks import Status

HELD = "start held"
TINY = 1e-300
ROUNDS = 4
"""Steps of Newton's method in floats."""
WIDTHS = (1e15, 1e-6)
"""How far from inputs in floats others are looked at, in their units: forces are mostly affine."""


def held_start(scene: Scene, state: Sequence[arb], tail: Sequence[arb]) -> CheckedCondition:
    """Some inputs within their bounds leave all joints of a robot without acceleration.

    The joints' forces b(u) have a zero: where S holds their slopes over a box of inputs about u0,
    and u0 - S^-1 b(u0) is within the box, it has one there, and no other in the box (interval
    Newton; Neumaier, *Interval methods for systems of equations*, 1990).  The margin is the least
    share that it leaves of a bound.  Of more inputs than joints, some keep values that balance the
    robot in floats.

    Args:
        scene: the robot in its task.
        state: coordinates (n,), then what does not matter: the robot is at rest.
        tail: theta and k.
    """
    bounds = input_bounds(scene.model, scene.task)
    found = _Balance(scene, state, tail).inputs(bounds)
    if found is None:
        why = "no inputs are known to balance the robot"
        return CheckedCondition(HELD, Status.UNDECIDED, -NO_MARGIN, "1", 0.0, why=why)
    inputs, unique = found
    least = arb(1)
    for bound in bounds:
        widest = ball(bound.widest_margin) if bound.widest_margin > 0 else arb(1)
        least = least.min(distance(bound, inputs) / widest)
    margin = below(least)
    status = Status.HOLDS if margin >= 0 else Status.UNDECIDED
    if unique and bool(least < 0):
        status, margin = Status.FAILS, float(least.mid())
    return CheckedCondition(HELD, status, margin, "1", 0.0)


@dataclass(frozen=True)
class _Balance:
    """The joints' forces of a robot at rest, by its inputs."""

    scene: Scene
    state: Sequence[arb]
    tail: Sequence[arb]

    def inputs(self, bounds: Sequence[InputBound]) -> tuple[list[arb], bool] | None:
        """Inputs (m,) that balance the robot, and whether no others do; None: none are known."""
        n, m = len(self.scene.model.dofs), self.scene.graph.parts.u.numel()
        start = np.array([float(_middle(bounds, place)) for place in range(m)])
        if not n:
            return [arb(value) for value in start.tolist()], True
        about = self._zero(start) if m >= n else None
        if about is None:
            return None
        chosen = _independent(_floats(self._slopes([arb(x) for x in about.tolist()])))
        for width in WIDTHS:
            found = self._enclosed(about, chosen, width)
            if found is not None:
                return found, m == n and width == WIDTHS[0]
        return None

    def _zero(self, u: Array) -> Array | None:
        """Inputs near others at which the forces vanish in floats."""
        for _ in range(ROUNDS):
            balls = [arb(value) for value in u.tolist()]
            forces, slopes = _floats(self._forces(balls)), _floats(self._slopes(balls))
            if not (np.isfinite(forces).all() and np.isfinite(slopes).all()):
                return None
            u = u - np.linalg.lstsq(slopes, forces[:, 0], rcond=None)[0]
        return u

    def _enclosed(self, about: Array, chosen: Sequence[int], width: float) -> list[arb] | None:
        """Balls about a zero in a box of the chosen inputs, all others being as they are."""
        centre = [arb(value) for value in about.tolist()]
        box = list(centre)
        for j in chosen:
            box[j] = arb(about[j], width)
        over = self._slopes(box)
        square = arb_mat([[over[i, j] for j in chosen] for i in range(over.nrows())])
        try:
            moves = square.solve(self._forces(centre)).entries()
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
        flat = tape(self.scene.graph.input_slopes).evaluate(self._arguments(u), BALLS)
        height = len(flat) // len(u)
        return arb_mat(
            [
                [flat[j * height + i] for j in range(len(u))]
                for i in range(len(self.scene.model.dofs))
            ]
        )


def _floats(matrix: arb_mat) -> Array:
    return np.array([[float(item) for item in row] for row in matrix.tolist()])


def _independent(slopes: Array) -> list[int]:
    """As many columns of a matrix (n, m) as it has rows, each the farthest from those before."""
    rest, chosen = slopes.copy(), list[int]()
    for _ in range(len(slopes)):
        sizes = np.linalg.norm(rest, axis=0)
        sizes[chosen] = -1.0
        chosen.append(int(np.argmax(sizes)))
        direction = rest[:, chosen[-1]] / max(sizes[chosen[-1]], TINY)
        rest -= np.outer(direction, direction @ rest)
    return sorted(chosen)


def _middle(bounds: Sequence[InputBound], place: int) -> Fraction:
    """The middle of the bounds of an input; zero where none is known."""
    own = [each for each in bounds if place in each.inputs and not each.norm2]
    return (own[0].lower + own[0].upper) / 2 if own else Fraction(0)

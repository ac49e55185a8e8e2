r"""Absolute angles: revolute joints about one axis measured from a fixed direction.

.. math:: q = D y

with an integer matrix D.  In y the mass matrix of a chain has one cosine per entry and no velocity
couples with another, so interval arithmetic loses far less than in the joints' own coordinates.
(The paper's Example 3 uses such angles, its case study the joints' own.)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.robots.robot import Joint, RobotModel, Turn


@dataclass(frozen=True, slots=True)
class Coordinates:
    """The matrix D, by rows, of q = D y, and the joints whose y is an absolute angle."""

    rows: tuple[tuple[int, ...], ...]
    absolute: frozenset[int]

    def solved_for(self, q: Sequence[Fraction]) -> list[Fraction]:
        """The y with D y = q, exactly.  A row has its own entry, at most one of another joint."""
        known: dict[int, Fraction] = {}
        while len(known) < len(self.rows):
            for i, row in enumerate(self.rows):
                others = [j for j, entry in enumerate(row) if j != i and entry]
                if i not in known and all(j in known for j in others):
                    rest = q[i] - sum((row[j] * known[j] for j in others), Fraction(0))
                    known[i] = rest / row[i]
        return [known[i] for i in range(len(self.rows))]


def own_coordinates(model: RobotModel) -> Coordinates:
    """The identity: y are the joints' own coordinates."""
    n = len(model.dofs)
    return Coordinates(tuple(tuple(int(i == j) for j in range(n)) for i in range(n)), frozenset())


def absolute_angles(model: RobotModel) -> Coordinates:
    """Absolute angles for a robot.

    A revolute joint that follows another about its axis, with only rigid turns about it and
    translations in between, is measured from where that one is; every other coordinate is its own
    up to its sign.  A coordinate that moves two frames is left as it is.
    """
    rows = [list(row) for row in own_coordinates(model).rows]
    uses = Counter(node.step.dof for node in model.frames if isinstance(node.step, Joint))
    absolute: set[int] = set()
    before: list[tuple[int, int | None]] = []
    for node in model.frames:
        axis, leader = before[node.parent] if before else (2, None)
        match node.step:
            case Turn(turned, _) if turned != axis:
                axis, leader = turned, None
            case Joint(dof, turned, sign) if model.dofs[dof].kind == "revolute":
                leader = leader if turned == axis else None
                axis = turned
                if uses[dof] == 1:
                    absolute.add(dof)
                    rows[dof][dof] = sign
                    if leader is not None:
                        rows[dof][leader] = -sign
                    leader = dof
            case _:
                pass
        before.append((axis, leader))
    return Coordinates(tuple(tuple(row) for row in rows), frozenset(absolute))


def own_motion(coordinates: Coordinates, y: ca.SX) -> ca.SX:
    """D y: the joints' own coordinates or rates, shape (n,)."""
    return _stack([_weighed(row, y) for row in coordinates.rows])


def generalised_forces(coordinates: Coordinates, forces: ca.SX) -> ca.SX:
    """D' tau: the forces on the joints' own coordinates by virtual work, shape (n,)."""
    return _stack([_weighed(column, forces) for column in zip(*coordinates.rows, strict=True)])


def _weighed(weights: Sequence[int], values: ca.SX) -> ca.SX:
    """The sum of values with weights 1, 0 and -1."""
    total = ca.SX(0)
    for i, weight in enumerate(weights):
        if weight:
            total = total + (values[i] if weight > 0 else -values[i])
    return total


def _stack(entries: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)

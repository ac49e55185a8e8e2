r"""The set of states in which every round of a motion that goes on for ever begins.

.. math:: S = \{\, c + G r : |r_i| \le 1 \,\}

with G square and invertible, over coordinates and rates of the joints and the modules' own states.
If all motions of the prefix end in S, and all motions of one round that begin in S end in S, then
every round begins in S (by induction), and what holds of all motions of one round holds of all
rounds.  A state x is in S if and only if :math:`|G^{-1} (x - c)| \le 1` entry by entry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, fmpq, fmpq_mat

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import ball
from solvers.verifier.proofs.zonotope import InitialSet, Zonotope


@dataclass(frozen=True, slots=True)
class Loop:
    """The first sample of a loop, and the set of states there, exactly, in SI units.

    Attributes:
        first: the sample at which the loop begins; after the last step it begins again.
        centre: coordinates, then rates of the joints, then the modules' own states, (N,).
        generators: the rows of G, (N, N), which is invertible.

    Raises:
        ValueError: the shapes do not agree, or G is singular.
    """

    first: int
    centre: tuple[Fraction, ...]
    generators: tuple[tuple[Fraction, ...], ...]

    def __post_init__(self) -> None:
        size = len(self.centre)
        if len(self.generators) != size or any(len(row) != size for row in self.generators):
            raise ValueError("the set of a loop needs as many generators as states")
        if size and _matrix(self.generators).det() == 0:
            raise ValueError("the set of the loop is flat: its generators are not independent")


@dataclass(frozen=True, slots=True)
class LoopSet:
    """The set of a loop in balls, in the coordinates of a graph, which q = D y gives.

    Attributes:
        first: the sample at which the loop begins.
        initial: the set, with what states hold besides: inputs, and the factors of masses.
        to_unit: G^-1 diag(D, D, 1), which takes states to the unit box about ``centre``, (N, N).
        centre: G^-1 c, (N,).
    """

    first: int
    initial: InitialSet
    to_unit: arb_mat
    centre: tuple[arb, ...]

    def farthest(self, states: Zonotope) -> arb:
        """The largest entry of |G^-1 (x - c)| of all states x of a set: at most 1 if it is in S."""
        size = len(self.centre)
        if not size:
            return arb(0)
        found = arb(0)
        middle = (self.to_unit * arb_mat([[x] for x in states.middle[:size]])).entries()
        reach = [abs(m - c) for m, c in zip(middle, self.centre, strict=True)]
        if states.columns:
            columns = arb_mat([column[:size] for column in states.columns]).transpose()
            for i, row in enumerate((self.to_unit * columns).tolist()):
                reach[i] = sum((abs(item) for item in row), reach[i])
        for item in reach:
            found = found.max(item)
        return found


def loop_set(
    loop: Loop, graph: RobotGraph, state: Sequence[arb], masses: Sequence[Fraction]
) -> LoopSet:
    """The set of a loop in the working precision.

    Args:
        loop: the exact set, in the joints' own coordinates.
        graph: the equations of motion.
        state: the planned start, whose entries behind the robot's states every set shares.
        masses: how far factors of masses may be from 1; they are the last entries of a state.
    """
    size = len(loop.centre)
    initial = [_solved(graph, column) for column in zip(*loop.generators, strict=True)]
    centre = [ball(value) for value in _solved(graph, loop.centre)] + list(state[size:])
    rest = [arb(0)] * (len(state) - size)
    columns = [[ball(value) for value in column] + rest for column in initial]
    radii = [arb(1)] * size
    for number, mass in enumerate(masses, len(state) - len(masses)):
        columns.append([arb(int(i == number)) for i in range(len(state))])
        radii.append(ball(mass))
    rows = tuple(tuple(column[i] for column in columns) for i in range(len(state)))
    whole = InitialSet(tuple(centre), rows if columns else (), tuple(radii))
    if not size:
        return LoopSet(loop.first, whole, arb_mat(0, 0), ())
    inverse = _matrix(loop.generators).inv()
    turned = inverse * _matrix(_joint_rows(graph, size))
    there = inverse * _matrix([[value] for value in loop.centre])
    to_unit = arb_mat([[_ball(item) for item in row] for row in turned.tolist()])
    return LoopSet(loop.first, whole, to_unit, tuple(_ball(item) for item in there.entries()))


def _solved(graph: RobotGraph, values: Sequence[Fraction]) -> list[Fraction]:
    """A state of the joints' coordinates in those of the graph."""
    n = len(graph.model.dofs)
    parts = [graph.coordinates.solved_for(part) for part in (values[:n], values[n : 2 * n])]
    return [value for part in parts for value in part] + list(values[2 * n :])


def _joint_rows(graph: RobotGraph, size: int) -> list[list[Fraction]]:
    """diag(D, D, 1)."""
    n, turn = len(graph.model.dofs), graph.coordinates.rows
    rows = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    for part in (0, n):
        for i in range(n):
            rows[part + i][part : part + n] = [Fraction(value) for value in turn[i]]
    return rows


def _matrix(rows: Sequence[Sequence[Fraction]]) -> fmpq_mat:
    return fmpq_mat([[fmpq(x.numerator, x.denominator) for x in row] for row in rows])


def _ball(value: fmpq) -> arb:
    return arb(value)

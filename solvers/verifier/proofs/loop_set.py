r"""The set of states in which every round of a motion that goes on for ever begins.

.. math:: S = \{\, c + G r : |r_i| \le 1 \,\}

with G square and invertible, over coordinates and rates of the joints and the modules' own states.
If all motions of the prefix end in S, and all motions of one round that begin in S end in S, then
every round begins in S (by induction), and whatever holds for all motions of one round holds for
all rounds.  A state x is in S if and only if :math:`|G^{-1} (x - c)| \le 1` entry by entry.

If a full turn of a joint gives the same robot, the joint may return with additional full turns: a
state x at the end of a round is then compared as :math:`x - 2 \pi t` with integer t, and the next
round counts the joint's coordinate from there.
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
        first: the sample at which the loop begins; it follows the last step.
        centre: coordinates, then rates of the joints, then the modules' own states, (N,).
        generators: the rows of G, (N, N), which is invertible.
        turns: the full turns of each joint in a round, (n,); empty: no turns.

    Raises:
        ValueError: the shapes do not agree, or G is singular.
    """

    first: int
    centre: tuple[Fraction, ...]
    generators: tuple[tuple[Fraction, ...], ...]
    turns: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        size = len(self.centre)
        if len(self.generators) != size or any(len(row) != size for row in self.generators):
            raise ValueError("the set of a loop needs as many generators as states")
        if 2 * len(self.turns) > size:
            raise ValueError("a loop turns no more joints than there are")
        if size and _matrix(self.generators).det() == 0:
            raise ValueError("the set of the loop is flat: its generators are not independent")


@dataclass(frozen=True, slots=True)
class LoopSet:
    """The set of a loop in balls, in the coordinates y of a graph, q = D y.

    Attributes:
        first: the sample at which the loop begins.
        initial: the set, with further entries of states: inputs, and the factors of masses.
        to_unit: G^-1 diag(D, D, 1), which maps states to the unit box about ``centre``, (N, N).
        centre: G^-1 c, (N,).
        turned: G^-1 (c + 2 pi t), (N,), with the full turns t of a round.
    """

    first: int
    initial: InitialSet
    to_unit: arb_mat
    centre: tuple[arb, ...]
    turned: tuple[arb, ...]

    def farthest(self, states: Zonotope, *, after: bool = False) -> arb:
        """The largest entry of |G^-1 (x - c)| over a set of states x: at most 1 if it is in S.

        The states are those before a round or, with ``after``, those after it, less its full turns.
        """
        size, centre = len(self.centre), self.turned if after else self.centre
        if not size:
            return arb(0)
        found = arb(0)
        middle = (self.to_unit * arb_mat([[x] for x in states.middle[:size]])).entries()
        reach = [abs(m - c) for m, c in zip(middle, centre, strict=True)]
        spread = states.first(size).radii_under(self.to_unit)
        for item, radius in zip(reach, spread, strict=True):
            found = found.max(item + radius)
        return found


def loop_set(
    loop: Loop, graph: RobotGraph, state: Sequence[arb], masses: Sequence[Fraction]
) -> LoopSet:
    """The set of a loop in the working precision.

    Args:
        loop: the exact set, in the joints' own coordinates.
        graph: the equations of motion.
        state: the planned start; every set shares its entries after the robot's states.
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
        return LoopSet(loop.first, whole, arb_mat(0, 0), (), ())
    inverse = _matrix(loop.generators).inv()
    by_graph = inverse * _matrix(_joint_rows(graph, size))
    there = _balls(inverse * _matrix([[value] for value in loop.centre]))
    turns = [Fraction(turn) for turn in loop.turns] + [Fraction(0)] * (size - len(loop.turns))
    further = _balls(inverse * _matrix([[turn] for turn in turns]))
    turned = [c + 2 * arb.pi() * t for c, t in zip(there, further, strict=True)]
    to_unit = arb_mat([[arb(item) for item in row] for row in by_graph.tolist()])
    return LoopSet(loop.first, whole, to_unit, tuple(there), tuple(turned))


def _solved(graph: RobotGraph, values: Sequence[Fraction]) -> list[Fraction]:
    """A state in the coordinates of the graph, from the joints' coordinates."""
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


def _balls(column: fmpq_mat) -> list[arb]:
    return [arb(value) for value in column.entries()]

r"""The vector field of a robot with some joints held at rest by dry friction.

A joint j that sticks has :math:`\dot q_j = \ddot q_j = 0`: its row of M and of the forces states
that, and friction supplies the effort.  The other joints move as if j were rigid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from compiler.expressions.tape import Node, Tape
from solvers.verifier.proofs.vector_field import Curvature, VectorField


class StickingFields:
    """The fields of a robot with some joints at rest, each built on demand."""

    def __init__(self, whole: VectorField) -> None:
        self.whole = whole
        self._known = {frozenset[int](): whole}

    def of(self, joints: frozenset[int]) -> VectorField:
        """The field with these joints at rest."""
        if joints not in self._known:
            self._known[joints] = sticking_field(self.whole, joints)
        return self._known[joints]


def sticking_field(field: VectorField, joints: frozenset[int]) -> VectorField:
    """The field of a robot with these joints at rest; the coordinates are the joints' own."""
    n, height = field.dofs, field.dofs + field.own

    def balance(output: int) -> int | None:
        if output < n * n:
            row, column = output % n, output // n
            return int(row == column) if joints & {row, column} else None
        return 0 if output - n * n in joints else None

    def rows(output: int) -> int | None:
        return 0 if output % height in joints else None

    slopes = field.input_slopes
    return replace(
        field,
        balance=_with_constants(field.balance, balance),
        variation=_with_constants(field.variation, rows),
        input_slopes=None if slopes is None else _with_constants(slopes, rows),
        curvature=None if field.curvature is None else _curvature(field.curvature, joints),
    )


def _with_constants(program: Tape, constant: Callable[[int], int | None]) -> Tape:
    """A program with some of its outputs replaced by 0 or 1."""
    nodes: list[Node] = [*program.nodes, ("constant", (0,)), ("constant", (1,))]
    values = [constant(output) for output in range(program.outputs)]
    results = tuple(
        result if value is None else len(program.nodes) + value
        for result, value in zip(program.results, values, strict=True)
    )
    return Tape(tuple(nodes), results)


def _curvature(whole: Curvature, joints: frozenset[int]) -> Curvature:
    """The second derivatives of the remaining rows."""
    kept = [number for number, (row, _, _) in enumerate(whole.places) if row not in joints]
    second = Tape(whole.tape.nodes, tuple(whole.tape.results[number] for number in kept))
    places = tuple(whole.places[number] for number in kept)
    if whole.slopes is None:
        return Curvature(second, places)
    renumbered = {number: place for place, number in enumerate(kept)}
    left = [i for i, (value, _) in enumerate(whole.slope_places) if value in renumbered]
    third = Tape(whole.slopes.nodes, tuple(whole.slopes.results[i] for i in left))
    slope_places = tuple(
        (renumbered[whole.slope_places[i][0]], whole.slope_places[i][1]) for i in left
    )
    return Curvature(second, places, third, slope_places)

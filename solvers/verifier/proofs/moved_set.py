"""How a set of states moves on a segment of a tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import SIGNS, diagonal
from solvers.verifier.proofs.a_priori import Deviation, NearPath, narrowed
from solvers.verifier.proofs.deviation_flow import Flow, flow
from solvers.verifier.proofs.path import Path
from solvers.verifier.proofs.second_order import Added, added_by_forms
from solvers.verifier.proofs.step_control import WIDE
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import Zonotope, exactly

SLICES = 4
"""The parts of a segment on which a tighter box is computed."""
KEPT = exactly(8)
"""The order to which a wide set is reduced when conditions are checked."""


@dataclass(frozen=True, slots=True)
class MovedSet:
    """The flow on a segment, what is added to the moved set, and a box of all deviations.

    The box in which they were first found to stay was ``growth`` times as large. Second-order terms
    add at most the fraction ``second`` of a rate's bound per second. For a wide set, ``spread``
    keeps the dependence between its entries.
    """

    flow: Flow
    added: Added
    radii: Sequence[arb]
    growth: float = 1.0
    second: float = 0.0
    spread: Spread | None = None


@dataclass(frozen=True, slots=True)
class Spread:
    """The deviations from a path during a segment: e(t) = P(t) G r + d.

    All |r_j| <= 1 and |d| <= ``reach``. A box of them would lose the dependence between entries.
    """

    path: Path
    flow: Flow
    states: Zonotope
    reach: list[arb]

    def at(self, time: arb) -> tuple[list[arb], arb_mat]:
        """The path at an instant (size,), and the columns (size, c) that span the deviations."""
        size = len(self.reach)
        rows = [[r if i == j else arb(0) for j in range(size)] for i, r in enumerate(self.reach)]
        if self.states.columns.size:
            moved = self.flow.at(time) * self.states.matrix
            rows = [a + b for a, b in zip(moved.tolist(), rows, strict=True)]
        return self.path.at(time), arb_mat(rows)

    def value(self, weights: Sequence[int], time: arb) -> arb:
        """An enclosure of a weighted sum of a state's entries, at an instant or a ball of times."""
        state, columns = self.at(time)
        moved = (arb_mat([[arb(w) for w in weights]]) * columns).entries()
        centre = sum((w * x for w, x in zip(weights, state, strict=True)), arb(0))
        return centre + SIGNS * sum((abs(item) for item in moved), arb(0)).upper()


def moved_set(
    field: VectorField, states: Zonotope, near: NearPath, found: Deviation, degree: int
) -> MovedSet:
    """How a set moves on [0, H]: by forms if it is wide, otherwise by the bounds of a box.

    Raises:
        ZeroDivisionError: M may be singular along the path.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    if not any(bool(radius > WIDE) for radius in found.radii):
        return _by_box(field, near, found)
    closer = added_by_forms(field, states, near, found, degree)
    if closer is None:
        moved = _by_box(field, near, found)
        radii = _closer(states, near, found, moved.flow, moved.added)
        found = narrowed(field, near, radii, degree)
        moved = _by_box(field, near, found)
        closer = moved.flow, moved.added
        return MovedSet(*closer, _closer(states, near, found, *closer))
    radii = _closer(states, near, found, *closer)
    pairs = zip(found.radii, radii, strict=True)
    growth = max(float(f) / float(r) for f, r in pairs if r > 0)
    rates = zip(closer[1].pull, radii[field.dofs : 2 * field.dofs], strict=True)
    second = max((float(a) / float(r) for a, r in rates if r > 0), default=0.0)
    spread = Spread(near.path, closer[0], states.reduced(KEPT), closer[1].reach)
    return MovedSet(*closer, radii, growth, second, spread)


def _by_box(field: VectorField, near: NearPath, found: Deviation) -> MovedSet:
    """The flow of all deviations in a box."""
    transition = flow(field, near.path.length / 2, found.linear)
    still, steady = [arb(0)] * field.size, found.steady
    if steady is None:
        box = transition.added(near.start, found.push)
        return MovedSet(transition, Added(box, None, still, box), found.radii)
    box = transition.added(near.start, steady.rest)
    reach = [(b + r).upper() for b, r in zip(box, steady.reach, strict=True)]
    added = Added(box, steady.columns, still, reach)
    return MovedSet(transition, added, found.radii)


def pulled(found: Deviation, moved: MovedSet, length: arb) -> list[arb]:
    """The most by which the derivatives of rates and own states differ from those of the path.

    The bound holds on all of [0, length]: e' = A e + c, where ``found`` bounds A and c and
    ``moved`` bounds e. For a wide set the dependence between the entries of e is used.
    """
    lower, dofs = found.linear.lower, len(found.push) - found.linear.lower.nrows()
    columns = diagonal(moved.radii)
    if moved.spread is not None:
        columns = moved.spread.at(arb(0).union(length))[1]
    rows = (lower * columns).tolist()
    return [
        (sum((abs(item) for item in row), arb(0)) + push).upper()
        for row, push in zip(rows, found.push[dofs:], strict=True)
    ]


def _closer(
    states: Zonotope, near: NearPath, found: Deviation, transition: Flow, added: Added
) -> list[arb]:
    """A box of all deviations, tighter than the one in which they were found to stay."""
    radii = [arb(0)] * len(added.box)
    for k in range(SLICES):
        time = near.path.length * arb(k).union(arb(k + 1)) / SLICES
        over = states.radii_under(transition.at(time))
        radii = [r.max((o + a).upper()) for r, o, a in zip(radii, over, added.reach, strict=True)]
    # Both boxes are valid, so the smaller bound of each pair is, too.
    return [r.min(f) for r, f in zip(radii, found.radii, strict=True)]

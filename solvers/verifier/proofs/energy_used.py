r"""The energy that a robot's drives convert along a validated tube.

.. math:: E = \sum_j \int_0^T |u_j \dot q_j| \, dt

over the joints with a free input; braking counts like driving.  An input is constant within a
segment. While a rate keeps its sign, the integral of its absolute value is the distance travelled,
which the polynomials of a segment give almost exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import below
from compiler.expressions.exact_numbers import shortest_decimal
from compiler.robots.state_and_input import robot_inputs
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.enclosure import TubeSegment, polynomial
from solvers.verifier.proofs.linearisation import Coefficients
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.state_limits import weighted_sum
from solvers.verifier.proofs.tube_checks import Status

ENERGY = "energy"
"""The name of the condition; its ``margin`` and ``most`` are the bounds of the energy."""
PARTS = 16
"""The number of parts of a segment in which a rate changes its sign."""


@dataclass(slots=True)
class EnergyUsed:
    """Bounds (J) of the energy so far, for ``joints``: pairs of an input and a row of D."""

    joints: tuple[tuple[int, tuple[int, ...]], ...]
    low: arb = field(default_factory=lambda: arb(0))
    high: arb = field(default_factory=lambda: arb(0))

    @staticmethod
    def of(scene: Scene) -> EnergyUsed | None:
        """Empty bounds for a task; None if no objective is about energy."""
        if all(each.kind != "energy" for each in scene.task.minimize):
            return None
        rows = scene.graph.coordinates.rows
        inputs = enumerate(robot_inputs(scene.model))
        return EnergyUsed(
            tuple((i, tuple(rows[item.dof])) for i, item in inputs if item.dof is not None)
        )

    def add(self, segment: TubeSegment, efforts: Sequence[arb]) -> None:
        """Add a segment, with the inputs (m,) that act in it, errors included."""
        for number, weights in self.joints:
            first = len(weights)
            rates = segment.states[first : 2 * first]
            low, high = _way(weighted_sum(weights, rates), segment.length)
            size = abs(efforts[number])
            self.low += size.lower() * low
            self.high += size.upper() * high

    def condition(self) -> CheckedCondition:
        """The condition on the whole motion; undecided if the bounds are not finite."""
        low, high = below(self.low), float(self.high.upper())
        if not (self.low.is_finite() and self.high.is_finite()):
            return CheckedCondition(ENERGY, Status.UNDECIDED, -NO_MARGIN, "J")
        return CheckedCondition(ENERGY, Status.HOLDS, max(0.0, low), "J", most=high)


def _way(rate: Coefficients, length: arb) -> tuple[arb, arb]:
    """Bounds of the integral of |rate| over a segment."""
    sign = polynomial(rate, arb(0).union(length))
    if sign > 0 or sign < 0:
        way = abs(_integral(rate, arb(0), length))
        return way.lower(), way.upper()
    low = high = arb(0)
    for part in range(PARTS):
        start, end = length * part / PARTS, length * (part + 1) / PARTS
        speed = polynomial(rate, start.union(end))
        if speed > 0 or speed < 0:
            way = abs(_integral(rate, start, end))
            low, high = low + way.lower(), high + way.upper()
        else:
            high += abs(speed).upper() * (end - start).upper()
    return low.lower(), high.upper()


def _integral(rate: Coefficients, start: arb, end: arb) -> arb:
    """The integral of a polynomial, term by term, so that each coefficient occurs once."""
    total = arb(0)
    low, high = arb(1), arb(1)
    for power, coefficient in enumerate(rate, 1):
        low, high = low * start, high * end
        total += coefficient * (high - low) / power
    return total


def energy_bounds(conditions: Sequence[CheckedCondition]) -> tuple[Fraction, Fraction] | None:
    """The proved bounds of the energy (J); None if the task does not ask for them."""
    for each in conditions:
        if each.name == ENERGY and each.status is Status.HOLDS:
            return shortest_decimal(each.margin), shortest_decimal(each.most)
    return None

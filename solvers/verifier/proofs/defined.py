"""Check that the equations of motion, as written, have a value at every instant of a tube."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from compiler.expressions.evaluators.balls import BALLS
from compiler.expressions.tape import Tape
from solvers.verifier.proofs.enclosure import TubeSegment
from solvers.verifier.proofs.tube_checks import MOST_SPLITS, Status


@dataclass(slots=True)
class Defined:
    """Checks that divisors are not zero and radicands not negative; keeps the worst answer so far.

    ``tape`` maps (q, w, u, theta, k) to the ``divisors`` first and then the radicands; ``tail``
    holds the balls of theta and k.
    """

    tape: Tape
    divisors: int
    tail: tuple[arb, ...]
    status: Status = Status.HOLDS
    time: float = 0.0

    @property
    def is_needed(self) -> bool:
        """Whether there is anything to check."""
        return self.tape.outputs > 0

    def check(self, segment: TubeSegment, u: Sequence[arb]) -> None:
        """Check the conditions over one segment of a tube, halving it where they are undecided."""
        half = segment.length / 2
        pending = [(half, half, 0)]
        while pending and self.status is not Status.FAILS:
            middle, width, depth = pending.pop()
            status = self.over(segment.at(middle + arb(0, 1) * width), u)
            if status is Status.UNDECIDED and depth < MOST_SPLITS:
                quarter = width / 2
                pending += [
                    (centre, quarter, depth + 1) for centre in (middle + quarter, middle - quarter)
                ]
            elif status is not Status.HOLDS:
                self.status, self.time = status, float((segment.start + middle).mid())
                pending = []

    def over(self, state: Sequence[arb], u: Sequence[arb]) -> Status:
        """The conditions on states given as balls."""
        values = self.tape.evaluate([*state, *u, *self.tail], BALLS)
        parts = [_divisor(value) for value in values[: self.divisors]]
        parts += [_radicand(value) for value in values[self.divisors :]]
        if Status.FAILS in parts:
            return Status.FAILS
        return Status.UNDECIDED if Status.UNDECIDED in parts else Status.HOLDS


def _divisor(value: arb) -> Status:
    if value == 0:
        return Status.FAILS
    return Status.HOLDS if value != 0 else Status.UNDECIDED


def _radicand(value: arb) -> Status:
    if value < 0:
        return Status.FAILS
    return Status.HOLDS if value >= 0 else Status.UNDECIDED

"""Rotations with rational sine and cosine, as near to a given angle as is asked.

Every rational t gives the rotation with cosine (1 - t^2) / (1 + t^2) and sine 2t / (1 + t^2), by
t = tan(angle / 2); quarter turns are exact.  How far it is off is bounded by a ball, not by floats.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import ball, working_precision

BITS = 48
"""So many binary digits has the tangent of half the angle."""


@dataclass(frozen=True, slots=True)
class RationalRotation:
    """An exact rotation; ``error`` bounds its distance, as a matrix norm, from the one meant."""

    cosine: Fraction
    sine: Fraction
    error: Fraction

    def apply(self, x: Fraction, y: Fraction) -> tuple[Fraction, Fraction]:
        """The image of a point."""
        return self.cosine * x - self.sine * y, self.sine * x + self.cosine * y


def rational_rotation(angle: Fraction, bits: int = BITS) -> RationalRotation:
    """A rational rotation within about ``2 ** -bits`` of an angle in radians; exact for 0."""
    if not angle:
        return RationalRotation(Fraction(1), Fraction(0), Fraction(0))
    with working_precision(4 * bits + 128):
        turn = ball(angle)
        quarter = arb.pi() / 2
        quarters = round(float(turn / quarter))
        tangent = ((turn - quarters * quarter) / 2).tan()
        t = Fraction(round(float(tangent.mid() * 2**bits)), 2**bits)
        cosine, sine = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        for _ in range(quarters % 4):
            cosine, sine = -sine, cosine
        # Two rotations differ by their difference as complex numbers, in any vector's norm.
        real = turn.cos() - ball(cosine)
        imaginary = turn.sin() - ball(sine)
        distance = (real * real + imaginary * imaginary).sqrt()
        error = _above(distance * 2 ** (2 * bits), 2 ** (2 * bits))
    return RationalRotation(cosine, sine, error)


def _above(distance: arb, scale: int) -> Fraction:
    """A rational at least as large as every number of a ball, over ``scale``."""
    upper = distance.upper().ceil().unique_fmpz()
    if upper is None:
        raise ArithmeticError("the enclosure of a rotation is too wide")
    return Fraction(int(upper) + 1, scale)

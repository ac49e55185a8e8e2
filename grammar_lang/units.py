"""The units of the language: a closed list, exact factors to SI, and dimensions as integer vectors.

Source: BIPM, *The International System of Units*, 9th edition, tables 2, 4 and 8.  Angles are
dimensionless.  The only irrational factor is pi/180, for the degree, so every factor is a rational
number times a power of pi.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

MAX_EXPONENT = 12


@dataclass(frozen=True, slots=True)
class Dimension:
    """The exponents of metre, kilogram, second and ampere."""

    length: int = 0
    mass: int = 0
    time: int = 0
    current: int = 0

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(
            self.length + other.length,
            self.mass + other.mass,
            self.time + other.time,
            self.current + other.current,
        )

    def __pow__(self, exponent: int) -> Dimension:
        return Dimension(
            self.length * exponent,
            self.mass * exponent,
            self.time * exponent,
            self.current * exponent,
        )

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other**-1

    def root(self) -> Dimension | None:
        """The dimension whose square is this one; None if an exponent is odd."""
        exponents = (self.length, self.mass, self.time, self.current)
        if any(e % 2 for e in exponents):
            return None
        return Dimension(*(e // 2 for e in exponents))


ONE = Dimension()
LENGTH = Dimension(length=1)
MASS = Dimension(mass=1)
TIME = Dimension(time=1)
SPEED = Dimension(length=1, time=-1)
FREQUENCY = Dimension(time=-1)
ACCELERATION = Dimension(length=1, time=-2)
FORCE = Dimension(length=1, mass=1, time=-2)
TORQUE = Dimension(length=2, mass=1, time=-2)
DENSITY = Dimension(length=-1, mass=1)
INERTIA = Dimension(length=2, mass=1)

_KNOWN: dict[Dimension, tuple[str, str]] = {
    ONE: ("a plain number or angle", ""),
    LENGTH: ("a length", "m"),
    MASS: ("a mass", "kg"),
    TIME: ("a time", "s"),
    Dimension(current=1): ("a current", "A"),
    Dimension(length=2): ("an area", "m^2"),
    Dimension(length=3): ("a volume", "m^3"),
    Dimension(length=-3, mass=1): ("a mass per volume", "kg/m^3"),
    SPEED: ("a speed", "m/s"),
    FREQUENCY: ("an angular rate", "rad/s"),
    ACCELERATION: ("an acceleration", "m/s^2"),
    FORCE: ("a force", "N"),
    TORQUE: ("a torque", "N*m"),
    DENSITY: ("a mass per length", "kg/m"),
    INERTIA: ("a moment of inertia", "kg*m^2"),
    Dimension(2, 1, -3, 0): ("a power", "W"),
    Dimension(2, 1, -3, -1): ("a voltage", "V"),
}


@dataclass(frozen=True, slots=True)
class Unit:
    """``factor * pi**pi_power`` SI units of a dimension; ``angular`` if rad or deg occurs in it."""

    dimension: Dimension
    factor: Fraction
    pi_power: int = 0
    angular: bool = False


_UNITS: dict[str, Unit] = {
    "kg": Unit(MASS, Fraction(1)),
    "g": Unit(MASS, Fraction(1, 1000)),
    "N": Unit(FORCE, Fraction(1)),
    "m": Unit(LENGTH, Fraction(1)),
    "cm": Unit(LENGTH, Fraction(1, 100)),
    "mm": Unit(LENGTH, Fraction(1, 1000)),
    "s": Unit(TIME, Fraction(1)),
    "ms": Unit(TIME, Fraction(1, 1000)),
    "min": Unit(TIME, Fraction(60)),
    "rad": Unit(ONE, Fraction(1), angular=True),
    "deg": Unit(ONE, Fraction(1, 180), pi_power=1, angular=True),
    "V": Unit(Dimension(2, 1, -3, -1), Fraction(1)),
    "A": Unit(Dimension(current=1), Fraction(1)),
    "W": Unit(Dimension(2, 1, -3, 0), Fraction(1)),
    "J": Unit(TORQUE, Fraction(1)),
    "Hz": Unit(FREQUENCY, Fraction(1)),
}
UNIT_NAMES = tuple(_UNITS)

_FACTOR = re.compile(r"([*/]?)([A-Za-z]+)(?:\^(-?[0-9]+))?")


def unit(text: str) -> Unit | None:
    """Read a unit from left to right (``kg*m/s^2``).

    None if the text is not a unit, or if an exponent exceeds ``MAX_EXPONENT`` in size.
    """
    total = Unit(ONE, Fraction(1))
    position = 0
    while position < len(text):
        match = _FACTOR.match(text, position)
        if match is None or match[2] not in _UNITS or len(match[3] or "") > 3:
            return None
        exponent = int(match[3] or 1)
        if abs(exponent) > MAX_EXPONENT:
            return None
        if match[1] == "/":
            exponent = -exponent
        one = _UNITS[match[2]]
        total = Unit(
            total.dimension * one.dimension**exponent,
            total.factor * one.factor**exponent,
            total.pi_power + one.pi_power * exponent,
            total.angular or one.angular,
        )
        position = match.end()
    return total


def symbol(dimension: Dimension, *, angular: bool = False) -> str:
    """The SI unit of a dimension as text: ``m``, ``kg/m``; ``1`` or ``rad`` if dimensionless."""
    if dimension == ONE:
        return "rad" if angular else "1"
    if dimension in _KNOWN:
        return _KNOWN[dimension][1]
    named = zip(
        ("m", "kg", "s", "A"),
        (dimension.length, dimension.mass, dimension.time, dimension.current),
        strict=True,
    )
    parts = [name if e == 1 else f"{name}^{e}" for name, e in named if e]
    return "*".join(parts)


def describe(dimension: Dimension) -> str:
    """A dimension as messages name it: ``a length (m)``."""
    if dimension == ONE:
        return _KNOWN[ONE][0]
    name = _KNOWN[dimension][0] if dimension in _KNOWN else "a quantity"
    return f"{name} ({symbol(dimension)})"

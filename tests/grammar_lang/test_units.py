from __future__ import annotations

from fractions import Fraction

import pytest

from grammar_lang.units import (
    DENSITY,
    FORCE,
    INERTIA,
    LENGTH,
    ONE,
    TORQUE,
    Dimension,
    describe,
    symbol,
    unit,
)


@pytest.mark.parametrize(
    ("text", "dimension", "factor", "pi_power"),
    [
        ("m", LENGTH, Fraction(1), 0),
        ("cm", LENGTH, Fraction(1, 100), 0),
        ("N*m", TORQUE, Fraction(1), 0),
        ("J", TORQUE, Fraction(1), 0),
        ("kg*m/s^2", FORCE, Fraction(1), 0),
        ("g/mm", DENSITY, Fraction(1), 0),
        ("kg*m^2", INERTIA, Fraction(1), 0),
        ("deg", ONE, Fraction(1, 180), 1),
        ("deg/s", Dimension(time=-1), Fraction(1, 180), 1),
        ("1/s", None, None, None),
        ("min^-1", Dimension(time=-1), Fraction(1, 60), 0),
        ("V*A", Dimension(2, 1, -3, 0), Fraction(1), 0),
        ("W", Dimension(2, 1, -3, 0), Fraction(1), 0),
        ("m/s*s", LENGTH, Fraction(1), 0),
        ("furlong", None, None, None),
        ("m^99", None, None, None),
        ("m^99999999999999", None, None, None),
    ],
)
def test_units(
    text: str, dimension: Dimension | None, factor: Fraction | None, pi_power: int | None
) -> None:
    found = unit(text)
    if dimension is None:
        assert found is None
    else:
        assert found is not None
        assert (found.dimension, found.factor, found.pi_power) == (dimension, factor, pi_power)


def test_symbols_name_the_si_unit() -> None:
    assert symbol(LENGTH) == "m"
    assert symbol(DENSITY) == "kg/m"
    assert symbol(TORQUE) == "N*m"
    assert symbol(ONE) == "1"
    assert symbol(ONE, angular=True) == "rad"
    assert symbol(Dimension(length=3, time=-1)) == "m^3*s^-1"
    assert describe(LENGTH) == "a length (m)"


def test_root() -> None:
    assert Dimension(length=2).root() == LENGTH
    assert LENGTH.root() is None

"""Drives of joints and bounds of their efforts: what they mean, and every way to get them wrong."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from tests.grammar_lang.test_module_dynamics import module, num

Check = Callable[[str], list[tuple[str, str]]]

RATE, EFFORT = ir.RateOf(ir.THIS, "q"), ir.EffortOf(ir.THIS, "q")


def test_a_drive_from_a_data_sheet() -> None:
    """Parts in any order; the joint feels 160^2 times the inertia of the rotor."""
    found = module(
        "dof q: revolute y in [-120, 120] deg rate in [-3, 3] rad/s effort <= 75 N*m;"
        "drive q: gear 160 rotor 5.23e-5 kg*m^2 viscous 0.3 N*m*s;"
    )
    again = module(
        "drive q: viscous 300 N*mm*s rotor 523 g*cm^2 / 1000 gear 160;"
        "dof q: revolute y in [-120, 120] deg rate in [-3, 3] rad/s effort <= 75 J;"
    )
    (dof,) = found.dofs
    assert dof.effort == num("75")
    assert dof.inertia is not None
    assert to_float(dof.inertia) == pytest.approx(160**2 * 5.23e-5, rel=1e-15)
    drag = ir.Binary("*", num("3/10"), RATE)
    assert found.torques == (ir.Torque("q", ir.Binary("-", EFFORT, drag)),)
    assert found.free_dofs == (dof,)
    (other,) = again.dofs
    assert other.effort == dof.effort
    assert again.torques == found.torques
    assert to_float(other.inertia or num("0")) == pytest.approx(160**2 * 5.23e-8, rel=1e-15)


def test_accelerations_behind_rates_and_before_efforts() -> None:
    found = module(
        "dof q: revolute y accel <= 90 deg/s^2; dof p: prismatic x rate in [-1, 1] m/s "
        "accel <= 250 cm/s^2 effort <= 3 N;"
    )
    assert [to_float(dof.accel or num("0")) for dof in found.dofs] == [1.5707963267948966, 2.5]
    assert [dof.effort for dof in found.dofs] == [None, num("3")]


def test_a_spindle() -> None:
    """5 mm a turn: 2 pi / 5 mm radians a metre, so that the rotor weighs what it does."""
    found = module(
        "dof q: prismatic x effort <= 200 N; const lead = 5 mm;"
        "drive q: gear 2 * pi / lead rotor 1e-5 kg*m^2 viscous 3 N*s/m;"
    )
    (dof,) = found.dofs
    assert dof.inertia is not None
    assert to_float(dof.inertia) == pytest.approx((2 * 3.141592653589793 / 0.005) ** 2 * 1e-5)


def test_friction_is_taken_from_a_torque_of_ones_own() -> None:
    found = module(
        "dof q: revolute z; dof p: revolute z; torque(q) = 2 * u; drive q: viscous 1 N*m*s;"
        "drive p: gear 3;"
    )
    own = ir.Binary("-", ir.Binary("*", num("2"), EFFORT), ir.Binary("*", num("1"), RATE))
    assert found.torques == (ir.Torque("q", own),)
    assert [dof.inertia for dof in found.dofs] == [None, None]


def test_dry_friction_is_an_effort_of_the_joint() -> None:
    """In its unit; a friction of zero is none."""
    found = module(
        "dof q: revolute z; dof d: prismatic x; dof r: revolute z; const c = 3 N*m;"
        "drive q: coulomb c / 2 viscous 1 N*m*s; drive d: coulomb 20 N; drive r: coulomb 0 N*m;"
    )
    assert [None if dof.coulomb is None else to_float(dof.coulomb) for dof in found.dofs] == [
        1.5, 20.0, None,
    ]  # fmt: skip
    assert [torque.dof for torque in found.torques] == ["q"]


HEAD = (
    "module M { role joint; dof q: revolute z; dof d: prismatic x; const c = 2 kg; "
    "param p in [1, 2]; "
)


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("drive a: gear 2;", [("UNKNOWN_NAME", "a")]),
        ("drive c: gear 2;", [("UNKNOWN_NAME", "c")]),
        ("drive q: gear 2; drive q: gear 3;", [("REPEATED_CLAUSE", "drive q: gear 3;")]),
        ("drive q: gear 2 gear 3;", [("REPEATED_CLAUSE", "gear 3")]),
        ("drive q: gear -2;", [("BAD_VALUE", "-2")]),
        ("drive q: gear 2 m^-1;", [("UNIT_MISMATCH", "2 m^-1")]),
        ("drive d: gear 2 kg;", [("UNIT_MISMATCH", "2 kg")]),
        ("drive q: rotor 2 kg;", [("UNIT_MISMATCH", "2 kg")]),
        ("drive d: rotor 2 kg*m^2;", [("BAD_VALUE", "drive d: rotor 2 kg*m^2;")]),
        ("drive d: rotor 2 kg*m^2 gear 3 m^-1;", []),
        (
            "drive q: gear 1e200 rotor 1 kg*m^2;",
            [("BAD_NUMBER", "drive q: gear 1e200 rotor 1 kg*m^2;")],
        ),
        (
            "drive q: gear 1e60 rotor 1 kg*m^2;",
            [("BAD_NUMBER", "drive q: gear 1e60 rotor 1 kg*m^2;")],
        ),
        ("drive q: gear 0 rotor 1 kg*m^2;", []),
        ("drive q: viscous 2 N*s/m;", [("UNIT_MISMATCH", "2 N*s/m")]),
        ("drive q: viscous -1 N*m*s;", [("BAD_VALUE", "-1 N*m*s")]),
        ("drive q: viscous c;", [("UNIT_MISMATCH", "c")]),
        ("drive q: viscous p;", [("NOT_CONSTANT", "p")]),
        ("drive q: coulomb 2 N*m coulomb 2 N*m;", [("REPEATED_CLAUSE", "coulomb 2 N*m")]),
        ("drive q: coulomb 2 N;", [("UNIT_MISMATCH", "2 N")]),
        ("drive d: coulomb 2 N*m;", [("UNIT_MISMATCH", "2 N*m")]),
        ("drive q: coulomb -1 N*m;", [("BAD_VALUE", "-1 N*m")]),
        ("drive q: coulomb p;", [("NOT_CONSTANT", "p")]),
        ("drive d: coulomb 1 N rotor 2 kg*m^2 gear 3 m^-1;", []),
        ("dof r: revolute z effort <= 0 N*m;", [("BAD_VALUE", "0 N*m")]),
        ("dof r: revolute z effort <= 5 N;", [("UNIT_MISMATCH", "5 N")]),
        ("dof r: revolute z accel <= 0 rad/s^2;", [("BAD_VALUE", "0 rad/s^2")]),
        ("dof r: revolute z accel <= 5 rad/s;", [("UNIT_MISMATCH", "5 rad/s")]),
        ("dof r: prismatic z accel <= 5 rad/s^2;", [("UNIT_MISMATCH", "5 rad/s^2")]),
        ("dof r: prismatic z accel <= p * 1 m/s^2;", [("NOT_CONSTANT", "p * 1 m/s^2")]),
        ("dof r: revolute z accel <= 5 rad/s^2; torque(r) = 1 N*m;", []),
        (
            "dof r: revolute z effort <= 5 N*m; torque(r) = 1 N*m;",
            [("BAD_DYNAMICS", "5 N*m")],
        ),
        ("dof r: revolute z effort <= 5 N*m; torque(r) = 2 * u;", []),
    ],
)
def test_findings(body: str, found: list[tuple[str, str]], check_fragment: Check) -> None:
    assert check_fragment(HEAD + body + " }") == found

"""Specs that small mistakes, or ill will, would turn into false certificates."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import load_text
from solvers.run_context import RunContext
from solvers.search.synthesis import Synthesis, synthesise
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.formulas import program
from tests.oracles.result_files import alter_spec
from tests.oracles.small_specs import TURNER
from tests.oracles.some_cases import some

pytestmark = pytest.mark.usefixtures("without_pictures")


JOINT = "module JO { role joint; dof q: revolute z in [-180, 180] deg; }"


def turner(dynamics: str, old: str = "", new: str = "") -> str:
    """The turner with dynamics in its joint."""
    text = TURNER.replace(JOINT, JOINT[:-1] + dynamics + " }")
    return text.replace(old, new) if old else text


def answer(text: str) -> Synthesis:
    found = program(text)
    return synthesise(found, found.tasks["Turn"], RunContext())


@pytest.mark.parametrize(
    "torque",
    [
        "u + (sqrt(-4-q^2) - sqrt(-4-q^2))*(1 N*m)",  # no real value anywhere
        "u * (rate(q)/rate(q))",  # no value at rest, where the motion starts
        "u + 0*(1/(q-q))*(1 N*m)",
        "u + 1/(q-q)*(1 N*m)",
    ],
)
def test_a_claim_about_dynamics_without_a_value_is_not_valid(
    torque: str, result: Callable[[str], Path]
) -> None:
    """Where they have one they are those of the plain joint, whose certificate they are given."""
    folder = result("turner")
    assert verify_directory(folder).outcome is Outcome.VALID
    alter_spec(folder, JOINT, JOINT[:-1] + f"torque(q) = {torque}; }}", sign=True)
    (folder / "design.json").unlink()
    report = verify_directory(folder)
    assert report.outcome in (Outcome.REFUTED, Outcome.UNDECIDED)
    assert "equations of motion" in str(report.reason)


@pytest.mark.parametrize(
    "torque", some(["u + 1e9*rate(q)*1e9*(1e-18 N*m*s)", "u + sqrt(q^2)*(0 N*m)"], 1)
)
def test_large_numbers_and_squares_under_roots_are_no_obstacle(torque: str) -> None:
    assert answer(turner(f"torque(q) = {torque};")).verdict == "found"


def test_an_input_of_one_value_is_kept_exactly() -> None:
    found = answer(turner("input v in [1, 1]; torque(q) = u + v*(0.001 N*m);"))
    assert found.design is not None
    assert {row[1] for row in found.design.inputs} == {"1"}


def test_a_fast_module_is_searched_and_integrated_with_short_steps() -> None:
    """A lag of 5 ms in steps of 0.2 s; the states agree with an implicit method."""
    found = answer(turner("state s N*m; der(s) = (u - s) / (5 ms); torque(q) = s;"))
    assert found.design is not None
    trajectory = found.design.configuration.outcome.trajectory
    (length,) = trajectory.theta

    def slope(_: float, x: np.ndarray, u: float) -> list[float]:
        return [x[1], 3 * x[2] / length**3, (u - x[2]) / 0.005]

    state = trajectory.x[0]
    for u, after in zip(trajectory.u[:, 0], trajectory.x[1:], strict=True):
        solved = solve_ivp(slope, (0, 0.2), state, "Radau", args=(u,), rtol=1e-10, atol=1e-12)
        state = solved.y[:, -1]
        np.testing.assert_allclose(after, state, atol=1e-7)


# --- amounts -------------------------------------------------------------------------------------


@pytest.mark.parametrize("range_", ["[-0.1, 1] kg/m", "{-1, 1} kg/m"])
def test_the_range_of_an_amount_must_not_go_below_zero(range_: str) -> None:
    text = TURNER.replace("const density = 1 kg/m;", f"param density in {range_};")
    errors = [d for d in load_text(text, "a.srg").diagnostics if d.severity is Severity.ERROR]
    assert [error.message for error in errors] == [
        "the range of `density` allows a negative value here"
    ]


def test_a_negative_mass_is_refuted(result: Callable[[str], Path]) -> None:
    folder = result("turner")
    alter_spec(folder, "density: L.density", "density: L.density - 2 * L.density", sign=True)
    (folder / "design.json").unlink()
    assert verify_directory(folder).outcome is Outcome.REFUTED


# --- values that no decimal is -------------------------------------------------------------------


def degrees(value: int) -> ir.Expr:
    return ir.Binary("*", ir.Num(Fraction(value, 180)), ir.Pi())


@pytest.mark.parametrize(
    "domain",
    [
        pytest.param("{90} deg", marks=pytest.mark.slow),
        "{0, 90} deg",
        pytest.param("[90, 90] deg", marks=pytest.mark.slow),
        pytest.param("{-90, 45, 90} deg", marks=pytest.mark.slow),
    ],
)
def test_an_angle_from_a_set_is_found_and_verified(domain: str, tmp_path: Path) -> None:
    """Two links with a bend in between reach the corners of a square with a right angle only."""
    text = TURNER.replace("edge eps;", f"module K {{ role link; param a in {domain}; }}\nedge eps;")
    text = text.replace("  tool:  N", "  bend: N -> N eps K;\n  tool:  N")
    text = text.replace(
        "  tool  {", "  bend { this.frame = N.frame * rot(z, K.a); }\n  tool  {"
    ).replace(
        "accept contains EN and starts with B eps JO;",
        "accept matches B eps JO eps L eps K eps L eps EN;",
    )
    text = text.replace("box [-1, 3] x [-1, 3]", "box [-3, 3] x [-3, 3]")
    text = text.replace("[1.2, 1.9] x [-0.3, 0.3]", "[0.9, 1.2] x [0.9, 1.2]")
    text = text.replace("[-0.3, 0.3] x [1.2, 1.9]", "[-1.2, -0.9] x [0.9, 1.2]")
    path = tmp_path / "a.srg"
    path.write_text(text, encoding="utf-8")
    assert run(["synth", str(path), "-o", str(tmp_path / "out")]) == 0
    assert verify_directory(tmp_path / "out").outcome is Outcome.VALID

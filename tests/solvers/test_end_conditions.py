"""What ``reach`` asks of the end of a motion, against school physics and simulations by scipy."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import cos, sin
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from grammar_lang import ir
from solvers.trajectory.task_limits import final_samples, motion_limits
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.small_specs import TURNER, replaced
from tests.solvers.test_disturbed_proof import INERTIA, ONE, TWO, proved, scene, spec

F = Fraction
ANYWHERE = "box [-3, 3] x [-3, 3]"


def rod(
    clause: str,
    state: tuple[Fraction, Fraction],
    inputs: Sequence[Fraction],
    region: str = ANYWHERE,
    disturbances: str = "",
) -> dict[str, CheckedCondition]:
    text = spec(len(inputs), disturbances, region, f"reach End {clause};")
    return proved(scene(ONE, text), state, [(u,) for u in inputs])


# --- rates ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("duration", ["0.25", "0.4", "1"])
def test_a_rod_that_brakes_is_slow_from_an_instant_on(side: int, duration: str) -> None:
    """|q'| = v0 - a t falls to 0.1 rad/s; it is largest where the last seconds begin."""
    a = 0.5 / INERTIA
    start = F("0.1") + F("0.5") / F(INERTIA).limit_denominator(10**9)
    fastest = 0.1 + a * float(duration)
    state, inputs = (F(0), side * start), [side * F("-0.5")] * 10
    for off, status in ((2e-3, Status.HOLDS), (-2e-3, Status.FAILS)):
        clause = f"rates <= {fastest + off:.9f} rad/s for {duration} s"
        found = rod(clause, state, inputs)["rates at the end"]
        assert found.status is status
        if status is Status.HOLDS:
            assert found.margin == pytest.approx(off, rel=0.05)
    # Without a time it is about the last instant alone.
    found = rod(f"rates <= {0.1 + 2e-3} rad/s", state, inputs)["rates at the end"]
    assert (found.status, found.margin) == (Status.HOLDS, pytest.approx(2e-3, rel=1e-3))
    assert rod(f"rates <= {0.1 - 2e-3}", state, inputs)["rates at the end"].status is Status.FAILS


def test_a_rest_for_a_while_is_broken_by_the_last_push() -> None:
    """The rate is 2e-3 rad/s for a tenth of a second, half a second before the end."""
    push = F("0.002") * F(INERTIA).limit_denominator(10**9) * 10
    inputs = [push, -push, F(0), F(0), F(0), F(0)]
    for duration, status in (("0.448", Status.HOLDS), ("0.452", Status.FAILS)):
        found = rod(f"at rest for {duration} s", (F(0), F(0)), inputs)
        assert found["rest at the end"].status is status


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_the_rates_of_all_disturbed_motions_are_bound(share: float) -> None:
    """A rod that turns freely keeps the error of its rate."""
    found = rod(
        "rates <= 0.05 rad/s for 0.3 s", (F(0), F(0)), [F(0)] * 5,
        disturbances=f"robust start {0.05 * share} rad/s;",
    )["rates at the end"]  # fmt: skip
    assert found.status is (Status.HOLDS if share < 1 else Status.UNDECIDED)
    if share < 1:
        assert found.margin == pytest.approx(0.005, rel=0.05)


@pytest.mark.parametrize("duration", ["0.05", "0.33", "0.8"])
def test_rates_are_those_of_the_joints(duration: str) -> None:
    """Two links of 1.3 m and 0.9 m, of which only absolute angles are states; scipy has joints."""
    state, inputs = (F("0.2"), F("0.4"), F("-0.3"), F("0.7")), [(F("0.5"), F("-0.4"))] * 8

    def rate(_: float, x: np.ndarray) -> np.ndarray:
        lengths = np.array([1.3, 0.9])
        mass, coriolis, _ = chain_dynamics(lengths, np.ones(2), x[:2], x[2:], (0, 0))
        return np.concatenate([x[2:], np.linalg.solve(mass, [0.5, -0.4] - coriolis)])

    end = solve_ivp(
        rate, (0, 0.8), [float(v) for v in state], method="DOP853", rtol=1e-11, atol=1e-12,
        dense_output=True,
    ).sol(np.linspace(0.8 - float(duration), 0.8, 400))  # fmt: skip
    fastest = float(np.abs(end[2:]).max())
    for off, status in ((1e-3, Status.HOLDS), (-1e-3, Status.FAILS)):
        clause = f"reach End rates <= {fastest + off:.9f} for {duration} s;"
        found = proved(scene(TWO, spec(8, "", ANYWHERE, clause)), state, inputs)
        assert found["rates at the end"].status is status


# --- the target -----------------------------------------------------------------------------------


TILTED = "polytope { 3*x - 4*y <= 2; 4*x + 3*y <= 6.6 }"


def entry() -> float:
    """When the tip of a rod that turns at 0.5 rad/s gets below 3 x - 4 y = 2, by bisection."""
    low, high = 0.0, 1.2
    for _ in range(60):
        middle = (low + high) / 2
        x, y = 1.3 * cos(0.5 * middle), 1.3 * sin(0.5 * middle)
        low, high = (low, middle) if 3 * x - 4 * y <= 2 else (middle, high)
    return high


def test_a_millisecond_decides_how_long_the_tip_is_in_the_target() -> None:
    """It turns uniformly, so that rates are bound to be below 0.6 rad/s all the time."""
    state, inputs = (F(0), F("0.5")), [F(0)] * 12
    since = 1.2 - entry()
    assert 0.1 < since < 1
    for off, status in ((-1e-3, Status.HOLDS), (1e-3, Status.FAILS)):
        found = rod(f"rates <= 0.6 for {since + off:.6f} s", state, inputs, TILTED)
        assert found["target End"].status is status
        assert found["rates at the end"].status is Status.HOLDS
    assert rod("rates <= 0.6", state, inputs, TILTED)["target End"].status is Status.HOLDS


# --- the search -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("clause", "samples"),
    [("", 1), ("at rest", 1), ("at rest for 0.01 s", 2), ("rates <= 1 for 0.2 s", 3),
     ("rates <= 1 for 0.5 s", 6)],
)  # fmt: skip
def test_samples_that_bind_reach_back_to_the_beginning(clause: str, samples: int) -> None:
    where = scene(ONE, spec(5, "", clauses=f"reach End {clause};"))
    assert final_samples(where.task) == samples
    found = motion_limits(where.model, where.task)
    assert found.final_samples == samples
    bound = {"": np.inf, "at": 5e-4}.get(clause[:2], 0.5)
    assert found.final_rates == bound
    if bound == 0.5:
        assert motion_limits(where.model, where.task, 0.0, 0.8).final_rates == pytest.approx(0.2)
        assert motion_limits(where.model, where.task, 0.0, 7.0).final_rates == pytest.approx(0.05)


@pytest.mark.parametrize(
    "clauses",
    [
        "reach T rates <= 0.02 rad/s for 0.35 s;",
        "reach T at rest for 0.3 s; satisfy eventually T by effector 1;",
    ],
)
def test_a_motion_that_stays_is_found(tmp_path: Path, clauses: str) -> None:
    text = replaced(TURNER, "reach T;", clauses)
    (tmp_path / "stay.srg").write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    assert run(["synth", str(tmp_path / "stay.srg"), "-o", str(out), "--quiet"]) == 0
    report = verify_directory(out)
    assert (report.outcome, report.reason) == (Outcome.VALID, None)
    names = {each.name for each in report.conditions}
    assert "target T" in names
    assert names & {"rates at the end", "rest at the end"}


def test_the_task_says_how_long_it_stays() -> None:
    task = scene(ONE, spec(5, "", clauses="reach End rates <= 2 for 0.3 s;")).task
    assert task.final_rates == ir.FinalRates(F(2), F(2), F(3, 10))
    assert task.stay == F(3, 10)

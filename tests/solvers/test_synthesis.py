"""Whole syntheses of small, odd robots: the verdict follows from geometry or from mechanics."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import solvers.conclusion
import solvers.search.family_search
from grammar_lang.load import load
from solvers.run_context import RunContext
from solvers.search.synthesis import synthesise
from tests.oracles.small_specs import TURNER

ARM = "accept contains EN and starts with B eps JO;"
BEAM = "accept matches B eps L eps EN;"
WEAK = ("effort <= 10 N*m", "effort <= 0.0001 N*m")
ROD = "rod(frame: N.frame, axis: x, length: L.length, density: L.density);"


def edited(*changes):
    text = TURNER
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return text


def run(tmp_path, text, **budgets):
    path = tmp_path / "spec.srg"
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    (task,) = program.tasks.values()
    return synthesise(program, task, RunContext(**budgets))


def standing(target):
    return edited((ARM, BEAM), ("target T box [-0.3, 0.3] x [1.2, 1.9]", f"target T box {target}"))


def test_a_robot_that_cannot_move_stands_in_start_and_target(tmp_path):
    result = run(tmp_path, standing("[1.5, 2.5] x [-0.2, 0.2]"))
    assert result.verdict == "found"
    (length,) = map(float, result.design.parameters)
    assert 1.5 < length < 1.9  # the tip is at (length, 0)
    assert result.design.inputs == ((),) * 10
    assert len(result.design.path[0]) == 11


def test_a_robot_that_cannot_move_cannot_be_in_two_places(tmp_path):
    """The regions are apart: a proof exists and is found."""
    result = run(tmp_path, standing("[2.2, 2.5] x [-0.2, 0.2]"))
    assert result.verdict == "impossible"
    assert [record.verdict for record in result.records] == ["refuted"]


def test_a_robot_without_mass_is_inadmissible_and_not_refuted(tmp_path):
    result = run(tmp_path, edited((ARM, "accept matches B eps JO eps L eps EN;"), (ROD, "")))
    assert result.verdict == "unknown"
    assert [record.verdict for record in result.records] == ["inadmissible"]
    assert "mass matrix" in result.reason


@pytest.mark.slow
def test_too_weak_a_robot_is_given_up_at_a_limit_that_is_named(tmp_path, monkeypatch):
    """A quarter turn within 2 s needs 4 rad / s^2 of a rod of 1/3 kg m^2 at least."""
    monkeypatch.setattr(solvers.search.family_search, "MOTION_SEARCHES", 1)
    result = run(tmp_path, edited(WEAK), paths=1)
    assert result.verdict == "unknown"
    assert [r.verdict for r in result.records].count("unresolved") == 1
    assert result.records[-1].verdict == "unresolved"
    assert "limit of 1 robots" in result.reason
    assert "best robustness" in result.reason


def test_an_unbounded_family_is_left_at_a_limit_that_is_named(tmp_path, monkeypatch):
    """The target lies beyond every reach, the structures would number thousands."""
    monkeypatch.setattr(solvers.conclusion, "DEFAULT_ROBOTS", 3)
    far = ("target T box [-0.3, 0.3] x [1.2, 1.9]", "target T box [2.9, 3] x [2.9, 3]")
    pole = ("accept contains EN and starts", "accept contains EN and count(L) <= 1 and starts")
    result = run(tmp_path, edited(far, pole), lemmas=False)
    assert result.verdict == "unknown"
    assert "limit of 3 different robots" in result.reason
    assert {r.verdict for r in result.records} <= {"refuted", "same"}
    bounded = run(
        tmp_path, edited(far, pole, ("  horizon", "  modules <= 5;\n  horizon")), lemmas=False
    )
    assert bounded.verdict == "impossible"
    assert len(bounded.records) > len(result.records)


def test_choices_are_claimed_exactly(tmp_path):
    choices = ("param length in [1, 2] m", "param length in {4/3, 1.7, 2} m")
    result = run(tmp_path, edited((ARM, "accept matches B eps JO eps L eps EN;"), choices))
    assert result.verdict == "found"
    (length,) = (p.stated for p in result.design.parameters)
    assert length in (Fraction(4, 3), Fraction(17, 10))


def test_too_short_a_horizon_ends_with_a_reason(tmp_path):
    """Start, free space and target need one sample each; the horizon has two samples."""
    one = (ARM, "accept matches B eps JO eps L eps EN;")
    short = (one, ("horizon 10 steps", "horizon 1 steps"))
    assert run(tmp_path, edited(*short)).verdict == "impossible"  # by its drives
    result = run(tmp_path, edited(*short, ("effort <= 10 N*m", "effort <= 100000 N*m")))
    assert result.verdict == "unknown"
    assert "the task has 2 samples" in result.reason


def effectors(count, more=""):
    """Words of a base with so many effectors, all of them at the origin: none is in S or in T."""
    return edited((ARM, f"accept matches B{' eps EN' * count}{more};"))


def test_a_finite_language_needs_no_bound_on_modules(tmp_path):
    """One word, of one module more than the search of an infinite language goes to."""
    assert solvers.conclusion.DEFAULT_MODULES == 12
    result = run(tmp_path, effectors(12))
    assert (result.verdict, len(result.records)) == ("impossible", 1)
    found = run(tmp_path, edited((ARM, f"accept matches B eps JO eps L{' eps EN' * 10};")))
    assert found.verdict == "found"


@pytest.mark.parametrize(
    ("text", "verdict", "said"),
    [
        (effectors(12, " (eps EN)*"), "unknown", "say `modules <= n` in the task, with n from 13"),
        (edited((ARM, "accept matches B and contains EN;")), "impossible", "has no robot"),
        (
            edited((ARM, ARM), ("  horizon", "  modules <= 2;\n  horizon")),
            "impossible",
            "at most 2",
        ),
    ],
)
def test_nothing_is_said_of_no_structures(tmp_path, text, verdict, said):
    """Nothing was refuted, as there was nothing to refute."""
    result = run(tmp_path, text)
    assert (result.verdict, result.records) == (verdict, ())
    assert said in result.reason
    assert "refuted" not in result.reason
    assert "0 structures" not in result.reason


@pytest.mark.slow
@pytest.mark.parametrize("steps", [20, 60])
def test_a_rod_is_swung_up_that_no_slow_motion_lifts(tmp_path, steps):
    """At the horizontal its weight turns it by 4.9 N m, more than there is; u = (1/3) a + w cos."""
    weight = 9.81 / 2
    text = edited(
        ("param length in [1, 2] m", "const length = 1 m"),
        ("bounds box [-1, 3] x [-1, 3]", "bounds box [-2, 2] x [-2, 2]"),
        ("box [1.2, 1.9] x [-0.3, 0.3]", "box [-0.1, 0.1] x [-1.05, -0.9]"),
        ("target T box [-0.3, 0.3] x [1.2, 1.9]", "target T box [-0.1, 0.1] x [0.9, 1.05]"),
        ("  obstacle O box [1.4, 2.5] x [1.4, 2.5] m;\n", ""),
        ("  avoid O with effector;\n", "  gravity (0, -9.81) m/s^2;\n  modules <= 4;\n"),
        ("reach T;", "reach T at rest;"),
        ("effort <= 10 N*m", "effort <= 3.8 N*m"),
        ("horizon 10 steps of 0.2 s", f"horizon {steps} steps of 0.1 s"),
    )
    result = run(tmp_path, text)
    assert result.verdict == "found"
    assert result.design.controller is None
    inputs = [float(row[0]) for row in result.design.inputs]
    assert max(map(abs, inputs)) < 3.8 < weight
    state = np.array([float(value) for value in result.design.start])
    for u in inputs:

        def moved(_time, x, u=u):
            return [x[1], 3 * (u - weight * np.cos(x[0]))]

        state = solve_ivp(moved, (0, 0.1), state, rtol=1e-11, atol=1e-12).y[:, -1]
    assert abs(np.cos(state[0])) < 0.1
    assert np.sin(state[0]) > 0.9
    assert abs(state[1]) < 1e-3

"""What progress says of a failed proof, and that a remedy is told once."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from grammar_lang.load import load
from solvers.run_context import OFTEN, FailureCounts, RunContext, Silent
from solvers.search.failed_proof import WIDTH, failure_text, shorter_steps
from solvers.search.motion_proof import MotionProof
from solvers.search.search_state import Blocked, Cause
from solvers.search.synthesis import synthesise
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status
from srgc.text_reports.synthesis_report import synthesis_text
from tests.oracles.small_specs import QUICK_TURN, TURNER


def blocked(
    name: str, margin: float, unit: str, time: float | None = 0.1, cause: Cause = Cause.UNPROVED
) -> Blocked:
    condition = CheckedCondition(name, Status.UNDECIDED, margin, unit, time)
    return Blocked(cause, condition=condition)


@pytest.mark.parametrize(
    ("failed", "text"),
    [
        (
            blocked("rate of Hip.q (joint 2)", -0.1101, "rad/s"),
            "`rate of Hip.q (joint 2)` not proved at 0.1 s, lacks 0.11 rad/s",
        ),
        (
            blocked("target B", -0.004, "m", 1.2, Cause.BROKEN),
            "`target B` is broken in a simulation at 1.2 s, lacks 0.004 m",
        ),
        (blocked("effort", -0.25, "1", None), "`effort` not proved, lacks 0.25 of the bound"),
        # A margin that is infinite, or has no unit, says nothing.
        (blocked("bounds", float("-inf"), "m"), "`bounds` not proved at 0.1 s"),
        (blocked("equations", -1.0, ""), "`equations` not proved at 0.1 s"),
        (Blocked(Cause.DIVERGES), "the motion with feedback diverges"),
    ],
)
def test_it_names_the_condition_its_time_and_what_it_lacks(failed: Blocked, text: str) -> None:
    assert failure_text(failed, goes_on=False) == text
    assert failure_text(failed, goes_on=True) == f"{text}; widening margins"


def test_an_enclosure_that_ends_is_its_own_reason() -> None:
    why = "the enclosure of the disturbed motions ends"
    ended = CheckedCondition(
        "disturbed motions", Status.UNDECIDED, float("-inf"), "", 0.25, why=why
    )
    assert failure_text(Blocked(Cause.UNPROVED, condition=ended), goes_on=False) == (
        f"{why} at 0.25 s"
    )


def test_it_fits_into_a_line() -> None:
    long = blocked(f"Bone.{'x' * 90} to Stone", -0.0123456, "m")
    text = failure_text(long, goes_on=True)
    # With the time that `synth` prints before it: 100 columns.
    assert len("[9999.99 s] ") + len(text) <= 100
    assert len(text) == WIDTH
    assert text.endswith("…` not proved at 0.1 s, lacks 0.012 m; widening margins")


def test_a_remedy_is_told_once() -> None:
    counts = FailureCounts()
    told = [counts.often(name) for name in ["rate", "target"] * 10]
    assert sum(told) == 1
    assert told.index(True) == 2 * (OFTEN - 1)


@pytest.mark.parametrize(("feedback", "robust"), [(True, True), (False, True), (True, False)])
def test_shorter_steps_are_told_where_feedback_answers_disturbances(
    *, feedback: bool, robust: bool
) -> None:
    said = list[str]()

    class Saying(Silent):
        def note(self, text: str) -> None:
            said.append(text)

    task: Any = SimpleNamespace(
        robust=robust or None, steps=12, step=Fraction(1, 10), at_most=False
    )
    path_problem: Any = SimpleNamespace(feedback=feedback, task=task)
    nothing: Any = None
    proof = MotionProof(nothing, task, nothing, RunContext(reporter=Saying()))
    for _ in range(20):
        proof.tell(path_problem, nothing, blocked("target B", -0.01, "m"), goes_on=True)
    hints = [text for text in said if not text.startswith("`target B` not proved")]
    hint = "it fails again and again; shorter steps may help: `horizon 24 steps of 0.05 s`"
    assert hints == ([hint] if feedback and robust else [])
    assert len(said) == 20 + len(hints)


@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ("horizon 10 steps of 0.2 s", "`horizon 20 steps of 0.1 s`"),
        ("horizon at most 7 steps of 0.25 s", "`horizon at most 14 steps of 0.125 s`"),
        ("horizon 3 steps of (1/3) s", "`horizon 6 steps of (1/6) s`"),
    ],
)
def test_shorter_steps_take_the_same_time(tmp_path: Path, given: str, shown: str) -> None:
    assert "horizon 10 steps of 0.2 s" in TURNER
    path = tmp_path / "turner.srg"
    path.write_text(TURNER.replace("horizon 10 steps of 0.2 s", given), encoding="utf-8")
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    assert shorter_steps(task) == shown
    path.write_text(TURNER.replace("horizon 10 steps of 0.2 s", shown.strip("`")), encoding="utf-8")
    again = load(path).program
    assert again is not None
    (shorter,) = again.tasks.values()
    assert shorter.steps * shorter.step == task.steps * task.step


def test_after_a_time_limit_the_last_proof_is_told(tmp_path: Path) -> None:
    """The search is ended once it has told what its first proof lacked."""
    path, seen = tmp_path / "turn.srg", list[str]()
    path.write_text(QUICK_TURN, encoding="utf-8")
    program = load(path).program
    assert program is not None
    task = program.tasks["Turn"]

    class Seeing(Silent):
        def note(self, text: str) -> None:
            seen.append(text)

    result = synthesise(
        program, task, RunContext(reporter=Seeing(), out_of_time=lambda: bool(seen))
    )
    assert "`rate of Hip.q` not proved at " in seen[0]
    assert " rad/s; widening margins" in seen[0]
    assert (result.verdict, result.unfinished) == ("unknown", True)
    text = synthesis_text(result, task, str(tmp_path))
    assert "margin of `rate of Hip.q` at " in text
    assert "shorter steps (`horizon 20 steps of 0.05 s`)" in text
    assert "smaller bounds in `robust`" in text

"""Noise that no bound bears: where it shows, by hand, and as the reason of a whole search."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.search.closed_loop import unbearable_noise
from solvers.trajectory.trajectory import Trajectory
from srgc.cli import run
from tests.oracles.small_specs import CLOSED, MOTOR, replaced
from tests.solvers.test_disturbed_proof import SLIDE, TWO, scene, spec

F = Fraction


@dataclass(frozen=True)
class Gains:
    """What is asked of a path problem, with gains (k, m, N) that are given."""

    model: RobotModel
    task: ir.Task
    given: Array
    feedback: bool = True
    spread: None = None

    def gains(self, trajectory: Trajectory) -> Array:
        del trajectory
        return self.given


def said(labels: tuple[str, ...], gains: Array, clauses: str, **more: bool) -> str | None:
    where = scene(labels, spec(len(gains), clauses))
    n = len(where.model.dofs)
    nowhere = Trajectory(np.zeros((len(gains) + 1, 2 * n)), np.zeros((len(gains), n)), np.zeros(0))
    return unbearable_noise(Gains(where.model, where.task, gains, **more), nowhere)  # type: ignore[arg-type]


def test_the_first_sample_at_which_noise_commands_too_much() -> None:
    """|K| n, entry by entry: 0.1 (40 + 2) + 0.5 (8 + 3) = 9.7 N*m, of a bound of 9 N*m."""
    gains = np.zeros((5, 2, 4))
    gains[1, 0] = (-40, 2, 8, 1)
    gains[3, 1] = (-40, 2, 8, -3)
    gains[4, 0] = (900, 0, 0, 0)
    noise = "robust measure 0.1 rad, 0.5 rad/s;"
    found = said(TWO, gains, noise)
    assert found == (
        "errors of measurements alone make feedback command 9.7 N*m at sample 3 (0.3 s), "
        "and the bound leaves 9 N*m"
    )
    assert said(TWO, gains[:3], noise) is None
    assert said(TWO, gains, "robust start 0.1 rad, 0.5 rad/s;") is None
    assert said(TWO, gains, "") is None
    assert said(TWO, gains, noise, feedback=False) is None


def test_slides_have_their_own_errors_and_units() -> None:
    found = said(SLIDE, np.full((2, 1, 2), 100.0), "robust measure 5 cm, 5 cm/s, 9 rad;")
    assert found is not None
    assert "command 10 N at sample 0 (0 s), and the bound leaves 9 N" in found


def test_a_declared_input_has_the_unit_of_its_module() -> None:
    text = replaced(MOTOR, "  reach T;", "  reach T;\n  robust measure 1 deg, 1 deg/s;")
    program = load_text(text, "motor.srg").program
    assert program is not None
    task = program.tasks["Turn"]
    family = family_of(program, task)
    model = family.robot(family.replay(("tool", "link", "joint", "base")))
    gains = np.zeros((10, 1, 2))
    gains[4] = 2000 / np.pi * 180, 0
    nowhere = Trajectory(np.zeros((11, 3)), np.zeros((10, 1)), np.array([1.5]))
    found = unbearable_noise(Gains(model, task, gains), nowhere)  # type: ignore[arg-type]
    assert found is not None
    assert "command 2e+03 at sample 4 (0.8 s), and the bound leaves 24" in found


FIXED = ("param length in [1, 2] m", "const length = 1.5 m")


def searched(folder: Path, *changes: tuple[str, str]) -> None:
    """Search the closed loop's spec with other errors of measurements, in few modules."""
    text = replaced(CLOSED, "horizon 10", "modules <= 4;\n  horizon 10")
    for before, after in changes:
        text = replaced(text, before, after)
    (folder / "spec.srg").write_text(text, encoding="utf-8")
    run(["synth", str(folder / "spec.srg"), "-q", "-o", str(folder / "out")])


@pytest.mark.usefixtures("without_pictures")
def test_a_search_says_that_noise_is_too_much(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    searched(tmp_path, ("measure 0.05 deg, 0.1 deg/s", "measure 80 deg, 200 deg/s"), FIXED)
    printed = capsys.readouterr().out
    assert "unknown" in printed
    assert "errors of measurements alone make feedback command" in printed
    assert "at sample 0 (0 s), and the bound leaves 10 N*m" in printed


@pytest.mark.usefixtures("without_pictures")
@pytest.mark.slow
def test_a_search_says_where_noise_takes_the_clearance(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Bounds of the inputs bear this noise, and the target does not: it is 0.6 m wide."""
    searched(tmp_path, ("measure 0.05 deg, 0.1 deg/s", "measure 20 deg"))
    printed = capsys.readouterr().out
    assert "unknown" in printed
    said = re.search(
        r"measurements alone carry motions up to ([0-9.]+) m off at sample 10", printed
    )
    assert said is not None
    assert float(said[1]) > 0.3

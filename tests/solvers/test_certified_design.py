"""No proof is spent on a motion that a simulation sees fail; one that may hold gets its proof."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import solvers.search.certified_design as module
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.search.certified_design import certified_design
from solvers.search.configuration_search import Configuration
from solvers.search.search_state import Answer, Blocked, Found
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs.scene import UNWATCHED
from tests.oracles.small_specs import TURNER, replaced

WORD = ("tool", "link", "joint", "base")
LENGTH, STEP, STEPS = 1.5, 0.2, 10
INERTIA = LENGTH**3 / 3
PUSH = 1.4 / (STEP**2 * (STEPS // 2) ** 2)
"""The acceleration that turns by 1.4 rad: half of the time one way, half the other way."""


def attempt(tmp_path: Path, text: str, *, feedback: bool = False, last: bool = False) -> Answer:
    """What becomes of a rod that turns from 0 to 1.4 rad and is at rest there."""
    path = tmp_path / "spec.srg"
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    workspace, family = program.workspaces[task.workspace], family_of(program, task)
    derivation = family.replay(WORD)
    numeric = NumericRobot(robot_graph(family.robot(derivation), task.gravity))
    cells, theta = abstract(workspace), np.array([LENGTH])
    u = np.repeat([INERTIA * PUSH, -INERTIA * PUSH], STEPS // 2)[:, None]
    x = numeric.simulate(np.zeros(2), u, theta, STEP, 8)
    assert x[-1] == pytest.approx([1.4, 0.0], abs=1e-9)
    places = numeric.points(x[:, :1], theta).value[:, 0]
    located = [cells.locate(place) for place in places]
    along = [cell for cell in located if cell is not None]
    starts = [0, *(i for i in range(1, len(along)) if along[i] != along[i - 1])]
    problem = PathProblem(
        numeric, workspace, task, cells, 0, tuple(along[i] for i in starts), 2e-3, 0,
        feedback=feedback,
    )  # fmt: skip
    outcome = ControlOutcome(
        Trajectory(x, u, theta), True, 1.0, 1.0, np.zeros(STEPS), 0.0, 1, "", 0.0
    )
    found = Configuration(outcome, tuple(starts), 1, problem.cells)
    return certified_design(program, task, derivation, problem, found, UNWATCHED, last=last)


def no_proof(*_: object) -> None:
    raise AssertionError("a proof was begun")


def between(turn: float, size: float = 0.01) -> str:
    """A box about the place of the tip when it has turned so far, 8 mm away from any sample."""
    x, y = LENGTH * np.cos(turn), LENGTH * np.sin(turn)
    return f"box [{x - size:.4f}, {x + size:.4f}] x [{y - size:.4f}, {y + size:.4f}]"


TURN = PUSH * (2.5 * STEP) ** 2 / 2
BLOCKED = replaced(TURNER, "box [1.4, 2.5] x [1.4, 2.5]", between(TURN))
TOUCHING = replaced(
    replaced(TURNER, "  avoid O with effector;\n", "  satisfy always not O;\n"),
    "box [1.4, 2.5] x [1.4, 2.5]",
    between(TURN),
)


@pytest.mark.parametrize("feedback", [False, True])
def test_an_obstacle_between_samples_ends_an_attempt_without_a_proof(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, feedback: bool
) -> None:
    monkeypatch.setattr(module, "prove_motion", no_proof)
    found = attempt(tmp_path, BLOCKED, feedback=feedback, last=True)
    assert isinstance(found, Blocked)
    assert "clearance of effector to O: violated at 0.5 s" in found.text
    assert found.lacking == found.beyond == 0.0


@pytest.mark.parametrize("feedback", [False, True])
def test_a_motion_that_may_hold_is_proved(tmp_path: Path, feedback: bool) -> None:
    assert isinstance(attempt(tmp_path, TURNER, feedback=feedback), Found)


@pytest.mark.parametrize("feedback", [False, True])
def test_a_formula_that_seems_to_fail_leaves_the_last_attempt_its_proof(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, feedback: bool
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(module, "prove_motion", no_proof)
        found = attempt(tmp_path, TOUCHING, feedback=feedback)
        assert isinstance(found, Blocked)
        assert "a formula fails between the samples" in found.text
    found = attempt(tmp_path, TOUCHING, feedback=feedback, last=True)
    assert isinstance(found, Blocked)
    assert "last proof tried" in found.text

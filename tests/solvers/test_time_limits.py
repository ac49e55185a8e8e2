"""A limit of time ends every stage where it is, and nothing that was cut is taken for an answer."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import z3
from scipy.sparse import csc_matrix

import solvers.search.synthesis
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.robots.normal_form import family_of
from compiler.tasks.specification import planning_problem
from compiler.time_limits.time_limit import OutOfTimeError, check_time, is_late, time_limit
from compiler.words.structures import structures
from compiler.workspaces.abstraction import abstract
from compiler.workspaces.bisection import bisections
from solvers.backends.conic import ConvexProgram, Optimum
from solvers.backends.portfolio import LARGE, UsualSolver
from solvers.backends.smt import solve_script
from solvers.execution.in_order import in_order
from solvers.impossibility import structure_refutation
from solvers.impossibility.box_refutation import WITH_PROOF, box_refutation
from solvers.impossibility.drive_search import AFTER_MOTIONS, drive_refutation
from solvers.impossibility.structure_refutation import refute_structure
from solvers.planner import Planner
from solvers.run_context import Memory, RunContext
from solvers.search.synthesis import NOT_COVERED, OUT_OF_TIME, Synthesis, synthesise
from solvers.trajectory.fine_motion import fine_motion
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.refutations.box_check import why_not
from solvers.verifier.verification import verify_directory
from tests.oracles import small_specs
from tests.oracles.formulas import program as program_of
from tests.oracles.hard_programs import hard_program
from tests.oracles.limits import Asked, asked_by
from tests.solvers.test_smt import CIRCLE, HARD

Stage = Callable[[], object]
Made = Callable[[str], Path]


class Robot:
    """The first robot of most joints of a small spec, in its task."""

    def __init__(self, text: str) -> None:
        self.program = program_of(text)
        (self.task,) = self.program.tasks.values()
        self.workspace = self.program.workspaces[self.task.workspace]
        self.family = family_of(self.program, self.task)
        derivations = structures(self.family.language, self.task.modules or 4)
        self.model = max(map(self.family.robot, derivations), key=lambda model: len(model.dofs))

    @property
    def graph(self) -> RobotGraph:
        """Anew, so that nothing is known from before."""
        return robot_graph(self.model)

    @property
    def numeric(self) -> NumericRobot:
        return NumericRobot(self.graph)


TURNER, BEYOND = Robot(small_specs.TURNER), Robot(small_specs.BEYOND_REACH)


def simulated() -> object:
    """A step with derivatives, for which equations of motion are made first."""
    numeric = TURNER.numeric
    theta = np.full(numeric.p, 1.5)
    return numeric.step(np.zeros((200, numeric.size)), np.zeros((200, numeric.m)), theta, 0.1, 2)


def planned() -> object:
    cells = abstract(TURNER.workspace)
    return Planner(planning_problem(cells, TURNER.task, 0, None)).next_plan()


def covering() -> str:
    found = box_refutation(BEYOND.model, BEYOND.graph, BEYOND.workspace, BEYOND.task, WITH_PROOF)
    assert found is not None
    return found.boxes


def refuted() -> object:
    return refute_structure(
        BEYOND.model, BEYOND.numeric, BEYOND.program, BEYOND.task, RunContext(journal=Memory())
    )


STAGES: dict[str, Stage] = {
    "equations of motion": lambda: TURNER.graph.variation,
    "samples": simulated,
    "structures": lambda: list(structures(TURNER.family.language, 6)),
    "cells": lambda: abstract(TURNER.workspace),
    "cuts": lambda: bisections(abstract(TURNER.workspace), 40),
    "plans": planned,
    "refutation": refuted,
    "covering": covering,
    "replay": lambda: why_not(covering(), BEYOND.model, BEYOND.workspace, BEYOND.task),
    "drives": lambda: drive_refutation(
        TURNER.model, TURNER.graph, TURNER.workspace, TURNER.task, AFTER_MOTIONS
    ),
}  # fmt: skip


@pytest.mark.parametrize("stage", STAGES)
def test_every_stage_asks_for_the_time_and_ends(stage: str) -> None:
    run = STAGES[stage]
    times, _ = asked_by(run)
    assert times >= 2
    for most in {0, times // 2, times - 1}:
        limit = Asked(most)
        with time_limit(limit), pytest.raises(OutOfTimeError):
            run()
        assert limit.times == most + 1


def test_a_proof_asks_for_the_time(made: Made) -> None:
    times, report = asked_by(lambda: verify_directory(made("turner") / "out"))
    assert times > 100
    with pytest.raises(OutOfTimeError):
        asked_by(lambda: verify_directory(made("turner") / "out"), times // 2)
    assert verify_directory(made("turner") / "out") == report


def test_without_a_limit_nothing_is_asked() -> None:
    limit = Asked(0)
    with time_limit(limit), time_limit(None):
        check_time()
        assert not is_late()
    assert limit.times == 0


# --- solvers that ask nobody ---------------------------------------------------------------------


def test_a_question_to_z3_is_interrupted() -> None:
    limit = Asked(3)
    with time_limit(limit), pytest.raises(OutOfTimeError):
        solve_script(HARD, resources=1_000_000_000)
    assert limit.times > 3


def test_what_z3_says_once_time_is_over_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """It has an answer, but only after the limit."""
    over = Asked(1)
    given = z3.Solver.check

    def late(solver: z3.Solver) -> z3.CheckSatResult:
        while over.times <= 1:
            pass
        return given(solver)

    monkeypatch.setattr(z3.Solver, "check", late)
    journal = Memory()
    nothing: Any = None
    context = RunContext(journal=journal)
    asked = structure_refutation._Asked(nothing, nothing, nothing, nothing, context)
    with time_limit(over), pytest.raises(OutOfTimeError):
        asked.refutes(CIRCLE.format(1), 10_000)
    assert not journal.values


def test_a_convex_program_is_abandoned() -> None:
    """It would take minutes; the next one is solved in another process."""
    solver, one = UsualSolver(), np.ones(LARGE)
    limit = Asked(5)
    with time_limit(limit), pytest.raises(OutOfTimeError):
        solver.solve(hard_program(), 1e-8)
    assert limit.times == 6
    nothing = csc_matrix((0, LARGE))
    easy = ConvexProgram(one, -2 * one, nothing, np.zeros(0), nothing, np.zeros(0), -one, 5 * one)
    answer = solver.solve(easy, 1e-9)
    assert isinstance(answer, Optimum)
    assert np.allclose(answer.point, 2.0, atol=1e-6)


class Never:
    """Workers that finish nothing."""

    width = 2

    def __init__(self) -> None:
        self.begun: list[Future[object]] = []

    def start(self, _function: object, _job: object) -> Future[object]:
        self.begun.append(Future())
        return self.begun[-1]

    def is_lost(self, _error: BaseException) -> bool:
        return False

    def is_alive(self) -> bool:
        return True


def test_jobs_of_others_are_not_waited_for() -> None:
    workers = Never()
    with time_limit(Asked(2)), pytest.raises(OutOfTimeError):
        next(in_order(workers, str, [1, 2, 3]))
    assert len(workers.begun) == 2
    assert all(job.cancelled() for job in workers.begun)


# --- the whole search ----------------------------------------------------------------------------


def searched(robot: Robot, journal: Memory, *, every: bool = False) -> Synthesis:
    return synthesise(robot.program, robot.task, RunContext(journal=journal), every=every)


def same(one: Synthesis, other: Synthesis) -> bool:
    """Whether two results say the same."""
    designs = [
        [(p.number, p.counts, p.design.inputs, p.design.conditions) for p in result.designs]
        for result in (one, other)
    ]
    said = [
        (result.verdict, result.reason, result.records, result.counts, result.unfinished)
        for result in (one, other)
    ]
    return designs[0] == designs[1] and said[0] == said[1]


@pytest.mark.parametrize("robot", [TURNER, BEYOND], ids=["found", "impossible"])
def test_a_search_that_is_cut_anywhere_goes_on(robot: Robot) -> None:
    """Whatever was recorded before the cut is what a whole run records."""
    journal = Memory()
    times, whole = asked_by(lambda: searched(robot, journal))
    assert not whole.unfinished
    assert times > 500
    cut = Memory()
    for part in (0.0, 0.02, 0.3, 0.6, 0.9, 0.99):
        _, result = asked_by(lambda: searched(robot, cut), int(part * times))
        if result.unfinished:
            assert result.verdict in ("unknown", whole.verdict)
            if result.verdict == "unknown":
                told = str(result.reason)
                assert told.startswith(OUT_OF_TIME) or NOT_COVERED in told
        assert all(journal.values[key] == value for key, value in cut.values.items())
    assert same(searched(robot, cut), whole)


def test_what_is_refuted_stays_so_without_a_second_proof() -> None:
    journal = Memory()
    whole = searched(BEYOND, journal)
    assert any(record.boxes for record in whole.records if record.script)
    cut = Memory()

    def late() -> bool:
        """Reached once all structures are refuted and the first one has a covering."""
        return any(key.startswith("boxes|") for key in cut.values)

    with time_limit(late):
        result = searched(BEYOND, cut)
    assert result.verdict == "impossible"
    assert str(result.reason).endswith(NOT_COVERED)
    assert result.unfinished
    assert [record.verdict for record in result.records] == [r.verdict for r in whole.records]
    assert same(searched(BEYOND, cut), whole)


def test_states_are_as_fine_as_time_allows() -> None:
    numeric = TURNER.numeric
    start = Trajectory(np.zeros((6, 2)), np.full((5, 1), 0.7), np.full(numeric.p, 1.5))
    fine = fine_motion(numeric, start, 0.5).x
    with time_limit(Asked(0)):
        assert fine_motion(numeric, start, 0.5).x is start.x
    with time_limit(Asked(1)):
        coarse = fine_motion(numeric, start, 0.5).x
    assert 0 < np.max(np.abs(coarse - fine)) < 1e-4


def test_nothing_is_tried_after_the_limit() -> None:
    _, result = asked_by(lambda: searched(TURNER, Memory()), 0)
    assert (result.verdict, result.reason, result.records) == ("unknown", OUT_OF_TIME, ())
    assert result.last_step == solvers.search.synthesis.BEGUN

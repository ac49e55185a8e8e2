"""What is proved first is kept while better motions are looked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from compiler.tasks.obstacle_pieces import expanded
from compiler.time_limits.time_limit import time_limit
from grammar_lang.load import load
from solvers.run_context import Memory, RunContext, Silent
from solvers.search.synthesis import Synthesis, synthesise
from solvers.verifier.proofs.tube_checks import Status
from tests.oracles.formulas import program as program_of
from tests.oracles.small_specs import LOOPED, PAIR, TURNER, replaced

DISTURBED = replaced(
    TURNER, "  horizon 10", "  robust start 0.2 deg, 0.2 deg/s;\n  robust effort 1 %;\n  horizon 10"
)
FEEDBACK = replaced(PAIR, "const length = 0.9 m", "param length in [0.85, 0.95] m")
FOR_EVER = replaced(LOOPED, "const mass = 1 kg", "param mass in [1, 2] kg")
TASKS = {"plain": TURNER, "disturbed": DISTURBED, "feedback": FEEDBACK, "for ever": FOR_EVER}
SPEC = Path(__file__).parents[2] / "specs" / "planar_arm.srg"


class Counting(Silent):
    """Counts how often there was something better."""

    def __init__(self) -> None:
        self.better = 0

    def robustness(self, value: float) -> None:
        self.better += value > 0


def searched(most: int) -> Synthesis:
    """A search that runs out of time when so many feasible motions have been reported."""
    program = load(SPEC).program
    assert program is not None
    reporter = Counting()
    context = RunContext(reporter=reporter, out_of_time=lambda: reporter.better > most)
    return synthesise(*expanded(program, program.tasks["PickAndPlace"]), context)


def test_out_of_time_there_is_the_first_proved_design() -> None:
    result = searched(2)
    assert result.verdict == "found"
    assert result.unfinished
    assert result.design is not None
    assert result.design.conditions
    assert all(each.status is Status.HOLDS for each in result.design.conditions)
    assert result.design.robustness > 0
    assert [each.verdict for each in result.records][-1] == "found"
    whole = searched(10**9)
    assert whole.design is not None
    assert not whole.unfinished
    assert whole.design.robustness > result.design.robustness


@pytest.mark.parametrize("text", TASKS.values(), ids=TASKS)
def test_the_first_design_does_not_wait_for_the_search(text: str) -> None:
    """Until there is a proved design, few of all evaluations are made."""
    assert evaluations(text, first=True) <= evaluations(text, first=False) / 2


def evaluations(text: str, *, first: bool) -> int:
    """How much a search records, to its end or until its ``first`` design."""
    spec = program_of(text)
    (task,) = spec.tasks.values()
    journal, told = Memory(), list[Synthesis]()
    with time_limit(lambda: first and bool(told)):
        result = synthesise(spec, task, RunContext(journal=journal), told=told.append)
    assert result.verdict == "found"
    assert result.unfinished == first
    return len(journal.values)

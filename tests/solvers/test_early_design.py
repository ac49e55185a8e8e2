"""What is proved first is kept while better motions are looked for."""

from __future__ import annotations

from pathlib import Path

from compiler.tasks.obstacle_pieces import expanded
from grammar_lang.load import load
from solvers.run_context import RunContext, Silent
from solvers.search.synthesis import Synthesis, synthesise
from solvers.verifier.proofs.tube_checks import Status

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

"""Proofs that go on beside the search: the same designs, however long they take."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import pytest

from compiler.tasks.obstacle_pieces import expanded
from solvers.execution.workers import InProcess, Job, Result, Workers, received, sent
from solvers.run_context import RunContext
from solvers.search.path_task import Design
from solvers.search.synthesis import Synthesis, synthesise
from tests.oracles.small_specs import CLOSED, LOOPED, TURNER
from tests.solvers.test_disturbed_proof import load_text

SHAKEN = TURNER.replace(
    "  horizon", "  robust start 0.2 deg, 0.1 deg/s; robust effort 0.5 %;\n  horizon"
)


@dataclass
class Later:
    """A job that is not done before it was looked at so many times."""

    data: bytes
    looks: int

    @property
    def done(self) -> bool:
        self.looks -= 1
        return self.looks < 0

    def result(self) -> object:
        return received(self.data)


@dataclass
class Elsewhere:
    """Does jobs as another process would: what they refer to is another copy."""

    looks: int
    begun: int = 0
    width: int = 2

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        return (received(sent(function, job)) for job in jobs)

    def begin(self, function: Callable[[Job], Result], job: Job) -> Later:
        self.begun += 1
        return Later(sent(function, job), self.looks)

    def close(self) -> None:
        """Nothing has to be ended."""


def synthesised(text: str, workers: Workers) -> Synthesis:
    program = load_text(text)
    (task,) = program.tasks.values()
    return synthesise(*expanded(program, task), RunContext(workers=workers))


def said(design: Design | None) -> tuple[object, ...]:
    """What a certificate and a report say of a design."""
    assert design is not None
    told = design.parameters, design.start, design.inputs, design.path, design.conditions
    return *told, design.robustness, design.controller, design.loop


@pytest.mark.parametrize("looks", [0, 2, 1000])
def test_the_same_design(looks: int) -> None:
    compare(TURNER, looks)


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(SHAKEN, id="open"),
        pytest.param(CLOSED, id="closed", marks=pytest.mark.slow),
        pytest.param(LOOPED, id="loop"),
    ],
)
def test_the_same_design_of_all_disturbed_motions(text: str) -> None:
    compare(text, 1)


def compare(text: str, looks: int) -> None:
    elsewhere = Elsewhere(looks)
    beside = synthesised(text, elsewhere)
    alone = synthesised(text, InProcess())
    assert elsewhere.begun
    assert beside.verdict == alone.verdict == "found"
    assert said(beside.design) == said(alone.design)

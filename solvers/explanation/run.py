"""Runs of the whole synthesis on changed tasks, which confirm a suggestion.

A run ends after a number of cell paths, or of checks of the time, which searches and proofs make as
they go on. So it is bounded without a clock and is repeatable.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from compiler.robots.state_and_input import input_bounds
from solvers.explanation.change import Change
from solvers.explanation.task_line import TaskLine
from solvers.run_context import Memory, Recorded, Reporter, RunContext, Silent
from solvers.search.synthesis import Synthesis, synthesise

MOST_RUNS = 16
"""The most runs for an explanation."""
MOST_PATHS = 2
"""The most cell paths that are tried in a run, for all structures together."""
MOST_PAUSES = 2500
"""How often a run may check the time before it is ended."""
REFUTATION = "smt|"
"""The prefix of keys that contain a whole script, so that their answers hold for other tasks,
too."""
NOT_SOUGHT: dict[str, Recorded] = {"drives|": ["", ""], "boxes|": ""}
"""Maps prefixes of keys to answers that spare a run the search for evidence of impossibility."""


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A change with which a robot was found and its motion proved.

    ``efforts`` are the largest efforts in each unit of its drives, N m and N.
    """

    change: Change
    word: tuple[str, ...]
    effort_peak: float
    robustness: float
    efforts: Mapping[str, float]


@dataclass(slots=True)
class _Shared:
    """A journal of one run: scripts are kept for the next, and only designs are searched for."""

    scripts: dict[str, Recorded]
    own: Memory = field(default_factory=Memory)

    def recall(self, key: str) -> Recorded:
        for start, answer in NOT_SOUGHT.items():
            if key.startswith(start):
                return answer
        return self._place(key).get(key)

    def record(self, key: str, value: Recorded) -> None:
        self._place(key)[key] = value

    def _place(self, key: str) -> dict[str, Recorded]:
        return self.scripts if key.startswith(REFUTATION) else self.own.values


@dataclass(slots=True)
class _Meter(Silent):
    """Counts the paths and time checks of a run, and says when to end it.

    It ends with the first proof, if it is told of it.
    """

    overtime: Callable[[], bool]
    reporter: Reporter
    budget: int = 1
    paths: int = 0
    pauses: int = 0
    proved: bool = False

    def path(self, cells: tuple[str, ...]) -> None:
        """Count a cell path that is being tried."""
        self.paths += 1
        self.reporter.path(cells)

    def told(self, _result: Synthesis) -> None:
        """Note that a design is proved, and would be improved now."""
        self.proved = True

    def ended(self) -> bool:
        """Whether the run has to end; called repeatedly."""
        self.pauses += 1
        many = self.paths > MOST_PATHS * self.budget or self.pauses > MOST_PAUSES * self.budget
        return self.proved or many or self.overtime()


@dataclass(slots=True)
class Runs:
    """The runs made so far; ``found`` and ``failed`` are the changes in the order of trial.

    ``tell`` receives a line about each run that begins, ``helps`` each suggestion, ``step`` what is
    done between runs.
    """

    context: RunContext
    limit: int = MOST_RUNS
    tell: Callable[[str], None] = lambda _: None
    helps: Callable[[Suggestion], None] = lambda _: None
    step: Callable[[str], None] = lambda _: None
    found: list[Suggestion] = field(default_factory=list[Suggestion])
    failed: list[Change] = field(default_factory=list[Change])
    scripts: dict[str, Recorded] = field(default_factory=dict[str, Recorded])

    @property
    def made(self) -> int:
        """The number of runs so far."""
        return len(self.found) + len(self.failed)

    @property
    def left(self) -> bool:
        """Whether another run is allowed."""
        return self.made < self.limit

    def run(self, change: Change) -> Suggestion | None:
        """Run the synthesis for a changed task; a suggestion if a robot is found and proved.

        Raises:
            OutOfTimeError: the time limit was reached.
        """
        self.context.check_time()
        self.tell(f"run {self.made + 1} of at most {self.limit}: {change.says}")
        result = self._result(change)
        # A run that the clock has ended shows nothing about the change.
        self.context.check_time()
        design = result.design
        if design is None:
            self.failed.append(change)
            return None
        outcome = design.configuration.outcome
        efforts = dict[str, float]()
        for bound in input_bounds(design.model, change.posed.task):
            if bound.effort:
                used = outcome.trajectory.u[:, list(bound.inputs)]
                sizes = np.linalg.norm(used, axis=1) if bound.norm2 else np.abs(used)
                efforts[bound.unit] = max(efforts.get(bound.unit, 0.0), float(sizes.max()))
        word = design.derivation.word
        found = Suggestion(change, word, outcome.effort_peak, outcome.robustness, efforts)
        self.found.append(found)
        self.helps(found)
        return found

    def _result(self, change: Change) -> Synthesis:
        meter = _Meter(self.context.out_of_time, self.context.reporter, change.budget)
        # The peaks of improved motions lead to the least effort that suffices.
        improved = change.line is not None and change.line.kind == "effort"
        context = replace(
            self.context,
            journal=_Shared(self.scripts),
            reporter=meter,
            out_of_time=meter.ended,
            paths=change.budget * self.context.paths,
            evaluations=change.budget * self.context.evaluations,
        )
        # A fast motion uses all available effort, so it would not show how much it needs.
        task = change.posed.task
        objectives = tuple(each for each in task.minimize if each.kind != "time")
        eased = replace(task, minimize=objectives)
        if improved:
            return synthesise(change.posed.program, eased, context)
        return synthesise(change.posed.program, eased, context, told=meter.told)


def smallest(found: Sequence[Suggestion]) -> tuple[Suggestion, ...]:
    """The smallest suggestion for each line and way of change: the one found last."""
    kept: dict[tuple[TaskLine | None, str], Suggestion] = {}
    for one in found:
        kept[one.change.line, one.change.way] = one
    return tuple(kept.values())

"""Runs of the whole synthesis on changed tasks: what a suggestion rests on.

A run ends after a number of cell paths, or of questions about the time, which searches and proofs
ask as they go on, so that it is bounded without a clock and repeats.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from compiler.robots.state_and_input import input_bounds
from solvers.explanation.change import Change
from solvers.run_context import Memory, Recorded, RunContext, Silent
from solvers.search.synthesis import Synthesis, synthesise

MOST_RUNS = 16
"""So many runs are made for an explanation."""
MOST_PATHS = 2
"""So many cell paths are tried in a run, of all structures together."""
MOST_PAUSES = 2500
"""So often a run may ask for the time before it is ended."""
REFUTATION = "smt|"
"""How keys begin that name a script in full, so that answers hold for other tasks too."""
NOT_SOUGHT: dict[str, Recorded] = {"drives|": ["", ""], "boxes|": ""}
"""By how keys begin, answers that spare a run the evidence that a task is impossible."""


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A change with which a robot was found and its motion proved.

    ``effort_unit`` is that of its drives; of turning and sliding ones, both.
    """

    change: Change
    word: tuple[str, ...]
    effort_peak: float
    robustness: float
    effort_unit: str


@dataclass(slots=True)
class _Shared:
    """A journal of one run that keeps scripts for the next, and lets it look for designs only."""

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
    """Counts what a run does, and says when that is enough."""

    overtime: Callable[[], bool]
    budget: int = 1
    paths: int = 0
    pauses: int = 0

    def path(self, cells: tuple[str, ...]) -> None:
        """A cell path is being tried."""
        self.paths += 1

    def ended(self) -> bool:
        """Whether the run is to end; asked again and again."""
        self.pauses += 1
        many = self.paths > MOST_PATHS * self.budget or self.pauses > MOST_PAUSES * self.budget
        return many or self.overtime()


@dataclass(slots=True)
class Runs:
    """The runs made so far; ``found`` and ``failed`` are the changes in the order of trial."""

    context: RunContext
    limit: int = MOST_RUNS
    tell: Callable[[str], None] = lambda _: None
    found: list[Suggestion] = field(default_factory=list[Suggestion])
    failed: list[Change] = field(default_factory=list[Change])
    scripts: dict[str, Recorded] = field(default_factory=dict[str, Recorded])

    @property
    def made(self) -> int:
        """How many runs there were."""
        return len(self.found) + len(self.failed)

    @property
    def left(self) -> bool:
        """Whether there may be another one."""
        return self.made < self.limit

    def run(self, change: Change) -> Suggestion | None:
        """Synthesise for a changed task; the suggestion if a robot is found and proved.

        Raises:
            OutOfTimeError: the limit of time was reached.
        """
        self.context.check_time()
        self.tell(f"run {self.made + 1} of at most {self.limit}: {change.says}")
        result = self._result(change)
        # A run that the clock has ended says nothing about the change.
        self.context.check_time()
        design = result.design
        if design is None:
            self.failed.append(change)
            return None
        outcome = design.configuration.outcome
        bounds = input_bounds(design.model, change.posed.task)
        units = " or ".join(dict.fromkeys(bound.unit for bound in bounds if bound.effort))
        word = design.derivation.word
        found = Suggestion(change, word, outcome.effort_peak, outcome.robustness, units)
        self.found.append(found)
        return found

    def _result(self, change: Change) -> Synthesis:
        meter = _Meter(self.context.out_of_time, change.budget)
        context = replace(
            self.context,
            journal=_Shared(self.scripts),
            reporter=meter,
            out_of_time=meter.ended,
            paths=change.budget * self.context.paths,
            evaluations=change.budget * self.context.evaluations,
        )
        # A fast motion takes all the effort that it may, and so would tell nothing of how much it
        # needs.
        task = change.posed.task
        objectives = tuple(each for each in task.minimize if each.kind != "time")
        return synthesise(change.posed.program, replace(task, minimize=objectives), context)

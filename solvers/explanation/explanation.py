"""Why a task was not met: the conflicting lines, the nearest robot, and changes that would help."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.time_limits.time_limit import OutOfTimeError
from compiler.words.derivation import Derivation, replay
from solvers.explanation.change import Change
from solvers.explanation.conflict import (
    MOST_QUESTIONS,
    Conflict,
    Conflicts,
    ConflictSearch,
    separation_conflict,
)
from solvers.explanation.learnt_lines import Learnt
from solvers.explanation.pairs import PairSearch
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.run import MOST_RUNS, Runs, Suggestion, smallest
from solvers.explanation.size_bounds import size_lines
from solvers.explanation.suggestions import SuggestionSearch
from solvers.explanation.task_line import TaskLine, task_lines
from solvers.run_context import RunContext
from solvers.verdict import NotFound

TELLING = (
    "parameter", "effort", "horizon", "avoid", "joint_range", "joint_rate", "joint_accel",
    "joint_effort", "fixed",
)  # fmt: skip
"""Kinds of lines that a person would change; conflicts with such lines come first."""


MOST_COMPARED = 100
"""The number of refuted structures, counted from the last, among which the foremost is chosen."""


FIRST_QUESTIONS = 60
"""After so many questions about conflicts, changes are tried before further robots are examined."""

MOST_QUICK = 40
"""The most questions to the refuter for the conflict at the end of a synthesis."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """The robot that came nearest to a design, and the obstacle to it.

    ``robustness`` is the best that was evaluated for it, None if nothing was evaluated.
    """

    word: tuple[str, ...]
    robustness: float | None
    obstacle: str


@dataclass(frozen=True, slots=True)
class Tried:
    """The results of a synthesis without a design: refuted structures, the nearest one, lemmas."""

    verdict: NotFound
    reason: str
    refuted: tuple[tuple[str, ...], ...]
    """Derivations, one for each different robot."""
    nearest: Nearest | None = None
    lemmas: tuple[Learnt, ...] = ()
    reasons: Mapping[tuple[str, ...], str] = field(default_factory=dict[tuple[str, ...], str])
    """Maps words of refuted robots to the reasons of their refutations."""


@dataclass(slots=True)
class Explanation:
    """The explanation found so far; ``ended`` says why the rest was not found.

    ``most_runs`` is the number of allowed runs. ``bound`` is the first line that bounds the size of
    robots such that a larger one has poses for the task; ``beyond`` is an example of such a robot.
    """

    posed: PosedTask
    tried: Tried
    conflicts: Conflicts = field(default_factory=lambda: Conflicts(()))
    bound: TaskLine | None = None
    beyond: tuple[str, ...] = ()
    suggestions: tuple[Suggestion, ...] = ()
    failed: tuple[Change, ...] = ()
    runs: int = 0
    most_runs: int = 0
    ended: str | None = None

    @property
    def all_refuted(self) -> bool:
        """Whether all tried structures are refuted, even if the verdict is unknown."""
        return bool(self.tried.refuted) and self.tried.nearest is None


@dataclass(frozen=True, slots=True)
class Asked:
    """The limits of an explanation, and who is told what becomes known.

    ``pairs`` more runs are allowed for changes of two lines if no change of one line has helped.
    ``tell`` receives a line of progress now and then, ``step`` what is being done, very often, and
    ``found`` each conflict and each suggestion at once; a later suggestion for the same line may be
    a smaller change.
    """

    context: RunContext = field(default_factory=RunContext)
    runs: int = MOST_RUNS
    pairs: int = 0
    tell: Callable[[str], None] = lambda _: None
    found: Callable[[Conflict | Suggestion], None] = lambda _: None
    step: Callable[[str], None] = lambda _: None


def explain(posed: PosedTask, tried: Tried, asked: Asked) -> Explanation:
    """Explain why a task was not met; everything found until the time limit is kept.

    Raises:
        MapFault: a map of obstacles cannot be used.
    """
    found = Explanation(posed, tried, most_runs=asked.runs)
    runs = Runs(asked.context, asked.runs, asked.tell, asked.found, asked.step)
    try:
        for number, lines in enumerate(_conflicts(found, asked)):
            _suggestions(found, runs, lines, again=bool(number))
        if asked.runs and not runs.left:
            found.ended = f"the limit of {asked.runs} runs was reached"
        if asked.pairs and not runs.found:
            runs.limit = runs.made + asked.pairs
            PairSearch(posed, runs).search(found.conflicts.lines)
    except OutOfTimeError:
        found.ended = "the time limit was reached"
    found.suggestions = smallest(runs.found)
    found.failed, found.runs = tuple(runs.failed), runs.made
    return found


def foremost(posed: PosedTask, refuted: Sequence[tuple[str, ...]]) -> Derivation:
    """The derivation, among refuted structures, with most freedom in coordinates and design."""
    grammar, family = (
        posed.program.grammars[posed.task.grammar],
        family_of(posed.program, posed.task),
    )

    def freedom(derivation: Derivation) -> int:
        model = robot_in_task(family, posed.task.origin, derivation)
        return (len(model.dofs) + 1) * (len(model.parameters) + 1)

    return max((replay(grammar, labels) for labels in refuted[-MOST_COMPARED:]), key=freedom)


def conflicts_of(
    posed: PosedTask,
    refuted: Sequence[Derivation],
    context: RunContext,
    step: Callable[[str], None] = lambda _: None,
) -> tuple[Conflicts, str | None]:
    """The conflicts of some refuted structures, and the reason if the search did not finish.

    ``step`` is told of what is being asked.
    """
    search = ConflictSearch(posed, context, context.check_time, step=step)
    try:
        return search.conflicts(refuted), None
    except OutOfTimeError:
        return search.found(len(refuted)), "the time limit was reached"


def quick_conflict(
    posed: PosedTask, refuted: Derivation | None, context: RunContext
) -> Explanation:
    """An explanation with the conflict of one structure, if a few questions find it.

    Without a structure, start and target are separated from each other.
    """
    found = Explanation(posed, Tried("impossible", "", ()))
    if refuted is None:
        cut = separation_conflict(posed)
        found.conflicts = Conflicts(() if cut is None else (cut,))
        return found
    search = ConflictSearch(posed, context, late=False)

    def enough() -> None:
        if search.questions >= MOST_QUICK:
            raise OutOfTimeError

    search.between = enough
    try:
        lines = search.conflict(refuted)
    except OutOfTimeError:
        lines = None
    found.conflicts = Conflicts(() if lines is None else (Conflict(lines, (refuted.word,)),))
    return found


def _conflicts(found: Explanation, asked: Asked) -> Iterator[tuple[TaskLine, ...]]:
    """The lines of conflicts, and in a second step those of many further robots, if there are some.

    The conflicts are noted, and whether the bound on modules is one of their lines.
    """
    posed, tried = found.posed, found.tried
    if not tried.refuted:
        cut = separation_conflict(posed)
        found.conflicts = Conflicts(() if cut is None else (cut,))
        if cut is None and tried.verdict == "impossible":
            _bound(found, asked)
        yield found.conflicts.lines
        return
    count = len(tried.refuted)
    asked.tell(f"looking for the conflicts of {'1 robot' if count == 1 else f'{count} robots'}")
    search = ConflictSearch(
        posed, asked.context, asked.context.check_time, step=asked.step, tell=asked.found
    )
    grammar = posed.program.grammars[posed.task.grammar]
    derivations = [replay(grammar, labels) for labels in tried.refuted]
    known = tuple[TaskLine, ...]()
    for number, most in enumerate((FIRST_QUESTIONS, MOST_QUESTIONS)):
        try:
            search.conflicts(derivations, most)
        finally:
            conflicts = search.found(count)
            ranked = sorted(conflicts.found, key=lambda one: (not _telling(one), -len(one.words)))
            found.conflicts = Conflicts(tuple(ranked), conflicts.left)
        if not number and tried.verdict == "impossible":
            _bound(found, asked)
        yield tuple(line for line in found.conflicts.lines if line not in known)
        known = found.conflicts.lines


def _telling(conflict: Conflict) -> bool:
    return any(line.kind in TELLING for line in conflict.lines)


def _bound(found: Explanation, asked: Asked) -> None:
    """Look for a larger robot with poses for the task."""
    search = SuggestionSearch(found.posed, Runs(asked.context, 0, step=asked.step))
    for line in size_lines(found.posed):
        asked.context.check_time()
        longer = search.longer(line)
        if longer is not None:
            found.bound, found.beyond = line, longer.word
            return


def _suggestions(found: Explanation, runs: Runs, lines: Sequence[TaskLine], *, again: bool) -> None:
    """Try changes of lines, of those that are new if this is done ``again``."""
    if not runs.left or (again and not lines):
        return
    search = SuggestionSearch(found.posed, runs)
    if found.tried.verdict == "impossible" or found.all_refuted:
        impossible = found.tried.verdict == "impossible"
        # If no larger robot had poses, none has now.
        bounds = () if again or (impossible and found.bound is None) else size_lines(found.posed)
        search.after_conflicts(lines, bounds)
    elif not again:
        search.after_motions(task_lines(found.posed), size_lines(found.posed))

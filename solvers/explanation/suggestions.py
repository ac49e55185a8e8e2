"""Search for changes of one line with which a robot is found, each confirmed by a run.

Poses show cheaply from which value on a change may help; runs decide. If poses show nothing, the
far end is tried first, then nearer values.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice, takewhile

from compiler.robots.normal_form import family_of
from compiler.words.derivation import Derivation
from compiler.words.structures import structures
from solvers.conclusion import module_bound
from solvers.explanation.change import (
    Change,
    single_changes,
    with_budget,
    with_feedback,
    with_fewer_steps,
    with_shorter_steps,
)
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.required_poses import first_with_poses, with_poses
from solvers.explanation.run import Runs, Suggestion
from solvers.explanation.scale import MOST_STEPS, Scale, scales
from solvers.explanation.size_bounds import beyond, exceeds, with_size_of
from solvers.explanation.straight_motions import by_promise, straight_motions
from solvers.explanation.task_line import TaskLine, control_line
from solvers.explanation.two_digits import rounded_up

CLOSE = Fraction(11, 10)
"""An effort within this factor of one that was too small is not refined further."""
DRIVES = ("effort", "joint_effort", "joint_rate", "joint_accel", "horizon")
"""Changed first: if these are to blame, there are poses for any ranges, and changes of ranges would
use up the runs."""
LOADS = "payload", "carry"
"""Changed next: a conflict with a load has poses for any ranges, too."""
LIMIT = "joint_range"
"""Limits of joints are dropped last, since real joints keep theirs."""
WIDER, WIDEST = Fraction(6, 5), Fraction(2)
"""Multiples of the least value with poses that are tried, too. With the least, a robot may only
just touch what it has to reach: then nothing is proved, after a long search."""
NEARER = 3
"""The runs that look for a smaller change once one has succeeded."""
SHORTER = (5, 2)
"""The parts into which steps are divided: the second number only if the first has helped."""
HALVES = 2
"""The parts into which steps are divided without disturbances: shorter steps follow an obstacle
more closely."""
LONGER = 2
"""The factor for the budgets."""
FEWER = Fraction(3, 4), Fraction(1, 2)
"""The fractions of a horizon that are tried."""
MOST_STRUCTURES = 300
"""The structures for which poses are searched."""


@dataclass(frozen=True, slots=True)
class SuggestionSearch:
    """Looks for changes of a task; ``runs`` stores which were confirmed and which failed."""

    posed: PosedTask
    runs: Runs

    @property
    def seed(self) -> int:
        """The seed of the poses."""
        return self.runs.context.seed

    def after_conflicts(self, lines: Iterable[TaskLine], bounds: Iterable[TaskLine]) -> None:
        """Try changes of the lines of conflicts, and of bounds on the size of robots."""
        derivations = self.structures(self.posed)
        shown = not with_poses(self.posed, derivations, self.seed, robots=1)
        listed = list(lines)
        self.drives(listed)
        rest = [line for line in listed if line.kind not in DRIVES]
        for place, line in self.told(sorted(rest, key=lambda line: line.kind not in LOADS)):
            if line.kind in LOADS:
                self.lighter(line)
                continue
            helps = False
            for scale in scales(self.posed, line):
                if not scale.last or (shown and not helps):
                    helps |= self.posable(scale, derivations, place, shown=shown)
            if line.kind != LIMIT or not helps:
                self.singles(line)
        self.sizes(bounds)

    def after_motions(self, lines: Sequence[TaskLine], bounds: Iterable[TaskLine]) -> None:
        """Try changes that may help if there are poses but no motion was found or proved."""
        horizon = next(line for line in lines if line.kind == "horizon")
        self.feedback("open loop")
        self.shorter(horizon)
        self.drives(lines)
        for _, line in self.told([each for each in lines if each.kind not in (*DRIVES, LIMIT)]):
            if line.kind in LOADS:
                self.lighter(line)
            else:
                self.singles(line)
        self.undisturbed(next(line for line in lines if line.kind == "start"))
        self.sizes(bounds)
        if not self.runs.found:
            self.otherwise(horizon)
        for line in () if self.runs.found else lines:
            if line.kind == LIMIT:
                self.ranges(line)

    def told(self, lines: Sequence[TaskLine]) -> Iterator[tuple[str, TaskLine]]:
        """The lines in order, with their place in words, which is told."""
        for number, line in enumerate(lines, 1):
            place = f"line {number} of {len(lines)}, {line.says}"
            self.runs.step(place)
            yield place, line

    def drives(self, lines: Sequence[TaskLine]) -> None:
        """Try stronger and faster drives and more steps, by what straight motions need."""
        changes = [s for line in lines if line.kind in DRIVES for s in scales(self.posed, line)]
        if not changes:
            return
        self.runs.step("looking for what straight motions need of the drives and the time")
        able = with_poses(self.posed, self.structures(self.posed), self.seed, robots=1)
        motions = straight_motions(self.posed, able[0], self.seed) if able else None
        for scale, value in by_promise(changes, motions):
            self.far(scale, value)

    def lighter(self, line: TaskLine) -> None:
        """Try less of a payload or a load; if a small part of it does not help, without it."""
        if not any(self.far(scale) for scale in scales(self.posed, line)):
            self.singles(line)

    def undisturbed(self, line: TaskLine) -> None:
        """Try without disturbances, and with feedback against them."""
        if self.posed.task.robust is None:
            return
        calm = self.posed.with_task(robust=None)
        self.tried(Change(line, "without `robust`", calm))
        # Last, since a search that may choose has tried feedback, unless it was ended early.
        self.feedback(None)

    def feedback(self, control: str | None) -> None:
        """Try inputs that follow measurements, if the task's ``control`` is the given one."""
        line = control_line(self.posed)
        if line is not None and self.posed.task.control == control:
            self.tried(with_feedback(self.posed, line))

    def shorter(self, line: TaskLine) -> None:
        """Try steps short enough for feedback to answer disturbances before they have grown."""
        task = self.posed.task
        if task.robust is None or task.control == "open loop":
            return
        for parts in SHORTER:
            if parts * task.steps > MOST_STEPS:
                continue
            if self.tried(with_shorter_steps(self.posed, line, parts)) is None:
                return

    def otherwise(self, line: TaskLine) -> None:
        """Try shorter horizons, the longest first, finer steps, and a longer search of the task.

        They take longest, and so are tried only if nothing else has helped.
        """
        task, context = self.posed.task, self.runs.context
        # With ``at most``, fewer steps have been tried.
        for part in () if task.at_most else FEWER:
            fewer = int(task.steps * part)
            if fewer and self.tried(with_fewer_steps(self.posed, line, fewer)) is not None:
                return
        finer = with_shorter_steps(self.posed, line, HALVES)
        if task.robust is not None or HALVES * task.steps > MOST_STEPS or not self.tried(finer):
            self.tried(with_budget(self.posed, LONGER, context.paths, context.evaluations))

    def tried(self, change: Change) -> Suggestion | None:
        """Run a change, if another run is allowed."""
        return self.runs.run(change) if self.runs.left else None

    def singles(self, line: TaskLine) -> None:
        """Try changes without a value: the next one only if the one before does not help."""
        for change in single_changes(self.posed, line):
            if self.posable_at(change.posed) and self.tried(change) is not None:
                return

    def ranges(self, line: TaskLine) -> None:
        """Try without the limit of a joint, and if that helps, with wider finite ranges."""
        before = len(self.runs.found)
        self.singles(line)
        if len(self.runs.found) > before:
            for scale in scales(self.posed, line):
                if not scale.last:
                    self.far(scale)

    def structures(self, posed: PosedTask) -> tuple[Derivation, ...]:
        """The first structures of the family."""
        family = family_of(posed.program, posed.task)
        found = structures(family.language, module_bound(family, posed.task))
        return tuple(islice(found, MOST_STRUCTURES))

    def posable_at(self, posed: PosedTask) -> bool:
        """Whether poses are found for some structure of a changed task."""
        return bool(with_poses(posed, self.structures(posed), self.seed, robots=1))

    # --- values ---------------------------------------------------------------------------------

    def posable(
        self, scale: Scale, derivations: Sequence[Derivation], place: str, *, shown: bool = True
    ) -> bool:
        """Try changes from the least one on for which there are poses; return whether one helps.

        A somewhat larger one comes first, then the least or one twice as large. If poses show
        nothing, as the task has some without the change, the largest comes first. Where more is not
        weaker, in lists, the least does.
        """

        def tick() -> None:
            self.runs.context.check_time()
            self.runs.step(f"{place}: looking for values with poses")

        def helps(value: Fraction) -> bool:
            return self.tried(scale.at(value)) is not None

        tasks = [scale.posed_at(value) for value in scale.values]
        if not tasks:
            return False
        first = first_with_poses(tasks, derivations, self.seed, tick)
        if first is None:
            return False
        least = scale.values[first]
        wider, widest = (scale.further(least, more) for more in (WIDER, WIDEST))
        if not shown:
            return bool(list(takewhile(helps, dict.fromkeys((widest, wider, least)))))
        if scale.with_all is not None:
            return any(map(helps, dict.fromkeys((least, wider, widest))))
        if helps(wider):
            if least != wider:
                helps(least)
            return True
        return widest != wider and helps(widest)

    def far(self, scale: Scale, promising: Fraction | None = None) -> bool:
        """Try the largest change first, and smaller ones if it helps; return whether it does.

        A change that seems large enough is tried before the largest.
        """
        low, count = -1, len(scale.values)
        wanted = [] if promising is None else [scale.values.index(promising)]
        for high in dict.fromkeys([*wanted, count - 1] if count else ()):
            best = self.tried(scale.at(scale.values[high]))
            if best is not None:
                self.nearer(scale, best, low, high)
                return True
            low = high
        return False

    def nearer(self, scale: Scale, best: Suggestion, low: int, high: int) -> None:
        """Try changes between one that helps and one that does not, by index; -1 if none is known.

        Between steps and values this halves the way, a few times.
        """
        if scale.line.kind == "effort":
            self.by_peak(scale, best, scale.values[low + 1], scale.values[high])
            return
        for _ in range(NEARER):
            if scale.line.kind == "horizon":
                between = scale.values[max(low, 0)] - (low < 0), scale.values[high]
                mean = Fraction(round(_between(*between)))
            else:
                mean = _between(scale.values[max(low, 0)], scale.values[high])
            middle = scale.values.index(_nearest(scale.values, mean))
            if not low < middle < high:
                return
            if self.tried(scale.at(scale.values[middle])) is None:
                low = middle
            else:
                high = middle

    def by_peak(self, scale: Scale, best: Suggestion, low: Fraction, high: Fraction) -> None:
        """For an effort, try the peak of a motion as the bound; if that fails, more."""
        kind = self.posed.task.effort[int(scale.line.key[0])].kind
        unit = "N*m" if kind == "revolute" else "N"
        wanted = rounded_up(Fraction(best.efforts[unit])) if best.efforts.get(unit) else low
        for _ in range(NEARER):
            if not low <= wanted < high:
                return
            found = self.tried(scale.at(wanted))
            if found is None:
                low = wanted
                wanted = rounded_up(_between(low, high))
            else:
                high = wanted
                wanted = rounded_up(Fraction(found.efforts.get(unit) or low))
            if high < CLOSE * low:
                return

    def sizes(self, lines: Iterable[TaskLine]) -> None:
        """For each bound on the size of robots, try the least one for which there are poses."""
        for line in lines:
            longer = self.longer(line)
            if longer is not None:
                self.tried(with_size_of(self.posed, line, longer))

    def longer(self, line: TaskLine) -> Derivation | None:
        """The first structure with poses that a bound rules out by its size."""
        self.runs.step(f"{line.says}: looking for poses of larger robots")
        posed = beyond(self.posed, line)
        every = (each for each in self.structures(posed) if exceeds(self.posed, line, each))
        return next(iter(with_poses(posed, every, self.seed, robots=1)), None)


def _nearest(values: Sequence[Fraction], wanted: Fraction) -> Fraction:
    """The value of a scale that is nearest to a number."""
    return min(values, key=lambda value: abs(value - wanted))


def _between(low: Fraction, high: Fraction) -> Fraction:
    """The geometric mean, rounded to a double."""
    return Fraction((float(low) * float(high)) ** 0.5)

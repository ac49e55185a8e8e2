"""Changes of two lines at once, tried if no change of one line helps.

Which pairs may help is seen cheaply: from straight motions, where a change of one line gives poses
and drives or time are then lacking, and from poses, where two ranges together give some.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, islice
from typing import TypeAlias

from compiler.words.derivation import Derivation
from solvers.explanation.change import Change
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.required_poses import first_with_poses, with_poses
from solvers.explanation.run import Runs
from solvers.explanation.scale import Scale, scales
from solvers.explanation.straight_motions import straight_motions
from solvers.explanation.suggestions import DRIVES, WIDER, SuggestionSearch
from solvers.explanation.task_line import TaskLine, task_lines

MOST_PAIRS = 4
"""The most runs with changes of two lines."""
MOST_FIRST = 6
"""The most changes of one line to which others are added."""
MOST_DIAGONALS = 6
"""The most pairs of ranges for which poses are searched."""
PARTS = 24
"""The parts into which two ranges that grow together are divided."""
RANGES = ("parameter", "joint_range", "bounds")
_Way: TypeAlias = tuple[TaskLine, int]
"""A line and the number of one of its scales."""


@dataclass(frozen=True, slots=True)
class PairSearch:
    """Looks for two changes that help together; ``runs`` has the single ones that failed."""

    posed: PosedTask
    runs: Runs

    def search(self, lines: Iterable[TaskLine]) -> None:
        """Try pairs, the most promising first, until one helps; ``lines`` are those in conflict."""
        ranges = [line for line in lines if line.kind in RANGES]
        for change in islice(chain(self.by_motions(), self.by_poses(ranges)), MOST_PAIRS):
            if not self.runs.left or self.runs.run(change) is not None:
                return

    # --- what straight motions show ---------------------------------------------------------------

    def by_motions(self) -> list[Change]:
        """Failed changes with one of a drive, a limit or the time that straight motions then need.

        Those with the least factor come first.
        """
        found = dict[frozenset[tuple[object, ...]], tuple[Fraction, Change]]()
        for first in islice(self._failed(), MOST_FIRST):
            for factor, second, both in self._with_drives(first):
                lines = frozenset((each.kind, each.key) for each in (first.line, second) if each)
                if lines not in found or factor < found[lines][0]:
                    found[lines] = factor, both
        return [change for _, change in sorted(found.values(), key=lambda item: item[0])]

    def _failed(self) -> Iterator[Change]:
        """The failed changes, the last one of each line and way; those with a value if any."""
        failed = [each for each in self.runs.failed if each.line and each.line.kind != "control"]
        valued = {each.line for each in failed if each.value is not None}
        last = {
            (each.line, each.way): each
            for each in failed
            if each.value is not None or each.line not in valued
        }
        return iter(last.values())

    def _with_drives(self, first: Change) -> Iterator[tuple[Fraction, TaskLine, Change]]:
        """For a change, each other one of a drive that straight motions need in addition."""
        self.runs.context.check_time()
        self.runs.step(f"{first.says}: looking for a change of another line")
        search = SuggestionSearch(first.posed, self.runs)
        able = with_poses(first.posed, search.structures(first.posed), search.seed, robots=1)
        if not able:
            return
        motions = straight_motions(first.posed, able[0], search.seed)
        for line in task_lines(first.posed):
            if line.kind not in DRIVES or _same(line, first.line):
                continue
            for scale in scales(first.posed, line):
                value = motions.least(scale)
                if value is None:
                    continue
                second = scale.at(value)
                both = _together(first, second, second.posed)
                if first.line is not None and first.line.kind in DRIVES:
                    # The first one is as large as possible: now the least one that is needed.
                    alone = _change(self.posed, line, 0, value)
                    own = _scale(alone.posed, first.line, 0)
                    less = replace(motions, posed=alone.posed).least(own)
                    if less is not None:
                        both = _together(own.at(less), second, own.at(less).posed)
                yield value / scale.values[0], line, both

    # --- what poses show --------------------------------------------------------------------------

    def by_poses(self, lines: Sequence[TaskLine]) -> Iterator[Change]:
        """Two ranges that grow together, up to the first values for which there are poses."""
        search = SuggestionSearch(self.posed, self.runs)
        derivations = search.structures(self.posed)
        if with_poses(self.posed, derivations, search.seed, robots=1):
            return
        # The others have poses alone, but no motion was found.
        tried = {change.line for change in self.runs.failed}
        every = [each for each in task_lines(self.posed) if each.kind in RANGES]
        first = self._ways(line for line in lines if line not in tried)
        second = self._ways(line for line in every if line not in tried)
        pairs = {
            frozenset((one, other)): (one, other)
            for one in first
            for other in second
            if one[0] != other[0]
        }
        for one, other in islice(pairs.values(), MOST_DIAGONALS):
            self.runs.step(f"{one[0].says} and {other[0].says}: looking for values with poses")
            tasks = [self._grown(one, other, part) for part in range(1, PARTS + 1)]
            part = self._first(tasks, derivations)
            if part is not None:
                yield from self._least(one, other, part + 1, derivations)

    def _least(
        self, one: _Way, other: _Way, part: int, derivations: Sequence[Derivation]
    ) -> Iterator[Change]:
        """The least values of two ranges with poses, and somewhat larger ones."""
        far = _change_at(self.posed, *other, part).posed
        scale = _scale(self.posed, *one)
        place = self._first([_scale(far, *one).posed_at(v) for v in scale.values], derivations)
        if place is None:
            return
        value = scale.values[place]
        added = _scale(scale.at(value).posed, *other)
        place = self._first([added.posed_at(v) for v in added.values], derivations)
        if place is None:
            return
        for more in (Fraction(1), WIDER):
            first = scale.at(scale.further(value, more))
            second = _scale(first.posed, *other).at(added.further(added.values[place], more))
            yield _together(first, second, second.posed)

    def _first(self, tasks: Sequence[PosedTask], derivations: Sequence[Derivation]) -> int | None:
        """The index of the first task with poses."""
        context = self.runs.context
        return first_with_poses(tasks, derivations, context.seed, context.check_time)

    def _ways(self, lines: Iterable[TaskLine]) -> list[_Way]:
        """The lines, each with the number of each of its scales."""
        return [
            (line, number)
            for line in lines
            for number, scale in enumerate(scales(self.posed, line))
            if scale.values
        ]

    def _grown(self, one: _Way, other: _Way, part: int) -> PosedTask:
        """Both ranges as far out as a part of their values."""
        return _change_at(_change_at(self.posed, *one, part).posed, *other, part).posed


def _same(line: TaskLine, other: TaskLine | None) -> bool:
    return other is not None and (line.kind, line.key) == (other.kind, other.key)


def _scale(posed: PosedTask, line: TaskLine, number: int) -> Scale:
    """A scale of a line in a changed task."""
    return list(scales(posed, line))[number]


def _change(posed: PosedTask, line: TaskLine, number: int, value: Fraction) -> Change:
    return _scale(posed, line, number).at(value)


def _change_at(posed: PosedTask, line: TaskLine, number: int, part: int) -> Change:
    scale = _scale(posed, line, number)
    place = -(-len(scale.values) * part // PARTS) - 1
    return scale.at(scale.values[place])


def _together(first: Change, second: Change, posed: PosedTask) -> Change:
    says = f"{first.says} and {second.says}"
    return Change(first.line, says, posed, way=says, lines=2)

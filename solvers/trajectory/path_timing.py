"""The timing of an effector along a cell path: a polyline and the samples that enter cells.

It is only a seed for the control synthesis, and a choice of samples that a formula allows.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.tasks.word_formula import Obligation, Word
from compiler.time_limits.time_limit import check_time
from compiler.workspaces.abstraction import Abstraction
from solvers.trajectory.monotone_cubic import monotone_cubic

TINY = 1e-300
Entries: TypeAlias = tuple[int, ...]
"""The sample at which each cell of a path is entered; the first is 0."""


@dataclass(frozen=True, slots=True)
class Polyline:
    """Points (w, d), in m, in order; ``gates`` are the indices at which cells are entered."""

    points: Array
    gates: tuple[int, ...]

    @property
    def along(self) -> Array:
        """The length of the line up to each point, (w,), in metres."""
        lengths = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(lengths)])

    @property
    def stretches(self) -> list[float]:
        """The lengths (m) at which the line enters each cell, from 0, and its total length."""
        return [0.0, *self.along[list(self.gates)].tolist(), float(self.along[-1])]

    def at(self, along: Array) -> Array:
        """The places (s, d) at lengths (s,) along the line, all in metres."""
        axes = range(self.points.shape[1])
        columns = [np.interp(along, self.along, self.points[:, axis]) for axis in axes]
        return np.stack(columns, axis=1)


def polyline(abstraction: Abstraction, cells: tuple[int, ...]) -> Polyline:
    """The centre of the first cell, the centres of the facets passed, the centre of the last cell.

    A cell that is left through the facet by which it was entered is visited at its centre.
    """
    points, gates = [_centre(abstraction, cells[0])], []
    for number in range(1, len(cells)):
        before, cell = cells[number - 1], cells[number]
        if number >= 2 and cells[number - 2] == cell:
            points.append(_centre(abstraction, before))
        gates.append(len(points))
        points.append(_gate(abstraction, before, cell))
    points.append(_centre(abstraction, cells[-1]))
    return Polyline(np.array(points), tuple(gates))


def _gate(abstraction: Abstraction, before: int, cell: int) -> Array:
    """The centre of the facet between two cells; if they share none, the middle between them."""
    if cell in abstraction.neighbours[before]:
        return abstraction.facet_centre(before, cell)
    return (_centre(abstraction, before) + _centre(abstraction, cell)) / 2


def _centre(abstraction: Abstraction, cell: int) -> Array:
    return np.array([float(x) for x in abstraction.cells[cell].polytope.centre])


def visit_times(
    abstraction: Abstraction, cells: tuple[int, ...], places: Sequence[int], steps: int
) -> dict[int, int]:
    """The samples at which places on a path are visited, on a way through these places only.

    It leads straight from the centre of the first cell through their centres to that of the last.
    """
    inner = [place for place in places if 0 < place < len(cells) - 1]
    points = [_centre(abstraction, cells[place]) for place in (0, *inner, len(cells) - 1)]
    line = Polyline(np.array(points), tuple(range(1, len(inner) + 1)))
    entries = smooth_timing(line, steps)[1]
    times = dict(zip(inner, entries[1:], strict=True))
    ends = {0: 0, len(cells) - 1: steps}
    return {place: times.get(place, ends.get(place, 0)) for place in places}


def smooth_timing(line: Polyline, steps: int, stops: Sequence[int] = ()) -> tuple[Array, Entries]:
    """Lengths (steps + 1,) in m along the line, from rest to rest, and the entries.

    Minimum jerk (Flash & Hogan 1985) over the whole line.  With ``stops``, places of cells on the
    path, it is applied to each leg between the middles of these cells; legs take times proportional
    to the square roots of their lengths, which gives them equal accelerations.  Every cell gets a
    sample of its own.
    """
    lengths = line.stretches
    ends = [*((lengths[cell] + lengths[cell + 1]) / 2 for cell in stops), lengths[-1]]
    ways = np.sqrt(np.diff([0.0, *ends]))
    share = np.concatenate([[0.0], np.cumsum(ways) / max(float(ways.sum()), TINY)])
    share[-1] = 1.0
    t = np.linspace(0.0, 1.0, steps + 1)
    leg = np.clip(np.searchsorted(share, t, side="right") - 1, 0, len(ways) - 1)
    first, last = share[leg], share[leg + 1]
    part = (t - first) / np.maximum(last - first, TINY)
    before = np.array([0.0, *ends])[leg]
    way = np.array(ends)[leg] - before
    s = before + (10 * part**3 - 15 * part**4 + 6 * part**5) * way
    passed = np.searchsorted(s, line.along[list(line.gates)] + 1e-12)
    # Every cell contains at least one sample, in order.
    entries = [0]
    for number, entry in enumerate(passed):
        rest = len(passed) - 1 - number
        entries.append(int(min(max(entry, entries[-1] + 1), steps - rest)))
    return s, tuple(entries)


def timing_of(line: Polyline, entries: Entries, steps: int, stops: Sequence[int] = ()) -> Array:
    """Lengths (steps + 1,) in m along the line that enter the cells at given samples.

    Monotone cubics through the gates, half a step before each entry.  They are at rest at both ends
    and at the samples ``stops``, halfway through the cells of these.
    """
    lengths = line.stretches
    known = dict(
        zip([0.0, *(entry - 0.5 for entry in entries[1:]), float(steps)], lengths, strict=True)
    )
    rests = sorted({0.0, float(steps), *map(float, stops)})
    for stop in stops:
        cell = bisect_right(entries, stop) - 1
        known.setdefault(float(stop), (lengths[cell] + lengths[cell + 1]) / 2)
    times, at, found = np.array(sorted(known)), np.arange(steps + 1.0), np.zeros(steps + 1)
    values = np.maximum.accumulate([known[time] for time in times.tolist()])
    for first, last in pairwise(rests):
        own, within = (times >= first) & (times <= last), (at >= first) & (at <= last)
        found[within] = monotone_cubic(times[own], values[own], at[within])
    return np.clip(found, 0.0, lengths[-1])


def rests_of(obligations: Iterable[Obligation], effector: int) -> tuple[int, ...]:
    """The samples, in order, at which an effector (from 0) picks a load up or puts it down."""
    found = (one for one in obligations if one.transfer is not None and one.effector == effector)
    return tuple(sorted(one.first for one in found))


def gentle_entries(
    line: Polyline,
    planned: Entries,
    steps: int,
    allowed: Callable[[Entries], bool],
    stops: Sequence[int] = (),
) -> Entries:
    """Allowed entries that need little haste, starting from the allowed ones ``planned``.

    Smooth timing with its ``stops`` is used if it is allowed.  Otherwise groups of entries are
    moved together as long as that lowers the sum of squared lengths over durations, which even
    speed would minimise.
    """
    _, smooth = smooth_timing(line, steps, stops)
    if allowed(smooth):
        return smooth
    best, least = planned, _haste(line, planned, steps)
    moved = True
    while moved:
        moved = False
        for trial in _moves(best, steps):
            check_time()
            haste = _haste(line, trial, steps)
            if haste < least and allowed(trial):
                best, least, moved = trial, haste, True
                break
    return best


def _haste(line: Polyline, entries: Entries, steps: int) -> float:
    """The sum of squared length over duration, in steps, of the stretches between gates."""
    lengths = np.diff([0.0, *line.along[list(line.gates)], line.along[-1]])
    times = np.diff([0.0, *(entry - 0.5 for entry in entries[1:]), float(steps)])
    return float(np.sum(lengths**2 / times))


def _moves(entries: Entries, steps: int) -> Iterator[Entries]:
    """The entries with a run of them moved by the same number of samples, far moves first."""
    count = len(entries)
    shift = 1 << max(steps.bit_length() - 1, 0)
    while shift:
        for size in range(count - 1, 0, -1):
            for first in range(1, count - size + 1):
                for by in (shift, -shift):
                    moved = (entry + by for entry in entries[first : first + size])
                    trial = (*entries[:first], *moved, *entries[first + size :])
                    if in_order(trial, steps):
                        yield trial
        shift //= 2


def word_of(
    abstraction: Abstraction, paths: Iterable[tuple[int, tuple[int, ...], Entries]], steps: int
) -> Word:
    """The propositions of the cells of effectors at the samples 0 .. ``steps``.

    A path is the number of the effector (from 0), its cells and the samples at which it enters
    them.  Letters number effectors from 1, as formulas do.
    """
    letters: list[dict[int, frozenset[str]]] = [{} for _ in range(steps + 1)]
    for effector, cells, entries in paths:
        ends = [*entries[1:], steps + 1]
        for cell, first, last in zip(cells, entries, ends, strict=True):
            for letter in letters[first:last]:
                letter[effector + 1] = abstraction.cells[cell].propositions
    return letters


def in_order(entries: Entries, steps: int) -> bool:
    """Whether every cell has a sample of its own: entries increase strictly up to ``steps``."""
    return entries[0] == 0 and entries[-1] <= steps and bool(np.all(np.diff(entries) > 0))

"""Prove formulas along a validated tube in continuous time, with a bound of their robustness.

The tube is cut into slices of time with exact ends. Each atom is decided on a slice if possible,
with bounds of its margin. From these the best possible robustness of a formula is estimated, and
only the slices that separate it from the proved robustness are halved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise, product

from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.tasks.monitor import (
    AtomKey,
    Monitored,
    Piece,
    Trace,
    Verdicts,
    boolean_parts,
    boolean_value,
    key,
)
from compiler.workspaces.partition import remainder
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from grammar_lang.ir.formula_parts import atoms, attained
from solvers.verifier.proofs.enclosure import TubeSegment
from solvers.verifier.proofs.point_map import PointMap, Slice
from solvers.verifier.proofs.region_distance import UNKNOWN, Gap, RegionDistance
from solvers.verifier.proofs.tube_checks import (
    MOST_SPLITS,
    MOST_UNBOUNDED_SPLITS,
    REFINEMENT,
    Status,
)
from solvers.verifier.proofs.turned import PosedRegion

MOST_SLICES = 4_000
"""The most slices that a formula may add: an effector that rests on a boundary would straddle it in
all of them."""
LEAST_HOPE = 1e-9
"""Metres; if no more than this can be gained, what is proved has to suffice."""
LOOSE = 0.9
"""A bound below this fraction of the best possible one justifies a narrower tube."""
MOST_UNSURE = 6
"""The most undecided atoms for which all cases are tried."""


@dataclass(frozen=True, slots=True)
class FormulaVerdict:
    """Whether a formula holds at time 0, and a bound of its robustness in metres.

    ``robustness`` is a lower bound of the space robustness; for a formula that fails, an upper
    bound, which is not positive; zero if undecided. It is ``loose`` if the tube is too wide for a
    close bound. ``time`` and ``place`` are where an effector attains it.
    """

    status: Status
    robustness: float
    loose: bool = False
    time: float | None = None
    place: tuple[float, ...] = ()


@dataclass(frozen=True, slots=True)
class _Part:
    """A slice of a segment, its ends in units of the step, and the gap of every atom."""

    segment: TubeSegment
    inputs: Sequence[arb]
    first: Fraction
    last: Fraction
    depth: int
    gaps: tuple[Gap, ...]
    finite: bool = True

    def straddles(self, level: float, numbers: Sequence[int]) -> bool:
        """Whether some atoms may be decided with this margin, but are not proved to be."""
        return any(
            gap.inside < level <= gap.most_inside or gap.outside < level <= gap.most_outside
            for gap in (self.gaps[number] for number in numbers)
        )


@dataclass(slots=True)
class FormulaProof:
    """The margins of the atoms of formulas along a tube, segment by segment.

    ``regions`` gives the sets of the atoms, ``task`` the horizon. ``tick`` is called repeatedly; an
    exception from it ends the proof. With a ``loop``, the sample at which a loop begins, the
    formulas are about motions that go on for ever.
    """

    point_map: PointMap
    regions: Mapping[AtomKey, RegionDistance | PosedRegion]
    task: ir.Task
    tick: Callable[[], None] = lambda: None
    loop: int | None = None
    parts: list[_Part] = field(default_factory=list)

    def add(self, segment: TubeSegment, u: Sequence[arb]) -> None:
        """Append the next segment of the tube, with the inputs that act in it."""
        if self.regions:
            unknown = (UNKNOWN,) * len(self.regions)
            self.parts.append(self._part(segment, u, segment.steps, 0, unknown))

    def verdict(self, formula: ir.Formula) -> FormulaVerdict:
        """The verdict on a formula once the tube is complete."""
        for status, said in ((Status.HOLDS, formula), (Status.FAILS, ir.Not(formula))):
            bound, hoped = self._robustness(said)
            if bound is not None:
                loose = bound < LOOSE * hoped - LEAST_HOPE
                signed = bound if status is Status.HOLDS else -bound
                return FormulaVerdict(status, signed, loose, *self._attained(formula, bound))
        return FormulaVerdict(self._by_cases(attained(formula)), 0.0)

    def _attained(
        self, formula: ir.Formula, bound: float
    ) -> tuple[float | None, tuple[float, ...]]:
        """The first time and place at which an atom has exactly the robustness of the formula."""
        effectors = [atom.effector for atom in self.regions]
        for part in self.parts:
            for number in self._numbers(formula):
                gap = part.gaps[number]
                if bound in (gap.inside, gap.outside):
                    time = self._over(part.segment, part.inputs, (part.first, part.last))
                    place = () if time is None else time.middle(effectors[number] - 1)
                    return float((part.first + part.last) / 2 * self.task.step), place
        return None, ()

    def _robustness(self, formula: ir.Formula) -> tuple[float | None, float]:
        """A lower bound of the robustness, None if none is positive, and the best possible value.

        Slices are halved for the largest level at which the estimates would suffice; once no slice
        straddles this level, it is proved.
        """
        numbers = self._numbers(formula)
        monitored = self._monitored(formula)
        most = len(self.parts) + MOST_SLICES
        while True:
            hoped = monitored.robustness(self._trace(numbers, hopeful=True)) or 0.0
            level = hoped * (1 - REFINEMENT)
            trace = self._trace(numbers, hopeful=False)
            enough = hoped < LEAST_HOPE or monitored.holds(trace, level)
            if enough or not self._refine(level, numbers, most):
                return monitored.robustness(trace), hoped

    def _monitored(self, formula: ir.Formula) -> Monitored:
        task = self.task
        loop = None if self.loop is None else self.loop * task.step
        return Monitored(formula, task.step * task.steps, task.step, loop)

    def _numbers(self, formula: ir.Formula) -> list[int]:
        """The indices of a formula's atoms among all atoms."""
        wanted = {key(atom) for atom in atoms(formula)}
        return [number for number, atom in enumerate(self.regions) if atom in wanted]

    def _by_cases(self, formula: ir.Formula) -> Status:
        """The result if undecided atoms are tried both ways, on whole slices."""
        step, monitored = self.task.step, self._monitored(formula)
        known: dict[ir.Formula, Verdicts] = {}
        for part in boolean_parts(formula):
            values = [(slice_, self._value(part, slice_)) for slice_ in self.parts]
            spans = {
                value: [(s.first * step, s.last * step) for s, found in values if found is value]
                for value in (True, False)
            }
            must, never = (monitored.union(spans[value]) for value in (True, False))
            known[part] = Verdicts(must, never.complement)
        trace = self._trace(self._numbers(formula), hopeful=False)
        for status, said in ((Status.HOLDS, formula), (Status.FAILS, ir.Not(formula))):
            if self._monitored(said).holds(trace, 0.0, known):
                return status
        return Status.UNDECIDED

    def _value(self, formula: ir.Formula, part: _Part) -> bool | None:
        """The value of a formula without time over a whole slice; None if it is not certain."""
        wanted = {key(atom) for atom in atoms(formula)}
        gaps = {a: gap for a, gap in zip(self.regions, part.gaps, strict=True) if a in wanted}
        values = {a: gap.inside > 0 for a, gap in gaps.items() if gap.inside or gap.outside}
        unsure = [a for a in gaps if a not in values]
        if len(unsure) > MOST_UNSURE:
            return None
        cases = [
            values | dict(zip(unsure, case, strict=True))
            for case in product((True, False), repeat=len(unsure))
        ]
        if len({boolean_value(formula, case) for case in cases}) > 1:
            cases = self._possible(part, unsure, cases)
        found = {boolean_value(formula, case) for case in cases}
        return found.pop() if len(found) == 1 else None

    def _possible(
        self, part: _Part, unsure: Sequence[AtomKey], cases: Sequence[dict[AtomKey, bool]]
    ) -> list[dict[AtomKey, bool]]:
        """The cases in which every effector can be on the stated sides of its regions."""
        self.tick()
        time = self._over(part.segment, part.inputs, (part.first, part.last))
        found = list(cases)
        for effector in sorted({atom.effector for atom in unsure}):
            own = [a for a in unsure if a.effector == effector]
            box = None if time is None or len(own) < 2 else box_around(time, effector - 1)
            if box is None:
                continue
            for case in product((True, False), repeat=len(own)):
                sides = [
                    [
                        self.regions[a].polytope
                        for a, is_in in zip(own, case, strict=True)
                        # An effector may be in the region without having the pose.
                        if is_in is side and (side or not a.poses)
                    ]
                    for side in (True, False)
                ]
                if not may_be(box, *sides):
                    found = [c for c in found if [c[a] for a in own] != list(case)]
        return found

    def _trace(self, numbers: Sequence[int], *, hopeful: bool) -> Trace:
        """The proved bounds of some atoms, or the estimates."""
        step = self.task.step
        ends = [part.first * step for part in self.parts]
        times = list(pairwise([*ends, *(part.last * step for part in self.parts[-1:])]))
        trace: dict[AtomKey, list[Piece]] = {}
        keys = list(self.regions)
        for number in numbers:
            gaps = [part.gaps[number] for part in self.parts]
            trace[keys[number]] = [
                Piece(*time, gap.most_inside, gap.most_outside)
                if hopeful
                else Piece(*time, gap.inside, gap.outside)
                for time, gap in zip(times, gaps, strict=True)
            ]
        return trace

    def _refine(self, level: float, numbers: Sequence[int], limit: int) -> bool:
        """Halve the slices on which some atoms straddle a level; whether there were any.

        There are at most ``limit`` slices afterwards.
        """
        refined: list[_Part] = []
        spare = limit - len(self.parts)
        for part in self.parts:
            most = MOST_SPLITS if part.finite else MOST_UNBOUNDED_SPLITS
            if spare < 1 or part.depth >= most or not part.straddles(level, numbers):
                refined.append(part)
                continue
            spare -= 1
            self.tick()
            middle = (part.first + part.last) / 2
            refined += [
                self._part(part.segment, part.inputs, span, part.depth + 1, part.gaps)
                for span in ((part.first, middle), (middle, part.last))
            ]
        if len(refined) == len(self.parts):
            return False
        self.parts = refined
        return True

    def _part(
        self,
        segment: TubeSegment,
        u: Sequence[arb],
        span: tuple[Fraction, Fraction],
        depth: int,
        known: tuple[Gap, ...],
    ) -> _Part:
        """A slice of a segment; ``known`` are the gaps of the slice that it is part of."""
        first, last = span
        time = self._over(segment, u, span)
        if time is None:
            return _Part(segment, u, first, last, depth, known, finite=False)
        gaps = tuple(
            region.over(time, atom.effector - 1).at_best(gap)
            for (atom, region), gap in zip(self.regions.items(), known, strict=True)
        )
        return _Part(segment, u, first, last, depth, gaps)

    def _over(
        self, segment: TubeSegment, u: Sequence[arb], span: tuple[Fraction, Fraction]
    ) -> Slice | None:
        """Positions over a slice, its ends in units of the step; None if not finite."""
        first, last = span
        middle = ball(((first + last) / 2 - segment.steps[0]) * self.task.step)
        return self.point_map.over(segment, u, middle, ball((last - first) / 2 * self.task.step))


# --- The regions that a point can be in together, if enclosures do not decide each one ------------
#
# When a point enters a region it is on the boundary, and its side can never be decided.  Still it
# is on one side; and between two regions that touch, it is in one of them.


THICKNESS = Fraction(1, 2**60)
"""How far, in metres, a box is widened along an axis along which a point does not move."""


def box_around(time: Slice, point: int) -> Polytope | None:
    """An exact box, with interior, around the positions in a slice; None if unbounded."""
    dimension = len(time.points[point])
    rows = []
    for axis in range(dimension):
        normal = [Fraction(axis == other) for other in range(dimension)]
        value = time.form([arb(int(entry)) for entry in normal], point)[0]
        if not value.is_finite():
            return None
        low, high = _exact(value.lower()), _exact(value.upper())
        if low == high:
            low, high = low - THICKNESS, high + THICKNESS
        rows.append(ir.HalfSpace(tuple(normal), high))
        rows.append(ir.HalfSpace(tuple(-entry for entry in normal), -low))
    return Polytope(tuple(rows))


def may_be(box: Polytope, within: Sequence[Polytope], without: Sequence[Polytope]) -> bool:
    """Whether a point of a box might be in some closed regions and outside the others.

    The answer may be True wrongly, but a False is proved exactly.
    """
    place = box
    for region in within:
        place = place.intersection(region)
        if place.is_empty:
            return False
    if not place.has_interior:
        return not any(region.contains(place) for region in without)
    parts = (region.intersection(place) for region in without)
    return bool(remainder(place.irredundant(), [part for part in parts if part.has_interior]))


def _exact(value: arb) -> Fraction:
    """The rational value of a ball of radius zero."""
    mantissa, exponent = value.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)

"""The conditions of a ``reach`` clause at the end of a motion, or of all disturbed motions.

Without a duration they are about the last instant, at which the sets of states are known best. With
a duration of d seconds they are about every instant of [T - d, T], also between the steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from flint import arb

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import ball
from compiler.robots.state_and_input import rates_unit
from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import CheckedCondition, least
from solvers.verifier.proofs.enclosure import TubeSegment
from solvers.verifier.proofs.least_margins import close_margins
from solvers.verifier.proofs.point_map import PointMap, Slice
from solvers.verifier.proofs.scene import Scene
from solvers.verifier.proofs.state_limits import StateLimit, check_limits
from solvers.verifier.proofs.tube_checks import (
    Constraint,
    Inside,
    Status,
    Stretch,
    check_segment,
    rows_of,
)
from solvers.verifier.proofs.turned import pose_name, poses_of
from solvers.verifier.proofs.zonotope import Zonotope


def target_name(reach: ir.Reach) -> str:
    """The name of the condition on positions."""
    return f"target {reach.region}"


FINAL_RATES = "rest at the end", "rates"
"""How the names of conditions on rates begin, at the end and where a load changes hands."""


def rates_name(rates: ir.FinalRates) -> str:
    """The name of the condition on rates."""
    return "rest at the end" if rates.bound == ir.REST_RATE else "rates at the end"


def end_names(task: ir.Task) -> frozenset[str]:
    """The names of all conditions on the end of a motion."""
    if task.reach is None:
        return frozenset()
    reach, rates = task.reach, task.reach.rates
    poses = [pose_name(reach, number) for number in range(len(reach.poses))]
    return frozenset([target_name(reach), *poses] + ([] if rates is None else [rates_name(rates)]))


def end_positions(scene: Scene, effector: int) -> list[Constraint]:
    """The position and orientation of an effector (from 0) at the end; empty without ``reach``."""
    reach = scene.task.reach
    if reach is None:
        return []
    region = scene.polytope(scene.workspace.region(reach.region))
    target = Inside(target_name(reach), (effector,), rows=rows_of(region))
    return [target, *poses_of(scene, reach, effector)]


def at_instant(places: Sequence[Sequence[arb]], time: float) -> Slice:
    """A slice that is one instant, with all points known, (points, d)."""
    none = arb(0)
    points = tuple(tuple((x, none, none) for x in place) for place in places)
    return Slice(arb(time), none, points)


def held_at(condition: Constraint, at: Slice) -> CheckedCondition:
    """The result for a condition at an instant."""
    gap, _ = condition.bound(at)
    time = float(at.time.mid())
    return least(condition.name, [gap], condition.unit, time, condition.where(at))


def known_at(
    point_map: PointMap,
    condition: Constraint,
    state: Sequence[arb],
    states: Zonotope | None,
    time: float,
) -> CheckedCondition:
    """The result for a condition at an instant: with a box of states or, if known, with a set."""
    found = held_at(condition, at_instant(point_map.positions(state), time))
    if found.status is Status.UNDECIDED and states is not None:
        found = held_at(condition, replace(point_map.instant(states), time=arb(time)))
    return found


@dataclass(slots=True)
class FinalRates(StateLimit):
    """All rates of the joints, q' = D y', are within a bound; ``rows`` are those of D."""

    rows: tuple[tuple[int, ...], ...] = ()

    def sums(self, size: int) -> list[list[int]]:
        """The joints' rates as sums of entries of a state."""
        none = [0] * len(self.rows)
        return [[*none, *row, *[0] * (size - 2 * len(row))] for row in self.rows]

    def gap_of(self, value: arb) -> arb:
        """The distance of a rate from the bound."""
        return arb("inf") if self.upper is None else self.upper - abs(value)

    def gaps(self, state: Sequence[arb]) -> list[arb]:
        """The distance of each joint's rate from the bound, for a state given as balls."""
        rows = self.sums(len(state))
        rates = (sum((w * x for w, x in zip(row, state, strict=True) if w), arb(0)) for row in rows)
        return [self.gap_of(rate) for rate in rates]

    def gaps_of(self, states: Zonotope) -> list[arb]:
        """The distance of each joint's rate from the bound, on a set that couples the rates."""
        return [self.gap_of(value) for value in states.values(self.sums(len(states.middle)))]


def slow_at(
    rates: FinalRates, state: Sequence[arb], states: Zonotope | None, time: float
) -> CheckedCondition:
    """Whether all rates are within the bound at an instant, computed as in ``known_at``."""
    found = least(rates.name, rates.gaps(state), rates.unit, time)
    if found.status is Status.UNDECIDED and states is not None:
        found = least(rates.name, rates.gaps_of(states), rates.unit, time)
    return found


def final_rates(graph: RobotGraph, rates: ir.FinalRates) -> FinalRates:
    """The bound of all rates at the end, in balls."""
    rows = tuple(tuple(row) for row in graph.coordinates.rows)
    unit = rates_unit(graph.model)
    return FinalRates(rates_name(rates), unit, (), None, ball(rates.bound), rows=rows)


@dataclass(slots=True)
class EndConditions:
    """A ``reach`` clause along a tube; ``effector`` is the one that reaches, from 0.

    ``first`` is the time in steps from which it applies, if it applies for a duration.
    """

    scene: Scene
    effector: int
    positions: list[Constraint] = field(init=False)
    rates: FinalRates | None = None
    first: Fraction | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        task, reach = self.scene.task, self.scene.task.reach
        self.positions = end_positions(self.scene, self.effector)
        if reach is None:
            return
        if reach.rates is not None:
            self.rates = final_rates(self.scene.graph, reach.rates)
        if task.stay:
            self.first = max(Fraction(0), task.steps - task.stay / task.step)

    def add(self, point_map: PointMap, segment: TubeSegment, inputs: Sequence[arb]) -> None:
        """Check the clause over the part of the next segment to which it applies."""
        if self.first is None or segment.steps[1] <= self.first:
            return
        step, before = self.scene.task.step, self.first - segment.steps[0]
        start = ball(before * step) if before > 0 else arb(0)
        middle, half = (segment.length + start) / 2, (segment.length - start) / 2
        limits = [] if self.rates is None else [self.rates]
        part = Stretch(segment, inputs, middle, half, 0)
        check_segment(point_map, part, self.positions)
        check_limits(part, limits)

    def conditions(
        self, point_map: PointMap, last: Sequence[arb], states: Zonotope | None
    ) -> Iterator[CheckedCondition]:
        """The conditions for a complete tube; ``last`` is a state at its end, one of ``states``."""
        task = self.scene.task
        rates, end = self.rates, float(task.step * task.steps)
        if self.first is not None:
            close_margins(point_map, self.positions)
            for each in self.positions:
                yield CheckedCondition(
                    each.name, each.status, each.margin, each.unit, each.time, each.place
                )
            if rates is not None:
                yield CheckedCondition(
                    rates.name, rates.status, rates.margin, rates.unit, rates.time
                )
            return
        for each in self.positions:
            yield known_at(point_map, each, last, states, end)
        if rates is not None:
            yield slow_at(rates, last, states, end)

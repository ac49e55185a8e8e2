"""The positions of effectors at coordinates that a task gives, for all robots of a small family."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from compiler.checks.starting_robots import starting_robots
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import (
    BALLS,
    ball,
    closed_ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.tape import UndefinedValueError, tape
from compiler.robots.robot import RobotModel
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir

PRECISION = 128
"""Bits of the computation."""


@dataclass(frozen=True, slots=True)
class GivenPositions:
    """For each robot that fits the coordinates, its effectors' positions, (e, d) balls in metres.

    A ball contains the positions for all values of the parameters.
    """

    robots: tuple[tuple[tuple[arb, ...], ...], ...]

    def outside(self, effector: int, region: Polytope) -> bool:
        """Whether an effector, from 1, is certainly outside a region, whatever the robot."""
        return self._all(effector, region, inside=False)

    def inside(self, effector: int, region: Polytope) -> bool:
        """Whether an effector, from 1, is certainly inside a region, whatever the robot."""
        return self._all(effector, region, inside=True)

    def _all(self, effector: int, region: Polytope, *, inside: bool) -> bool:
        found = [tips[effector - 1] for tips in self.robots if effector <= len(tips)]
        with working_precision(PRECISION):
            return bool(found) and all(_is(point, region, inside=inside) for point in found)


def given_positions(program: ir.Program, task: ir.Task, start: ir.StartAt) -> GivenPositions | None:
    """The positions at a given start; None if there are too many robots, or one is undefined."""
    robots = starting_robots(program, task, start)
    if robots is None:
        return None
    found = []
    for model, given in robots:
        if given.fault:
            continue
        try:
            found.append(_tips(model, given.values))
        except (UndefinedValueError, ValueError, ZeroDivisionError):
            return None
    return GivenPositions(tuple(found))


def _tips(model: RobotModel, values: Sequence[ir.Expr]) -> tuple[tuple[arb, ...], ...]:
    """The positions of the effectors of a robot with these coordinates."""
    graph = robot_graph(model)
    with working_precision(PRECISION):
        theta = [_all_values(parameter.domain) for parameter in model.parameters]
        constants = [constant_ball(constant) for constant in graph.constants]
        coordinates = [closed_ball(value) for value in values]
        flat = tape(graph.effectors).evaluate([*coordinates, *theta, *constants], BALLS)
        d = model.dimension
        return tuple(tuple(flat[i : i + d]) for i in range(0, len(flat), d))


def _all_values(domain: ir.Interval | ir.Choices) -> arb:
    ends = [domain.lower, domain.upper] if isinstance(domain, ir.Interval) else domain.values
    first, *others = (closed_ball(value) for value in ends)
    for other in others:
        first = first.union(other)
    return first


def _is(point: Sequence[arb], region: Polytope, *, inside: bool) -> bool:
    gaps = [
        ball(row.offset)
        - sum((ball(a) * x for a, x in zip(row.normal, point, strict=True)), arb(0))
        for row in region.rows
    ]
    if inside:
        return all(bool(gap > 0) for gap in gaps)
    return any(bool(gap < 0) for gap in gaps)

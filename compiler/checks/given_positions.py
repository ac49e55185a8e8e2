"""Where effectors are at the coordinates that a task gives, of all robots of a small family."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

from flint import arb

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import (
    BALLS,
    ball,
    closed_ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.tape import UndefinedValueError, tape
from compiler.robots.candidate import robot_in_task
from compiler.robots.frame_table import SemanticsError
from compiler.robots.given_start import given_start
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.words.budget import BudgetExceededError
from compiler.words.finite_automaton import AutomatonTooLargeError
from compiler.words.intersection import IntersectionTooLargeError
from compiler.words.structures import InfiniteAmbiguityError, structures_of
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir

MOST_ROBOTS = 8
"""Families with more are passed over: a check is to be quick."""
PRECISION = 128
"""Bits of what is computed."""


@dataclass(frozen=True, slots=True)
class GivenPositions:
    """Per robot that fits the coordinates the positions of its effectors, (e, d) balls in metres.

    A ball holds the positions for all values of the parameters.
    """

    robots: tuple[tuple[tuple[arb, ...], ...], ...]

    def outside(self, effector: int, region: Polytope) -> bool:
        """Whether an effector, from 1, is outside a region for certain, whatever the robot."""
        return self._all(effector, region, inside=False)

    def inside(self, effector: int, region: Polytope) -> bool:
        """Whether it is inside for certain."""
        return self._all(effector, region, inside=True)

    def _all(self, effector: int, region: Polytope, *, inside: bool) -> bool:
        found = [tips[effector - 1] for tips in self.robots if effector <= len(tips)]
        with working_precision(PRECISION):
            return bool(found) and all(_is(point, region, inside=inside) for point in found)


def given_positions(program: ir.Program, task: ir.Task, start: ir.StartAt) -> GivenPositions | None:
    """The positions at a given start; None where the robots are too many, or one is unclear."""
    try:
        family = family_of(program, task)
        if not family.language.is_finite(max_modules=task.modules):
            return None
        words = family.language.words(max_modules=task.modules)
        known = list(islice(structures_of(family.language, words), MOST_ROBOTS + 1))
    except (
        AutomatonTooLargeError,
        BudgetExceededError,
        InfiniteAmbiguityError,
        IntersectionTooLargeError,
        SemanticsError,
    ):
        return None
    if len(known) > MOST_ROBOTS:
        return None
    found = []
    for derivation in known:
        try:
            model = robot_in_task(family, task.origin, derivation)
        except SemanticsError:
            continue
        given = given_start(model, start)
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

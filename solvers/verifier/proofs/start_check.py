"""Check that the robot is physically possible and starts as its task allows."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import BALLS, ball, closed_ball, scalar_balls
from compiler.expressions.tape import tape
from compiler.robots.given_start import given_start
from compiler.robots.robot import RobotModel, amounts_of
from compiler.robots.state_and_input import common_unit, rates_unit
from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition, inside, least
from solvers.verifier.proofs.held_start import held_start
from solvers.verifier.proofs.scene import Motion, Scene
from solvers.verifier.proofs.tube_checks import Status


def positive_mass(graph: RobotGraph, state: Sequence[arb], tail: Sequence[arb]) -> CheckedCondition:
    """Check that M is positive definite at the start: all pivots of its LDL^T are positive.

    Along the tube the pivots stay away from zero, or the enclosure would fail, so M stays positive
    definite.
    """
    n = len(graph.model.dofs)
    flat = tape(graph.mass_matrix).evaluate([*state[:n], *tail], BALLS)
    matrix = [[flat[j * n + i] for j in range(n)] for i in range(n)]
    least_pivot = arb("inf")
    for k in range(n):
        pivot = matrix[k][k]
        least_pivot = least_pivot.min(pivot)
        if not pivot > 0:
            break
        for i in range(k + 1, n):
            for j in range(k + 1, n):
                matrix[i][j] = matrix[i][j] - matrix[i][k] * matrix[k][j] / pivot
    unit = common_unit(graph.model, "kg*m^2", "kg")
    return least("mass matrix positive definite", [least_pivot], unit, 0.0)


def unphysical(model: RobotModel, tail: Sequence[arb]) -> list[CheckedCondition]:
    """A failing condition for each negative amount of a body or a shape.

    Amounts are lengths, masses, densities, radii, sizes and moments of inertia.
    """
    scalars = scalar_balls(model.scalars, tail)
    amounts = [(f"body {number}", amounts_of(body)) for number, body in enumerate(model.bodies, 1)]
    amounts += [(f"shape {number}", shape.sizes) for number, shape in enumerate(model.shapes, 1)]
    return [
        CheckedCondition(f"amounts of {name}", Status.FAILS, float(scalars[i].mid()), "SI", 0.0)
        for name, own in amounts
        for i in own
        if scalars[i] < 0
    ]


def start_conditions(
    scene: Scene,
    motion: Motion,
    state: Sequence[arb],
    tail: Sequence[arb],
    tips: Sequence[Sequence[arb]],
) -> list[CheckedCondition]:
    """Check that the task allows the initial state; ``tips`` are the effectors' positions there.

    ``tail`` holds the balls of theta and k.
    """
    start, n = scene.task.start, len(scene.model.dofs)
    rates, unit = [abs(value) for value in motion.state[n:]], rates_unit(scene.model)
    if isinstance(start, ir.StartAt):
        return [_pose(scene, start, state), _rates("start at rest", rates, Fraction(0), unit)]
    region = scene.polytope(scene.workspace.region(start.region))
    number = motion.effector if start.effector is None else start.effector - 1
    found = [
        inside(f"start {start.region}", region, tips[number], 0.0),
        _rates("start rates", rates, start.rates, unit),
    ]
    return [*found, held_start(scene, state, tail)] if start.held else found


def _pose(scene: Scene, start: ir.StartAt, state: Sequence[arb]) -> CheckedCondition:
    """Check that the coordinates are those of the task, except for values without a decimal.

    The coordinates do not contain joints that are merged or left out: the value of each of these
    has to be in its own range.
    """
    given = given_start(scene.model, start)
    if given.fault:
        return CheckedCondition("start pose", Status.FAILS, -1.0, "SI", 0.0, why=given.fault)
    exact = [closed_ball(value) for value in given.values]
    own = [_weighed(row, state) for row in scene.graph.coordinates.rows]
    near = [ball(Fraction(1, 10**9)) - abs(s - e) for s, e in zip(own, exact, strict=True)]
    found = least("start pose", near, "SI", 0.0)
    if given.undecided and found.status is Status.HOLDS:
        number = given.undecided[0].number + 1
        why = f"value {number} of the start may be out of the range of its joint"
        return CheckedCondition("start pose", Status.UNDECIDED, 0.0, "SI", 0.0, why=why)
    margin = NO_MARGIN if found.status is Status.HOLDS else found.margin
    return CheckedCondition(found.name, found.status, margin, "SI", 0.0)


def _rates(name: str, rates: Sequence[Fraction], bound: Fraction, unit: str) -> CheckedCondition:
    """Check that no rate is larger than a bound; a start at rest has no margin."""
    gap = bound - max(rates, default=Fraction(0))
    if gap < 0:
        return CheckedCondition(name, Status.FAILS, float(gap), unit, 0.0, exact=True)
    margin = float(gap) if bound else NO_MARGIN
    return CheckedCondition(name, Status.HOLDS, margin, unit, 0.0, exact=True)


def _weighed(weights: Sequence[int], values: Sequence[arb]) -> arb:
    return sum((w * x for w, x in zip(weights, values, strict=False) if w), arb(0))

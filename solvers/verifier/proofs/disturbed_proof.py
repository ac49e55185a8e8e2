"""The proof that a robot does its task whatever the disturbances that the task names.

One tube holds the motions from every start within the radii, under all inputs that differ at any
instant from what is stated by no more than their part.  Where motions go on for ever, another tube
holds all that begin a round in the set of the loop.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.tasks.specification import disturbance_radii, input_errors, uncertain_masses
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition, decisive, inside
from solvers.verifier.proofs.control_law import InputError
from solvers.verifier.proofs.effort_bounds import effort_conditions
from solvers.verifier.proofs.enclosure import Accuracy
from solvers.verifier.proofs.end_conditions import (
    end_names,
    final_rates,
    rates_name,
    target_name,
)
from solvers.verifier.proofs.endless_conditions import unless_open
from solvers.verifier.proofs.instant_conditions import position_conditions, state_limits
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.scene import Motion, Scene, Watch
from solvers.verifier.proofs.tube_checks import Status
from solvers.verifier.proofs.tube_proof import (
    DrivenRobot,
    driven_robot,
    follow,
)
from solvers.verifier.proofs.zonotope import InitialSet


def disturbed_findings(
    scene: Scene,
    motion: Motion,
    planned: Sequence[CheckedCondition],
    accuracy: Accuracy,
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """The conditions on the planned motion, replaced by those on all disturbed ones.

    Where the tube ends early, what has to hold until the end is not decided.
    """
    with working_precision(accuracy.bits):
        robot = driven_robot(scene, motion, disturbed=True)
        initial = disturbed_start(scene, robot.state)
        followed = follow(robot, initial, input_error(scene), accuracy, watch)
        found = followed.so_far() if followed.ended else followed.conditions()
        if motion.law is not None:
            found += effort_conditions(scene.model, scene.task, followed.commanded)
    if motion.loop is not None:
        found = unless_open(found)
    told = [_told(each) for each in found]
    if followed.ended:
        told = _cut_short(scene, planned, told, followed.time)
    # Two conditions may have the same name: all of either kind go together.
    names = {each.name for each in told}
    return (*(each for each in planned if each.name not in names), *told)


def _cut_short(
    scene: Scene, planned: Sequence[CheckedCondition], told: Sequence[CheckedCondition], time: float
) -> list[CheckedCondition]:
    """What is not proved by a tube that ends early; ``told`` is what it shows up to there."""
    ended = CheckedCondition(
        "disturbed motions", Status.UNDECIDED, -NO_MARGIN, "", time,
        why="the enclosure of the disturbed motions ends",
    )  # fmt: skip
    known = [each for each in told if each.status is not Status.HOLDS]
    about = {each.name for each in told} | end_names(scene.task)
    rest = [
        replace(ended, name=each.name, margin=NO_MARGIN, unit=each.unit)
        for each in planned
        if (each.name in about or each.clause is not None)
        and each.name not in {item.name for item in known}
    ]
    return [*known, ended, *rest]


def with_counterexample(
    scene: Scene,
    motion: Motion,
    conditions: tuple[CheckedCondition, ...],
    accuracy: Accuracy,
    watch: Watch,
) -> tuple[CheckedCondition, ...]:
    """The conditions, with a violation by a disturbed motion where one is found of what is open."""
    worst = decisive(conditions)
    # Corners are simulated in an open loop alone.
    if worst is None or worst.status is Status.FAILS or motion.law is not None:
        return conditions
    reach = scene.task.reach
    target = None if reach is None else target_name(reach)
    for each in conditions:
        # What has no margin is open because the tube ends, not because it is nearly violated.
        lost = each.status is Status.UNDECIDED and each.margin < NO_MARGIN
        if lost or each.name == target:
            found = counterexample(
                scene,
                motion,
                each.name,
                disturbance_radii(scene.task, scene.model),
                accuracy,
                watch,
            )
            if found is not None:
                return tuple(found if item is each else item for item in conditions)
    return conditions


def _told(condition: CheckedCondition) -> CheckedCondition:
    """A condition on all disturbed motions, with the reason where they are too many to prove it."""
    if condition.status is not Status.UNDECIDED or condition.why:
        return condition
    why = f"the enclosure of the disturbed motions outgrows the margin of `{condition.name}`"
    return replace(condition, why=why)


def input_error(scene: Scene) -> InputError | None:
    """How far inputs may be from what is commanded; None: not at all."""
    part, most = input_errors(scene.task, scene.model)
    if not part and not any(most):
        return None
    return InputError(ball(part), tuple(ball(value) for value in most))


def disturbed_start(scene: Scene, state: Sequence[arb]) -> InitialSet:
    """The states in which a robot may be at first, in the graph's coordinates.

    The task's radii are about the joints' coordinates and rates, q = D y; the graph's are y.  The
    factors of uncertain masses are the last entries.
    """
    radii = disturbance_radii(scene.task, scene.model)
    n, columns = len(scene.model.dofs), list[list[Fraction]]()
    moved = [number for number, radius in enumerate(radii) if radius]
    for number in moved:
        unit = [Fraction(int(i == number % n)) for i in range(n)]
        column = scene.graph.coordinates.solved_for(unit)
        none = [Fraction(0)] * n
        whole = [*column, *none] if number < n else [*none, *column]
        columns.append([*whole, *[Fraction(0)] * (len(state) - 2 * n)])
    lengths = [radii[number] for number in moved]
    masses = uncertain_masses(scene.task, scene.model)
    for number, item in enumerate(masses, len(state) - len(masses)):
        columns.append([Fraction(int(i == number)) for i in range(len(state))])
        lengths.append(item.part)
    rows = tuple(tuple(ball(column[i]) for column in columns) for i in range(len(state)))
    return InitialSet(tuple(state), rows, tuple(ball(length) for length in lengths))


# --- A disturbed motion that violates what could not be proved of all of them ---------------------
#
# Candidates are the corners of the disturbances: every coordinate and rate of the start at an end
# of its interval, every input off by the same part of itself all the time.  Which corner is worst,
# is guessed from one float simulation per end; that it violates the task, is proved like any
# motion.


SUBSTEPS = 4
"""Of Runge and Kutta's method, per step of the task."""


@dataclass(frozen=True, slots=True)
class Measure:
    """How far a state is from a violation; ``at_end``: only that of the last sample counts."""

    of: Callable[[DrivenRobot, Sequence[arb]], float]
    at_end: bool = False


@dataclass(frozen=True, slots=True)
class Corner:
    """Per coordinate and rate, then per input: at which end it is, -1 or 1; 0: as planned."""

    start: tuple[int, ...]
    inputs: tuple[int, ...]

    def moved(self, number: int, sign: int) -> Corner:
        """With one of the entries at another end."""
        items = [*self.start, *self.inputs]
        items[number] = sign
        return Corner(tuple(items[: len(self.start)]), tuple(items[len(self.start) :]))

    def motion(self, motion: Motion, radii: Sequence[Fraction], part: Fraction) -> Motion:
        """The motion so disturbed: states by ``radii`` (2 n,), SI, inputs by a ``part`` of them."""
        state = [x + s * r for x, s, r in zip(motion.state, self.start, radii, strict=True)]
        factors = [1 + sign * part for sign in self.inputs]
        inputs = (tuple(f * u for f, u in zip(factors, u, strict=True)) for u in motion.inputs)
        return replace(motion, state=tuple(state), inputs=tuple(inputs))


def counterexample(
    scene: Scene,
    motion: Motion,
    name: str,
    radii: Sequence[Fraction],
    accuracy: Accuracy,
    watch: Watch,
) -> CheckedCondition | None:
    """A violation by a disturbed motion of the condition of that name, or None.

    ``radii`` are those of coordinates and rates.  Formulas are not looked at.
    """
    part = Fraction(0) if scene.task.robust is None else scene.task.robust.effort
    with working_precision(accuracy.bits):
        measure = _measure(scene, motion, name)
        if measure is None:
            return None
        corner = _worst_corner(scene, motion, measure, radii, part)
        watch.tick()
        disturbed = driven_robot(scene, corner.motion(motion, radii, part))
        followed = follow(disturbed, InitialSet(disturbed.state), None, accuracy, watch)
        found = followed.so_far() if followed.ended else followed.conditions()
    for each in found:
        if each.name == name and each.status is Status.FAILS:
            return replace(each, why=f"{each.name}: violated by a disturbed motion")
    return None


def _worst_corner(
    scene: Scene, motion: Motion, measure: Measure, radii: Sequence[Fraction], part: Fraction
) -> Corner:
    """The corner at which each disturbance alone does more harm than at its other end."""
    count = len(motion.inputs[0]) if motion.inputs else 0
    worst = planned = Corner((0,) * len(radii), (0,) * count)
    sizes = [*radii, *(part,) * count]
    for number, size in enumerate(sizes):
        if not size:
            continue
        values = {
            sign: _worst_value(
                scene, planned.moved(number, sign).motion(motion, radii, part), measure
            )
            for sign in (-1, 1)
        }
        worst = worst.moved(number, -1 if values[-1] < values[1] else 1)
    return worst


def _worst_value(scene: Scene, motion: Motion, measure: Measure) -> float:
    """The least of what is measured along a simulation; infinite where there is none."""
    robot, states = driven_robot(scene, motion), list(_simulated(scene, motion))
    return min(
        (
            measure.of(robot, [arb(x) for x in state.tolist()])
            for state in (states[-1:] if measure.at_end else states)
        ),
        default=float("inf"),
    )


def _simulated(scene: Scene, motion: Motion) -> Iterator[Array]:
    """The states at the samples, in floats, as long as they are finite."""
    robot = driven_robot(scene, motion)
    x = np.array([float(item) for item in robot.state])
    tail = [float(item) for item in robot.tail]
    count, n, h = len(scene.graph.model.parameters), len(scene.model.dofs), float(scene.task.step)

    def rate(x: Array, u: Array) -> Array:
        pull = scene.graph.acceleration(x[:n], x[n:], u, tail[:count], tail[count:])
        return np.concatenate([x[n : 2 * n], np.asarray(pull, dtype=np.float64).ravel()])

    yield x
    for row in motion.inputs:
        u = np.array([float(value) for value in row])
        for _ in range(SUBSTEPS):
            d = h / SUBSTEPS
            a = rate(x, u)
            b = rate(x + d / 2 * a, u)
            c = rate(x + d / 2 * b, u)
            x = x + d / 6 * (a + 2 * b + 2 * c + rate(x + d * c, u))
        if not np.isfinite(x).all():
            return
        yield x


def _measure(scene: Scene, motion: Motion, name: str) -> Measure | None:
    """The distance of a state from a violation of the condition of that name."""
    robot = driven_robot(scene, motion)
    conditions = {item.name: item for item in position_conditions(scene, robot.tail)}
    limits = {item.name: item for item in state_limits(scene, robot.field.size)}
    if name in conditions:
        condition = conditions[name]
        return Measure(lambda robot, state: float(condition.bound(_still(robot, state))[1].mid()))
    if name in limits:
        return Measure(lambda _, state: float(limits[name].gap(state).mid()))
    reach = scene.task.reach
    if reach is not None and name == target_name(reach):
        target = scene.polytope(scene.workspace.region(reach.region))
        return Measure(
            lambda robot, state: (
                inside(name, target, robot.point_map.positions(state)[motion.effector], 0.0).margin
            ),
            at_end=True,
        )
    if reach is not None and reach.rates is not None and name == rates_name(reach.rates):
        rates = final_rates(scene.graph, reach.rates)
        return Measure(lambda _, state: float(rates.gap(state).lower()), at_end=True)
    return None


def _still(robot: DrivenRobot, state: Sequence[arb]) -> Slice:
    points = robot.point_map.positions(state)
    none = arb(0)
    return Slice(none, none, tuple(tuple((x, none, none) for x in point) for point in points))

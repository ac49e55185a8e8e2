"""A tube held against everything that a task asks of a motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from textwrap import shorten

from flint import arb

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import (
    BALLS,
    ball,
    closed_ball,
    constant_ball,
    scalar_balls,
)
from compiler.expressions.tape import Tape, tape
from compiler.robots.robot import RobotModel, RodBody
from compiler.robots.state_and_input import robot_inputs, robot_states
from compiler.tasks.formula_parts import atoms, formula_text
from compiler.tasks.monitor import key
from compiler.tasks.specification import measurement_radii, uncertain_masses
from grammar_lang import ir
from solvers.verifier.proofs.apart import Apart
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.control_law import InputError, SampledLaw, open_loop, sampled_law
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, TubeSegment, tube
from solvers.verifier.proofs.end_conditions import EndConditions
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.point_map import PointMap
from solvers.verifier.proofs.region_distance import region_distance
from solvers.verifier.proofs.scene import Motion, Scene, Watch
from solvers.verifier.proofs.tube_checks import (
    MOST_SPLITS,
    Constraint,
    Inside,
    StateLimit,
    Status,
    Stretch,
    check_segment,
    close_margins,
    rows_of,
)
from solvers.verifier.proofs.vector_field import Curvature, VectorField
from solvers.verifier.proofs.zonotope import InitialSet, Zonotope

LONGEST_TEXT = 72
"""Characters of a formula in a report."""


@dataclass(frozen=True, slots=True)
class DrivenRobot:
    """A robot of which everything is known but where it begins, in balls.

    ``state`` is the planned start in the graph's coordinates, ``inputs`` the stated inputs per
    step.  With a ``law`` the state ends with the inputs that it holds.
    """

    scene: Scene
    motion: Motion
    graph: RobotGraph
    field: VectorField
    point_map: PointMap
    state: tuple[arb, ...]
    inputs: tuple[tuple[arb, ...], ...]
    law: SampledLaw | None = None

    @property
    def tail(self) -> tuple[arb, ...]:
        """The balls of theta and k."""
        return self.field.tail


def driven_robot(scene: Scene, motion: Motion, *, disturbed: bool = False) -> DrivenRobot:
    """A motion in the working precision.

    Where it is ``disturbed``, measurements have the task's errors, and the last entries of the
    state are the factors of uncertain masses.  A law is rounded there, and where the task names no
    disturbances, so that there is no other proof.
    """
    model, task = scene.model, scene.task
    masses = uncertain_masses(task, model) if disturbed else ()
    law = motion.law
    if law is None and masses:
        law = open_loop(motion.inputs, 2 * len(model.dofs))
    graph = scene.graph if law is None else scene.graph.holding_inputs
    graph = graph.weighed([item.bodies for item in masses]) if masses else graph
    tail = tuple(value.ball for value in motion.theta)
    tail += tuple(constant_ball(constant) for constant in graph.constants)
    own, n = robot_states(graph.model), len(graph.model.dofs)
    still = 0 if law is None else len(robot_inputs(model)) + len(masses)
    slopes = tape(graph.input_slopes) if task.robust is not None else None
    curvature = None
    if task.robust is not None:
        second, places = graph.curvature
        curvature = Curvature(tape(second), places)
    field = VectorField(
        tape(graph.balance), tape(graph.variation), n, tail, len(own) + still, slopes, curvature
    )
    moves = None if task.robust is None else tape(graph.point_slopes)
    point_map = PointMap(tape(graph.points), field, graph.model.dimension, moves)
    exact = [graph.coordinates.solved_for(part) for part in (motion.state[:n], motion.state[n:])]
    state = [ball(value) for part in exact for value in part]
    state += [arb(0) if item.initial is None else closed_ball(item.initial) for item in own]
    if law is None:
        inputs = tuple(tuple(ball(value) for value in step) for step in motion.inputs)
        return DrivenRobot(scene, motion, graph, field, point_map, tuple(state), inputs)
    noise = measurement_radii(task, model) if disturbed else ()
    rounding = law.rounding if disturbed or task.robust is None else ()
    rows = graph.coordinates.rows
    sampled = sampled_law(law, motion.inputs, rows, noise, rounding, len(own))
    state += [arb(0)] * (still - len(masses)) + [arb(1)] * len(masses)
    return DrivenRobot(
        scene, motion, graph, field, point_map, tuple(state), sampled.inputs, sampled
    )


@dataclass(slots=True)
class Followed:
    """What a tube shows, as far as it goes; ``samples`` are the states at the steps.

    ``commanded`` are the inputs that a law commands, a row per step; none without one.  ``last``
    is the set of states at the last of the ``samples``.  ``ended`` says why it goes no farther than
    ``time``, empty where it is complete.
    """

    robot: DrivenRobot
    constraints: list[Constraint]
    limits: list[StateLimit]
    defined: Defined
    formulas: FormulaProof
    end: EndConditions
    samples: list[Sequence[arb]]
    commanded: list[Sequence[arb]] = field(default_factory=list[Sequence[arb]])
    time: float = 0.0
    ended: str = ""
    last: Zonotope | None = None

    def positions(self) -> list[list[list[arb]]]:
        """Positions (samples, points, d)."""
        return [self.robot.point_map.positions(sample) for sample in self.samples]

    def conditions(self) -> list[CheckedCondition]:
        """All that a complete tube shows, but for what is asked of samples alone."""
        found = self.so_far()
        found += self.end.conditions(self.robot.point_map, self.samples[-1], self.last)
        found += [self._satisfied(*each) for each in enumerate(self.robot.scene.task.satisfy)]
        return found

    def so_far(self) -> list[CheckedCondition]:
        """What has to hold at every instant."""
        found = []
        if self.defined.is_needed:
            item = self.defined
            name = "equations of motion defined"
            found.append(CheckedCondition(name, item.status, NO_MARGIN, "", item.time))
        found += [
            CheckedCondition(c.name, c.status, c.margin, "m", c.time, c.place)
            for c in self.constraints
        ]
        found += [
            CheckedCondition(limit.name, limit.status, limit.margin, limit.unit, limit.time)
            for limit in self.limits
            if limit.margin < NO_MARGIN or limit.status is not Status.HOLDS
        ]
        return found

    def _satisfied(self, number: int, clause: ir.Satisfy) -> CheckedCondition:
        """What is proved of a formula; its margin is a bound of its robustness."""
        text = shorten(formula_text(clause.formula), LONGEST_TEXT, placeholder=" …")
        verdict = self.formulas.verdict(clause.formula)
        return CheckedCondition(
            f"satisfy {number + 1}: {text}", verdict.status, verdict.robustness, "m",
            verdict.time, verdict.place, clause=number, loose=verdict.loose,
        )  # fmt: skip


def follow(
    robot: DrivenRobot,
    initial: InitialSet,
    error: InputError | None,
    accuracy: Accuracy,
    watch: Watch,
) -> Followed:
    """Hold the tube from a set of states against the task.

    ``error`` is how far inputs may be from what is commanded, None: not at all.  What the ``watch``
    raises ends the proof.
    """
    scene, step = robot.scene, robot.scene.task.step
    graph = robot.graph
    found = Followed(
        robot,
        position_conditions(scene, robot.tail),
        state_limits(scene, robot.field.size),
        Defined(tape(graph.conditions), graph.divisors, robot.tail),
        _formulas(scene, robot.point_map, watch.tick),
        EndConditions(scene, robot.motion.effector),
        [],
    )
    ends: dict[int, Sequence[arb]] = {0: box_of(initial)}
    try:
        for segment in tube(
            robot.field, initial, robot.inputs, ball(step), accuracy, error, robot.law
        ):
            watch.tick()
            inputs = segment.inputs
            whole = Stretch.of(segment, inputs)
            check_segment(robot.point_map, whole, found.constraints, found.limits)
            found.end.add(robot.point_map, segment, inputs)
            found.formulas.add(segment, inputs)
            if found.defined.is_needed:
                found.defined.check(segment, inputs)
            found.time = float((segment.start + segment.length).mid())
            if robot.law is not None and segment.number == len(found.commanded):
                found.commanded.append(segment.commanded)
            if segment.steps[1].denominator == 1:
                ends[int(segment.steps[1])], found.last = segment.end, segment.last
                watch.part(int(segment.steps[1]), scene.task.steps)
    except EnclosureFailure as failure:
        found.ended = str(failure)
    close_margins(robot.point_map, found.constraints)
    found.samples = [ends[number] for number in sorted(ends)]
    return found


def box_of(initial: InitialSet) -> list[arb]:
    """The box around a set of states."""
    unit = arb(0, 1)
    if not initial.radii:
        return list(initial.centre)
    return [
        centre + sum((g * r * unit for g, r in zip(row, initial.radii, strict=True)), arb(0))
        for centre, row in zip(initial.centre, initial.generators, strict=True)
    ]


def _formulas(scene: Scene, point_map: PointMap, tick: Callable[[], None]) -> FormulaProof:
    """The atoms of the task's formulas, with the sets they speak of."""
    regions = {
        key(atom): region_distance(scene.polytope(scene.workspace.region(atom.region)))
        for atom in atoms(*(clause.formula for clause in scene.task.satisfy))
    }
    return FormulaProof(point_map, regions, scene.task, tick)


# --- Whether the equations of motion have a value, as written, at every instant of a tube ---------


@dataclass(slots=True)
class Defined:
    """Divisors that are not zero, then radicands that are not negative; the worst answer so far.

    ``tape`` maps (q, w, u, theta, k) to the ``divisors`` first and the radicands behind them;
    ``tail`` holds the balls of theta and k.
    """

    tape: Tape
    divisors: int
    tail: tuple[arb, ...]
    status: Status = Status.HOLDS
    time: float = 0.0

    @property
    def is_needed(self) -> bool:
        """Whether there is anything to check."""
        return self.tape.outputs > 0

    def check(self, segment: TubeSegment, u: Sequence[arb]) -> None:
        """Hold the conditions against one segment of a tube, halving it where they are open."""
        half = segment.length / 2
        pending = [(half, half, 0)]
        while pending and self.status is not Status.FAILS:
            middle, width, depth = pending.pop()
            status = self.over(segment.at(middle + arb(0, 1) * width), u)
            if status is Status.UNDECIDED and depth < MOST_SPLITS:
                quarter = width / 2
                pending += [
                    (centre, quarter, depth + 1) for centre in (middle + quarter, middle - quarter)
                ]
            elif status is not Status.HOLDS:
                self.status, self.time = status, float((segment.start + middle).mid())
                pending = []

    def over(self, state: Sequence[arb], u: Sequence[arb]) -> Status:
        """The conditions on states given as balls."""
        values = self.tape.evaluate([*state, *u, *self.tail], BALLS)
        parts = [_divisor(value) for value in values[: self.divisors]]
        parts += [_radicand(value) for value in values[self.divisors :]]
        if Status.FAILS in parts:
            return Status.FAILS
        return Status.UNDECIDED if Status.UNDECIDED in parts else Status.HOLDS


def _divisor(value: arb) -> Status:
    if value == 0:
        return Status.FAILS
    return Status.HOLDS if value != 0 else Status.UNDECIDED


def _radicand(value: arb) -> Status:
    if value < 0:
        return Status.FAILS
    return Status.HOLDS if value >= 0 else Status.UNDECIDED


# --- What has to hold at every instant of a motion: the task's and the robot's own bounds ---------


def position_conditions(scene: Scene, tail: Sequence[arb]) -> list[Constraint]:
    """Bounds, and every ``avoid``; ``tail`` holds the balls of theta and k."""
    task, workspace, graph = scene.task, scene.workspace, scene.graph
    effectors = tuple(range(len(graph.model.effectors)))
    bounds = rows_of(scene.polytope(workspace.bounds))
    bodies = _bodies(scene, tail)
    found: list[Constraint] = [Inside("bounds", effectors, rows=bounds)]
    if task.bounds_body:
        for name, points, radius in bodies:
            found.append(Inside(f"bounds of {name}", points, rows=bounds, distance=radius))
    several = len(effectors) > 1
    tips = [(f"effector {e + 1}" if several else "effector", (e,), arb(0)) for e in effectors]
    for avoid in task.avoid:
        groups = bodies if avoid.subject == "body" else tips
        for name in avoid.regions:
            region = workspace.region(name)
            found += [_apart(scene, region, avoid.margin, group) for group in groups]
    return found


def _bodies(scene: Scene, tail: Sequence[arb]) -> list[tuple[str, tuple[int, ...], arb]]:
    """Per body its name, its points behind the effectors, and its radius."""
    first = len(scene.model.effectors)
    return [
        (scene.body(i), tuple(first + point for point in hull), _radius(scene.model, i, tail))
        for i, hull in enumerate(scene.graph.hulls)
    ]


def _apart(
    scene: Scene, region: ir.Region, margin: Fraction, group: tuple[str, tuple[int, ...], arb]
) -> Apart:
    name, points, radius = group
    polytope = scene.polytope(region)
    vertices: tuple[tuple[arb, ...], ...] = ()
    if polytope.is_bounded:
        vertices = tuple(tuple(ball(x) for x in vertex) for vertex in polytope.vertices)
    return Apart(
        f"clearance of {name} to {region.name}",
        points,
        rows=rows_of(polytope),
        vertices=vertices,
        distance=ball(margin) + radius,
    )


def _radius(model: RobotModel, body: int, tail: Sequence[arb]) -> arb:
    """The radius of a body: that of a capsule, else zero."""
    item = model.bodies[body]
    if not isinstance(item, RodBody) or item.radius is None:
        return arb(0)
    return scalar_balls(model.scalars, tail)[item.radius]


def state_limits(scene: Scene, size: int) -> list[StateLimit]:
    """Joint and rate limits as balls, on the rows of q = D y; states have ``size`` entries."""
    graph, found = scene.graph, list[StateLimit]()
    none = (0,) * len(graph.model.dofs)
    own = (0,) * (size - 2 * len(graph.model.dofs))
    for number, dof in enumerate(graph.model.dofs):
        row = graph.coordinates.rows[number]
        unit = "rad" if dof.kind == "revolute" else "m"
        for weights, interval, what, measure in (
            ((*row, *none, *own), dof.range, "range", unit),
            ((*none, *row, *own), dof.rate, "rate", f"{unit}/s"),
        ):
            if interval is not None:
                ends = closed_ball(interval.lower), closed_ball(interval.upper)
                found.append(StateLimit(f"{what} of joint {number + 1}", measure, weights, *ends))
    return found

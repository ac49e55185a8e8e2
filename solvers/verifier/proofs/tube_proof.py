"""Check a tube against all conditions that a task sets for a motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from textwrap import shorten

from flint import arb

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.dynamics.rubbing_joints import with_dry_friction
from compiler.expressions.evaluators.balls import (
    ball,
    closed_ball,
    constant_ball,
)
from compiler.expressions.tape import tape
from compiler.robots.state_and_input import dry_friction, robot_inputs, robot_states
from compiler.tasks.monitor import AtomKey, key
from compiler.tasks.specification import measurement_radii, uncertain_masses
from grammar_lang import ir
from grammar_lang.ir.formula_parts import atoms, formula_text
from solvers.verifier.proofs.carried_loads import TransferConditions
from solvers.verifier.proofs.checked_condition import NO_MARGIN, CheckedCondition
from solvers.verifier.proofs.control_law import InputError, SampledLaw, open_loop, sampled_law
from solvers.verifier.proofs.defined import Defined
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, TubeSegment, tube
from solvers.verifier.proofs.end_conditions import EndConditions
from solvers.verifier.proofs.endless_conditions import endless_conditions, reached_some_time
from solvers.verifier.proofs.energy_used import EnergyUsed
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.instant_conditions import (
    acceleration_limits,
    position_conditions,
    state_limits,
)
from solvers.verifier.proofs.least_margins import close_margins
from solvers.verifier.proofs.loop_set import LoopSet, loop_set
from solvers.verifier.proofs.point_map import PointMap
from solvers.verifier.proofs.region_distance import RegionDistance, region_distance
from solvers.verifier.proofs.scene import Motion, Scene, Watch
from solvers.verifier.proofs.state_limits import StateLimit, check_limits
from solvers.verifier.proofs.tube_checks import (
    Constraint,
    Status,
    Stretch,
    check_segment,
)
from solvers.verifier.proofs.turned import PosedRegion, posed_region
from solvers.verifier.proofs.vector_field import Curvature, VectorField
from solvers.verifier.proofs.zonotope import InitialSet, Zonotope, zonotope

FAILED = "a condition fails"
"""The reason why a brief proof ends early."""
LONGEST_TEXT = 72
"""The most characters of a formula in a report."""
LEAST_IN_MACHINE = 200
"""The instructions of first derivatives from which balls of doubles in machine code are faster: two
links have about 50, three joints in space 300, six joints thousands."""


@dataclass(frozen=True, slots=True)
class DrivenRobot:
    """A robot with its motion and equations in balls; only the set of its starts is given later.

    ``state`` is the planned start in the graph's coordinates, ``inputs`` the stated inputs per
    step. With a ``law`` the state ends with the inputs that the law holds. With a ``loop`` it is
    about all motions, which go on for ever.
    """

    scene: Scene
    motion: Motion
    graph: RobotGraph
    field: VectorField
    point_map: PointMap
    state: tuple[arb, ...]
    inputs: tuple[tuple[arb, ...], ...]
    law: SampledLaw | None = None
    loop: LoopSet | None = None

    @property
    def tail(self) -> tuple[arb, ...]:
        """The balls of theta and k."""
        return self.field.tail


def driven_robot(
    scene: Scene,
    motion: Motion,
    *,
    disturbed: bool = False,
    factors: Sequence[Fraction] = (),
) -> DrivenRobot:
    """A motion in the working precision; ``factors`` are those of uncertain masses, default 1.

    If it is ``disturbed``, measurements have the task's errors, the last entries of the state are
    the factors of uncertain masses, and a loop begins from all states of its set. The rounding of a
    law is included in that case, and also if the task names no disturbances, since there is no
    other proof then.
    """
    model, task = scene.model, scene.task
    masses = uncertain_masses(task, model) if disturbed or factors else ()
    law = motion.law
    if law is None and masses:
        law = open_loop(motion.inputs, 2 * len(model.dofs))
    graph = scene.graph if law is None else scene.graph.holding_inputs
    graph = graph.weighed([item.bodies for item in masses]) if masses else graph
    tail = tuple(value.ball for value in motion.theta)
    tail += tuple(constant_ball(constant) for constant in graph.constants)
    own, n = robot_states(graph.model), len(graph.model.dofs)
    still = 0 if law is None else len(robot_inputs(model)) + len(masses)
    graph = with_dry_friction(graph)
    friction = [(joint, closed_ball(size)) for joint, size in dry_friction(model).items()]
    slopes = tape(graph.input_slopes) if friction or task.robust is not None else None
    disturbances = friction or task.robust is not None or task.repeat
    # Without second derivatives, sets are enclosed by boxes.
    curvature = Curvature.of(graph) if disturbances else None
    variation = tape(graph.variation)
    field = VectorField(
        tape(graph.balance), variation, n, tail, len(own) + still, slopes, curvature,
        in_machine=len(variation.plan.steps) >= LEAST_IN_MACHINE, friction=tuple(friction),
    )  # fmt: skip
    moves = tape(graph.point_slopes) if disturbances else None
    point_map = PointMap(tape(graph.points), field, graph.model.dimension, moves)
    exact = [graph.coordinates.solved_for(part) for part in (motion.state[:n], motion.state[n:])]
    state = [ball(value) for part in exact for value in part]
    state += [arb(0) if item.initial is None else closed_ball(item.initial) for item in own]
    if law is None:
        inputs = tuple(tuple(ball(value) for value in step) for step in motion.inputs)
        loop = _loop(scene, motion, graph, state) if disturbed else None
        return DrivenRobot(scene, motion, graph, field, point_map, tuple(state), inputs, loop=loop)
    noise = measurement_radii(task, model) if disturbed else ()
    rounding = law.rounding if disturbed or task.robust is None else ()
    rows = graph.coordinates.rows
    sampled = sampled_law(law, motion.inputs, rows, noise, rounding, len(own))
    state += [arb(0)] * (still - len(masses))
    state += [ball(value) for value in factors] or [arb(1)] * len(masses)
    loop = _loop(scene, motion, graph, state) if disturbed else None
    return DrivenRobot(
        scene, motion, graph, field, point_map, tuple(state), sampled.inputs, sampled, loop
    )


def _loop(scene: Scene, motion: Motion, graph: RobotGraph, state: Sequence[arb]) -> LoopSet | None:
    if motion.loop is None:
        return None
    masses = [item.part for item in uncertain_masses(scene.task, scene.model)]
    return loop_set(motion.loop, graph, state, masses)


@dataclass(slots=True)
class Followed:
    """The results along a tube, as far as it reaches; ``samples`` are the states at the steps.

    ``commanded`` are the inputs that a law commands, a row per step; empty without a law.
    ``reached`` are the sets at the end of the prefix and of the first round of a loop, or at the
    end of the motion. ``ended`` says why the tube does not reach beyond ``time``; it is empty for a
    complete tube.
    """

    robot: DrivenRobot
    constraints: list[Constraint]
    limits: list[StateLimit]
    defined: Defined
    formulas: FormulaProof
    end: EndConditions
    carried: TransferConditions
    samples: list[Sequence[arb]]
    commanded: list[Sequence[arb]] = field(default_factory=list[Sequence[arb]])
    reached: list[Zonotope] = field(default_factory=list[Zonotope])
    time: float = 0.0
    ended: str = ""
    energy: EnergyUsed | None = None

    @property
    def fails(self) -> bool:
        """Whether something that has to hold at every instant has failed."""
        states = [item.status for item in self.constraints]
        states += [item.status for item in self.limits]
        return Status.FAILS in (*states, self.defined.status)

    def positions(self) -> list[list[list[arb]]]:
        """Positions (samples, points, d)."""
        return [self.robot.point_map.positions(sample) for sample in self.samples]

    def conditions(self) -> list[CheckedCondition]:
        """All conditions for a complete tube, except those about samples alone."""
        found = self.so_far()
        scene, effector = self.robot.scene, self.robot.motion.effector
        task, loop = scene.task, self.robot.loop
        if task.repeat and loop is None:
            return found
        if loop is not None:
            found += endless_conditions(loop, self.reached, task, effector, self.formulas)
        else:
            found += self.end.conditions(self.robot.point_map, self.samples[-1], self.reached[-1])
        found += self.carried.conditions(self.robot.point_map, self.samples)
        found += [] if self.energy is None else [self.energy.condition()]
        found += [self.satisfied(*each) for each in enumerate(task.satisfy)]
        return found

    def so_far(self) -> list[CheckedCondition]:
        """The conditions that have to hold at every instant."""
        found = []
        if self.defined.is_needed:
            item = self.defined
            name = "equations of motion defined"
            found.append(CheckedCondition(name, item.status, NO_MARGIN, "", item.time))
        found += [
            CheckedCondition(c.name, c.status, c.margin, c.unit, c.time, c.place)
            for c in self.constraints
        ]
        found += [
            CheckedCondition(limit.name, limit.status, limit.margin, limit.unit, limit.time)
            for limit in self.limits
            if limit.margin < NO_MARGIN or limit.status is not Status.HOLDS
        ]
        return found

    def satisfied(self, number: int, clause: ir.Satisfy) -> CheckedCondition:
        """The condition for a formula; its margin is a bound of its robustness."""
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
    """Follow the tube from a set of states and check it against the task.

    ``error`` is how far inputs may be from the commanded ones; None if they do not differ. An
    exception from the ``watch`` ends the proof.
    """
    scene, step = robot.scene, robot.scene.task.step
    graph, accelerations = robot.graph, acceleration_limits(scene)
    found = Followed(
        robot,
        position_conditions(scene, robot.tail),
        [*state_limits(scene, robot.field.size), *accelerations],
        Defined(tape(graph.conditions), graph.divisors, robot.tail),
        _formulas(robot, watch.tick),
        EndConditions(scene, robot.motion.effector),
        TransferConditions(scene, robot.motion),
        [],
        energy=EnergyUsed.of(scene),
    )
    ends: dict[int, Sequence[arb]] = {0: box_of(initial)}
    try:
        for start, steps in legs(robot, initial):
            last = zonotope(start)
            found.carried.add(steps.start, last)
            for segment in tube(
                robot.field,
                start,
                robot.inputs,
                ball(step),
                accuracy,
                error,
                robot.law,
                steps,
                accelerations=bool(accelerations),
            ):
                watch.tick()
                last = last if segment.last is None else segment.last
                # Conditions keep segments for their margins; sets of states would take much memory.
                _check(found, replace(segment, last=None))
                if watch.brief and found.fails:
                    found.ended = FAILED
                    break
                if segment.steps[1].denominator == 1:
                    ends[int(segment.steps[1])] = segment.end
                    found.carried.add(int(segment.steps[1]), last)
                    watch.part(int(segment.steps[1]), scene.task.steps)
            if found.ended:
                break
            found.reached.append(last)
    except EnclosureFailure as failure:
        found.ended = str(failure)
    close_margins(robot.point_map, found.constraints)
    found.samples = [ends[number] for number in sorted(ends)]
    return found


def legs(robot: DrivenRobot, initial: InitialSet) -> list[tuple[InitialSet, range]]:
    """The sets from which steps are followed; with a loop, first the prefix, then one round."""
    count, loop = len(robot.inputs), robot.loop
    if loop is None:
        return [(initial, range(count))]
    return [(initial, range(loop.first)), (loop.initial, range(loop.first, count))]


def _check(found: Followed, segment: TubeSegment) -> None:
    """Check a segment against the task."""
    robot, inputs = found.robot, segment.inputs
    whole = Stretch.of(segment, inputs)
    check_segment(robot.point_map, whole, found.constraints)
    check_limits(whole, found.limits)
    if not robot.scene.task.repeat:
        found.end.add(robot.point_map, segment, inputs)
    found.formulas.add(segment, inputs)
    if found.defined.is_needed:
        found.defined.check(segment, inputs)
    if found.energy is not None:
        # The inputs of a law are entries of the state; ``inputs`` are added to them.
        held = [arb(0)] * len(inputs) if robot.law is None else segment.commanded
        found.energy.add(segment, [a + b for a, b in zip(held, inputs, strict=True)])
    found.time = float((segment.start + segment.length).mid())
    if robot.law is not None and segment.number == len(found.commanded):
        found.commanded.append(segment.commanded)


def box_of(initial: InitialSet) -> list[arb]:
    """The box around a set of states."""
    unit = arb(0, 1)
    if not initial.radii:
        return list(initial.centre)
    return [
        centre + sum((g * r * unit for g, r in zip(row, initial.radii, strict=True)), arb(0))
        for centre, row in zip(initial.centre, initial.generators, strict=True)
    ]


def _formulas(robot: DrivenRobot, tick: Callable[[], None]) -> FormulaProof:
    """The proof of the task's formulas, with the sets of their atoms."""
    scene, task = robot.scene, robot.scene.task
    spoken = [clause.formula for clause in task.satisfy]
    if task.repeat and task.reach is not None:
        spoken.append(reached_some_time(task.reach, robot.motion.effector))
    regions: dict[AtomKey, RegionDistance | PosedRegion] = {}
    points = len(scene.model.effectors)
    for atom in atoms(*spoken):
        region = region_distance(scene.polytope(scene.workspace.region(atom.region)))
        regions[key(atom)] = region
        if atom.poses:
            posed = posed_region(scene.graph, region, atom.poses, atom.effector - 1)
            regions[key(atom)], points = posed, max(points, posed.points)
    loop = None if robot.loop is None else robot.loop.first
    return FormulaProof(robot.point_map.first(points), regions, task, tick, loop)

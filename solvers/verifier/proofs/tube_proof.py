"""A tube held against everything that a task asks of a motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from textwrap import shorten

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, constant_ball
from compiler.expressions.tape import tape
from compiler.robots.state_and_input import robot_states
from compiler.tasks.formula_parts import atoms
from compiler.tasks.formula_text import formula_text
from compiler.tasks.monitor import key
from grammar_lang import ir
from solvers.verifier.proofs.defined_checks import Defined
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, tube
from solvers.verifier.proofs.finding import NO_MARGIN, Finding, inside
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.initial_set import InitialSet
from solvers.verifier.proofs.motion_conditions import position_conditions, state_limits
from solvers.verifier.proofs.region_distance import region_distance
from solvers.verifier.proofs.scene import Motion, Scene
from solvers.verifier.proofs.start_check import at_rest
from solvers.verifier.proofs.tube_checks import (
    Constraint,
    PointMap,
    StateLimit,
    Status,
    check_segment,
    close_margins,
)
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.watch import Watch

LONGEST_TEXT = 72
"""Characters of a formula in a report."""


@dataclass(frozen=True, slots=True)
class DrivenRobot:
    """A robot of which everything is known but where it begins, in balls.

    ``state`` is the planned start in the graph's coordinates, ``inputs`` the stated inputs per
    step.
    """

    scene: Scene
    motion: Motion
    field: VectorField
    point_map: PointMap
    state: tuple[arb, ...]
    inputs: tuple[tuple[arb, ...], ...]

    @property
    def tail(self) -> tuple[arb, ...]:
        """The balls of theta and k."""
        return self.field.tail


def driven_robot(scene: Scene, motion: Motion) -> DrivenRobot:
    """A motion in the working precision."""
    graph = scene.graph
    tail = tuple(value.ball for value in motion.theta)
    tail += tuple(constant_ball(constant) for constant in graph.constants)
    own, n = robot_states(graph.model), len(graph.model.dofs)
    slopes = tape(graph.input_slopes) if scene.task.robust is not None else None
    field = VectorField(tape(graph.balance), tape(graph.variation), n, tail, len(own), slopes)
    point_map = PointMap(tape(graph.points), field, graph.model.dimension)
    exact = [graph.coordinates.solved_for(part) for part in (motion.state[:n], motion.state[n:])]
    state = [ball(value) for part in exact for value in part]
    state += [arb(0) if item.initial is None else closed_ball(item.initial) for item in own]
    inputs = tuple(tuple(ball(value) for value in step) for step in motion.inputs)
    return DrivenRobot(scene, motion, field, point_map, tuple(state), inputs)


@dataclass(slots=True)
class Followed:
    """What a tube shows, as far as it goes; ``samples`` are the states at the steps.

    ``ended`` says why it goes no farther than ``time``, empty where it is complete.
    """

    robot: DrivenRobot
    constraints: list[Constraint]
    limits: list[StateLimit]
    defined: Defined
    formulas: FormulaProof
    samples: list[Sequence[arb]]
    time: float = 0.0
    ended: str = ""

    def positions(self) -> list[list[list[arb]]]:
        """Positions (samples, points, d)."""
        return [self.robot.point_map.positions(sample) for sample in self.samples]

    def findings(self) -> list[Finding]:
        """All that a complete tube shows, but for what is asked of samples alone."""
        found = self.so_far()
        scene, effector = self.robot.scene, self.robot.motion.effector
        task, last = scene.task, self.samples[-1]
        end = float(task.step) * task.steps
        if task.reach is not None:
            tip = self.robot.point_map.positions(last)[effector]
            target = scene.polytope(scene.workspace.region(task.reach.region))
            found.append(inside(f"target {task.reach.region}", target, tip, end))
            if task.reach.at_rest:
                found.append(at_rest(scene.graph, last, end))
        found += [self._satisfied(*each) for each in enumerate(task.satisfy)]
        return found

    def so_far(self) -> list[Finding]:
        """What has to hold at every instant."""
        found = []
        if self.defined.is_needed:
            item = self.defined
            name = "equations of motion defined"
            found.append(Finding(name, item.status, NO_MARGIN, "", item.time))
        found += [
            Finding(c.name, c.status, c.margin, "m", c.time, c.place) for c in self.constraints
        ]
        found += [
            Finding(limit.name, limit.status, limit.margin, limit.unit, limit.time)
            for limit in self.limits
            if limit.margin < NO_MARGIN or limit.status is not Status.HOLDS
        ]
        return found

    def _satisfied(self, number: int, clause: ir.Satisfy) -> Finding:
        """What is proved of a formula; its margin is a bound of its robustness."""
        text = shorten(formula_text(clause.formula), LONGEST_TEXT, placeholder=" …")
        verdict = self.formulas.verdict(clause.formula)
        return Finding(
            f"satisfy {number + 1}: {text}", verdict.status, verdict.robustness, "m",
            verdict.time, verdict.place, clause=number, loose=verdict.loose,
        )  # fmt: skip


def follow(
    robot: DrivenRobot,
    initial: InitialSet,
    effort: arb | None,
    accuracy: Accuracy,
    watch: Watch,
) -> Followed:
    """Hold the tube from a set of states against the task.

    ``effort`` is the part of themselves by which inputs may differ from what is stated, None: they
    do not.  What the ``watch`` raises ends the proof.
    """
    scene, step = robot.scene, robot.scene.task.step
    graph = scene.graph
    found = Followed(
        robot,
        position_conditions(scene, robot.tail),
        state_limits(scene),
        Defined(tape(graph.conditions), graph.divisors, robot.tail),
        _formulas(scene, robot.point_map, watch.tick),
        [],
    )
    part = arb(0) if effort is None else effort * arb(0, 1)
    applied = [[u + u * part for u in row] for row in robot.inputs]
    ends: dict[int, Sequence[arb]] = {0: box_of(initial)}
    try:
        for segment in tube(robot.field, initial, robot.inputs, ball(step), accuracy, effort):
            watch.tick()
            inputs = applied[segment.number]
            check_segment(robot.point_map, segment, inputs, found.constraints, found.limits)
            found.formulas.add(segment, inputs)
            if found.defined.is_needed:
                found.defined.check(segment, inputs)
            found.time = float((segment.start + segment.length).mid())
            if segment.steps[1].denominator == 1:
                ends[int(segment.steps[1])] = segment.end
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

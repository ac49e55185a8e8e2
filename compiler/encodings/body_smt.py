"""The refutation of a robot by poses of its whole body, as an SMT-LIB 2 script, in the plane.

Statement: for some parameters in range there are poses, one with an effector in the start region
and one with an effector in the target, with every effector within the bounds and every rod, point
and centre of mass clear of the obstacles that the task keeps bodies out of. The unknowns are the
vectors from joint to joint (``planar_poses.py``). A script asks about one of the two poses, or
about both with the same parameters. ``unsat`` proves that the structure cannot do the task; every
relaxation only enlarges the set of solutions.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.encodings.graph_terms import ONE, LinearTerm, TermEvaluator
from compiler.encodings.planar_poses import PlanarPose
from compiler.encodings.pose_questions import BodyConditions, PoseQuestion, effector_choices
from compiler.encodings.reachability_smt import PRECISION, Pose
from compiler.encodings.region_terms import (
    Formula,
    Quantity,
    RealScript,
    all_of,
    any_of,
    between,
    inside,
    point_clear,
    segment_clear,
)
from compiler.encodings.scalar_terms import ScalarTerms
from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.expressions.exact_numbers import rational_bounds
from compiler.expressions.scalars import evaluate_constant
from compiler.expressions.tape import tape
from compiler.robots.robot import Offset, RobotModel, RodBody, Shape, SolidBody
from grammar_lang import ir

Poses: TypeAlias = tuple[Pose, ...]

HEADER = """\
Is there a robot of this structure with {wanted}, every
effector within the bounds and the whole body clear of the obstacles?  unsat: there is none, so no
robot of this structure does the task.  Limits of revolute joints, the dynamics, margins and radii
are left out, touching is allowed, and irrational numbers lie in rational intervals: all this can
only add solutions.  SI units."""

START = "a pose that brings an effector into the start region"
TARGET = "a pose that brings {who} into {target}"


def body_scripts(question: PoseQuestion) -> tuple[Poses, ...]:
    """The sets of poses that scripts for a question ask about, one set per script."""
    if question.start is None:
        return (("target",),)
    return ("target",), ("start",), ("start", "target")


def body_script(
    model: RobotModel, question: PoseQuestion, demands: BodyConditions, poses: Poses
) -> str | None:
    """The script of a robot and a task: SMT-LIB 2, QF_NRA, the same bytes for the same input.

    None if no effector is a candidate: the script without the body refutes this case.
    """
    pairs = effector_choices(model, question)
    if not pairs:
        return None
    script = RealScript()
    who = "an effector" if len(poses) == 1 else question.who
    wanted = {"start": START, "target": TARGET.format(who=who, target=question.goal)}
    script.comment(HEADER.format(wanted=" and\n".join(wanted[pose] for pose in poses)))
    script.lines.append("(set-logic QF_NRA)")
    with working_precision(PRECISION):
        _Encoding(model, question, demands, script).write(poses, pairs)
    script.lines.append("(check-sat)")
    return "\n".join(script.lines) + "\n"


@dataclass(slots=True)
class _Encoding:
    model: RobotModel
    question: PoseQuestion
    demands: BodyConditions
    script: RealScript

    def write(self, poses: Poses, pairs: Sequence[tuple[int, int]]) -> None:
        """Write everything between the logic and the check."""
        scalars = ScalarTerms(self.model, self.script)
        scalars.define(_lengths(self.model))
        bodies: dict[Pose, PlanarPose] = {}
        for pose in poses:
            self.script.comment(f"The {pose} pose: effectors within the bounds, the body clear.")
            bodies[pose] = PlanarPose(self.model, scalars, pose)
            self._clear(bodies[pose])
        self.script.comment("The effectors in their regions.")
        alternatives = dict.fromkeys(
            all_of([part for pose in poses for part in self._reached(bodies[pose], pose, pair)])
            for pair in pairs
        )
        self.script.assertion(any_of(list(alternatives)))

    def _reached(self, body: PlanarPose, pose: Pose, pair: tuple[int, int]) -> list[Formula]:
        """The effector of a choice is where it must be at a pose."""
        region = self.question.target if pose == "target" else self.question.start or ()
        position = body.position(body.effectors[pair[pose == "target"]])
        return [inside(row, position) for row in region]

    def _clear(self, body: PlanarPose) -> None:
        """Assert what holds at every instant."""
        script, demands = self.script, self.demands
        found: list[Formula] = []
        for place in body.effectors:
            position = body.position(place)
            found += [inside(row, position) for row in self.question.bounds]
            found += [point_clear(polygon, position) for polygon in demands.effectors]
        for place in body.points:
            position = body.position(place)
            found += self._within(position)
            found += [point_clear(polygon, position) for polygon in demands.bodies]
        for rod in body.rods:
            ends = [body.position(end) for end in rod.ends]
            found += [formula for end in ends for formula in self._within(end)]
            if demands.bodies:
                line = body.line(rod)
                found += [segment_clear(polygon, ends, line) for polygon in demands.bodies]
        script.assertion(*dict.fromkeys(found))

    def _within(self, position: Sequence[Quantity]) -> list[Formula]:
        """Bodies stay within the bounds if the task says so."""
        bounds: tuple[ir.HalfSpace, ...] = self.question.bounds
        return [inside(row, position) for row in bounds] if self.demands.bounds_body else []


def _lengths(model: RobotModel) -> set[int]:
    """The scalars, except angles, on which positions of a robot in the plane depend."""
    found = set[int]()
    for node in model.frames:
        if isinstance(node.step, Offset):
            found.update(node.step.vector[:2])
    for each in model.colliders:
        if isinstance(each, SolidBody):
            found.update(each.com[:2])
        elif isinstance(each, RodBody | Shape) and each.length is not None:
            found.add(each.length)
        elif isinstance(each, Shape):
            found.update(scalar for corner in each.corners for scalar in corner[:2])
    return found


# --- A robot's mass matrix and effector positions as an SMT-LIB 2 script, for users to extend -----


BITS = 128


def model_script(graph: RobotGraph) -> str:
    """Declarations, ranges, and the entries of M and of the effectors' positions as functions.

    The entries are ``M_i_j`` (i <= j) and ``e_i_x``, with indices from 1; coordinates are ``q1`` or
    ``cos_q1`` and ``sin_q1``, parameters ``theta1``. The user's own assertions can follow.
    """
    model, script = graph.model, RealScript(["(set-logic QF_NRA)"])
    with working_precision(BITS):
        evaluator = TermEvaluator(script)
        inputs = [*_coordinates(evaluator, model), *_parameters(evaluator, model)]
        inputs += [evaluate_constant(value, evaluator) for value in graph.constants]
        n, axes = len(model.dofs), "xyz"[: model.dimension]
        script.comment("The mass matrix.")
        mass = tape(graph.mass_matrix).evaluate(inputs, evaluator)
        for i in range(n):
            for j in range(i, n):
                _function(evaluator, f"M_{i + 1}_{j + 1}", mass[j * n + i])
        script.comment("The positions of the effectors, in m.")
        tips = tape(graph.effectors).evaluate(inputs, evaluator)
        names = [f"e_{i + 1}_{axis}" for i in range(len(model.effectors)) for axis in axes]
        for name, tip in zip(names, tips, strict=True):
            _function(evaluator, name, tip)
    return "\n".join(script.lines) + "\n"


def _function(evaluator: TermEvaluator, name: str, number: LinearTerm) -> None:
    text = evaluator.expression(number).text
    evaluator.script.lines.append(f"(define-fun {name} () Real {text})")


def _coordinates(evaluator: TermEvaluator, model: RobotModel) -> Iterator[LinearTerm]:
    """The coordinates, declared within their ranges."""
    for number, dof in enumerate(model.dofs, 1):
        name = f"q{number}"
        places = " and ".join(map(str, dof.symbols))
        evaluator.script.comment(f"{name}: {dof.kind} {dof.axis}, at {places} in the word.")
        if dof.kind == "prismatic" and dof.range is not None:
            yield _bounded(evaluator, name, dof.range)
            continue
        if dof.kind == "prismatic":
            evaluator.real(name)
        else:
            if dof.range is not None:
                ends = closed_ball(dof.range.lower), closed_ball(dof.range.upper)
                evaluator.ranges[name] = ends[0].union(ends[1])
            evaluator.unit_point(name)
        yield LinearTerm({name: ONE}, Fraction(0))


def _parameters(evaluator: TermEvaluator, model: RobotModel) -> Iterator[LinearTerm]:
    """The parameters, declared within their ranges."""
    for number, parameter in enumerate(model.parameters, 1):
        described = f"{parameter.name} of {parameter.module} at {parameter.symbol} in the word"
        evaluator.script.comment(f"theta{number}: {described}.")
        yield _bounded(evaluator, f"theta{number}", parameter.domain)


def _bounded(evaluator: TermEvaluator, name: str, domain: ir.Interval | ir.Choices) -> LinearTerm:
    """A real, declared within outer rational bounds."""
    ends = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    first, *others = (closed_ball(end) for end in ends)
    for other in others:
        first = first.union(other)
    script = evaluator.script
    evaluator.ranges[name] = first
    unknown = script.declare(name, first)
    bounds = [rational_bounds(end) for end in ends]
    if isinstance(domain, ir.Choices):
        evaluator.choices[name] = [closed_ball(end) for end in ends]
    if isinstance(domain, ir.Interval):
        script.assertion(*between((bounds[0][0], bounds[1][1]), unknown))
    else:
        script.assertion(any_of([all_of(between(each, unknown)) for each in bounds]))
    return evaluator.symbol(unknown)

"""The robot of a word of a family, chosen by a command or through the Python interface."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from compiler.expressions.scalars import Constant
from compiler.robots.attributes import SemanticsError
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import (
    Body,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    RodBody,
    Shape,
    SolidBody,
    Step,
    Turn,
)
from grammar_lang import ir
from srgc.graphs.graph_request import chosen_derivation
from srgc.session import UsageFault, chosen


@dataclass(frozen=True, slots=True)
class RobotRequest:
    """A request for the robot of a word, with its choices; ``derivation`` counts from 1."""

    word: tuple[str, ...]
    grammar: str | None = None
    task: str | None = None
    workspace: str | None = None
    derivation: int | None = None


@dataclass(frozen=True, slots=True)
class ChosenRobot:
    """A robot, the word, grammar and task it comes from, and remarks for the reader."""

    program: ir.Program
    word: tuple[str, ...]
    labels: tuple[str, ...]
    model: RobotModel
    grammar: ir.Grammar
    task: ir.Task | None
    remarks: tuple[str, ...] = ()

    @property
    def gravity(self) -> tuple[Fraction, ...]:
        """The gravity of the task in m/s^2; empty without a task."""
        return () if self.task is None else self.task.gravity


def chosen_robot(program: ir.Program, request: RobotRequest) -> ChosenRobot:
    """Build the robot that is asked for.

    Raises:
        UsageFault: the choices do not fit the program, or the word has no robot.
    """
    task = None if request.task is None else chosen(program.tasks, request.task, "task")
    named = request.grammar or (None if task is None else task.grammar)
    grammar = chosen(program.grammars, named, "grammar")
    dimension = _dimension(program, task, request.workspace)
    family = RobotFamily(program, grammar, dimension or 3)
    found = chosen_derivation(family.language, grammar, request.word, request.derivation)
    if not request.word:
        raise UsageFault("the empty word is not a robot")
    try:
        model = family.robot(found.derivation)
    except SemanticsError as error:
        raise UsageFault(str(error)) from None
    if dimension is None and is_planar(model):
        model = RobotFamily(program, grammar, 2).robot(found.derivation)
    labels = tuple(found.derivation.labels)
    return ChosenRobot(program, request.word, labels, model, grammar, task, found.remarks)


def _dimension(
    program: ir.Program, task: ir.Task | None, workspace: str | None
) -> Literal[2, 3] | None:
    """The dimension of the workspace, or the common one of all workspaces; None without any."""
    name = workspace or (None if task is None else task.workspace)
    dimensions = {place.dimension for place in program.workspaces.values()}
    if name is None and len(dimensions) == 1:
        return dimensions.pop()
    if name is None and not dimensions:
        return None
    return chosen(program.workspaces, name, "workspace").dimension


# --- Whether a spatial robot moves in the x-y plane only ------------------------------------------


Z = 2


def is_planar(model: RobotModel) -> bool:
    """Whether all turns are about z and everything that moves stays at z = 0.

    This looks at the form of the model only: it does not notice steps along z that cancel.
    """
    steps = (node.step for node in model.frames)
    return (
        all(_planar_step(model, step) for step in steps)
        and all(_planar_body(model, body) for body in model.bodies)
        and all(_planar_shape(shape) for shape in model.shapes)
    )


def _planar_step(model: RobotModel, step: Step | None) -> bool:
    match step:
        case Turn(axis, _):
            return axis == Z
        case Offset((_, _, z)):
            return _is_zero(model, z)
        case Joint(dof, axis, _):
            return (model.dofs[dof].kind == "revolute") == (axis == Z)
        case None:
            return True


def _planar_body(model: RobotModel, body: Body) -> bool:
    match body:
        case RodBody():
            return body.axis != Z
        case PointBody():
            return True
        case SolidBody():
            return len(body.inertia) == 1 and _is_zero(model, body.com[Z])


def _planar_shape(shape: Shape) -> bool:
    if shape.kind == "box":
        return len(shape.sizes) == 2
    return shape.length is None or shape.axis != Z


def _is_zero(model: RobotModel, scalar: int) -> bool:
    return model.scalars[scalar] == Constant(Fraction(0))

"""A text of a robot in normal form: equal texts, equal robots."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.scalars import Apply, ParameterLeaf, evaluate_scalars
from compiler.robots.given_start import given_start
from compiler.robots.own_dynamics import OwnDynamics
from compiler.robots.robot import (
    Body,
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    RodBody,
    SolidBody,
    Turn,
    scalars_of_body,
    scalars_of_step,
)
from grammar_lang import ir


def robot_key(model: RobotModel) -> str:
    """A text that is equal for two normal forms only if they are the same robot.

    Parameters that are used are numbered in word order, so that equal robots built from
    different occurrences compare equal.
    """
    used = _used_scalars(model)
    read = {node.index for i in used if isinstance(node := model.scalars[i], ParameterLeaf)}
    parameters = sorted(read.union(*(own.read_parameters for own in model.own)))
    names = {index: f"p{number}" for number, index in enumerate(parameters)}

    values = [names.get(index, "unused") for index in range(len(model.parameters))]
    texts = evaluate_scalars(model.scalars, _KeyEvaluator(), values)
    parts = [f"dim {model.dimension}"]
    parts += [_frame_text(model, frame, texts) for frame in model.frames]
    parts += [_body_text(body, texts) for body in model.bodies]
    parts.append(f"effectors {model.effectors}")
    parts += [_own_text(own, names) for own in model.own]
    parts += [f"{name}: {model.parameters[index].domain}" for index, name in names.items()]
    return "\n".join(parts)


class _KeyEvaluator(Evaluator[str]):
    """Values are texts: operations with the texts of their arguments behind them."""

    def constant(self, value: Fraction | int) -> str:
        return str(value)

    def pi(self) -> str:
        return "pi"

    def power(self, base: str, exponent: int, /) -> str:
        return f"^{exponent or ''}({base})"

    def neg(self, argument: str, /) -> str:
        return f"neg({argument})"

    def fabs(self, argument: str, /) -> str:
        return f"abs({argument})"

    def sqrt(self, argument: str, /) -> str:
        return f"sqrt({argument})"

    def sin(self, argument: str, /) -> str:
        return f"sin({argument})"

    def cos(self, argument: str, /) -> str:
        return f"cos({argument})"

    def tan(self, argument: str, /) -> str:
        return f"tan({argument})"

    def add(self, left: str, right: str, /) -> str:
        return f"+({left},{right})"

    def sub(self, left: str, right: str, /) -> str:
        return f"-({left},{right})"

    def mul(self, left: str, right: str, /) -> str:
        return f"*({left},{right})"

    def div(self, left: str, right: str, /) -> str:
        return f"/({left},{right})"


def robot_key_in_task(model: RobotModel, task: ir.Task) -> str:
    """The key of a robot together with the start that a task gives it.

    Words of one normal form may start at different coordinates: they are different robots then.
    """
    key = robot_key(model)
    if not isinstance(task.start, ir.StartAt):
        return key
    return f"{key}\n{given_start(model, task.start).key}"


def _own_text(own: OwnDynamics, names: Mapping[int, str]) -> str:
    """The dynamics of a module's own with the parameters by their names in the key."""
    parameters = [(name, names.get(index)) for name, index in own.parameters]
    return f"own {own.states} {own.inputs} {own.torques} {parameters} {own.dofs}"


def _frame_text(model: RobotModel, frame: FrameNode, texts: list[str]) -> str:
    match frame.step:
        case None:
            return "world"
        case Turn(axis, angle):
            return f"{frame.parent} turn {axis} {texts[angle]}"
        case Offset(vector):
            return f"{frame.parent} move {[texts[i] for i in vector]}"
        case Joint(dof, axis, sign):
            limits = model.dofs[dof]
            kind = f"{limits.kind} {limits.range} {limits.rate}"
            return f"{frame.parent} joint {dof} {axis} {sign} {kind}"


def _used_scalars(model: RobotModel) -> set[int]:
    """The scalars that frames and bodies use, directly or not."""
    used = {i for frame in model.frames for i in scalars_of_step(frame.step)}
    used |= {i for body in model.bodies for i in scalars_of_body(body)}
    for i in range(len(model.scalars) - 1, -1, -1):
        node = model.scalars[i]
        if i in used and isinstance(node, Apply):
            used.update(node.arguments)
    return used


def _body_text(body: Body, texts: list[str]) -> str:
    match body:
        case RodBody(frame, axis, sign, length, density, radius):
            thickness = "-" if radius is None else texts[radius]
            return f"rod {frame} {axis} {sign} {texts[length]} {texts[density]} {thickness}"
        case PointBody(frame, mass):
            return f"point {frame} {texts[mass]}"
        case SolidBody(frame, mass, com, inertia):
            items = [texts[i] for i in (*com, *inertia)]
            return f"solid {frame} {texts[mass]} {items}"

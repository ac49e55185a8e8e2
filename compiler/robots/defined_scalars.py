"""Whether a robot's scalars have a value for all values of its parameters."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from flint import arb

from compiler.expressions.evaluators.balls import closed_ball, scalar_balls, working_precision
from compiler.expressions.scalars import Apply, Constant, ParameterLeaf, PiConstant
from compiler.robots.robot import RobotModel, RobotParameter
from grammar_lang import ir
from grammar_lang.ir.constants import rational

BOXES = 256
PRECISION = 128

Box = tuple[arb, ...]


def scalars_are_defined(model: RobotModel) -> bool:
    """Whether all scalars are proven to have a value: False means only that it was not proven.

    The parameter box is halved along its widest side as long as this cannot be decided.
    """
    with working_precision(PRECISION):
        pending = [tuple(box) for box in product(*(_sides(p) for p in model.parameters))]
        spent = 0
        while pending:
            box = pending.pop()
            spent += 1
            if _defined(model, box):
                continue
            widest = max(range(len(box)), key=lambda i: float(box[i].rad()), default=None)
            if widest is None or not box[widest].rad() > 0 or spent + len(pending) > BOXES:
                return False
            pending += _halves(box, widest)
        return True


def _sides(parameter: RobotParameter) -> Sequence[arb]:
    """The range of a parameter, or each of its values."""
    domain = parameter.domain
    if isinstance(domain, ir.Choices):
        return [closed_ball(value) for value in domain.values]
    return [closed_ball(domain.lower).union(closed_ball(domain.upper))]


def _halves(box: Box, side: int) -> list[Box]:
    middle, quarter = box[side].mid(), box[side].rad() / 2
    centres = (middle - quarter, middle + quarter)
    return [(*box[:side], c + arb(0, 1) * quarter, *box[side + 1 :]) for c in centres]


def _defined(model: RobotModel, box: Box) -> bool:
    """Whether every operation has a value throughout a box."""
    values = scalar_balls(model.scalars, box)
    return all(
        _has_value(model, node, [values[i] for i in node.arguments])
        for node in model.scalars
        if isinstance(node, Apply)
    )


def _has_value(model: RobotModel, node: Apply, arguments: list[arb]) -> bool:
    match node.operation:
        case "/":
            return bool(arguments[1] != 0)
        case "^" if node.exponent < 0:
            return bool(arguments[0] != 0)
        case "tan":
            return bool(arguments[0].cos() != 0)
        case "sqrt":
            return bool(arguments[0] >= 0) or _never_negative(model, node.arguments[0])
        case _:
            return True


def _never_negative(model: RobotModel, scalar: int) -> bool:
    """Whether a scalar is recognised as non-negative: a square, or a sum or product of such."""
    todo = [scalar]
    while todo:
        match model.scalars[todo.pop()]:
            case Constant(value) if value >= 0:
                pass
            case PiConstant():
                pass
            case ParameterLeaf(index):
                domain = model.parameters[index].domain
                ends = (domain.lower,) if isinstance(domain, ir.Interval) else domain.values
                exact = [rational(end) for end in ends]
                if not all(end is not None and end >= 0 for end in exact):
                    return False
            case Apply("^", _, exponent) if exponent % 2 == 0:
                pass
            case Apply("*", (a, b)) if a == b:
                pass
            case Apply("+" | "*" | "/", arguments):
                todo += arguments
            case Apply("sqrt" | "abs"):
                pass
            case _:
                return False
    return True

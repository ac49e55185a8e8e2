"""A text for a robot in normal form: robots with equal texts are equal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.evaluators.balls import ball, closed_ball, scalar_balls
from compiler.expressions.scalars import Apply, ParameterLeaf, evaluate_scalars
from compiler.robots.given_start import given_start
from compiler.robots.robot import (
    Body,
    FrameNode,
    Joint,
    Offset,
    OwnDynamics,
    PointBody,
    RobotDof,
    RobotModel,
    RobotParameter,
    RodBody,
    Shape,
    SolidBody,
    Turn,
    scalars_of_body,
    scalars_of_step,
)
from grammar_lang import ir


def robot_key(model: RobotModel) -> str:
    """A text that is equal for two normal forms only if they are the same robot.

    Used parameters are numbered in word order, so that equal robots built from different
    occurrences of modules have equal texts.
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
    parts += [_shape_text(shape, texts) for shape in model.shapes]
    if model.covered:
        parts.append(f"covered {model.covered}")
    parts.append(f"effectors {model.effectors}")
    parts += [_own_text(own, names) for own in model.own]
    parts += [f"{name}: {model.parameters[index].domain}" for index, name in names.items()]
    if model.payloads:
        parts.append(f"payloads {model.payloads}")
    if model.posed:
        parts.append("posed")
    if model.apart:
        parts.append(f"apart {model.apart}")
    return "\n".join(parts)


class _KeyEvaluator(Evaluator[str]):
    """Values are texts: an operation followed by the texts of its arguments."""

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
    """The key of a robot together with the start that a task gives it and the owners of its bodies.

    Words with one normal form may start at different coordinates; they are different robots then.
    They also differ if the masses of some modules are uncertain and equal bodies belong to other
    modules.
    """
    key = robot_key(model)
    if isinstance(task.start, ir.StartAt):
        key += f"\n{given_start(model, task.start).key}"
    if task.robust is not None and task.robust.masses:
        key += f"\n{_owners_text(model, {item.module for item in task.robust.masses})}"
    return key


def _owners_text(model: RobotModel, modules: set[str]) -> str:
    """Which bodies are owned by one of the given modules, and which of them share an owner."""
    own = [owner if owner and owner.module in modules else None for owner in model.owners]
    order = {owner: number for number, owner in enumerate(dict.fromkeys(filter(None, own)))}
    return f"owners {[owner and (owner.module, order[owner]) for owner in own]}"


def _own_text(own: OwnDynamics, names: Mapping[int, str]) -> str:
    """A module's own dynamics, with the parameters under their names in the key."""
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
            if limits.is_driven:
                kind += " " + " ".join(map(str, limits.amounts))
            return f"{frame.parent} joint {dof} {axis} {sign} {kind}"


def _used_scalars(model: RobotModel) -> set[int]:
    """The scalars that frames and bodies use, directly or indirectly."""
    used = {i for frame in model.frames for i in scalars_of_step(frame.step)}
    used |= {i for body in model.bodies for i in scalars_of_body(body)}
    used |= {i for shape in model.shapes for i in _of_shape(shape)}
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
        case PointBody(frame, mass, load):
            return f"point {frame} {texts[mass]}" + ("" if load is None else f" load {load}")
        case SolidBody(frame, mass, com, inertia):
            items = [texts[i] for i in (*com, *inertia)]
            return f"solid {frame} {texts[mass]} {items}"


def _of_shape(shape: Shape) -> tuple[int, ...]:
    """The scalars of a shape."""
    return (*shape.sizes, *(scalar for corner in shape.corners for scalar in corner))


def _shape_text(shape: Shape, texts: list[str]) -> str:
    sizes = [texts[i] for i in _of_shape(shape)]
    return f"{shape.kind} {shape.frame} {shape.axis} {shape.sign} {sizes}"


# --- Whether two normalised robots certainly differ -----------------------------------------------
#
# ``robot_key`` compares expressions as they are written, so to it ``a + (b + c)`` and
# ``(a + b) + c`` differ. Here expressions are compared by their values at sample points of the
# parameter box, in ball arithmetic: they are reported as different only if two balls are disjoint.


SAMPLES = (3, 7)

Naming: TypeAlias = Callable[[RobotModel, tuple[int, ...]], list[int]]


def provably_different(first: RobotModel, second: RobotModel) -> bool:
    """Whether two normal forms are proven to differ, however their parameters are matched.

    Parameters are matched in word order, and in the order in which the robots use them. False does
    not mean that the robots are equal.
    """
    if _skeleton(first) != _skeleton(second) or _limits_differ(first, second):
        return True
    namings: tuple[Naming, ...] = (_by_word, _by_use)
    return all(_values_differ(first, second, naming) for naming in namings)


# --- parts without expressions -----------------------------------------------------------------


def _skeleton(model: RobotModel) -> tuple[object, ...]:
    """The tree of frames, joints, bodies and effectors with all expressions left out."""
    return (
        model.dimension,
        tuple(_bare_frame(frame) for frame in model.frames),
        tuple(_bare_body(body) for body in model.bodies),
        tuple(
            replace(shape, sizes=(0,) * len(shape.sizes), corners=((0, 0, 0),) * len(shape.corners))
            for shape in model.shapes
        ),
        model.covered,
        tuple(
            (dof.kind, *(each is None for each in (dof.range, dof.rate, *dof.amounts)))
            for dof in model.dofs
        ),
        model.effectors,
    )


def _bare_frame(frame: FrameNode) -> FrameNode:
    match frame.step:
        case Turn(axis, _):
            return FrameNode(frame.parent, Turn(axis, 0))
        case Offset():
            return FrameNode(frame.parent, Offset((0, 0, 0)))
        case Joint() | None:
            return frame


def _bare_body(body: Body) -> Body:
    match body:
        case RodBody(radius=radius):
            return replace(body, length=0, density=0, radius=None if radius is None else 0)
        case PointBody():
            return replace(body, mass=0)
        case SolidBody(inertia=inertia):
            return replace(body, mass=0, com=(0, 0, 0), inertia=(0,) * len(inertia))


def _limits_differ(first: RobotModel, second: RobotModel) -> bool:
    """Whether some degree of freedom has a different limit or rotor."""
    pairs = zip(first.dofs, second.dofs, strict=True)
    return any(
        not a.overlaps(b) for x, y in pairs for a, b in zip(_limits(x), _limits(y), strict=True)
    )


def _limits(dof: RobotDof) -> Iterator[arb]:
    for interval in (dof.range, dof.rate):
        if interval is not None:
            yield closed_ball(interval.lower)
            yield closed_ball(interval.upper)
    for amount in dof.amounts:
        if amount is not None:
            yield closed_ball(amount)


# --- expressions -----------------------------------------------------------------------------


def _scalars(model: RobotModel) -> tuple[int, ...]:
    """The scalars of frames and bodies, in order."""
    found = [scalar for frame in model.frames for scalar in scalars_of_step(frame.step)]
    found += [scalar for body in model.bodies for scalar in scalars_of_body(body)]
    found += [scalar for shape in model.shapes for scalar in _of_shape(shape)]
    return tuple(found)


def _by_use(model: RobotModel, scalars: tuple[int, ...]) -> list[int]:
    """The parameters that the scalars depend on, in the order of their first use."""
    found: dict[int, None] = {}
    seen: set[int] = set()
    todo = list(reversed(scalars))
    while todo:
        scalar = todo.pop()
        if scalar in seen:
            continue
        seen.add(scalar)
        node = model.scalars[scalar]
        if isinstance(node, ParameterLeaf):
            found[node.index] = None
        elif isinstance(node, Apply):
            todo += reversed(node.arguments)
    return list(found)


def _by_word(model: RobotModel, _scalars: tuple[int, ...]) -> list[int]:
    return list(range(len(model.parameters)))


def _values_differ(first: RobotModel, second: RobotModel, naming: Naming) -> bool:
    """Whether some scalar has disjoint values at a sample point, parameters matched in order."""
    scalars = _scalars(first), _scalars(second)
    used = naming(first, scalars[0]), naming(second, scalars[1])
    domains = [
        [model.parameters[index].domain for index in indices]
        for model, indices in zip((first, second), used, strict=True)
    ]
    if domains[0] != domains[1]:
        return True
    for sample in SAMPLES:
        a = scalar_balls(first.scalars, _point(first.parameters, used[0], sample))
        b = scalar_balls(second.scalars, _point(second.parameters, used[1], sample))
        if any(not a[i].overlaps(b[j]) for i, j in zip(*scalars, strict=True)):
            return True
    return False


def _point(parameters: tuple[RobotParameter, ...], used: list[int], sample: int) -> list[arb]:
    """A point of the parameter box that depends on the positions of the parameters in ``used``."""
    point = [arb(0)] * len(parameters)
    for place, index in enumerate(used):
        match parameters[index].domain:
            case ir.Interval(lower, upper):
                low, share = closed_ball(lower), Fraction(place + 1, place + sample)
                point[index] = low + ball(share) * (closed_ball(upper) - low)
            case ir.Choices(values):
                point[index] = closed_ball(values[(place + sample) % len(values)])
    return point

"""The normal form of a robot model: rigid steps merged, idle joints removed, coaxial joints merged.

Two robots whose normal forms have equal keys are equal up to the names of their parameters, so
only one of them has to be tried.  The converse need not hold; a missed equality costs time only.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction

from compiler.arithmetic.scalars import (
    Apply,
    Constant,
    ParameterLeaf,
    PiConstant,
    ScalarTable,
    read_scalars,
)
from compiler.robots.own_dynamics import OwnDynamics
from compiler.robots.robot import (
    WORLD,
    Body,
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotDof,
    RobotModel,
    RodBody,
    SolidBody,
    Step,
    Turn,
)
from grammar_lang import ir


def normalise(model: RobotModel) -> RobotModel:
    """The normal form of a robot.

    A degree of freedom that moves neither mass nor an effector nor a body point is removed;
    consecutive joints about one axis with nothing between them become one, whose range is the
    interval sum of theirs.
    """
    while True:
        idle = _idle_dof(model)
        if idle is None:
            break
        model = _without(model, idle)
    while True:
        pair = _coaxial_pair(model)
        if pair is None:
            break
        model = _merged(model, *pair)
    acting = (own.acting() for own in model.own)
    return _compressed(replace(model, own=tuple(own for own in acting if own.torques)))


# --- joints that move nothing --------------------------------------------------------------------


def _moves(model: RobotModel, joint: Joint, steps: list[Step], body: Body | None) -> bool:
    """Whether a joint moves an item that lies behind ``steps`` (None: an effector)."""
    if model.dofs[joint.dof].kind == "prismatic" or isinstance(body, SolidBody):
        return True
    zero = {i for i, node in enumerate(model.scalars) if node == Constant(Fraction(0))}
    aligned = True
    for step in steps:
        match step:
            case Turn(axis, _):
                aligned = aligned and axis == joint.axis
            case Offset(vector):
                off = [i for i in range(3) if vector[i] not in zero]
                if off and not (aligned and off == [joint.axis]):
                    return True
            case Joint(dof, axis, _):
                along = aligned and axis == joint.axis
                if model.dofs[dof].kind == "prismatic" and not along:
                    return True
                aligned = along
    return isinstance(body, RodBody) and not (aligned and body.axis == joint.axis)


def _items(model: RobotModel) -> list[tuple[int, Body | None]]:
    return [(body.frame, body) for body in model.bodies] + [(e, None) for e in model.effectors]


def _idle_dof(model: RobotModel) -> int | None:
    """A degree of freedom that moves nothing, or None."""
    moving: set[int] = set()
    for frame, body in _items(model):
        steps = list(model.steps(frame))
        for position, step in enumerate(steps):
            if isinstance(step, Joint) and _moves(model, step, steps[position + 1 :], body):
                moving.add(step.dof)
    idle = [dof for dof in range(len(model.dofs)) if dof not in moving]
    return idle[-1] if idle else None


def _without(model: RobotModel, dof: int) -> RobotModel:
    """The model with one degree of freedom fixed at zero and dropped."""
    dofs = model.dofs[:dof] + model.dofs[dof + 1 :]
    removed = tuple(sorted(model.removed + model.dofs[dof].symbols))
    frames = tuple(_renumbered(node, dof) for node in model.frames)
    own = _own_renumbered(model, [i for i in range(len(model.dofs)) if i != dof])
    return replace(model, dofs=dofs, frames=frames, removed=removed, own=own)


def _own_renumbered(model: RobotModel, order: list[int]) -> tuple[OwnDynamics, ...]:
    """The modules' own dynamics when only these degrees of freedom are left, in this order."""
    places = {old: new for new, old in enumerate(order)}
    return tuple(own.renumbered(places) for own in model.own)


def _renumbered(node: FrameNode, gone: int) -> FrameNode:
    """A frame after degree of freedom ``gone`` has been dropped."""
    if not isinstance(node.step, Joint) or node.step.dof < gone:
        return node
    if node.step.dof == gone:
        return FrameNode(node.parent, None)
    return FrameNode(node.parent, replace(node.step, dof=node.step.dof - 1))


# --- coaxial joints ------------------------------------------------------------------------------


def _coaxial_pair(model: RobotModel) -> tuple[int, int] | None:
    """Two joint frames, the second directly behind the first about one axis, nothing between.

    A coordinate that occurs in several frames is left alone: the others do not follow.  So is one
    that a module's own dynamics read: they are about the joint alone.
    """
    read = {dof for own in model.own for dof in own.bound_dofs.values()}
    used = {node for frame, _ in _items(model) for node in model.chain(frame)}
    joints = {n: s for n in used if isinstance(s := model.frames[n].step, Joint)}
    uses = Counter(step.dof for step in joints.values())
    alone = {
        node: step for node, step in joints.items() if uses[step.dof] == 1 and step.dof not in read
    }
    carriers = {node: _origin(model, model.frames[node].parent) for node in used}
    occupied = {_origin(model, frame) for frame, _ in _items(model)}
    for second in sorted(alone):
        first = carriers[second]
        if first not in alone or first in occupied:
            continue
        step, before = alone[second], alone[first]
        same_kind = model.dofs[step.dof].kind == model.dofs[before.dof].kind
        behind = [
            node for node in used if carriers[node] == first and model.frames[node].step is not None
        ]
        if same_kind and step.axis == before.axis and behind == [second]:
            return first, second
    return None


def _origin(model: RobotModel, frame: int) -> int:
    """The nearest frame at or above ``frame`` that is the world or has a step."""
    while frame != WORLD and model.frames[frame].step is None:
        frame = model.frames[frame].parent
    return frame


def _sum(a: ir.Interval | None, b: ir.Interval | None, sign: int) -> ir.Interval | None:
    """The interval ``a + sign * b``; None is unlimited."""
    if a is None or b is None:
        return None
    low, high = (b.lower, b.upper)
    if sign < 0:
        low, high = ir.Unary("neg", b.upper), ir.Unary("neg", b.lower)
    return ir.Interval(ir.Binary("+", a.lower, low), ir.Binary("+", a.upper, high))


def _merged(model: RobotModel, first: int, second: int) -> RobotModel:
    """The model with two coaxial joints made one."""
    kept, gone = model.frames[first].step, model.frames[second].step
    if not isinstance(kept, Joint) or not isinstance(gone, Joint):
        raise TypeError("only joints are merged")
    a, b = model.dofs[kept.dof], model.dofs[gone.dof]
    sign = kept.sign * gone.sign
    merged = RobotDof(
        tuple(sorted(a.symbols + b.symbols)),
        a.kind,
        a.axis,
        _sum(a.range, b.range, sign),
        _sum(a.rate, b.rate, sign),
    )
    dofs = (*model.dofs[: kept.dof], merged, *model.dofs[kept.dof + 1 :])
    smaller = _without(replace(model, dofs=dofs), gone.dof)
    order = sorted(range(len(smaller.dofs)), key=lambda i: smaller.dofs[i].symbols)
    place = {old: new for new, old in enumerate(order)}
    frames = tuple(
        FrameNode(node.parent, replace(node.step, dof=place[node.step.dof]))
        if isinstance(node.step, Joint)
        else node
        for node in smaller.frames
    )
    sorted_dofs = tuple(smaller.dofs[i] for i in order)
    own = _own_renumbered(smaller, order)
    return replace(smaller, dofs=sorted_dofs, frames=frames, removed=model.removed, own=own)


# --- rigid steps ---------------------------------------------------------------------------------


@dataclass(slots=True)
class _Rebuilder:
    """Rebuilds the frames that are used, with rigid steps merged."""

    model: RobotModel
    table: ScalarTable
    frames: list[FrameNode] = field(default_factory=lambda: [FrameNode(WORLD, None)])
    index: dict[tuple[int, Step], int] = field(default_factory=dict[tuple[int, Step], int])

    def add(self, parent: int, step: Step) -> int:
        key = (parent, step)
        if key not in self.index:
            self.index[key] = len(self.frames)
            self.frames.append(FrameNode(parent, step))
        return self.index[key]

    def frame(self, old: int) -> int:
        """The new frame of an old one."""
        current, rigid = WORLD, list[Step]()
        for step in self.model.steps(old):
            if isinstance(step, Joint):
                for part in rigid:
                    current = self.add(current, part)
                current, rigid = self.add(current, step), []
            else:
                self.push(rigid, step)
        for part in rigid:
            current = self.add(current, part)
        return current

    def push(self, rigid: list[Step], step: Turn | Offset) -> None:
        """Append a rigid step, merging it with the last one where both are of one sort."""
        last = rigid[-1] if rigid else None
        if isinstance(step, Offset) and isinstance(last, Offset):
            pairs = zip(last.vector, step.vector, strict=True)
            x, y, z = (self.table.binary("+", a, b) for a, b in pairs)
            rigid[-1] = Offset((x, y, z))
        elif isinstance(step, Turn) and isinstance(last, Turn) and step.axis == last.axis:
            rigid[-1] = Turn(step.axis, self.table.binary("+", last.angle, step.angle))
        else:
            rigid.append(step)


def _compressed(model: RobotModel) -> RobotModel:
    """Only the frames that carry something, with merged rigid steps."""
    table = ScalarTable()
    for node in model.scalars:
        table.add(node)
    rebuilder = _Rebuilder(model, table)
    bodies = tuple(replace(body, frame=rebuilder.frame(body.frame)) for body in model.bodies)
    effectors = tuple(rebuilder.frame(frame) for frame in model.effectors)
    return replace(
        model,
        frames=tuple(rebuilder.frames),
        scalars=tuple(table.nodes),
        bodies=bodies,
        effectors=effectors,
    )


# --- the key of a normal form --------------------------------------------------------------------


def robot_key(model: RobotModel) -> str:
    """A text that is equal for two normal forms only if they are the same robot.

    Parameters that are used are numbered in word order, so that equal robots built from
    different occurrences compare equal.
    """
    used = _used_scalars(model)
    read = {node.index for i in used if isinstance(node := model.scalars[i], ParameterLeaf)}
    parameters = sorted(read.union(*(own.read_parameters for own in model.own)))
    names = {index: f"p{number}" for number, index in enumerate(parameters)}

    def leaf(node: Constant | PiConstant | ParameterLeaf) -> str:
        match node:
            case Constant(value):
                return str(value)
            case PiConstant():
                return "pi"
            case ParameterLeaf(index):
                return names.get(index, "unused")

    def apply(node: Apply, arguments: list[str]) -> str:
        return f"{node.operation}{node.exponent or ''}({','.join(arguments)})"

    texts = read_scalars(model.scalars, leaf, apply)
    parts = [f"dim {model.dimension}"]
    parts += [_frame_text(model, frame, texts) for frame in model.frames]
    parts += [_body_text(body, texts) for body in model.bodies]
    parts.append(f"effectors {model.effectors}")
    parts += [_own_text(own, names) for own in model.own]
    parts += [f"{name}: {model.parameters[index].domain}" for index, name in names.items()]
    return "\n".join(parts)


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
    used = {i for frame in model.frames for i in _step_scalars(frame.step)}
    used |= {i for body in model.bodies for i in _body_scalars(body)}
    for i in range(len(model.scalars) - 1, -1, -1):
        node = model.scalars[i]
        if i in used and isinstance(node, Apply):
            used.update(node.arguments)
    return used


def _step_scalars(step: Step | None) -> tuple[int, ...]:
    match step:
        case Turn(_, angle):
            return (angle,)
        case Offset(vector):
            return vector
        case Joint() | None:
            return ()


def _body_scalars(body: Body) -> tuple[int, ...]:
    match body:
        case RodBody(_, _, _, length, density, radius):
            return (length, density) if radius is None else (length, density, radius)
        case PointBody(_, mass):
            return (mass,)
        case SolidBody(_, mass, com, inertia):
            return (mass, *com, *inertia)


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

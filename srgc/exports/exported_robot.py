"""What an export of a robot is made of, whatever the format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.rigid_links.part_names import PartNames, effector_modules, part_names
from compiler.rigid_links.rigid_tree import LinkJoint, RigidTree, RigidTreeError, rigid_tree
from compiler.robots.labelled_graph import labelled_graph
from compiler.robots.own_dynamics import OwnDynamics
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from grammar_lang import ir
from srgc.results.found_design import FoundDesign
from srgc.version import VERSION

# --- The names that the parts of a design have in whatever it is exported as ----------------------


def design_tree(design: FoundDesign) -> RigidTree | None:
    """The tree of rigid links of a design, if its robot is one."""
    try:
        return rigid_tree(design.model, design.stated)
    except RigidTreeError:
        return None


def design_names(design: FoundDesign, tree: RigidTree | None) -> PartNames:
    """The names of joints and effectors, and of the links of a tree."""
    grammar = design.program.grammars[design.task.grammar]
    modules = design.program.modules
    graph = labelled_graph(design.program, grammar, design.derivation)
    tools = effector_modules(design.derivation, grammar.semantics or {}, modules)
    return part_names(design.model, tree, graph, modules, tools)


# --------------------------------------------------------------------------------------------------
# What of the modules' own dynamics other formats can hold: viscous friction, and nothing else.
#
# That is torque(q) = u - b rate(q).


@dataclass(frozen=True, slots=True)
class _Linear:
    """``constant + effort * u + rate * rate(q)``, exactly."""

    constant: Fraction
    effort: Fraction = Fraction(0)
    rate: Fraction = Fraction(0)

    @property
    def number(self) -> Fraction | None:
        """The value, if it is one."""
        return None if self.effort or self.rate else self.constant

    def plus(self, other: _Linear, factor: int) -> _Linear:
        """The sum with ``factor`` times another."""
        return _Linear(
            self.constant + factor * other.constant,
            self.effort + factor * other.effort,
            self.rate + factor * other.rate,
        )

    def times(self, factor: Fraction) -> _Linear:
        """All of it times a number."""
        return _Linear(self.constant * factor, self.effort * factor, self.rate * factor)


def viscous_friction(own: OwnDynamics, theta: Sequence[Fraction]) -> dict[int, Fraction] | None:
    """The damping b >= 0 (SI) of each degree of freedom that a module's own dynamics act on.

    None if they are anything else for parameters with these values, or are not rational.
    """
    values = {name: theta[index] for name, index in own.parameters}
    found: dict[int, Fraction] = {}
    for torque in own.torques:
        read = _linear(torque.value, torque.dof, values)
        if read is None or read.constant != 0 or read.effort != 1 or read.rate > 0:
            return None
        found[own.bound_dofs[torque.dof]] = -read.rate
    return found


def _linear(expression: ir.Expr, dof: str, values: dict[str, Fraction]) -> _Linear | None:
    """An expression as a linear one in the input and the rate of a degree of freedom."""
    match expression:
        case ir.Num(value):
            return _Linear(value)
        case ir.ParameterOf(_, name):
            return _Linear(values[name])
        case ir.EffortOf(_, name) if name == dof:
            return _Linear(Fraction(0), effort=Fraction(1))
        case ir.RateOf(_, name) if name == dof:
            return _Linear(Fraction(0), rate=Fraction(1))
        case ir.Unary("neg", operand):
            inner = _linear(operand, dof, values)
            return None if inner is None else inner.times(Fraction(-1))
        case ir.Binary(operator, left, right):
            a, b = _linear(left, dof, values), _linear(right, dof, values)
            return None if a is None or b is None else _combined(operator, a, b)
        case _:
            return None


def _combined(operator: str, a: _Linear, b: _Linear) -> _Linear | None:
    """An operation on two linear expressions, if the result is one."""
    if operator in ("+", "-"):
        return a.plus(b, 1 if operator == "+" else -1)
    left, right = a.number, b.number
    if operator == "*" and left is not None:
        return b.times(left)
    if right is None:
        return None
    if operator == "*":
        return a.times(right)
    if operator == "/" and right:
        return a.times(1 / right)
    if operator == "^" and left:
        return _Linear(left ** int(right))
    return None


def dampings(design: FoundDesign) -> tuple[float, ...]:
    """The viscous friction of every degree of freedom that has no other dynamics of its own."""
    found = [0.0] * len(design.model.dofs)
    for own in design.model.own:
        for dof, damping in (viscous_friction(own, design.stated) or {}).items():
            found[dof] = float(damping)
    return tuple(found)


def left_out(design: FoundDesign) -> str | None:
    """The modules whose dynamics URDF and MJCF do not hold, or None where there are none."""
    others = [own for own in design.model.own if viscous_friction(own, design.stated) is None]
    modules = sorted({(own.symbol, own.module) for own in others})
    if not modules:
        return None
    names = ", ".join(f"{module} (symbol {symbol})" for symbol, module in modules)
    return f"the dynamics of their own of {names}"


# --- The robot of a design as it is exported: its tree of links with names, motors and remarks ----


def exported_robot(design: FoundDesign) -> ExportedRobot:
    """What the export of a design is made of.

    Raises:
        RigidTreeError: the robot is no tree of rigid links with a joint per degree of freedom.
    """
    model, task = design.model, design.task
    tree = rigid_tree(model, design.stated)
    gravity = [float(value) for value in task.gravity] + [0.0] * 3
    coordinates = design.start[: 2 * len(model.dofs)]
    flat = "in the plane xy, where only moments of inertia about z act on the motion"
    plane = (flat,) if model.dimension == 2 else ()
    return ExportedRobot(
        task.name,
        tree,
        design_names(design, tree),
        tuple(motor_bound(model, task, dof) for dof in range(len(model.dofs))),
        dampings(design),
        (gravity[0], gravity[1], gravity[2]),
        task.step,
        tuple(float(value) for value in coordinates),
        (*origin(design), *plane, *remarks(design)),
    )


def motor_bound(model: RobotModel, task: ir.Task, dof: int) -> float | None:
    """The least bound of the task on the free input of a degree of freedom (N m or N)."""
    if all(item.dof != dof for item in robot_inputs(model)):
        return None
    kind = model.dofs[dof].kind
    bounds: list[Fraction] = [item.bound for item in task.effort if item.kind == kind]
    return float(min(bounds)) if bounds else None


def remarks(design: FoundDesign) -> tuple[str, ...]:
    """What of a robot an export does not hold."""
    others = left_out(design)
    return (f"{others} are left out; every joint has a plain motor",) if others else ()


def origin(design: FoundDesign) -> tuple[str, ...]:
    """Lines that say what a file is made from."""
    claim = design.claim
    return (
        f"robot: {' '.join(claim.word)}",
        f"of {claim.spec}, task {claim.task}, spec_sha256 {claim.spec_sha256}",
        f"exported by srgc {VERSION}; SI units",
    )


# --- What an export of a robot is made of, whatever the format ------------------------------------


@dataclass(frozen=True, slots=True)
class Motor:
    """A joint by its name, the number of the link that it carries, and the bound of its effort.

    ``damping`` is its viscous friction (N m s or N s/m).
    """

    name: str
    link: int
    joint: LinkJoint
    bound: float | None
    damping: float


@dataclass(frozen=True, slots=True)
class ExportedRobot:
    """A robot with the numbers of its task.

    ``efforts`` are the bounds of the motors by degree of freedom (N m, N), None without one, and
    ``dampings`` the viscous friction of the joints (N m s, N s/m), 0 without;
    ``gravity`` is in m/s^2, ``step`` that of the task in seconds; ``start`` holds coordinates and
    rates, or nothing; ``remarks`` are lines for a reader.
    """

    name: str
    tree: RigidTree
    names: PartNames
    efforts: tuple[float | None, ...]
    dampings: tuple[float, ...]
    gravity: tuple[float, float, float]
    step: Fraction
    start: tuple[float, ...]
    remarks: tuple[str, ...]

    def motors(self) -> Iterator[Motor]:
        """The motors in the order of the degrees of freedom."""
        for link, joint in self.tree.carried():
            dof = joint.dof
            name, damping = self.names.joints[dof], self.dampings[dof]
            yield Motor(name, link, joint, self.efforts[dof], damping)

"""The model of a robot: frames, degrees of freedom, bodies, effectors, own dynamics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias, TypeVar

from compiler.expressions.scalars import ScalarNode
from grammar_lang import ir

# --- A module's own dynamics in a robot (Definition 5) ------------------------------------------


@dataclass(frozen=True, slots=True)
class OwnDynamics:
    """The states, declared inputs and torques of the module at word index ``symbol``.

    Expressions use the module's names; ``parameters`` and ``dofs`` map them to the robot's numbers.
    The coordinate, rate and input of a removed degree of freedom (None) are zero.
    """

    symbol: int
    module: str
    states: tuple[ir.State, ...]
    inputs: tuple[ir.Input, ...]
    torques: tuple[ir.Torque, ...]
    parameters: tuple[tuple[str, int], ...]
    dofs: tuple[tuple[str, int | None], ...]

    @property
    def bound_dofs(self) -> dict[str, int]:
        """The robot's degrees of freedom by the names that the module gives them."""
        return {name: dof for name, dof in self.dofs if dof is not None}

    @property
    def read_parameters(self) -> frozenset[int]:
        """The robot's parameters that the expressions name."""
        numbers = dict(self.parameters)
        found = (leaf for expression in self.expressions() for leaf in ir.leaves(expression))
        return frozenset(numbers[leaf.name] for leaf in found if isinstance(leaf, ir.ParameterOf))

    def expressions(self) -> Iterator[ir.Expr]:
        """The expressions in it: derivatives, then torques."""
        yield from (state.derivative for state in self.states)
        yield from (torque.value for torque in self.torques)

    def renumbered(self, places: Mapping[int, int]) -> OwnDynamics:
        """These dynamics after the robot's degrees of freedom got new numbers.

        What acts only on degrees of freedom without a new number is removed.
        """
        dofs = tuple((name, None if dof is None else places.get(dof)) for name, dof in self.dofs)
        return replace(self, dofs=dofs).acting()

    def acting(self) -> OwnDynamics:
        """Leave out torques on removed dofs, and states and inputs that no torque depends on."""
        bound = self.bound_dofs
        torques = tuple(torque for torque in self.torques if torque.dof in bound)
        read: set[ir.Expr] = set()
        todo = [torque.value for torque in torques]
        by_name = {state.name: state for state in self.states}
        while todo:
            for leaf in ir.leaves(todo.pop()):
                if leaf not in read:
                    read.add(leaf)
                    if isinstance(leaf, ir.StateOf):
                        todo.append(by_name[leaf.name].derivative)
        return replace(
            self,
            torques=torques,
            states=tuple(s for s in self.states if ir.StateOf(ir.THIS, s.name) in read),
            inputs=tuple(i for i in self.inputs if ir.InputOf(ir.THIS, i.name) in read),
        )


def own_dynamics(
    symbol: int,
    module: ir.Module,
    parameters: Mapping[tuple[int, str], int],
    dofs: Mapping[tuple[int, str], int],
) -> OwnDynamics | None:
    """The own dynamics of the module at a word index; None if it has none.

    ``parameters`` and ``dofs`` map word index and name to the robot's numbers.
    """
    if not (module.states or module.inputs or module.torques):
        return None
    return OwnDynamics(
        symbol,
        module.name,
        module.states,
        module.inputs,
        module.torques,
        tuple((p.name, parameters[symbol, p.name]) for p in module.parameters),
        tuple((d.name, dofs[symbol, d.name]) for d in module.dofs),
    )


# --------------------------------------------------------------------------------------------------
# The robot model: the result of evaluating an attribute grammar on a derivation (FRG, Def. 6).


WORLD = 0

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Turn:
    """A rotation by a scalar angle (rad) about axis 0, 1 or 2 of the local frame."""

    axis: int
    angle: int


@dataclass(frozen=True, slots=True)
class Offset:
    """A translation by three scalars (m) in the local frame."""

    vector: tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Joint:
    """Motion of a degree of freedom about or along ``sign`` times axis 0, 1 or 2."""

    dof: int
    axis: int
    sign: int


Step: TypeAlias = Turn | Offset | Joint


@dataclass(frozen=True, slots=True)
class FrameNode:
    """A frame: its parent's index (always smaller) and the step from there; None for the world."""

    parent: int
    step: Step | None


@dataclass(frozen=True, slots=True)
class RobotDof:
    """A degree of freedom, into which the joints at the word indices ``symbols`` are merged.

    ``effort`` bounds its input, ``inertia`` is the rotor's as the joint feels it, ``accel`` bounds
    its acceleration, ``coulomb`` is dry friction, ``gear`` a ratio. Its name is ``called``.
    """

    symbols: tuple[int, ...]
    kind: ir.DofKind
    axis: ir.Axis
    range: ir.Interval | None
    rate: ir.Interval | None
    effort: ir.Expr | None = None
    inertia: ir.Expr | None = None
    accel: ir.Expr | None = None
    coulomb: ir.Expr | None = None
    gear: ir.Expr | None = None
    called: str = field(default="", compare=False)

    @property
    def amounts(self) -> tuple[ir.Expr | None, ...]:
        """The quantities of its drive that affect its motion."""
        return self.effort, self.inertia, self.accel, self.coulomb

    @property
    def is_driven(self) -> bool:
        """Whether it has a drive of its own, or limits of a drive; such joints are not merged."""
        return any(each is not None for each in (*self.amounts, self.gear))


@dataclass(frozen=True, slots=True)
class WordDof:
    """A degree of freedom of the word, and where it is in the model.

    It is the coordinate ``dof`` of the model, or one summand of it, with ``sign`` (1 or -1). If
    ``dof`` is None, it moves nothing and was removed.
    """

    kind: ir.DofKind
    range: ir.Interval | None
    dof: int | None
    sign: int = 1


@dataclass(frozen=True, slots=True)
class RobotParameter:
    """A design parameter of the module at word index ``symbol``."""

    symbol: int
    module: str
    name: str
    domain: ir.Interval | ir.Choices
    unit: str

    @property
    def label(self) -> str:
        """``symbol.name``, which no other parameter of the robot has."""
        return f"{self.symbol}.{self.name}"


@dataclass(frozen=True, slots=True)
class BodyOwner:
    """The module, at word index ``symbol``, that owns a body."""

    symbol: int
    module: str


@dataclass(frozen=True, slots=True)
class RodBody:
    """A uniform slender rod from the frame's origin along ``sign`` times an axis."""

    frame: int
    axis: int
    sign: int
    length: int
    density: int
    radius: int | None


@dataclass(frozen=True, slots=True)
class PointBody:
    """A point mass; with a ``load`` (the number of an input) it is present only while that is 1."""

    frame: int
    mass: int
    load: int | None = None


@dataclass(frozen=True, slots=True)
class SolidBody:
    """A rigid body with inertia about its centre of mass: one scalar in the plane, six in space."""

    frame: int
    mass: int
    com: tuple[int, int, int]
    inertia: tuple[int, ...]


Body: TypeAlias = RodBody | PointBody | SolidBody


@dataclass(frozen=True, slots=True)
class Shape:
    """The shape of a link in collisions: a massless convex set; ``sizes`` are as in ``ir.Shape``.

    A shape with an axis extends from the frame's origin along ``sign`` times that axis. A hull is
    the convex hull of ``corners``, three scalars each.
    """

    frame: int
    kind: ir.ShapeKind
    axis: int
    sign: int
    sizes: tuple[int, ...]
    corners: tuple[tuple[int, int, int], ...] = ()

    @property
    def radius(self) -> int | None:
        """The scalar by which a point or a segment is grown in all directions."""
        return self.sizes[-1] if self.kind in {"sphere", "capsule"} else None

    @property
    def length(self) -> int | None:
        """The scalar that says how far it extends along its axis."""
        return self.sizes[0] if self.kind in {"capsule", "cylinder"} else None

    def across(self, dimension: int) -> tuple[int, ...]:
        """The axes along which it extends about its origin or its line, in that many dimensions."""
        if self.kind in {"box", "hull"}:
            return tuple(range(dimension))
        return tuple(i for i in range(dimension) if self.kind == "cylinder" and i != self.axis)


Collider: TypeAlias = Body | Shape


def scalars_of_step(step: Step | None) -> tuple[int, ...]:
    """The scalars of a step, in order."""
    match step:
        case Turn(_, angle):
            return (angle,)
        case Offset(vector):
            return vector
        case Joint() | None:
            return ()


def scalars_of_body(body: Body) -> tuple[int, ...]:
    """The scalars of a body, in order."""
    if isinstance(body, SolidBody):
        return (body.mass, *body.com, *body.inertia)
    return amounts_of(body)


def amounts_of(body: Body) -> tuple[int, ...]:
    """The scalars of a body that are not negative for any real body."""
    match body:
        case RodBody(_, _, _, length, density, radius):
            return (length, density) if radius is None else (length, density, radius)
        case PointBody(_, mass, _):
            return (mass,)
        case SolidBody(_, mass, _, inertia):
            return (mass, *inertia[:3])


@dataclass(frozen=True, slots=True)
class RobotModel:
    """A robot.

    ``frames`` are in topological order, frame 0 is the world. ``effectors`` are frames, in word
    order, as ``own``, the modules' own dynamics, and ``joints``, the degrees of freedom of the word
    once they may differ from ``dofs``. ``removed`` are word indices of joints that move nothing,
    ``owners`` the owners of bodies where known, ``shape_owners`` those of shapes. Shapes collide
    instead of ``covered`` bodies. ``apart`` are pairs of numbers of ``colliders`` that must not
    touch. If ``posed``, the orientation of effectors matters. ``payloads`` are numbers of bodies,
    ``seen`` frames of visuals, if asked for: no frame is kept or merged for them.
    """

    dimension: Literal[2, 3]
    scalars: tuple[ScalarNode, ...]
    frames: tuple[FrameNode, ...]
    dofs: tuple[RobotDof, ...]
    parameters: tuple[RobotParameter, ...]
    bodies: tuple[Body, ...]
    effectors: tuple[int, ...]
    removed: tuple[int, ...] = ()
    own: tuple[OwnDynamics, ...] = ()
    joints: tuple[WordDof, ...] | None = None
    owners: tuple[BodyOwner | None, ...] = ()
    apart: tuple[tuple[int, int], ...] = ()
    shapes: tuple[Shape, ...] = ()
    shape_owners: tuple[BodyOwner | None, ...] = ()
    covered: tuple[int, ...] = ()
    posed: bool = False
    payloads: tuple[int, ...] = ()
    seen: tuple[int, ...] = ()

    @property
    def colliders(self) -> tuple[Collider, ...]:
        """Everything that can collide: the bodies that are not covered, then the shapes."""
        return (*self._uncovered(self.bodies), *self.shapes)

    @property
    def collider_owners(self) -> tuple[BodyOwner | None, ...]:
        """The owner of each of the ``colliders`` where it is known; empty if no owner is known."""
        return (*self._uncovered(self.owners), *self.shape_owners)

    @property
    def collider_names(self) -> tuple[str, ...]:
        """The names of the ``colliders``: bodies and shapes are numbered from 1."""
        bodies = [f"body {number}" for number in range(1, len(self.bodies) + 1)]
        shapes = [f"shape {number}" for number in range(1, len(self.shapes) + 1)]
        return (*self._uncovered(bodies), *shapes)

    def _uncovered(self, items: Sequence[Item]) -> Iterator[Item]:
        return (item for number, item in enumerate(items) if number not in self.covered)

    @property
    def periodic(self) -> tuple[bool, ...]:
        """For each degree of freedom, whether a full turn of it gives the same robot.

        True if it is revolute without a range and no module's own dynamics read its coordinate.
        """
        read = {
            own.bound_dofs.get(leaf.name)
            for own in self.own
            for expression in own.expressions()
            for leaf in ir.leaves(expression)
            if isinstance(leaf, ir.DofOf)
        }
        return tuple(
            dof.kind == "revolute" and dof.range is None and number not in read
            for number, dof in enumerate(self.dofs)
        )

    @property
    def word_dofs(self) -> tuple[WordDof, ...]:
        """The degrees of freedom of the word, in word order and in the order of their module."""
        own = (WordDof(dof.kind, dof.range, i) for i, dof in enumerate(self.dofs))
        return tuple(own) if self.joints is None else self.joints

    def chain(self, frame: int) -> list[int]:
        """The frames from the world (excluded) to ``frame`` (included)."""
        nodes: list[int] = []
        while frame != WORLD:
            nodes.append(frame)
            frame = self.frames[frame].parent
        return nodes[::-1]

    def steps(self, frame: int) -> Iterator[Step]:
        """The steps from the world to a frame."""
        for node in self.chain(frame):
            step = self.frames[node].step
            if step is not None:
                yield step

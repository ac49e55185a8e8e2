"""The model of a robot: frames, degrees of freedom, bodies, effectors, own dynamics."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, TypeVar

from compiler.expressions.scalars import ScalarNode
from grammar_lang import ir

# --- The dynamics of its own that a module brings into a robot (Definition 5) ---------------------


@dataclass(frozen=True, slots=True)
class OwnDynamics:
    """States, declared inputs and torques of the module at word index ``symbol``.

    Their expressions name the module's own things; ``parameters`` and ``dofs`` say which of the
    robot's those are.  Coordinate, rate and input of a lost degree of freedom (None) read zero.
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
        """The robot's degrees of freedom by the names they have here."""
        return {name: dof for name, dof in self.dofs if dof is not None}

    @property
    def read_parameters(self) -> frozenset[int]:
        """The robot's parameters that the expressions name."""
        numbers = dict(self.parameters)
        found = (leaf for expression in self.expressions() for leaf in ir.leaves(expression))
        return frozenset(numbers[leaf.name] for leaf in found if isinstance(leaf, ir.ParameterOf))

    def expressions(self) -> Iterator[ir.Expr]:
        """What it is made of: derivatives, then torques."""
        yield from (state.derivative for state in self.states)
        yield from (torque.value for torque in self.torques)

    def renumbered(self, places: Mapping[int, int]) -> OwnDynamics:
        """The same after the robot's degrees of freedom got new numbers; the others are lost.

        What then acts on no degree of freedom is left out.
        """
        dofs = tuple((name, None if dof is None else places.get(dof)) for name, dof in self.dofs)
        return replace(self, dofs=dofs).acting()

    def acting(self) -> OwnDynamics:
        """Without the states and inputs that no torque depends on, and the torques on lost dofs."""
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
    """The dynamics of the module at a word index; None if it has none.

    ``parameters`` and ``dofs`` number the robot's by word index and name.
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
# The robot model: what an attribute grammar's evaluation on a derivation yields (FRG, Def. 6).


WORLD = 0

Item = TypeVar("Item")


@dataclass(frozen=True, slots=True)
class Turn:
    """Rigid rotation by a scalar angle (rad) about axis 0, 1 or 2 of the local frame."""

    axis: int
    angle: int


@dataclass(frozen=True, slots=True)
class Offset:
    """Rigid translation by three scalars (m) in the local frame."""

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
    """A degree of freedom of the joints at the word indices ``symbols``, merged into one.

    ``effort`` bounds its free input, ``inertia`` is its rotor's as the joint feels it, ``accel``
    bounds its acceleration, ``coulomb`` is its dry friction, ``gear`` its ratio; all closed.
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

    @property
    def amounts(self) -> tuple[ir.Expr | None, ...]:
        """What of its drive acts on its motion."""
        return self.effort, self.inertia, self.accel, self.coulomb

    @property
    def is_driven(self) -> bool:
        """Whether it has a drive of its own, or limits of one; such joints are not merged."""
        return any(each is not None for each in (*self.amounts, self.gear))


@dataclass(frozen=True, slots=True)
class WordDof:
    """A degree of freedom of the word, and where it is in the model.

    It is the coordinate ``dof`` of the model, or with others a summand of it, with ``sign`` (1 or
    -1).  A ``dof`` of None says that it moves nothing and was removed.
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
    """The module, at word index ``symbol``, that a body is that of."""

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
    """A point mass; with a ``load`` it is there at times: an input of the robot, by number."""

    frame: int
    mass: int
    load: int | None = None


@dataclass(frozen=True, slots=True)
class SolidBody:
    """A rigid body with inertia about its com: one scalar in the plane, six in space."""

    frame: int
    mass: int
    com: tuple[int, int, int]
    inertia: tuple[int, ...]


Body: TypeAlias = RodBody | PointBody | SolidBody


@dataclass(frozen=True, slots=True)
class Shape:
    """What a link is in collisions: a massless convex set, in ``sizes`` as ``ir.Shape`` has them.

    Those with an axis lead from the frame's origin along ``sign`` times it.  A hull is that of
    ``corners``, three scalars each.
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
        """The scalar of how far it leads along its axis."""
        return self.sizes[0] if self.kind in {"capsule", "cylinder"} else None

    def across(self, dimension: int) -> tuple[int, ...]:
        """The axes along which it extends beside its origin or its line, in so many dimensions."""
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
    """The scalars of a body that no real body has below zero."""
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

    ``frames`` are in topological order, frame 0 is the world.  ``effectors`` holds frames, in
    word order.  ``removed`` holds the word indices of joints that move nothing, ``own`` the
    dynamics of their own that modules have, in word order.  ``joints`` holds the degrees of freedom
    of the word, in word order, once they may be others than ``dofs``.  ``owners`` says whose a body
    is, where that is known, ``shape_owners`` whose a shape.  ``covered`` bodies do not collide:
    their links do as shapes.  Pairs that have to stay ``apart`` are numbers of ``colliders``.  Of
    ``posed`` robots the turn of effectors matters.  ``payloads`` are numbers of bodies.  ``seen``
    are the frames of visuals, where these were asked for: no frame is kept or joined for them.
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
        """What collides: the bodies that are not covered, then the shapes."""
        return (*self._uncovered(self.bodies), *self.shapes)

    @property
    def collider_owners(self) -> tuple[BodyOwner | None, ...]:
        """Whose each of the ``colliders`` is, where that is known; none where nothing is."""
        return (*self._uncovered(self.owners), *self.shape_owners)

    @property
    def collider_names(self) -> tuple[str, ...]:
        """What each of the ``colliders`` is called: bodies and shapes are numbered from 1."""
        bodies = [f"body {number}" for number in range(1, len(self.bodies) + 1)]
        shapes = [f"shape {number}" for number in range(1, len(self.shapes) + 1)]
        return (*self._uncovered(bodies), *shapes)

    def _uncovered(self, items: Sequence[Item]) -> Iterator[Item]:
        return (item for number, item in enumerate(items) if number not in self.covered)

    @property
    def periodic(self) -> tuple[bool, ...]:
        """Per degree of freedom, whether a whole turn of it gives the same robot.

        It is revolute and has no range, and no module's own dynamics read its coordinate.
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
        """The degrees of freedom of the word, in word order and then as their module has them."""
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

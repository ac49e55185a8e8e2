r"""A pose of a robot in the plane as unknown vectors, for nonlinear real arithmetic.

The frames between revolute joints are rigid except for prismatic joints: they are a *group*, which
rotates as one. If all points of a group other than its origin p are at one place d, its world
vector w is enough,

.. math:: |w|^2 = |d|^2,

otherwise it needs the direction (c, s) of the group, with :math:`c^2 + s^2 = 1`, and points are at
:math:`p + (c d_x - s d_y, s d_x + c d_y)`. Each joint turns freely: limits of revolute joints are
left out. Everything else is exact.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from compiler.encodings.region_terms import (
    Quantity,
    RealScript,
    add,
    constant,
    equal,
    multiply,
    subtract,
    sum_of_squares,
)
from compiler.encodings.scalar_terms import Angle, ScalarTerms, slide_term
from compiler.robots.robot import (
    WORLD,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    Shape,
    SolidBody,
    Step,
    Turn,
)

Vector: TypeAlias = tuple[Quantity, Quantity]

ZERO = (constant(0), constant(0))
EAST = Angle(constant(1), constant(0))


@dataclass(frozen=True, slots=True)
class Place:
    """A point of a group: ``local`` is in the axes of the group, relative to its origin."""

    group: int
    local: Vector


@dataclass(frozen=True, slots=True)
class Rod:
    """The ends of a rod or of a shape's axis, and its direction in the axes of their group."""

    ends: tuple[Place, Place]
    along: Vector


@dataclass(frozen=True, slots=True)
class _Frame:
    """A frame in its group: its origin and its axes."""

    place: Place
    axes: Angle


@dataclass(slots=True)
class PlanarPose:
    """One robot in one unknown pose, named ``pose`` in the script.

    ``effectors``, ``points`` (of colliders without a length) and ``rods`` (of those with one) are
    in the order of the model.
    """

    model: RobotModel
    scalars: ScalarTerms
    pose: str
    effectors: list[Place] = field(default_factory=list[Place])
    points: list[Place] = field(default_factory=list[Place])
    rods: list[Rod] = field(default_factory=list[Rod])
    _frames: list[_Frame] = field(default_factory=list[_Frame])
    _origins: list[Place] = field(default_factory=list[Place])
    _slides: dict[int, Quantity] = field(default_factory=dict[int, Quantity])
    _arms: dict[int, list[str]] = field(default_factory=dict[int, list[str]])
    _turned: dict[tuple[int, str], Vector] = field(default_factory=dict[tuple[int, str], Vector])
    _worlds: dict[int, Vector] = field(default_factory=dict[int, Vector])
    _directions: dict[int, Angle] = field(default_factory=dict[int, Angle])

    def __post_init__(self) -> None:
        self._origins.append(Place(0, ZERO))
        self._frames.append(_Frame(Place(0, ZERO), EAST))
        absorbed = _absorbed(self.model)
        for number, node in enumerate(self.model.frames):
            if number != WORLD:
                step = None if number in absorbed else node.step
                self._frames.append(self._stepped(self._frames[node.parent], step))
        self.effectors = [self._frames[frame].place for frame in self.model.effectors]
        for each in self.model.colliders:
            frame = self._frames[each.frame]
            if isinstance(each, SolidBody):
                local = (self.scalars.term(each.com[0]), self.scalars.term(each.com[1]))
                self.points.append(self._beside(frame, local))
            elif isinstance(each, Shape) and each.corners:
                for x, y, _ in each.corners:
                    local = (self.scalars.term(x), self.scalars.term(y))
                    self.points.append(self._beside(frame, local))
            elif isinstance(each, PointBody) or each.length is None:
                self.points.append(frame.place)
            else:
                along = _turn(frame.axes, _unit(each.axis, each.sign))
                end = self._moved(frame, each.axis, each.sign, self.scalars.term(each.length))
                self.rods.append(Rod((frame.place, end), along))
        used = [*self.effectors, *self.points, *self._origins]
        used += [end for rod in self.rods for end in rod.ends]
        for place in used:
            if _text(place.local) != _text(ZERO):
                texts = self._arms.setdefault(place.group, [])
                texts.append(_text(place.local))

    @property
    def script(self) -> RealScript:
        """The script to which the pose is written."""
        return self.scalars.script

    # --- frames in their groups ---

    def _stepped(self, frame: _Frame, step: Step | None) -> _Frame:
        match step:
            case None:
                return frame
            case Turn(_, angle):
                return _Frame(frame.place, self._product(frame.axes, self.scalars.angle(angle)))
            case Offset(vector):
                local = (self.scalars.term(vector[0]), self.scalars.term(vector[1]))
                return _Frame(self._beside(frame, local), frame.axes)
            case Joint(dof, axis, sign) if self.model.dofs[dof].kind == "prismatic":
                return _Frame(self._moved(frame, axis, sign, self._slide(dof)), frame.axes)
            case Joint():
                self._origins.append(frame.place)
                return _Frame(Place(len(self._origins) - 1, ZERO), EAST)

    def _slide(self, dof: int) -> Quantity:
        if dof not in self._slides:
            self._slides[dof] = slide_term(self.model, self.script, dof, self.pose)
        return self._slides[dof]

    def _moved(self, frame: _Frame, axis: int, sign: int, way: Quantity) -> Place:
        unit = _unit(axis, sign)
        return self._beside(frame, (multiply(unit[0], way), multiply(unit[1], way)))

    def _beside(self, frame: _Frame, local: Vector) -> Place:
        x, y = _turn(frame.axes, local)
        before = frame.place.local
        return Place(
            frame.place.group, (self._named(add(before[0], x)), self._named(add(before[1], y)))
        )

    def _named(self, quantity: Quantity) -> Quantity:
        return self.script.named("d", quantity)

    def _product(self, first: Angle, second: Angle) -> Angle:
        if first == EAST:
            return second
        cosine, sine = _turn(first, (second.cosine, second.sine))
        return Angle(self._named(cosine), self._named(sine))

    # --- the world ---

    def position(self, place: Place) -> Vector:
        """A point in the axes of the world."""
        if place.group == 0:
            return place.local
        x, y = self._origin(place.group)
        if _text(place.local) == _text(ZERO):
            return x, y
        across, up = self._world(place)
        return add(x, across), add(y, up)

    def line(self, rod: Rod) -> tuple[Quantity, Quantity, Quantity]:
        """A direction u of a rod and m = u_x a_y - u_y a_x, for a point a on its line."""
        first = rod.ends[0]
        outer = [end for end in rod.ends if _text(end.local) != _text(ZERO)]
        if first.group == 0:
            u = rod.along
        elif len(outer) == 1 and self._is_arm(first.group):
            u = self._world(outer[0])
        else:
            u = _turn(self._direction(first.group), rod.along)
        x, y = self.position(first)
        u = self.script.named("u", u[0]), self.script.named("u", u[1])
        moment = subtract(multiply(u[0], y), multiply(u[1], x))
        return u[0], u[1], self.script.named("m", moment)

    def _origin(self, group: int) -> Vector:
        if group not in self._worlds:
            x, y = self.position(self._origins[group])
            self._worlds[group] = self.script.named("p", x), self.script.named("p", y)
        return self._worlds[group]

    def _is_arm(self, group: int) -> bool:
        """Whether one vector is enough for all points of the group."""
        return len(set(self._arms.get(group, []))) == 1

    def _world(self, place: Place) -> Vector:
        """The vector from a group's origin to one of its points, in the axes of the world."""
        key = place.group, _text(place.local)
        if key in self._turned:
            return self._turned[key]
        if self._is_arm(place.group):
            script, square = self.script, sum_of_squares(place.local)
            found = (script.fresh(f"{self.pose}_w"), script.fresh(f"{self.pose}_w"))
            script.assertion(equal(sum_of_squares(found), square))
        else:
            x, y = _turn(self._direction(place.group), place.local)
            found = (self._named(x), self._named(y))
        self._turned[key] = found
        return found

    def _direction(self, group: int) -> Angle:
        if group not in self._directions:
            script = self.script
            cosine, sine = (script.fresh(f"{self.pose}_c"), script.fresh(f"{self.pose}_s"))
            script.assertion(equal(sum_of_squares((cosine, sine)), constant(1)))
            self._directions[group] = Angle(cosine, sine)
        return self._directions[group]


def _absorbed(model: RobotModel) -> set[int]:
    """Rotating frames that are the only frame behind a revolute joint, which absorbs the rotation.

    Nothing else may be in the joint's frame.
    """
    occupied = {each.frame for each in model.colliders} | set(model.effectors)
    children: dict[int, list[int]] = {}
    for number, node in enumerate(model.frames):
        if number != WORLD:
            children.setdefault(node.parent, []).append(number)
    found = set[int]()
    for number, node in enumerate(model.frames):
        step, below = node.step, children.get(number, [])
        turns = isinstance(step, Joint) and model.dofs[step.dof].kind == "revolute"
        if turns and number not in occupied and len(below) == 1:
            (only,) = below
            if isinstance(model.frames[only].step, Turn):
                found.add(only)
    return found


def _unit(axis: int, sign: int) -> Vector:
    return (constant(sign), constant(0)) if axis == 0 else (constant(0), constant(sign))


def _turn(angle: Angle, vector: Vector) -> Vector:
    """The vector rotated by an angle."""
    x, y = vector
    return (
        subtract(multiply(angle.cosine, x), multiply(angle.sine, y)),
        add(multiply(angle.sine, x), multiply(angle.cosine, y)),
    )


def _text(vector: Vector) -> str:
    return f"{vector[0].text} {vector[1].text}"

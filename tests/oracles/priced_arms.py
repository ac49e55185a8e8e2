"""Random families of planar arms with prices, and which of their robots do a task, by algebra.

An arm of links that all turn freely about its base reaches just the points at a distance of at most
the sum of their lengths and at least what the longest one exceeds the others by.  Nothing weighs,
nothing is in the way, and there is time: an arm does the task if it reaches both regions.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from math import cos, hypot, pi, sin

CLEAR = 0.01
"""Metres by which every robot of a family reaches into a region, or does not reach it."""
PAIRS = 3
Point = tuple[float, float]
Robot = tuple[str, ...]
"""The joints and the links of an arm, in turn."""


@dataclass(frozen=True)
class Kind:
    """A module; its numbers in hundredths of their units, joints without a length."""

    name: str
    price: int
    weight: int
    length: int = 0


@dataclass(frozen=True)
class Wish:
    """An objective as it is written, by how many percent it may be left, and its value."""

    text: str
    value: Callable[[PricedArms, Robot], Fraction]
    within: int = 0

    def __str__(self) -> str:
        return f"{self.text} within {self.within} %" if self.within else self.text

    def most(self, least: Fraction) -> Fraction:
        """What robots may have where it is so much at least."""
        return least * (100 + self.within) / 100


def _price(arms: PricedArms, robot: Robot) -> Fraction:
    return 3 + sum(Fraction(arms.kinds[name].price, 100) for name in robot)


def _weight(arms: PricedArms, robot: Robot) -> Fraction:
    return sum((Fraction(arms.kinds[name].weight, 100) for name in robot), Fraction(0))


def _modules(_: PricedArms, robot: Robot) -> Fraction:
    return Fraction(len(robot) + 2)


PRICE, WEIGHT = Wish("sum(price)", _price), Wish("sum(weight)", _weight)
MASS, MODULES = Wish("mass", _weight), Wish("modules", _modules)
WISHES: tuple[tuple[Wish, ...], ...] = (
    (PRICE,),
    (Wish("sum(price)", _price, 10), MODULES),
    (PRICE, WEIGHT),
    (MODULES, PRICE),
    (MASS,),
    (Wish("mass", _weight, 15), PRICE),
    (Wish("sum(price)", _price, 5), Wish("modules", _modules, 25), MASS),
)


@dataclass(frozen=True)
class Place:
    """A convex region with its corners in order."""

    text: str
    corners: tuple[Point, ...]

    def distances(self, centre: Point) -> tuple[float, float]:
        """From a point to the nearest and to the farthest point of the region."""
        moved = [(x - centre[0], y - centre[1]) for x, y in self.corners]
        edges = list(zip(moved, [*moved[1:], moved[0]], strict=True))
        turns = [a[0] * b[1] - a[1] * b[0] for a, b in edges]
        inside = all(t > 0 for t in turns) or all(t < 0 for t in turns)
        near = 0.0 if inside else min(_from_origin(a, b) for a, b in edges)
        return near, max(hypot(*corner) for corner in moved)


def _from_origin(a: Point, b: Point) -> float:
    """The distance of a line segment from the origin."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    part = min(1.0, max(0.0, -(a[0] * dx + a[1] * dy) / (dx * dx + dy * dy)))
    return hypot(a[0] + part * dx, a[1] + part * dy)


@dataclass
class PricedArms:
    """A family with a task; ``text`` is the specification.

    Families that have a robot at the border of a region are drawn again, and so are those none of
    whose robots does the task, or more than half.
    """

    seed: int
    wishes: tuple[Wish, ...] = field(init=False)

    def __post_init__(self) -> None:
        choose = random.Random(f"priced arms {self.seed}")
        self.wishes = WISHES[self.seed % len(WISHES)]
        self._draw(choose)
        while not self._is_clear() or not 0 < len(self.able) <= len(self.robots) / 2:
            self._draw(choose)

    # --- what is drawn -------------------------------------------------------------------------

    def _draw(self, choose: random.Random) -> None:
        joints, links = choose.choice([(2, 3), (2, 4), (3, 3)])
        self.joints = [
            Kind(f"J{n}", choose.randrange(100, 40_000), choose.randrange(10, 90))
            for n in range(1, joints + 1)
        ]
        self.links = [
            Kind(
                f"L{n}",
                choose.randrange(100, 20_000),
                choose.randrange(5, 60),
                choose.randrange(10, 60),
            )
            for n in range(1, links + 1)
        ]
        self.kinds = {kind.name: kind for kind in (*self.joints, *self.links)}
        self.range = choose.choice(["", " in [-360, 360] deg"])
        self.base = choose.randint(-30, 30), choose.randint(-30, 30)
        self.home, self.shelf = self._place(choose), self._place(choose)
        self.robots = list(self._robots())
        self.able = [robot for robot in self.robots if self.does(robot)]

    def _place(self, choose: random.Random) -> Place:
        """A region somewhere about the base, in hundredths of a metre."""
        far, angle = choose.uniform(10, 140), choose.uniform(-pi, pi)
        x = round(self.base[0] + far * cos(angle))
        y = round(self.base[1] + far * sin(angle))
        half, other = choose.randint(5, 12), choose.randint(5, 12)
        match choose.choice(["box", "hull", "polytope"]):
            case "box":
                left, right, below, above = x - half, x + half, y - other, y + other
                text = f"box [{_m(left)}, {_m(right)}] x [{_m(below)}, {_m(above)}]"
                corners = [(left, below), (right, below), (right, above), (left, above)]
            case "hull":
                turn = choose.uniform(0, pi)
                c, s = cos(turn), sin(turn)
                ends = (-half, -other), (half, -other), (half, other), (-half, other)
                corners = [(round(x + a * c - b * s), round(y + a * s + b * c)) for a, b in ends]
                text = "hull " + ", ".join(f"({_m(p)}, {_m(q)})" for p, q in corners)
            case _:
                corners = [(x + half, y), (x, y + half), (x - half, y), (x, y - half)]
                sides = (
                    ("x + y", x + y), ("-x - y", -x - y), ("x - y", x - y), ("y - x", y - x)
                )  # fmt: skip
                parts = " ".join(f"{side} <= {_m(middle + half)};" for side, middle in sides)
                text = f"polytope {{ {parts} }}"
        return Place(f"{text} m", tuple((p / 100, q / 100) for p, q in corners))

    # --- which robots do the task --------------------------------------------------------------

    def _robots(self) -> Iterator[Robot]:
        for pairs in range(1, PAIRS + 1):
            for joints in product(self.joints, repeat=pairs):
                for links in product(self.links, repeat=pairs):
                    both = zip(joints, links, strict=True)
                    yield tuple(kind.name for pair in both for kind in pair)

    def _gaps(self, robot: Robot) -> tuple[float, ...]:
        """By how much a robot reaches into the regions: beyond the near and the far points."""
        lengths = [self.kinds[name].length / 100 for name in robot[1::2]]
        far, near = sum(lengths), max(0.0, 2 * max(lengths) - sum(lengths))
        centre = self.base[0] / 100, self.base[1] / 100
        found: list[float] = []
        for place in (self.home, self.shelf):
            nearest, farthest = place.distances(centre)
            found += [far - nearest, farthest - near]
        return tuple(found)

    def _is_clear(self) -> bool:
        return all(abs(gap) >= CLEAR for robot in self.robots for gap in self._gaps(robot))

    def does(self, robot: Robot) -> bool:
        """Whether a robot reaches both regions."""
        return all(gap > 0 for gap in self._gaps(robot))

    @property
    def least(self) -> tuple[Fraction, ...]:
        """The least value of each objective, among robots within what those before leave."""
        left, found = self.able, list[Fraction]()
        for wish in self.wishes:
            found.append(min(wish.value(self, robot) for robot in left))
            left = [robot for robot in left if wish.value(self, robot) <= wish.most(found[-1])]
        return tuple(found)

    def values(self, robot: Robot) -> tuple[Fraction, ...]:
        """What a robot has of each objective."""
        return tuple(wish.value(self, robot) for wish in self.wishes)

    # --- the specification ---------------------------------------------------------------------

    @property
    def text(self) -> str:
        """The family and the task."""
        minimize = " then ".join(map(str, self.wishes))
        joints, links = ([kind.name for kind in some] for some in (self.joints, self.links))
        return f"""\
module Base {{ role base; const price = 1; }}
{_lines(map(self._module, self.kinds.values()))}
module Hand {{ role effector; const price = 2; }}
edge eps;

grammar Arms {{
  start Arm;
  base: Arm -> Base;
{_lines(f"  {name.lower()}: Arm -> Arm eps {name};" for name in self.kinds)}
  hand: Arm -> Arm eps Hand;
  accept matches Base (eps ({" | ".join(joints)}) eps ({" | ".join(links)}))+ eps Hand;
}}

semantics Arms {{
  base {{ this.frame = world * move(x, {_m(self.base[0])} m) * move(y, {_m(self.base[1])} m); }}
{_lines(map(self._block, self.kinds.values()))}
  hand {{ this.frame = Arm.frame; effector(frame: Arm.frame); }}
}}

workspace Hall {{
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region Home {self.home.text};
  region Shelf {self.shelf.text};
}}

task Reach {{
  robot Arms;
  workspace Hall;
  start in Home at rest;
  reach Shelf;
  effort <= 50 N*m;
  control open loop;
  horizon 20 steps of 0.2 s;
  modules <= {2 + 2 * PAIRS};
  minimize {minimize};
}}
"""

    def _module(self, kind: Kind) -> str:
        own = f"const price = {_m(kind.price)}; const weight = {_m(kind.weight)} kg;"
        if kind.length:
            return f"module {kind.name} {{ role link; const length = {_m(kind.length)} m; {own} }}"
        return f"module {kind.name} {{ role joint; dof q: revolute z{self.range}; {own} }}"

    def _block(self, kind: Kind) -> str:
        name = kind.name
        step = f"move(x, {name}.length)" if kind.length else f"rot(z, {name}.q)"
        frame = f"Arm.frame * {step}"
        body = f"point(frame: {frame if kind.length else 'Arm.frame'}, mass: {name}.weight);"
        return f"  {name.lower()} {{ this.frame = {frame}; {body} }}"


def _m(hundredths: int) -> str:
    """Hundredths as a decimal."""
    return f"{hundredths / 100:.2f}"


def _lines(texts: Sequence[str] | Iterator[str]) -> str:
    return "\n".join(texts)

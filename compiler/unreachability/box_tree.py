"""Coverings of boxes by halving: a tree over parameters, with trees over coordinates at leaves."""

from __future__ import annotations

import string
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball
from compiler.expressions.evaluators.intervals import Ends, outward
from compiler.robots.robot import RobotDof, RobotModel
from grammar_lang import ir

# --------------------------------------------------------------------------------------------------
# The sides of a box to be covered: ranges, full turns and finite sets, and enclosures of parts.


@dataclass(frozen=True, slots=True)
class RangeSide:
    """The closed range between two real numbers, given by balls around them.

    Parts are fractions of the range and thus exact, however precisely the ends are known: two parts
    touch iff their fractions do. A ``circle`` is a full turn whose ends are one point.
    """

    low: arb
    high: arb
    circle: bool = False

    def enclosure(self, part: Part) -> Ends:
        """An interval around a part; undefined if the ends have no finite value."""
        width, steps = self.high - self.low, 1 << part.halvings
        first = self.low + width * ball(Fraction(part.number, steps))
        last = self.low + width * ball(Fraction(part.number + 1, steps))
        return outward(first, last)


@dataclass(frozen=True, slots=True)
class ChoiceSide:
    """A finite set of numbers, given by balls around them, in the order listed."""

    values: tuple[arb, ...]

    @property
    def circle(self) -> bool:
        """Whether the ends are one point: they are not."""
        return False

    def chosen(self, part: Part) -> tuple[int, int]:
        """The index of the first number of a part, and the index after its last.

        Raises:
            BoxTreeError: a single value is halved.
        """
        first, last = 0, len(self.values)
        for place in reversed(range(part.halvings)):
            if last - first < 2:
                raise BoxTreeError("it halves a single value")
            middle = first + (last - first + 1) // 2
            first, last = (middle, last) if part.number >> place & 1 else (first, middle)
        return first, last

    def enclosure(self, part: Part) -> Ends:
        """An interval around the values of a part."""
        first, last = self.chosen(part)
        low, high = self.values[first], self.values[first]
        for value in self.values[first + 1 : last]:
            low, high = low.min(value), high.max(value)
        return outward(low, high)


Side: TypeAlias = RangeSide | ChoiceSide


def parameter_sides(model: RobotModel) -> tuple[Side, ...]:
    """The domains of the parameters of a robot, at the working precision."""
    return tuple(_domain(parameter.domain) for parameter in model.parameters)


def coordinate_sides(model: RobotModel) -> tuple[RangeSide, ...] | None:
    """The ranges of the coordinates; None if a prismatic joint has no range.

    An unlimited revolute joint has a circle, from -pi to pi.
    """
    found = [_coordinate(dof) for dof in model.dofs]
    known = [side for side in found if side is not None]
    return tuple(known) if len(known) == len(found) else None


def enclosures(sides: Sequence[Side], parts: Sequence[Part]) -> list[Ends]:
    """Intervals around the sides of a box."""
    return [side.enclosure(part) for side, part in zip(sides, parts, strict=True)]


def _domain(domain: ir.Interval | ir.Choices) -> Side:
    if isinstance(domain, ir.Choices):
        return ChoiceSide(tuple(closed_ball(value) for value in domain.values))
    return RangeSide(closed_ball(domain.lower), closed_ball(domain.upper))


def _coordinate(dof: RobotDof) -> RangeSide | None:
    if dof.range is not None:
        return RangeSide(closed_ball(dof.range.lower), closed_ball(dof.range.upper))
    return RangeSide(-arb.pi(), arb.pi(), circle=True) if dof.kind == "revolute" else None


# --- Coverings of boxes by halving: a tree over parameters with trees over coordinates ------------
#
# A tree is the list of its nodes in prefix order: a node that halves is the number of the side that
# it halves, followed by the trees of the first and the second half. As text: ``boxes 1``, then one
# letter per node, ignoring blanks and line ends. ``A B ...`` halve the first, second ... parameter,
# ``a b ...`` the coordinates; ``.`` is a box of coordinates. ``|`` (no way through) or ``!`` (out
# of reach of the drives) is a box of parameters, followed by a tree of coordinates. ``$`` is a box
# whose robots have too much of an objective, and nothing follows.


HEADER = "boxes 1"
MOST_VARIABLES = len(string.ascii_lowercase)
"""The most parameters, and the most coordinates."""
MOST_HALVINGS = 60
"""The most halvings of one side: positions of its parts then fit 64-bit integers."""
MOST_NODES = 1_000_000
LINE = 100
"""The letters on a line."""

LEAF: Literal[-1] = -1
CoordinateTree: TypeAlias = tuple[int, ...]
"""Nodes in prefix order: the number of a coordinate that is halved, or ``LEAF``."""
Reason: TypeAlias = Literal["|", "!", "$"]


class BoxTreeError(ValueError):
    """A text is not a covering, or the covering is of another robot."""


@dataclass(frozen=True, slots=True)
class ParameterLeaf:
    """A box of parameters, and why no robot in it does the task, shown on boxes of coordinates.

    There are no such boxes if the robots have too much of an objective.
    """

    reason: Reason
    coordinates: CoordinateTree


ParameterTree: TypeAlias = tuple[int | ParameterLeaf, ...]
"""Nodes in prefix order: the number of a parameter that is halved, or a leaf."""


@dataclass(frozen=True, slots=True)
class Part:
    """The part from ``number / 2^halvings`` to ``(number + 1) / 2^halvings`` of a side.

    For a finite set, halvings choose its first or second half, the first being the larger, and so
    on.
    """

    number: int = 0
    halvings: int = 0

    def halves(self) -> tuple[Part, Part]:
        """Both halves; they share their middle."""
        return Part(2 * self.number, self.halvings + 1), Part(
            2 * self.number + 1, self.halvings + 1
        )


Parts: TypeAlias = tuple[Part, ...]
"""A box: a part for every side."""


def text(tree: ParameterTree) -> str:
    """The text of a covering, as in its file."""
    code = "".join(_code(node) for node in tree)
    lines = (code[i : i + LINE] for i in range(0, len(code), LINE))
    return "\n".join([HEADER, *lines]) + "\n"


def _code(node: int | ParameterLeaf) -> str:
    if isinstance(node, int):
        return string.ascii_uppercase[node]
    below = ("." if item == LEAF else string.ascii_lowercase[item] for item in node.coordinates)
    return node.reason + "".join(below)


def parse(content: str) -> ParameterTree:
    """Read the text of a covering.

    Raises:
        BoxTreeError: it is not a covering.
    """
    header, _, body = content.partition("\n")
    if header.strip() != HEADER:
        raise BoxTreeError(f"the first line is not `{HEADER}`")
    code = "".join(body.split())
    if len(code) > MOST_NODES:
        raise BoxTreeError(f"it has more than {MOST_NODES} nodes")
    nodes: list[int | ParameterLeaf] = []
    place, missing = 0, 1
    while missing:
        letter = code[place : place + 1]
        place += 1
        if letter == "$":
            nodes.append(ParameterLeaf("$", ()))
            missing -= 1
        elif letter in ("|", "!"):
            end = _end(code, place)
            below = tuple(_COORDINATES[item] for item in code[place:end])
            nodes.append(ParameterLeaf("|" if letter == "|" else "!", below))
            place, missing = end, missing - 1
        elif letter and letter in string.ascii_uppercase:
            nodes.append(string.ascii_uppercase.index(letter))
            missing += 1
        else:
            raise BoxTreeError(_unexpected(letter))
    if place != len(code):
        raise BoxTreeError("something follows its end")
    return tuple(nodes)


_COORDINATES = {".": LEAF, **{letter: i for i, letter in enumerate(string.ascii_lowercase)}}


def _end(code: str, start: int) -> int:
    """The index after the tree of coordinates that starts at ``start``."""
    missing, place = 1, start
    while missing:
        letter = code[place : place + 1]
        if letter not in _COORDINATES:
            raise BoxTreeError(_unexpected(letter))
        missing += -1 if letter == "." else 1
        place += 1
    return place


def _unexpected(letter: str) -> str:
    return f"an unexpected `{letter}`" if letter else "it ends too early"


def coordinate_boxes(tree: CoordinateTree, count: int) -> Iterator[Parts]:
    """The boxes of a tree over ``count`` coordinates, in prefix order.

    Raises:
        BoxTreeError: it halves a coordinate that the robot does not have, or halves too often.
    """
    waiting: list[Parts] = [(Part(),) * count]
    for node in tree:
        box = waiting.pop()
        if node == LEAF:
            yield box
        else:
            waiting += _halved(box, node)[::-1]


def parameter_boxes(tree: ParameterTree, count: int) -> Iterator[tuple[Parts, ParameterLeaf]]:
    """The boxes of a tree over ``count`` parameters, with their leaves, in prefix order.

    Raises:
        BoxTreeError: it halves a parameter that the robot does not have, or halves too often.
    """
    waiting: list[Parts] = [(Part(),) * count]
    for node in tree:
        box = waiting.pop()
        if isinstance(node, ParameterLeaf):
            yield box, node
        else:
            waiting += _halved(box, node)[::-1]


def _halved(box: Parts, variable: int) -> Sequence[Parts]:
    if variable >= len(box):
        raise BoxTreeError("it halves what the robot does not have")
    if box[variable].halvings == MOST_HALVINGS:
        raise BoxTreeError(f"it halves one side more than {MOST_HALVINGS} times")
    halves = box[variable].halves()
    return [(*box[:variable], half, *box[variable + 1 :]) for half in halves]

"""The sides of a box to be covered: ranges, full turns and finite sets, and enclosures of parts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.coverings.box_tree import BoxTreeError, Part
from compiler.expressions.evaluators.balls import ball, closed_ball
from compiler.expressions.evaluators.intervals import Ends, outward
from compiler.robots.robot import RobotDof, RobotModel
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class RangeSide:
    """The closed range between two real numbers, given by balls around them.

    Parts are fractions of the range, exact however the ends are known: two parts touch iff their
    fractions do.  A ``circle`` is a full turn whose ends are one point.
    """

    low: arb
    high: arb
    circle: bool = False

    def enclosure(self, part: Part) -> Ends:
        """An interval around a part; undefined where the ends have no finite value."""
        width, steps = self.high - self.low, 1 << part.halvings
        first = self.low + width * ball(Fraction(part.number, steps))
        last = self.low + width * ball(Fraction(part.number + 1, steps))
        return outward(first, last)


@dataclass(frozen=True, slots=True)
class ChoiceSide:
    """A finite set of numbers, given by balls around them, as they are listed."""

    values: tuple[arb, ...]

    @property
    def circle(self) -> bool:
        """Whether the ends are one point: they are not."""
        return False

    def chosen(self, part: Part) -> tuple[int, int]:
        """The first number in the list of a part, and the one behind its last.

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
    """The ranges of the coordinates; None where a prismatic joint has none.

    An unlimited revolute joint turns about a circle, from -pi to pi.
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

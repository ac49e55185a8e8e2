"""The robots of a structure with less than some amount of an objective, by their parameters."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.intervals import Ends, outward
from compiler.expressions.exact_numbers import exact_rational, rational_bounds
from compiler.expressions.exact_numbers import outward as bounds_of
from compiler.objectives.least_values import Amount, mass_bounds
from compiler.robots.robot import RobotModel, RobotParameter
from grammar_lang import ir

SLICES = 64
"""The parts of a side of a box; parts at its ends that contain no such robot are left out."""


@dataclass(frozen=True, slots=True)
class Less:
    """Less than ``bound`` of an objective, and at most the given amounts of those in ``limits``."""

    limits: tuple[tuple[Amount, Fraction], ...]
    amount: Amount
    bound: Fraction

    def is_open(self, word: Sequence[str], model: RobotModel | None) -> bool:
        """Whether some robot of a structure may satisfy this, whatever its parameters."""
        within = all(amount.of_robot(word, model) <= most for amount, most in self.limits)
        return within and self.amount.of_robot(word, model) < self.bound

    @property
    def text(self) -> str:
        """The condition as text, the same in every run."""
        allowed = [f"{amount.text} <= {most}" for amount, most in self.limits]
        return " and ".join([*allowed, f"{self.amount.text} < {self.bound}"])


@dataclass(frozen=True, slots=True)
class CheaperRobots:
    """The robots of a structure that satisfy any of ``less``."""

    word: tuple[str, ...]
    model: RobotModel
    less: tuple[Less, ...]

    def none_in(self, box: Sequence[Ends]) -> bool:
        """Whether no parameters in a box give such a robot.

        Args:
            box: intervals around the parameters of the robot, in their order.
        """
        return all(self._excluded(box, each) for each in self.less)

    def narrowed(self, box: Sequence[Ends]) -> list[Ends]:
        """A box that contains all parameters of the given box that give such a robot.

        Slices at both ends of each side, in multiples of its ``SLICES``-th part, are left out.
        """
        found = list(box)
        for i, side in enumerate(box):
            if side.finite and side.low < side.high:
                found[i] = self._narrowed(found, i)
        return found

    def _narrowed(self, box: list[Ends], place: int) -> Ends:
        """The side of a box without the largest slices at its ends that contain no such robot."""
        low, high = box[place].low, box[place].high
        edges = [low, *(low + (high - low) * k / SLICES for k in range(1, SLICES)), high]

        def none_in(first: arb, last: arb) -> bool:
            return self.none_in([*box[:place], outward(first, last), *box[place + 1 :]])

        above = [*range(1, SLICES), SLICES]
        last = above[bisect_left(above[:-1], x=True, key=lambda k: none_in(edges[k], high))]
        below = [*range(last - 1, 0, -1), 0]
        first = below[bisect_left(below[:-1], x=True, key=lambda k: none_in(low, edges[k]))]
        return outward(edges[first], edges[last])

    def _excluded(self, box: Sequence[Ends], less: Less) -> bool:
        if self.least(less.amount, box) >= less.bound:
            return True
        return any(self.least(amount, box) > most for amount, most in less.limits)

    def least(self, amount: Amount, box: Sequence[Ends]) -> Fraction:
        """A lower bound on an objective of a robot with parameters in a box, in SI units."""
        least = amount.of_robot(self.word, self.model)
        if amount.exact or not all(side.finite for side in box):
            return least
        if amount.objective.kind == "mass":
            values = map(_value, self.model.parameters, box)
            bounds = mass_bounds(self.model, list(values))
            return least if bounds is None else max(least, bounds[0])
        if amount.objective.kind == "sum":
            return max(least, self._sum(amount, box))
        return least

    def _sum(self, amount: Amount, box: Sequence[Ends]) -> Fraction:
        """The sum over the word, in which some symbols add a parameter."""
        varied = {name for name, value in amount.objective.amounts if value is None}
        total = amount.of_word(symbol for symbol in self.word if symbol not in varied)
        for parameter, side in zip(self.model.parameters, box, strict=True):
            if parameter.module in varied and parameter.name == amount.objective.attribute:
                value = _value(parameter, side)
                if isinstance(value, arb):
                    value = (bounds_of(value) or (Fraction(0),))[0]
                total += value
        return total


def _value(parameter: RobotParameter, side: Ends) -> Fraction | arb:
    """The value of a parameter in a side if it is a single rational; else a ball around it."""
    low, high = bounds_of(side.low), bounds_of(side.high)
    if isinstance(parameter.domain, ir.Interval) or low is None or high is None:
        return side.ball()
    found = [(rational_bounds(value), value) for value in parameter.domain.values]
    near = [value for (least, most), value in found if least <= high[1] and most >= low[0]]
    single = exact_rational(near[0]) if len(near) == 1 else None
    return side.ball() if single is None else single

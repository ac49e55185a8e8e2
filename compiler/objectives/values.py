"""The value of a robot with its parameters in an objective, in bounds that contain it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.expressions.exact_numbers import Bounds, rational_bounds, shortest_decimal
from compiler.objectives.least_values import Amount, mass_bounds
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel


@dataclass(frozen=True, slots=True)
class MotionValues:
    """The values of a motion.

    ``share`` is a lower bound of the margin of inputs to their bounds, as a share, None if no input
    has a choice; ``time`` is its duration (s); ``energy`` bounds the energy that drives turn over
    (J), None if unknown.
    """

    share: float | None
    time: Fraction
    energy: Bounds | None


def value_bounds(
    amount: Amount,
    word: Sequence[str],
    model: RobotModel,
    parameters: Sequence[ParameterValue],
    motion: MotionValues,
) -> Bounds | None:
    """Bounds of the value of a robot, in SI units; equal if it is recognised as rational.

    Args:
        amount: the objective.
        word: the word of the robot.
        model: the robot.
        parameters: the values of its parameters.
        motion: the values of its motion.

    Returns:
        None if it has no finite value.
    """
    match amount.objective.kind:
        case "effort":
            used = Fraction(0) if motion.share is None else 1 - shortest_decimal(motion.share)
            return used, used
        case "time":
            return motion.time, motion.time
        case "energy":
            return motion.energy
        case "mass":
            return mass_bounds(model, [value.exact for value in parameters])
        case _:
            return _sum(amount, word, parameters)


def _sum(amount: Amount, word: Sequence[str], parameters: Sequence[ParameterValue]) -> Bounds:
    """The sum over a word, in which some symbols add the value of a parameter."""
    values = {
        each.parameter.symbol: each.exact
        for each in parameters
        if each.parameter.name == amount.objective.attribute
    }
    varied = {name for name, value in amount.objective.amounts if value is None}
    low = high = Fraction(0)
    for place, symbol in enumerate(word):
        if symbol in varied:
            exact = values[place]
            bounds = (exact, exact) if isinstance(exact, Fraction) else rational_bounds(exact)
        else:
            bounds = (amount.weights.get(symbol, Fraction(0)),) * 2
        low, high = low + bounds[0], high + bounds[1]
    return low, high

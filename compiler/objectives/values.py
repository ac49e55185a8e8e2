"""What a robot with its parameters is worth in an objective, in bounds that contain it."""

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
    """What a motion is worth.

    ``share`` is what inputs keep from their bounds at least, as a share, None where none has a
    choice; ``time`` how long it takes (s); ``energy`` bounds of what drives turn over (J), None
    where they are not known.
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
    """Bounds of the value of a robot, in SI units; equal ones where it is seen to be rational.

    Args:
        amount: the objective.
        word: the word of the robot.
        model: the robot.
        parameters: the values of its parameters.
        motion: what its motion is worth.

    Returns:
        None where it has no finite value.
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
    """The sum over a word, of whose symbols some add the value of a parameter."""
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

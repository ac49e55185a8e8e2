"""Boxes of joint coordinates and parameters: their enclosures, halves and natural values.

A side is a range, which may be unlimited, or a finite set.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import closed_ball
from compiler.expressions.evaluators.exact import NotExact, PiLinear, exact_closed
from compiler.expressions.evaluators.intervals import INFINITY, Ends, around, outward
from compiler.expressions.exact_numbers import rational_bounds
from compiler.robots.robot import RobotModel
from grammar_lang import ir

FARTHEST, FINEST = 2.0**20, 2.0**-20

Side: TypeAlias = tuple[Ends, ...]
"""One interval for a range, or one for each element of a finite set."""
Box: TypeAlias = tuple[Side, ...]
Domain: TypeAlias = ir.Interval | ir.Choices | None


def domains(model: RobotModel) -> list[tuple[Domain, bool]]:
    """The domains of all coordinates, then of all parameters, and whether each is of an angle."""
    joints = [(dof.range, dof.kind == "revolute") for dof in model.dofs]
    return [*joints, *((parameter.domain, False) for parameter in model.parameters)]


def robot_box(model: RobotModel) -> Box:
    """All coordinates, then all parameters; an unlimited angle has one full turn."""
    return tuple(_side(domain, angle=angle) for domain, angle in domains(model))


def _side(domain: Domain, *, angle: bool) -> Side:
    match domain:
        case ir.Choices(values):
            return tuple(around(closed_ball(value)) for value in values)
        case ir.Interval(lower, upper):
            return (outward(closed_ball(lower), closed_ball(upper)),)
        case _:
            pi = arb.pi()
            return (outward(-pi, pi) if angle else Ends(-INFINITY, INFINITY),)


def hull(side: Side) -> Ends:
    """An interval around a side."""
    low, high = side[0].low, side[0].high
    for part in side[1:]:
        low, high = low.min(part.low), high.max(part.high)
    return Ends(low, high)


def middle(side: Side) -> float:
    """A number near the middle of a side; for an unlimited side 0, or twice its finite end."""
    part = side[(len(side) - 1) // 2]
    if part.finite:
        return float((part.low + part.high).mid()) / 2
    if part.low < 0 < part.high:
        return 0.0
    if part.high.is_finite():
        return min(2 * float(part.high), -1.0)
    return max(2 * float(part.low), 1.0)


def halves(side: Side) -> tuple[Side, Side] | None:
    """Two sides that cover it; None for a single value, and for a very small or distant side."""
    if len(side) > 1:
        cut = len(side) // 2
        return side[:cut], side[cut:]
    (part,) = side
    cut_at = arb(middle(side))
    finite = part.finite
    if (finite and part.high - part.low < FINEST) or not part.low < cut_at < part.high:
        return None
    if not finite and abs(cut_at) > 2 * FARTHEST:
        return None
    return (Ends(part.low, cut_at),), (Ends(cut_at, part.high),)


def side_text(side: Side) -> str:
    """A side as text, in SI units."""
    if len(side) > 1:
        return "{" + ", ".join(f"{float(part.low):.9g}" for part in side) + "}"
    return f"[{float(side[0].low):.9g}, {float(side[0].high):.9g}]"


def natural_values(domain: Domain, *, angle: bool) -> tuple[PiLinear, ...]:
    """Zero, right angles, the ends and the centre, as far as they are certainly in a domain."""
    if isinstance(domain, ir.Choices):
        return tuple(value for choice in domain.values if (value := _exact(choice)) is not None)
    found = [PiLinear(Fraction(0))]
    if angle:
        found += [PiLinear(Fraction(0), Fraction(k, 2)) for k in (1, -1, 2, -2, 3, -3, 4, -4)]
    if domain is None:
        return tuple(found[: 5 if angle else 1])
    first = _exact(domain.lower) or PiLinear(rational_bounds(domain.lower)[1])
    last = _exact(domain.upper) or PiLinear(rational_bounds(domain.upper)[0])
    centre = PiLinear((first.rational + last.rational) / 2, (first.pis + last.pis) / 2)
    found = [v for v in (*found, first, last, centre) if first.at_most(v) and v.at_most(last)]
    return tuple(dict.fromkeys(found))


def _exact(expression: ir.Expr) -> PiLinear | None:
    try:
        return exact_closed(expression)
    except NotExact:
        return None

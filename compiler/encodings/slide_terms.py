"""Unknown coordinates of prismatic joints, within outer rational limits."""

from __future__ import annotations

from flint import arb

from compiler.encodings.real_terms import Quantity, RealScript, between
from compiler.expressions.rational_enclosure import rational_bounds
from compiler.robots.robot import RobotModel


def slide_term(model: RobotModel, script: RealScript, dof: int, pose: str) -> Quantity:
    """A new unknown for the coordinate of a prismatic joint at a pose."""
    limits = model.dofs[dof].range
    if limits is None:
        return script.fresh(f"{pose}_q")
    lower = rational_bounds(limits.lower)[0]
    upper = rational_bounds(limits.upper)[1]
    low, high = (arb(int(end.numerator)) / end.denominator for end in (lower, upper))
    unknown = script.fresh(f"{pose}_q", low.union(high))
    script.assertion(*between((lower, upper), unknown))
    return unknown

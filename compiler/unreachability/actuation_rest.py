r"""The goal poses in which drives can keep a robot nearly still for a while, against gravity.

The last d seconds of a motion have rates of at most r. For the momentum P_i of a joint, row i of
M q',

.. math:: \dot P_i = u_i - g_i - b_i \dot q_i - f_i
    + \tfrac12 \dot q^\top (\partial_i M)\, \dot q, \qquad |P_i| \le r \sum_j |M_{ij}|

with friction f_i of at most c_i. So if the weight g_i exceeds the input's bound U_i by more than
all of the rest can make up for,

.. math:: d \left(g_i - U_i - |b_i| r - c_i - \tfrac12 r^2 \sum_{jk} |\partial_i M_{jk}|\right)
    > 2 r \sum_j |M_{ij}|

in all poses within r d of a box, no motion ends in this box; the same for -g_i.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from flint import arb

from compiler.dynamics.energy_graph import EnergyGraph
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.unreachability.actuation_bounds import LeafBox

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Rest:
    """The end of a motion: its last ``duration`` (s) with rates of at most ``rate`` (SI)."""

    rate: arb
    duration: arb


@dataclass(frozen=True, slots=True)
class Holding:
    """The bounds of the forces on the joints of a robot, for parameters of a box.

    ``tail`` holds the sides of the parameters, then the constants of the graph. ``inputs``,
    ``damping`` and ``friction`` (n,) bound the input of each joint, its b and its dry friction.
    """

    graph: EnergyGraph
    tail: Sequence[Ends]
    inputs: Sequence[arb]
    damping: Sequence[arb]
    friction: Sequence[arb]


@dataclass(frozen=True, slots=True)
class TooHeavy:
    """A joint, from 0, needs more than its drive has (N m or N) to be held still."""

    joint: int
    needed: arb
    available: arb


def held_goals(
    holding: Holding, rest: Rest, leaves: Sequence[LeafBox]
) -> tuple[list[LeafBox], list[TooHeavy]]:
    """The boxes, without those goals at which the drives cannot keep still, and why not."""
    kept, reasons = list[LeafBox](), list[TooHeavy]()
    for leaf in leaves:
        reason = _too_heavy(holding, rest, leaf) if leaf.goal_possible else None
        kept.append(leaf if reason is None else replace(leaf, goal_possible=False))
        reasons += [] if reason is None else [reason]
    return kept, reasons


def _too_heavy(holding: Holding, rest: Rest, leaf: LeafBox) -> TooHeavy | None:
    """A joint that cannot be kept still in any pose of a box; None if none is known."""
    graph, count = holding.graph, len(leaf.coordinates)
    if graph.potential is None:
        return None
    moved = rest.rate * rest.duration * arb(0, 1)
    sides = [around(side + moved) for side in leaf.coordinates]
    inputs = [*sides, *holding.tail]
    _, *pull = graph.potential.evaluate(inputs, INTERVALS)
    found = list[TooHeavy]()
    for joint, weight in enumerate(pull):
        if not weight.finite:
            continue
        least, most = weight.low.max(-weight.high), holding.inputs[joint]
        if least > most and _exceeds(holding, rest, inputs, joint, least - most, count):
            found.append(TooHeavy(joint, least, most))
    return max(found, key=lambda each: float(each.needed / each.available), default=None)


def _exceeds(
    holding: Holding, rest: Rest, inputs: list[Ends], joint: int, excess: arb, count: int
) -> bool:
    """Whether a weight beyond the input's bound moves the joint too much, whatever else acts."""
    graph, run = holding.graph, INTERVALS
    row = graph.mass.evaluate(inputs, run)[joint * count : (joint + 1) * count]
    turning = ZERO
    if joint in graph.active:
        slopes, size = graph.slopes.evaluate(inputs, run), count * count
        first = graph.active.index(joint) * size
        turning = _sum(slopes[first : first + size])
    other = holding.damping[joint] * rest.rate + holding.friction[joint]
    other += rest.rate * rest.rate * turning / 2
    return bool(rest.duration * (excess - other) > 2 * rest.rate * _sum(row))


def _sum(values: Sequence[Ends]) -> arb:
    """An upper bound of the sum of the sizes of values; infinite or nan if one is unbounded."""
    total = ZERO
    for value in values:
        total += abs(value.low).max(abs(value.high))
    return total.upper()

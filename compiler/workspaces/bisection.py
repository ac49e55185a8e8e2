"""Cuts that halve cells: a given cell, or repeatedly the largest one.

Source: Wongpiromsarn, Topcu, Ozay, Xu & Murray, *TuLiP: a software toolbox for receding horizon
temporal logic planning* (2011), splits cells until they are fine enough; here cells are halved by
volume.  Only the place of a cut depends on floats, and it is then a short rational.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from fractions import Fraction

from compiler.time_limits.time_limit import check_time
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.hull import Point, primitive
from compiler.workspaces.partition import Cut
from compiler.workspaces.polytope import Polytope
from grammar_lang.ir import HalfSpace

STEPS = 16
"""A direction given in floats is rounded to this many steps in its largest component."""


def bisections(abstraction: Abstraction, count: int) -> tuple[Cut, ...]:
    """Cuts that make at least ``count`` cells by halving the largest cell repeatedly.

    The largest is the first of those with the greatest volume; it is cut across its longest axis.
    """
    cells = [cell.polytope for cell in abstraction.cells]
    waiting = [(-cell.volume, number) for number, cell in enumerate(cells)]
    heapq.heapify(waiting)
    cuts: list[Cut] = []
    while len(cells) < count:
        check_time()
        _, number = waiting[0]
        row = _across(cells[number], _longest(cells[number]))
        inside, outside = cells[number].halves(row)
        if inside is None or outside is None:
            raise AssertionError("a cut between the ends of a cell meets its interior")
        cuts.append(Cut(number, row))
        cells[number] = inside
        heapq.heapreplace(waiting, (-inside.volume, number))
        heapq.heappush(waiting, (-outside.volume, len(cells)))
        cells.append(outside)
    return tuple(cuts)


def halving(abstraction: Abstraction, cell: int, direction: Sequence[float] | None = None) -> Cut:
    """The cut of a cell near its middle, across a direction (by default, its longest axis).

    Args:
        abstraction: the cells.
        cell: the index of the cell.
        direction: shape (d,), not zero, of any length; it is rounded to a short rational.
    """
    polytope = abstraction.cells[cell].polytope
    normal = _longest(polytope) if direction is None else _rounded(direction)
    return Cut(cell, _across(polytope, normal))


def _longest(cell: Polytope) -> Point:
    """The unit vector of the axis along which a cell is longest, the first one on a tie."""
    extents = [max(axis) - min(axis) for axis in zip(*cell.vertices, strict=True)]
    best = extents.index(max(extents))
    return tuple(Fraction(int(axis == best)) for axis in range(len(extents)))


def _rounded(direction: Sequence[float]) -> Point:
    """A primitive integer vector near a direction.

    Raises:
        ValueError: the direction is zero.
    """
    largest = max(abs(entry) for entry in direction)
    if not largest > 0:
        raise ValueError("no cell is halved across a direction of length zero")
    steps = primitive([round(STEPS * entry / largest) for entry in direction])
    return tuple(Fraction(step) for step in steps)


def _across(cell: Polytope, normal: Point) -> HalfSpace:
    """The half-space with this normal that ends near the middle of the cell, at a short decimal."""
    heights = [sum((a * x for a, x in zip(normal, v, strict=True)), Fraction(0))
               for v in cell.vertices]  # fmt: skip
    low, high = min(heights), max(heights)
    return HalfSpace(normal, short_between(low, high))


def short_between(low: Fraction, high: Fraction) -> Fraction:
    """A decimal with the fewest digits within ``(high - low) / 16`` of the middle of both."""
    middle, slack = (low + high) / 2, (high - low) / 16
    scale = Fraction(1)
    while scale <= slack / 5:
        scale *= 10
    while True:
        near = round(middle / scale) * scale
        if abs(near - middle) <= slack:
            return near
        scale /= 10

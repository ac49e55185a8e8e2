"""Boxes of the parameters of a robot, halved if nothing is known about them as a whole.

A box is a tree: it is whole, or cut in two at a value of one parameter, or after a number of its
choices. The two parts of an interval share their common end; once one of them is completely
refuted, the other one no longer contains that end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.exact_numbers import rational_bounds
from compiler.missions.parameter_ranges import Range, Ranges, ranges_of
from compiler.robots.robot import RobotModel, RobotParameter
from grammar_lang import ir

Domain: TypeAlias = ir.Interval | ir.Choices
Box: TypeAlias = tuple[Domain, ...]
"""A domain for each parameter of a robot, in their order."""


@dataclass(frozen=True, slots=True)
class Cut:
    """The place of a cut: a value of an interval, or a number of choices."""

    parameter: int
    at: Fraction | int


def whole_box(model: RobotModel) -> Box:
    """The box of all parameters of a robot."""
    return tuple(parameter.domain for parameter in model.parameters)


def within_box(model: RobotModel, box: Box) -> RobotModel:
    """The robots of a structure with parameters in a box."""
    parameters: list[RobotParameter] = [
        replace(parameter, domain=domain)
        for parameter, domain in zip(model.parameters, box, strict=True)
    ]
    return replace(model, parameters=tuple(parameters))


def parts(box: Box, cut: Cut) -> tuple[Box, Box]:
    """The two parts of a box.

    Raises:
        ValueError: a part would be empty, or there is no such parameter.
    """
    if not 0 <= cut.parameter < len(box):
        raise ValueError("there is no such parameter")
    domain = box[cut.parameter]
    if isinstance(domain, ir.Choices):
        if not isinstance(cut.at, int) or not 0 < cut.at < len(domain.values):
            raise ValueError("the choices are not cut in two")
        below: Domain = ir.Choices(domain.values[: cut.at])
        above: Domain = ir.Choices(domain.values[cut.at :])
    else:
        low, high = rational_bounds(domain.lower)[1], rational_bounds(domain.upper)[0]
        if isinstance(cut.at, int) or not low < cut.at < high:
            raise ValueError("the interval is not cut in two")
        below = ir.Interval(domain.lower, ir.Num(cut.at))
        above = ir.Interval(ir.Num(cut.at), domain.upper)
    return _with(box, cut.parameter, below), _with(box, cut.parameter, above)


def _with(box: Box, place: int, domain: Domain) -> Box:
    return (*box[:place], domain, *box[place + 1 :])


def box_key(box: Box) -> str:
    """A text for a box, the same in every run."""
    return ";".join(
        ",".join(map(str, (domain.lower, domain.upper)))
        if isinstance(domain, ir.Interval)
        else "|".join(map(str, domain.values))
        for domain in box
    )


@dataclass(slots=True, eq=False)
class BoxTree:
    """A box of the parameters of one structure; ``refuted``: no robot in it does the task."""

    box: Box
    cut: Cut | None = None
    parts: tuple[BoxTree, BoxTree] | None = None
    refuted: bool = False
    parent: BoxTree | None = field(default=None, repr=False)

    def split(self, cut: Cut) -> tuple[BoxTree, BoxTree]:
        """Cut a leaf in two; raises ValueError as :func:`parts` does."""
        low, high = (BoxTree(each, parent=self) for each in parts(self.box, cut))
        self.cut, self.parts = cut, (low, high)
        return low, high

    @property
    def is_refuted(self) -> bool:
        """Whether all of it is refuted."""
        if self.parts is None:
            return self.refuted
        return all(part.is_refuted for part in self.parts)

    def leaves(self) -> Iterator[BoxTree]:
        """The leaves, in order."""
        if self.parts is None:
            yield self
        else:
            for part in self.parts:
                yield from part.leaves()

    def open_leaves(self) -> list[BoxTree]:
        """The leaves that are not refuted."""
        return [leaf for leaf in self.leaves() if not leaf.refuted]

    def ranges(self) -> tuple[Ranges, ...]:
        """The ranges of the values of a leaf: its sides without ends that other leaves refute."""
        found = list(map(ranges_of, self.box))
        node = self
        while node.parent is not None:
            above = node.parent
            if above.cut is not None and above.parts is not None:
                first = node is above.parts[0]
                other, cut = above.parts[1 if first else 0], above.cut
                if not isinstance(cut.at, int) and other.is_refuted:
                    sides = found[cut.parameter]
                    found[cut.parameter] = tuple(_opened(r, cut.at, high=first) for r in sides)
            node = above
        return tuple(found)


def _opened(range_: Range, at: Fraction, *, high: bool) -> Range:
    """A range without its end at ``at``, if it has one there."""
    if high and range_.high == at:
        return replace(range_, high_open=True)
    if not high and range_.low == at:
        return replace(range_, low_open=True)
    return range_


def choices_halved(box: Box) -> Cut | None:
    """The cut that halves the longest list of choices of a box; None if there is no choice."""
    counts = [len(d.values) if isinstance(d, ir.Choices) else 0 for d in box]
    most = max(counts, default=0)
    return None if most < 2 else Cut(counts.index(most), (most + 1) // 2)

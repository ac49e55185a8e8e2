"""The range of a joint in the unit in which it is written."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

from grammar_lang import ir
from grammar_lang.ir.constants import evident
from solvers.explanation.posed_task import PosedTask
from solvers.explanation.relaxation import ends

DEGREE = Fraction(1, 180)
"""A degree, in half turns."""
LENGTHS = {"cm": Fraction(1, 100), "mm": Fraction(1, 1000)}
"""Units of length other than the metre, in metres."""
TURNS = {"deg": Fraction(360), "rad": Fraction(63, 10)}
"""A whole turn; that in rad is rounded up."""


@dataclass(frozen=True, slots=True)
class WrittenRange:
    """The ends of a range in its ``unit``: m, cm, mm, rad or deg."""

    low: Fraction
    high: Fraction
    unit: str

    @property
    def turn(self) -> Fraction | None:
        """A whole turn in this unit; None if it is one of length."""
        return TURNS.get(self.unit)

    def end(self, value: Fraction) -> ir.Expr:
        """A number in this unit as an end of a range, in SI units."""
        if self.unit != "deg":
            return ir.Num(value * LENGTHS.get(self.unit, 1))
        return ir.Binary("*", ir.Num(value * DEGREE), ir.Pi())


def written_range(posed: PosedTask, dof: ir.Dof) -> WrittenRange | None:
    """The range of a degree of freedom, in the unit in which it is written; None if it has none."""
    if dof.range is None:
        return None
    if dof.kind == "prismatic":
        unit = next((each for each in LENGTHS if _says(each, posed, dof)), "m")
        low, high = (end / LENGTHS.get(unit, 1) for end in ends(dof.range))
        return WrittenRange(low, high, unit)
    first, last = _half_turns(dof.range.lower), _half_turns(dof.range.upper)
    if first is None or last is None or not _says("deg", posed, dof):
        return WrittenRange(*ends(dof.range), "rad")
    return WrittenRange(first / DEGREE, last / DEGREE, "deg")


def _half_turns(angle: ir.Expr) -> Fraction | None:
    """An angle divided by pi, if that is evidently rational."""
    found = evident(angle)
    if found is None or (found[0] and found[1] != 1):
        return None
    return found[0]


def _says(unit: str, posed: PosedTask, dof: ir.Dof) -> bool:
    """Whether a range is written in a unit."""
    sources, span = posed.program.sources, dof.span
    if span.file >= len(sources):
        return False
    text = sources[span.file].text[span.start : span.end]
    about_range = re.split(r"\b(?:rate|accel|effort|named)\b", text, maxsplit=1)[0]
    return re.search(rf"(?<![A-Za-z_]){unit}\b", about_range) is not None

"""What every word that satisfies a sampled formula does: where it is always, begins and ends."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from compiler.specifications.sampled_formula import (
    Every,
    Literal,
    SampledFormula,
    Throughout,
    ThroughoutFrom,
)


@dataclass(slots=True)
class FormulaDemands:
    """Literals, by the samples at which they hold: all, the first, or the last."""

    always: list[Literal] = field(default_factory=list)
    first: list[Literal] = field(default_factory=list)
    last: list[Literal] = field(default_factory=list)


def formula_demands(formula: SampledFormula | None) -> FormulaDemands:
    """Necessary for the formula to hold at sample 0, not sufficient."""
    found = FormulaDemands()
    if formula is None:
        return found
    for part in _conjuncts(formula):
        match part:
            case Literal():
                found.first.append(part)
            case Throughout(part=Literal() as literal, first=0, last=None):
                found.always.append(literal)
            case ThroughoutFrom(part=Literal() as literal):
                found.last.append(literal)
            case _:
                pass
    return found


def _conjuncts(formula: SampledFormula) -> Iterator[SampledFormula]:
    stack = [formula]
    while stack:
        part = stack.pop()
        if isinstance(part, Every):
            stack.extend(reversed(part.parts))
        else:
            yield part

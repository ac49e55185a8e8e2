"""How much of its inputs a design uses, kind by kind."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.robots.input_bounds import input_bounds
from solvers.verifier.claims.certificate import exact
from srgc.results.found_design import FoundDesign


@dataclass(frozen=True, slots=True)
class UsedInputs:
    """Inputs that share a bound.

    ``peak`` is the largest size of one of them, or of their norm where that is bounded; ``margin``
    what they keep from the bound; ``effort``: whether they are efforts of joints.  In ``unit``.
    """

    peak: float
    margin: float
    unit: str
    effort: bool


def used_inputs(found: FoundDesign) -> tuple[UsedInputs, ...]:
    """What a design uses of each bound on its inputs, in the order of the bounds."""
    rows = np.array([[float(exact(text)) for text in row] for row in found.claim.inputs])
    used = []
    for bound in input_bounds(found.model, found.task):
        values = rows[:, list(bound.inputs)]
        sizes = np.linalg.norm(values, axis=1) if bound.norm2 else np.abs(values)
        inner = sizes if bound.norm2 else values
        low, high = float(inner.min() - float(bound.lower)), float(float(bound.upper) - inner.max())
        margin = high if bound.norm2 else min(low, high)
        used.append(UsedInputs(float(sizes.max()), margin, bound.unit, bound.effort))
    return tuple(used)

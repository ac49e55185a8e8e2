"""Place the base of a robot by a module that carries it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from srgc.imports.cobra.pose_data import Tolerance, ToleratedPose
from srgc.imports.cobra.region_sets import POSITIONS, inner
from srgc.imports.module_set import Move, Turn, steps_of
from srgc.imports.quantities import Quantities

NARROW = 0.01
"""A base with less freedom than this (m or rad) stands at its nominal place."""
PARAMETERS = {"x": "east", "y": "north", "z": "up"}


@dataclass(frozen=True, slots=True)
class GroundPort:
    """The type and gender of the port on which bases stand; a gender may be empty."""

    type: str
    gender: str


def floor_module(
    name: str, pose: ToleratedPose | None, port: GroundPort, remarks: list[str]
) -> str:
    """The block of the module on which the base stands."""
    write = Quantities()
    free = {} if pose is None else dict(_free(pose, remarks))
    lines = ["// Where the base stands.", f"module {name} {{", "role base;"]
    for axis, (low, high) in free.items():
        lines.append(f"param {PARAMETERS[axis]} in {write.interval(low, high)};")
    lines.append(f"port out: {port.type} {port.gender};")
    factors = ["in"]
    if pose is not None:
        tilted = pose.nominal.copy()
        in_nominal = any(_is_tilted(each) for each in pose.tolerances if each.projection in free)
        place = [step for step in steps_of(tilted) if _does(step)]
        shifts = [f"move({axis}, {PARAMETERS[axis]})" for axis in free]
        moves = [f"move({write.vector(step.by)})" for step in place if isinstance(step, Move)]
        turns = [
            f"rot({step.axis}, {write.angle(step.angle)})"
            for step in place
            if isinstance(step, Turn)
        ]
        factors += [*moves, *turns, *shifts] if in_nominal else [*moves, *shifts, *turns]
    lines += [f"frame out = {' * '.join(factors)};", "}"]
    return "\n".join(lines)


def _does(step: object) -> bool:
    if isinstance(step, Move):
        return max(map(abs, step.by)) > 1e-12
    return isinstance(step, Turn) and abs(step.angle) > 1e-12


def _is_tilted(tolerance: Tolerance) -> bool:
    return bool(np.abs(tolerance.axes - np.eye(3)).max() > 1e-9)


def _free(pose: ToleratedPose, remarks: list[str]) -> Iterator[tuple[str, tuple[float, float]]]:
    """The free intervals (m) by axis; other freedoms stay nominal, with a remark."""
    found = dict[str, tuple[float, float]]()
    for each in pose.tolerances:
        wide = max(-each.low, each.high) > NARROW
        if not wide:
            continue
        if each.projection == "r_sph" and math.isfinite(each.high):
            half = inner(each.high / math.sqrt(3))
            found |= dict.fromkeys("xyz", (-half, half))
            remarks.append(f"{each.place.path}: the base within a cube in the ball")
        elif each.projection == "r_cyl" and math.isfinite(each.high):
            half = inner(each.high / math.sqrt(2))
            found |= dict.fromkeys("xy", (-half, half))
            remarks.append(f"{each.place.path}: the base within a square in the circle")
        elif each.projection in POSITIONS and math.isfinite(each.high - each.low):
            found[each.projection] = each.low, each.high
        else:
            remarks.append(f"{each.place.path}: freedom of the base; it stands as nominal there")
    yield from sorted(found.items())

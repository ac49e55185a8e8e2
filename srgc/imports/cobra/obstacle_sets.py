"""Convert obstacles of a task to sets of a workspace."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from srgc.imports.cobra.region_sets import ALIGNED
from srgc.imports.cobra.task_data import Obstacle
from srgc.imports.names import Names, is_legible
from srgc.imports.quantities import Quantities
from srgc.imports.timor.geometry_data import Geometry


@dataclass(frozen=True, slots=True)
class ObstacleSet:
    """A set with its name, and points (n, 3) in m whose hull contains it, up to its radius."""

    name: str
    text: str
    points: NDArray[np.float64]
    comment: str = ""


def obstacle_sets(obstacle: Obstacle, names: Names, write: Quantities) -> Iterator[ObstacleSet]:
    """A set for each shape of an obstacle that is not a mesh."""
    wanted = Names().camel(obstacle.name or f"Obstacle {obstacle.id}", "Obstacle")
    said = [] if is_legible(obstacle.name) else [f"`{obstacle.name}`"]
    said += [] if obstacle.name in ("", obstacle.id) else [f"ID {obstacle.id}"]
    comment = ", ".join(said)
    for geometry in obstacle.shapes:
        if geometry.kind != "mesh":
            text, points = _set(geometry, write)
            yield ObstacleSet(names.name(wanted), text, points, comment)


def _set(geometry: Geometry, write: Quantities) -> tuple[str, NDArray[np.float64]]:
    at, turn = geometry.pose[:3, 3], geometry.pose[:3, :3]
    match geometry.kind:
        case "sphere":
            (radius,) = geometry.size
            text = f"ball {write.vector(at.tolist())} radius {write.length(radius)}"
            return text, at + radius * np.array([*np.eye(3), *-np.eye(3)])
        case "cylinder":
            radius, length = geometry.size
            ends = [at + side * length / 2 * turn[:, 2] for side in (-1, 1)]
            points = ", ".join(write.vector(end.tolist()) for end in ends)
            corners = [end + radius * (x * turn[:, 0] + y * turn[:, 1])
                       for end in ends for x, y in product((-1, 1), repeat=2)]  # fmt: skip
            return f"cylinder {points} radius {write.length(radius)}", np.array(corners)
        case _:
            return _box(geometry, write)


def _box(geometry: Geometry, write: Quantities) -> tuple[str, NDArray[np.float64]]:
    """A box if its edges are parallel to the world's axes, otherwise the hull of its corners."""
    at, turn = geometry.pose[:3, 3], geometry.pose[:3, :3]
    half = np.array(geometry.size) / 2
    corners = np.array([at + turn @ (half * signs) for signs in product((-1, 1), repeat=3)])
    if np.abs(np.sort(np.abs(turn), axis=0)[:2]).max() > ALIGNED:
        points = ", ".join(write.vector(corner.tolist()) for corner in corners)
        return f"hull {points}", corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    texts, unit = write.lengths(np.column_stack([low, high]).ravel().tolist())
    sides = [f"[{one}, {other}]" for one, other in zip(texts[::2], texts[1::2], strict=True)]
    return f"box {' x '.join(sides)} {unit}", corners

"""Limits on the size of meshes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from srgc.imports.source_fault import SourceFault, file_fault

if TYPE_CHECKING:
    from srgc.imports.meshes.mesh import Mesh

MOST_TRIANGLES = 1_000_000
LARGEST = 1e6
"""Coordinates and sizes are smaller, in metres: nothing in a robot's scene is farther away."""


def too_many(count: int, path: Path) -> None:
    """Reject a mesh with too many triangles.

    Raises:
        SourceFault: there are more than :data:`MOST_TRIANGLES`.
    """
    if count > MOST_TRIANGLES:
        message = f"it has {count:,} triangles, and may have {MOST_TRIANGLES:,}"
        raise file_fault(path, message, "simplify it first")


def scaled_within(
    mesh: Mesh, factors: Sequence[Fraction], fault: Callable[[str], SourceFault]
) -> Mesh:
    """A mesh in metres with each axis scaled, if its coordinates stay below :data:`LARGEST`.

    Raises:
        SourceFault: a vertex would be that far away or farther; ``fault`` makes it of a message.
    """
    most = np.abs(mesh.vertices).max(axis=0, initial=0.0).tolist()
    if any(abs(by) * Fraction(far) >= LARGEST for by, far in zip(factors, most, strict=True)):
        raise fault(f"with its scale a vertex is {LARGEST:g} m away or farther")
    return mesh.scaled(factors)

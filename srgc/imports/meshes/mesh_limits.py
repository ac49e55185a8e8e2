"""Limits on the size of meshes."""

from __future__ import annotations

from pathlib import Path

from srgc.imports.source_fault import file_fault

MOST_TRIANGLES = 1_000_000
LARGEST = 1e6
"""Coordinates are smaller, in metres: nothing in a robot's scene is farther away."""


def too_many(count: int, path: Path) -> None:
    """Reject a mesh with too many triangles.

    Raises:
        SourceFault: there are more than :data:`MOST_TRIANGLES`.
    """
    if count > MOST_TRIANGLES:
        message = f"it has {count:,} triangles, and may have {MOST_TRIANGLES:,}"
        raise file_fault(path, message, "simplify it first")

"""How large meshes may be."""

from __future__ import annotations

from pathlib import Path

from srgc.imports.source_fault import file_fault

MOST_TRIANGLES = 1_000_000
LARGEST = 1e6
"""Coordinates are smaller, in metres: what is farther off is no scene of a robot."""


def too_many(count: int, path: Path) -> None:
    """Refuse more triangles than are read.

    Raises:
        SourceFault: there are more.
    """
    if count > MOST_TRIANGLES:
        message = f"it has {count:,} triangles, and may have {MOST_TRIANGLES:,}"
        raise file_fault(path, message, "simplify it first")

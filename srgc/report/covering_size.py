"""How many boxes a covering of a refuted robot has."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from solvers.verifier.claims.bounded_file import evidence_bytes

HEADER = "boxes 1\n"


@dataclass(frozen=True, slots=True)
class CoveringSize:
    """``parameters`` boxes of parameters, with ``coordinates`` boxes of coordinates in all.

    ``by_drives`` of the former are refuted by what the drives can do, the others by poses alone.
    """

    parameters: int
    coordinates: int
    by_drives: int


def covering_size(folder: Path, name: str) -> CoveringSize | None:
    """The size of the covering in a file of a result folder; None where there is none."""
    try:
        content = evidence_bytes(folder, name).decode("ascii")
    except (OSError, UnicodeDecodeError):
        return None
    if not content.startswith(HEADER):
        return None
    tree = content.removeprefix(HEADER)
    drives = tree.count("!")
    return CoveringSize(tree.count("|") + drives, tree.count("."), drives)

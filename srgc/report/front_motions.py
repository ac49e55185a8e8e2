"""The motions of the designs that no other dominates, read from the folders below a result."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from srgc.faults import UsageFault
from srgc.report.tables import Trajectory, planned_trajectory
from srgc.results.found_design import FoundDesign, found_design

MOST_MOTIONS = 24
"""The number of designs of a front to show in motion, from the first one."""


@dataclass(frozen=True, slots=True)
class FrontMotion:
    """A design of a front, with the number of its structure and its sampled motion."""

    structure: int
    found: FoundDesign
    trajectory: Trajectory


def front_motions(folder: Path, pareto: Mapping[str, Any]) -> tuple[FrontMotion, ...]:
    """The motions of the first designs of ``pareto.json``, if the task has objectives.

    Designs are omitted if their folder is missing or was altered, or if it has another robot than
    the entry.
    """
    if "units" not in pareto:
        return ()
    motions = (_motion(folder, entry) for entry in pareto["designs"][:MOST_MOTIONS])
    return tuple(motion for motion in motions if motion is not None)


def _motion(folder: Path, entry: Mapping[str, Any]) -> FrontMotion | None:
    structure = entry["structure"]
    try:
        found = found_design(folder / "designs" / str(structure))
        if list(found.derivation.word) != entry["word"]:
            return None
        return FrontMotion(structure, found, planned_trajectory(found))
    except UsageFault:
        return None

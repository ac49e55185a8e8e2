"""Open the folder of a result, of a task or of a mission."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from srgc.api.mission_result import MissionResult, mission_in
from srgc.api.result import Result, opened
from srgc.api.spoken_faults import spoken


@spoken
def open_result(folder: str | PathLike[str]) -> Result | MissionResult:
    """Open a result that ``srgc synth``, ``srgc evolve`` or ``Result.save`` has written.

    Args:
        folder: the folder of the result.

    Returns:
        A ``MissionResult`` for ``synth --mission`` and ``evolve``, otherwise a ``Result``.

    Raises:
        SrgcError: the folder has no results, or they have been altered.
    """
    from srgc.results.mission_refusal import is_mission_folder

    path = Path(folder)
    return mission_in(path) if is_mission_folder(path) else opened(path)

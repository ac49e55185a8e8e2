"""The result in a folder, of a task or of a mission."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from srgc.api.mission_result import MissionResult, mission_in
from srgc.api.result import Result, opened
from srgc.api.spoken_faults import spoken


@spoken
def open_result(folder: str | PathLike[str]) -> Result | MissionResult:
    """A result that ``srgc synth``, ``srgc evolve`` or ``Result.save`` has written.

    Args:
        folder: where it is.

    Returns:
        Of ``synth --mission`` and ``evolve`` the result of a mission, else that of a task.

    Raises:
        SrgcError: there are no results in the folder, or they have been altered.
    """
    from srgc.results.mission_refusal import is_mission_folder

    path = Path(folder)
    return mission_in(path) if is_mission_folder(path) else opened(path)

"""Folders of missions given instead of those of one task: recognised and refused."""

from __future__ import annotations

from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.files.file_tree import visible
from solvers.verdict import MISSION
from srgc.faults import UsageFault
from srgc.results.result_folder import json_object

MOST_NAMED = 4
"""The number of tasks to name in a message."""


def is_mission_folder(folder: Path) -> bool:
    """Whether a folder has the results of a mission, with any verdict."""
    if (folder / MISSION).is_file():
        return True
    if not (folder / "design.json").is_file():
        return False
    try:
        return json_object(folder / "design.json").get("mission") is not None
    except UsageFault:
        return False


def refuse_mission(folder: Path) -> None:
    """Refuse the results of a mission if those of a single task are needed.

    Raises:
        UsageFault: the folder has results of a mission; the message names the folders of its tasks.
    """
    if not is_mission_folder(folder):
        return
    tasks = folder / "tasks"
    names = sorted(path.name for path in tasks.iterdir()) if tasks.is_dir() else []
    if not names:
        raise UsageFault(
            f"{folder} holds the results of a mission for which there are no robots",
            code=Code.NO_ROBOT,
            hint="`srgc why` and `srgc report` take it",
        )
    shown = [visible(str(tasks / name)) for name in names[:MOST_NAMED]]
    if len(names) > MOST_NAMED:
        shown.append(f"{len(names) - MOST_NAMED} more")
    raise UsageFault(
        f"{folder} holds the results of a mission: name the folder of one of its tasks, "
        f"{', '.join(shown)}"
    )

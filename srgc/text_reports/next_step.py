"""The line that ends a report: the next step, as a shell command or as advice in words."""

from __future__ import annotations

import shlex

WIDTH = 80
"""The most columns of the line."""
HEAD = "next:    "
WHY, WHY_MISSION = "what would make it possible", "what each task rules out"
"""What `srgc why` says of an impossible task, and of an impossible mission."""


def next_command(command: str, path: str, comment: str = "") -> str:
    """A command for a file or folder, followed by its purpose if there is room."""
    line = f"{HEAD}{command} {shlex.quote(path)}"
    full = f"{line}  # {comment}" if comment else line
    fitting = (each for each in (full, line) if len(each) <= WIDTH)
    return next(fitting, f"{HEAD}{command}, with the same path")


def next_advice(advice: str, command: str, path: str) -> str:
    """Advice in words and a command that explains more, on a second line if one is too short."""
    said, more = f"{HEAD}{advice}", next_command(command, path).removeprefix(HEAD)
    both = f"{said}, or {more}"
    return both if len(both) <= WIDTH else f"{said}\n{'':{len(HEAD)}}or {more}"

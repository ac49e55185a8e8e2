"""The line that ends a report: what to do next, a command for a shell or advice in words."""

from __future__ import annotations

import shlex

WIDTH = 80
"""So many columns has the line at most."""
HEAD = "next:    "


def next_command(command: str, path: str, comment: str = "") -> str:
    """A command about a file or folder, with what it is good for, where there is room for that."""
    line = f"{HEAD}{command} {shlex.quote(path)}"
    full = f"{line}  # {comment}" if comment else line
    fitting = (each for each in (full, line) if len(each) <= WIDTH)
    return next(fitting, f"{HEAD}{command}, with the same path")


def next_advice(advice: str, command: str, path: str) -> str:
    """Advice in words, and a command that says more, below it where a line is too short."""
    said, more = f"{HEAD}{advice}", next_command(command, path).removeprefix(HEAD)
    both = f"{said}, or {more}"
    return both if len(both) <= WIDTH else f"{said}\n{'':{len(HEAD)}}or {more}"

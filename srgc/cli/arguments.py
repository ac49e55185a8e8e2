"""Arguments that several commands share."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from srgc.cli.completions import complete_file, complete_folder, complete_name
from srgc.paths import refuse_impossible

Command = TypeVar("Command", bound=Callable[..., Any])


class PathOf(click.Path):
    """A path that a file or a folder can have, whether there is one or not."""

    def convert(
        self,
        value: str | os.PathLike[str],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> str | bytes | os.PathLike[str]:
        """The path.

        Raises:
            UsageFault: there can be no such file.
        """
        refuse_impossible(value)
        return super().convert(value, param, ctx)


FILE = click.argument("file", type=PathOf(path_type=Path), shell_complete=complete_file)
FILES = click.argument(
    "files",
    nargs=-1,
    required=True,
    type=PathOf(path_type=Path),
    shell_complete=complete_file,
    metavar="FILE...",
)
FILES_OR_STDIN = click.argument(
    "files",
    nargs=-1,
    required=True,
    type=PathOf(path_type=Path, allow_dash=True),
    shell_complete=complete_file,
    metavar="FILE...",
)
FOLDER = click.argument("folder", type=PathOf(path_type=Path), shell_complete=complete_folder)
GRAMMAR = click.option(
    "--grammar", shell_complete=complete_name, help="The grammar, where the file has several."
)
WORKSPACE = click.option(
    "--workspace", shell_complete=complete_name, help="The workspace, where the file has several."
)
TASK = click.option(
    "--task", shell_complete=complete_name, help="The task, where the file has several."
)
OUTPUT = click.option(
    "-o",
    "output",
    type=PathOf(path_type=Path, allow_dash=True),
    help="Write here, not to stdout (`-`).",
)
QUIET = click.option(
    "-q", "--quiet", is_flag=True, help="Nothing on standard error but errors: no progress."
)


def _finite(
    _context: click.Context, parameter: click.Parameter, value: float | None
) -> float | None:
    """Refuse nan, which every comparison lets through, and what is no limit."""
    if value is not None and not math.isfinite(value):
        raise click.BadParameter("a number of seconds is due", param=parameter)
    return value


def limit_of_time(text: str) -> Callable[[Command], Command]:
    """The option of a limit of time, with its help."""
    return click.option(
        "--time-limit",
        type=click.FloatRange(0, min_open=True),
        callback=_finite,
        help=text,
    )

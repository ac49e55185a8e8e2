"""Arguments that several commands share."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

Command = TypeVar("Command", bound=Callable[..., Any])

FILE = click.argument("file", type=click.Path(path_type=Path))
GRAMMAR = click.option("--grammar", help="The grammar, where the file has several.")


def _finite(
    _context: click.Context, parameter: click.Parameter, value: float | None
) -> float | None:
    """Refuse nan, which every comparison lets through."""
    if value is not None and math.isnan(value):
        raise click.BadParameter("a number of seconds is due", param=parameter)
    return value


def limit_of_time(text: str) -> Callable[[Command], Command]:
    """The option of a limit of time, with its help."""
    return click.option(
        "--time-limit",
        type=click.FloatRange(0, sys.float_info.max, min_open=True),
        callback=_finite,
        help=text,
    )

"""Click arguments and options that several commands share."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

from srgc.cli.completions import complete_file, complete_folder, complete_name
from srgc.paths import refuse_impossible

Command = TypeVar("Command", bound=Callable[..., Any])


class PathOf(click.Path):
    """A path that the file system allows, whether or not something exists there."""

    def convert(
        self,
        value: str | os.PathLike[str],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> str | bytes | os.PathLike[str]:
        """Convert the value to a path.

        Raises:
            UsageFault: there can be no such file.
        """
        refuse_impossible(value)
        return super().convert(value, param, ctx)


FILE = click.argument("file", type=PathOf(path_type=Path), shell_complete=complete_file)
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
    "--grammar", shell_complete=complete_name, help="The grammar, if the file has several."
)
WORKSPACE = click.option(
    "--workspace", shell_complete=complete_name, help="The workspace, if the file has several."
)
TASK = click.option(
    "--task", shell_complete=complete_name, help="The task, if the file has several."
)
OUTPUT = click.option(
    "-o",
    "output",
    type=PathOf(path_type=Path, allow_dash=True),
    help="Write to this file instead of stdout (`-`).",
)
VERBOSE = click.option(
    "--verbose",
    is_flag=True,
    help="Also print what the solvers themselves answer.",
)
QUIET = click.option(
    "-q", "--quiet", is_flag=True, help="Show no progress: only errors go to standard error."
)


def _finite(
    _context: click.Context, parameter: click.Parameter, value: float | None
) -> float | None:
    """Refuse nan, which passes every comparison, and infinity, which is no limit."""
    if value is not None and not math.isfinite(value):
        raise click.BadParameter("a number of seconds is expected", param=parameter)
    return value


def limit_of_time(text: str) -> Callable[[Command], Command]:
    """The option ``--time-limit``, with its help."""
    return click.option(
        "--time-limit",
        type=click.FloatRange(0, min_open=True),
        callback=_finite,
        help=text,
    )


# --- A command whose help has examples, exit statuses and a page to read on -----------------------


ALWAYS = {
    2: "wrong usage, or a file that cannot be read or written",
    5: "the spec has errors or does not exist",
    70: "a bug in srgc",
    130: "interrupted",
    141: "nothing reads the output any more",
}
"""The statuses that every command may end with; only commands that read a spec end with 5."""


class DocumentedCommand(click.Command):
    """A click command with more sections in its help.

    ``examples`` are command lines that work in a checkout of srgc, in this order; the test suite
    runs them.  ``statuses`` maps the command's own exit statuses to their meanings; those of
    :data:`ALWAYS` are added.  ``read_on`` names a page under ``docs/``.
    """

    def __init__(
        self,
        *arguments: Any,
        examples: Sequence[str] = (),
        statuses: Mapping[int, str] | None = None,
        reads_spec: bool = True,
        read_on: str = "",
        **options: Any,
    ) -> None:
        super().__init__(*arguments, **options)
        self.examples = tuple(examples)
        always = {k: text for k, text in ALWAYS.items() if reads_spec or k != 5}
        self.statuses = dict(sorted(({0: "done"} | dict(statuses or {}) | always).items()))
        self.read_on = read_on

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse as click does; in completion, leave out a last option that awaits its value."""
        if ctx.resilient_parsing and args and self._awaits_value(args[-1]):
            args = args[:-1]
        return super().parse_args(ctx, args)

    def _awaits_value(self, word: str) -> bool:
        """Whether a word is an option that takes a value."""
        options = (each for each in self.params if isinstance(each, click.Option))
        return any(word in each.opts and not (each.is_flag or each.count) for each in options)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the sections after the options."""
        super().format_epilog(ctx, formatter)
        with formatter.section("Examples"):
            for example in self.examples:  # unwrapped, so that it can be copied
                formatter.write(f"{'':{formatter.current_indent}}{example}\n")
        with formatter.section("Exit status"):
            formatter.write_dl([(str(status), text) for status, text in self.statuses.items()])
        if self.read_on:
            formatter.write_paragraph()
            formatter.write_text(f"Read on: {self.read_on}")

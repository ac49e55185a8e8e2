"""The table of commands: names, modules, and one line about each.

A command is imported only when it is asked for, so that ``srgc --version``, ``--help`` and shell
completion take no longer than the import of click.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from importlib import import_module
from keyword import iskeyword
from shutil import get_terminal_size
from typing import NamedTuple

import click

from srgc.interruption import begin
from srgc.version import VERSION

COMPLETE = "_SRGC_COMPLETE"
"""The environment variable by which a shell's completion script asks for completions."""

CLICK_WIDTH, LEAST_WIDTH = 50, 24
"""The least width of a help page: click's, and ours."""


class Entry(NamedTuple):
    """A command: the module that defines it under its name, its group in the help, and one line."""

    module: str
    group: str
    brief: str


GROUPS = {
    "Design": {
        "new": ("new", "Write a commented spec to start from."),
        "check": ("check", "Find the mistakes in a spec."),
        "fmt": ("fmt", "Write a spec in canonical form."),
        "import": ("importing", "Convert a robot, modules or a scene from other tools to a spec."),
        "expand": ("expand", "Print the productions that grammars from ports stand for."),
        "synth": ("synth", "Find a robot and prove it, or prove that there is none."),
        "evolve": ("evolve", "Rebuild the robot of a result for another task."),
        "verify": ("verify", "Check a result independently of the search."),
    },
    "Understand": {
        "words": ("language", "List, count or draw the robots of a family."),
        "accepts": ("language", "Decide whether a word is in a family."),
        "language": ("language", "Describe the language of a family."),
        "compare": ("compare", "Compare the words of grammars, or results."),
        "graph": ("graph", "Draw an automaton, words, a robot or cells."),
        "model": ("model", "Print the equations of motion of a robot."),
        "plan": ("plan", "Find the cells that effectors go through."),
        "landscape": ("landscape", "Draw the robustness over two parameters."),
        "why": ("why", "Explain why there is no robot, and what to change."),
        "explain": ("explain", "Explain the code of a diagnostic."),
    },
    "Use results": {
        "report": ("report", "Write a result as one page for a browser."),
        "export": ("export", "Write a robot or its motion for other tools."),
        "replay": ("replay", "Simulate a design, and compare it with its proof."),
        "view": ("view", "View designs in 3D, on a live page."),
    },
    "Editors and shells": {
        "lsp": ("lsp", "Serve an editor: diagnostics, hover, completion."),
        "completion": ("completion", "Print the completion script for a shell."),
    },
}

TABLE: Mapping[str, Entry] = {
    name: Entry(f"srgc.cli.{module}", group, brief)
    for group, commands in GROUPS.items()
    for name, (module, brief) in commands.items()
}


class CommandTable(click.Group):
    """A group that imports its commands only when they are asked for."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names of all commands, in the order of the help."""
        return [*TABLE]

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command with that name, or None."""
        return command_named(cmd_name) if cmd_name in TABLE else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command as click does; for an unknown name, suggest the nearest one."""
        name = args[0]
        if name == "help":  # as in git and cargo
            return self.resolve_command(ctx, [*args[1:2], "--help"])
        if name not in TABLE and name[:1].isalnum() and not ctx.resilient_parsing:
            from difflib import get_close_matches

            near = get_close_matches(name, TABLE, 1)
            hint = f" Did you mean '{near[0]}'?" if near else ""
            ctx.fail(f"No such command '{name}'.{hint}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> object:
        """Invoke as click does, but without the empty line that click prints after an interrupt.

        Raises:
            Abort: the command was interrupted.
        """
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise click.Abort from None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands in groups, with all descriptions in the same column."""
        width = max(map(len, TABLE))
        for group, commands in GROUPS.items():
            with formatter.section(group):
                formatter.write_dl([(n.ljust(width), brief) for n, (_, brief) in commands.items()])

    def shell_complete(
        self, ctx: click.Context, incomplete: str
    ) -> list[click.shell_completion.CompletionItem]:
        """Complete the names of the commands and the options of the group."""
        from click.shell_completion import CompletionItem

        named = [
            CompletionItem(name, help=entry.brief)
            for name, entry in TABLE.items()
            if name.startswith(incomplete)
        ]
        return [*named, *click.Command.shell_complete(self, ctx, incomplete)]


@click.group(
    cls=CommandTable,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="`srgc COMMAND --help` shows examples and the exit statuses of a command.",
)
@click.version_option(VERSION, prog_name="srgc")
def cli() -> None:
    """Find modular robots that are proved to do their task."""


def command_named(name: str) -> click.Command:
    """Import and return the command with a name in :data:`TABLE`."""
    function = f"{name}_" if iskeyword(name) else name
    command = getattr(import_module(TABLE[name].module), function)
    if not isinstance(command, click.Command):
        raise TypeError(f"{name} is no command")
    return command


def all_commands() -> dict[str, dict[str, click.Command]]:
    """All commands by group and name, in the order of the help, for the reference page."""
    return {group: {name: command_named(name) for name in names} for group, names in GROUPS.items()}


def _narrow() -> int | None:
    """The width for help on a terminal narrower than click's least width; None on wider ones."""
    columns = get_terminal_size().columns
    return max(columns - 2, LEAST_WIDTH) if columns < CLICK_WIDTH + 2 else None


def run_command(arguments: list[str] | None) -> int:
    """Run a command line; return the status of its command, or 0 if the command returns none."""
    begin()
    try:
        # The code that prints text decides on colours, so click must not strip them.
        status = cli.main(
            arguments, prog_name="srgc", standalone_mode=False, color=True, terminal_width=_narrow()
        )
    except SystemExit as ending:
        if COMPLETE in os.environ:
            return int(ending.code or 0)
        raise
    return status if isinstance(status, int) else 0

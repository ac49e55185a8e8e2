"""The command reference, made from the commands themselves whenever the site is built.

The page ``reference/commands.md`` has a line ``<!-- commands -->``; in its place comes a section
per command: how it is called, what it does, its options, examples and exit statuses.
"""

from __future__ import annotations

import inspect
import re
from typing import TYPE_CHECKING

import click

from srgc.cli.arguments import DocumentedCommand
from srgc.cli.command_table import all_commands, cli

if TYPE_CHECKING:
    from collections.abc import Iterator


GROUP = cli.make_context("srgc", [], resilient_parsing=True)
"""Where commands have the names of the option for help from."""


def reference() -> str:
    """The sections of all commands, by group, as MyST Markdown."""
    lines: list[str] = []
    for group, commands in all_commands().items():
        lines.append(f"## {group}\n")
        for name, command in commands.items():
            lines.extend(section(name, command))
    return "\n".join(lines)


def section(name: str, command: click.Command) -> Iterator[str]:
    """The lines of the section of one command."""
    context = click.Context(command, parent=GROUP, info_name=name)
    yield f"### srgc {name}\n"
    usage = " ".join(command.collect_usage_pieces(context))
    yield f"```text\nsrgc {name} {usage}\n```\n"
    yield from paragraphs(command.help or "")
    yield f"```{{program}} srgc {name}\n```\n"
    for parameter in command.get_params(context):
        if isinstance(parameter, click.Option) and not parameter.hidden:
            yield from described(parameter, context)
    if isinstance(command, DocumentedCommand):
        yield from taught(command)


def described(option: click.Option, context: click.Context) -> Iterator[str]:
    """One option: its names, what it takes, and what it is for."""
    names, says = option.get_help_record(context) or ("", "")
    yield f"````{{option}} {names.replace(' / ', ', ')}"
    yield f"{escaped(says)}\n````\n"


def taught(command: DocumentedCommand) -> Iterator[str]:
    """Examples, which the suite runs, and exit statuses."""
    if command.examples:
        yield "Examples:\n"
        yield "```sh\n" + "\n".join(command.examples) + "\n```\n"
    yield "| exit status | meaning |\n|---|---|"
    for status, says in command.statuses.items():
        yield f"| {status} | {escaped(says)} |"
    yield ""


def paragraphs(text: str) -> Iterator[str]:
    """A help text as paragraphs; those that begin with a backspace keep their lines."""
    for part in re.split(r"\n\s*\n", inspect.cleandoc(text).partition("\f")[0]):
        if part.startswith("\b"):
            kept = part[1:].strip("\n")
            yield f"```text\n{kept}\n```\n"
        elif part.strip():
            yield f"{escaped(' '.join(part.split()))}\n"


def escaped(text: str) -> str:
    """A text in which Markdown reads no markup but code in backquotes."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(p if p.startswith("`") else re.sub(r"([*_<>\[\]|])", r"\\\1", p) for p in parts)

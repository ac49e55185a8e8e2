"""The command that writes a starter file: ``new``."""

from __future__ import annotations

from pathlib import Path

import click

from srgc.cli.arguments import DocumentedCommand, PathOf
from srgc.faults import UsageFault


def _kinds(_context: click.Context, _parameter: click.Parameter, begun: str) -> list[str]:
    """The kinds that begin with ``begun``, for shell completion."""
    from srgc.starters.starter_files import STARTERS

    return [kind for kind in STARTERS if kind.startswith(begun)]


@click.command(
    cls=DocumentedCommand,
    examples=["srgc new", "srgc new planar", "srgc new space -o crane.srg"],
    reads_spec=False,
    read_on="docs/how-to/new.md",
)
@click.argument("kind", required=False, shell_complete=_kinds)
@click.option(
    "-o",
    "output",
    type=PathOf(path_type=Path, allow_dash=True),
    help="Write to this file; `-` is stdout.  Default: KIND.srg.",
)
@click.option("--force", is_flag=True, help="Replace an existing file.")
def new(kind: str | None, output: Path | None, force: bool) -> int:  # noqa: FBT001
    """Write a starter file with comments that explain it.  Without KIND, list the kinds.

    The file has no errors, and `srgc synth` finds a robot for it within seconds.
    """
    from srgc.starters.starter_files import list_of_starters, next_steps, starter

    if kind is None:
        if output is not None or force:
            raise UsageFault("a kind is missing: `srgc new` lists them")
        click.echo(list_of_starters())
        return 0
    text = starter(kind)
    path = output or Path(f"{kind}.srg")
    if path == Path("-"):
        click.echo(text.encode(), nl=False)
        return 0
    _write(path, text.encode(), force=force)
    click.echo(next_steps(path, text))
    return 0


def _write(path: Path, content: bytes, *, force: bool) -> None:
    """Write a file; without ``force`` only if nothing has that name, not even a broken link."""
    if path.is_dir():
        raise UsageFault(f"{path} is a folder; `-o` names a file")
    try:
        with path.open("wb" if force else "xb") as file:
            file.write(content)
    except FileExistsError:
        raise UsageFault(f"{path} is there already; --force replaces it") from None
    except OSError as error:
        raise UsageFault(f"{path}: {error.strerror}") from None

"""The command that serves an editor: ``lsp``."""

from __future__ import annotations

import sys

import click

from srgc.cli.arguments import DocumentedCommand
from srgc.faults import UsageFault


@click.command(
    cls=DocumentedCommand,
    examples=["srgc lsp --help"],
    statuses={
        0: "ended by the client",
        1: "the client left without `shutdown`, or sent an invalid message",
    },
    reads_spec=False,
    read_on="docs/how-to/editors.md",
)
@click.option("--stdio", is_flag=True, help="Serve standard input and output; the default.")
@click.option(
    "--tcp",
    "port",
    metavar="PORT",
    type=click.IntRange(1, 65535),
    help="Serve the first client that connects to this port on this machine.",
)
def lsp(stdio: bool, port: int | None) -> int:  # noqa: FBT001
    """Serve an editor over the Language Server Protocol.

    Your editor starts this command; you do not have to type anything.  Messages go to standard
    error.
    """
    if stdio and port is not None:
        raise UsageFault("--stdio does not go with --tcp")
    from srgc.language_server.serving import serve_stdio, serve_tcp

    if port is None:
        if sys.stdin is None or sys.stdout is None:
            raise UsageFault("standard input or output is closed: an editor starts `srgc lsp`")
        return serve_stdio()
    try:
        return serve_tcp(port)
    except OSError as error:
        raise UsageFault(f"port {port} cannot be used: {error.strerror}") from None

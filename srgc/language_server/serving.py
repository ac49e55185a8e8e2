"""A server on standard input and output, or on a port of this machine."""

from __future__ import annotations

import logging
import os
import sys
from contextlib import suppress

from srgc.language_server.server import Server


def _log_to_stderr() -> None:
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("srgc lsp: %(levelname)s: %(message)s"))
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(logging.ERROR)
    # What it says is said again by ``Server.report_server_error``, where it is a fault.
    logging.getLogger("pygls").setLevel(logging.CRITICAL)


def serve_stdio() -> int:
    """Serve one client until it ends; 0 after ``shutdown``, 1 without."""
    _log_to_stderr()
    # Whatever else prints, a library or a child, must not break into the protocol.
    sys.stdout.flush()
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    aside = os.open(os.devnull, os.O_WRONLY) if sys.stderr is None else sys.stderr.fileno()
    os.dup2(aside, sys.stdout.fileno())
    server = Server()
    try:
        server.start_io(sys.stdin.buffer, channel)
    finally:
        server.close()
    return 0 if server.stopped else 1


def serve_tcp(port: int) -> int:
    """Serve the first client that connects to a port of this machine.

    Raises:
        OSError: the port cannot be used.
    """
    _log_to_stderr()
    server = Server()
    try:
        with suppress(SystemExit):
            server.start_tcp("127.0.0.1", port)
    finally:
        server.close()
    return 0 if server.stopped else 1

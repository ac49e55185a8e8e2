"""A server on standard input and output, or on a port of this machine."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
import sys
from typing import BinaryIO

from pygls.io_ import StdoutWriter

from srgc.language_server.message_stream import MessageStream, UnreadableMessage
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
    return _serve(sys.stdin.buffer, channel)


def serve_tcp(port: int) -> int:
    """Serve the first client that connects to a port of this machine, as :func:`serve_stdio`.

    Raises:
        OSError: the port cannot be used.
    """
    _log_to_stderr()
    with socket.create_server(("127.0.0.1", port)) as waiting:
        connection, _ = waiting.accept()
    with connection, connection.makefile("rb") as incoming:
        return _serve(incoming, connection.makefile("wb"))


def _serve(incoming: BinaryIO, outgoing: BinaryIO) -> int:
    server = Server()
    server.protocol.set_writer(StdoutWriter(outgoing))
    lost = False
    try:
        lost = asyncio.run(_answer(server, MessageStream(incoming)))
    except (OSError, SystemExit):
        pass  # the client has gone, or has said ``exit``
    finally:
        server.close()
    return 0 if server.stopped and not lost else 1


async def _answer(server: Server, messages: MessageStream) -> bool:
    """Handle messages to the end of the stream; whether that is because its frame is lost."""
    while True:
        try:
            body = await asyncio.to_thread(messages.next)
        except UnreadableMessage as fault:
            _refuse(server, fault)
            if fault.lost:
                return True
            continue
        if body is None:
            return False
        server.protocol.receive(body)


def _refuse(server: Server, fault: UnreadableMessage) -> None:
    """Answer what cannot be read, and say so to the user where it is the end."""
    if fault.lost:
        logging.getLogger(__name__).error("the connection ends: %s", fault)
    server.protocol.refuse(None, fault.CODE, str(fault))

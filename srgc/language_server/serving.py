"""A server on standard input and output or on a port, with messages of limited size."""

from __future__ import annotations

import asyncio
import logging
import os
import re
import socket
import sys
from typing import BinaryIO

from lsprotocol import types as lsp
from pygls.io_ import StdoutWriter

from srgc.language_server.server import Server

# --- The messages of a client, read from a stream -------------------------------------------------
#
# Source: *Language Server Protocol Specification 3.17*, "Base Protocol": a message is a header of
# ``Name: value`` lines, of which ``Content-Length`` is required, an empty line, and that number of
# bytes.
#
# pygls treats an unreadable header as empty, reads lines of any length, and waits for bytes that
# never arrive.  Here every unreadable message gets an error, and the memory for it is limited.


HEADER_LIMIT = 2**13
"""The most bytes of a header."""
MESSAGE_LIMIT = 2**26
"""The most bytes of a message: a text of the greatest size with every character escaped."""
SKIPPED_LIMIT = 2**30
"""The most bytes of a longer message to skip; no client sends more."""

_PIECE = 2**16
_LENGTH = re.compile(rb"0*([0-9]{1,20})")
_FIELD = re.compile(rb"([!#$%&'*+.^_`|~0-9A-Za-z-]+)[ \t]*:[ \t]*(.*?)[ \t\r]*\n", re.DOTALL)
_CHARSET = re.compile(rb";[ \t]*charset[ \t]*=[ \t]*\"?([^\";, \t]*)", re.IGNORECASE)
_UTF8 = {b"utf-8", b"utf8"}


class UnreadableMessage(Exception):
    """A message that cannot be read; ``lost`` if the start of the next one cannot be determined."""

    CODE = lsp.ErrorCodes.InvalidRequest.value

    def __init__(self, message: str, *, lost: bool) -> None:
        super().__init__(message)
        self.lost = lost


class MessageStream:
    """The messages in a stream of bytes."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._skipped = 0

    def next(self) -> bytes | None:
        """The body of the next message; None at the end of the stream.

        Raises:
            UnreadableMessage: it cannot be read; unless the stream is lost, the next call continues
                with the following message.
        """
        self._skip()
        fields = self._fields()
        if fields is None:
            return None
        length = _length(fields.get(b"content-length", set()))
        if length > MESSAGE_LIMIT:
            self._skipped = length
            said = f"a message of {length:,} bytes, more than {MESSAGE_LIMIT:,}"
            raise UnreadableMessage(said, lost=length > SKIPPED_LIMIT)
        charsets = {
            found[1].lower()
            for value in fields.get(b"content-type", set())
            for found in _CHARSET.finditer(value)
        }
        if not charsets <= _UTF8:
            self._skipped = length
            raise UnreadableMessage("a message in another charset than UTF-8", lost=False)
        body = self._stream.read(length)
        if len(body) < length:
            said = f"the input ends after {len(body):,} of the {length:,} bytes of a message"
            raise UnreadableMessage(said, lost=True)
        return body

    def _skip(self) -> None:
        """Skip the rest of a message that was refused."""
        while self._skipped:
            piece = self._stream.read(min(self._skipped, _PIECE))
            self._skipped = self._skipped - len(piece) if piece else 0

    def _fields(self) -> dict[bytes, set[bytes]] | None:
        """The values in a header by lower-case name; None at the end of the stream.

        Empty lines before a header are skipped, as some clients end a message with one.
        """
        found: dict[bytes, set[bytes]] = {}
        left = HEADER_LIMIT
        while True:
            line = self._stream.readline(left + 1)
            if not line and not found:
                return None
            if len(line) > left:
                said = f"the header of a message has more than {HEADER_LIMIT:,} bytes"
                raise UnreadableMessage(said, lost=True)
            if not line.endswith(b"\n"):
                raise UnreadableMessage("the input ends in the header of a message", lost=True)
            if line in {b"\r\n", b"\n"}:
                if found:
                    return found
                continue
            field = _FIELD.fullmatch(line)
            if field is None:
                raise UnreadableMessage("a line that is no field of a header", lost=True)
            found.setdefault(field[1].lower(), set()).add(field[2])
            left -= len(line)


def _length(values: set[bytes]) -> int:
    """The only length that a header states."""
    if not values:
        raise UnreadableMessage("a header without Content-Length", lost=True)
    if len(values) > 1:
        raise UnreadableMessage("a header with more than one Content-Length", lost=True)
    [value] = values
    found = _LENGTH.fullmatch(value)
    if found is None:
        raise UnreadableMessage("a Content-Length that is no length", lost=True)
    return int(found[1])


# --- A server on standard input and output, or on a port of this machine --------------------------


def _log_to_stderr() -> None:
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("srgc lsp: %(levelname)s: %(message)s"))
    root = logging.getLogger()
    root.handlers = [handler]
    root.setLevel(logging.ERROR)
    # ``Server.report_server_error`` reports the errors that pygls would log.
    logging.getLogger("pygls").setLevel(logging.CRITICAL)


def serve_stdio() -> int:
    """Serve one client until it ends; return 0 if it sent ``shutdown``, else 1."""
    _log_to_stderr()
    # Other output, of a library or a child process, must not disturb the protocol.
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
        pass  # the client has gone, or has sent ``exit``
    finally:
        server.close()
    return 0 if server.stopped and not lost else 1


async def _answer(server: Server, messages: MessageStream) -> bool:
    """Handle all messages in the stream; return whether message boundaries were lost."""
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
    """Answer an unreadable message; if the connection ends with it, log that."""
    if fault.lost:
        logging.getLogger(__name__).error("the connection ends: %s", fault)
    server.protocol.refuse(None, fault.CODE, str(fault))

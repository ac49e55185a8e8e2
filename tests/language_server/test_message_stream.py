"""Headers and bodies that are none: one error each, and a clean end where nothing can go on."""

from __future__ import annotations

import json
import random
import socket
import time
import tracemalloc
from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from itertools import product
from typing import Any

import pytest

from srgc.language_server.serving import (
    HEADER_LIMIT,
    MESSAGE_LIMIT,
    SKIPPED_LIMIT,
    MessageStream,
    UnreadableMessage,
)
from tests.language_server.client import PATIENCE, Client
from tests.oracles.some_cases import some

Start = Callable[..., Client]
NEXT = b"Content-Length: 2\r\n\r\n{}"
LENGTH = b"Content-Length: %s\r\n\r\n"

LOST = {
    "a huge length": (LENGTH % b"99999999999999999999", "99,999,999,999,999,999,999 bytes"),
    "a length of a thousand digits": (LENGTH % (b"9" * 5000), "no length"),
    "a length beyond what is passed over": (LENGTH % b"%d" % (SKIPPED_LIMIT + 1), "more than"),
    "a negative length": (LENGTH % b"-1", "no length"),
    "a length that is none": (LENGTH % b"abc", "no length"),
    "an empty length": (LENGTH % b"", "no length"),
    "a length with a sign": (LENGTH % b"+2", "no length"),
    "a length in hexadecimal": (LENGTH % b"0x2", "no length"),
    "a length with a fraction": (LENGTH % b"2.0", "no length"),
    "a length of other digits": (LENGTH % "\u0662".encode(), "no length"),
    "two lengths in one": (LENGTH % b"2, 3", "no length"),
    "two lengths": (b"Content-Length: 3\r\n" + NEXT, "more than one Content-Length"),
    "no length": (b"Content-Type: application/vscode-jsonrpc\r\n\r\n{}", "without Content-Length"),
    "no colon": (b"Content-Length 2\r\n\r\n{}", "no field"),
    "no name": (b": 2\r\n\r\n{}", "no field"),
    "a body without header": (b'{"jsonrpc": "2.0"}\r\n\r\n', "no field"),
    "binary garbage": (bytes(range(256)) * 4, "no field"),
    "NUL bytes": (bytes(HEADER_LIMIT * 2), "more than 8,192 bytes"),
    "a line of megabytes": (b"X: " + b"a" * 2**22, "more than 8,192 bytes"),
    "thousands of fields": (b"X: a\r\n" * 2000 + NEXT, "more than 8,192 bytes"),
    "an end in the header": (b"Content-Length: 2", "ends in the header"),
    "an end after the header": (b"Content-Length: 2\r\n", "ends in the header"),
    "an end before the body": (b"Content-Length: 2\r\n\r\n", "ends after 0 of the 2 bytes"),
    "an end in the body": (b"Content-Length: 99999\r\n\r\n{}", "ends after 2 of the 99,999"),
}
KEPT = {
    "lower case": (b"content-length: 2\r\n\r\n{}", b"{}"),
    "upper case": (b"CONTENT-LENGTH: 2\r\n\r\n{}", b"{}"),
    "no blank": (b"Content-Length:2\r\n\r\n{}", b"{}"),
    "blanks": (b"Content-Length : \t 2 \t\r\n\r\n{}", b"{}"),
    "zeros": (b"Content-Length: " + b"0" * 5000 + b"2\r\n\r\n{}", b"{}"),
    "no return": (b"Content-Length: 2\n\n{}", b"{}"),
    "empty lines before": (b"\r\n\n\r\n" * 4000 + NEXT, b"{}"),
    "the same length twice": (b"Content-Length: 2\r\n" + NEXT, b"{}"),
    "an unknown field": (b"X-Trace: a: b\r\nY:\r\n" + NEXT, b"{}"),
    "bytes in a field": (b"X: \xff\0\r\n" + NEXT, b"{}"),
    "a type": (b"Content-Type: application/vscode-jsonrpc; charset=utf-8\r\n" + NEXT, b"{}"),
    "a type of old": (b"content-type: text; Charset=UTF8; x=y\r\n" + NEXT, b"{}"),
    "no body": (b"Content-Length: 0\r\n\r\n", b""),
}


@pytest.mark.parametrize("name", LOST)
def test_a_frame_that_is_lost(name: str) -> None:
    data, said = LOST[name]
    with pytest.raises(UnreadableMessage, match=said) as caught:
        MessageStream(BytesIO(data)).next()
    assert caught.value.lost
    assert len(str(caught.value)) < 100


@pytest.mark.parametrize("name", KEPT)
def test_headers_that_are_read(name: str) -> None:
    data, body = KEPT[name]
    stream = MessageStream(BytesIO(data + data + NEXT))
    assert [stream.next(), stream.next(), stream.next(), stream.next()] == [body, body, b"{}", None]


def test_what_is_refused_is_passed_over() -> None:
    long = LENGTH % (b"%d" % (MESSAGE_LIMIT + 1)) + bytes(MESSAGE_LIMIT + 1)
    other = b"Content-Type: text; charset=utf-16\r\nContent-Length: 4\r\n\r\n{\0}\0"
    stream = MessageStream(BytesIO(long + other + NEXT))
    tracemalloc.start()
    for said in ("67,108,865 bytes, more than 67,108,864", "another charset"):
        with pytest.raises(UnreadableMessage, match=said) as caught:
            stream.next()
        assert not caught.value.lost
    assert stream.next() == b"{}"
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2**22
    short = MessageStream(BytesIO(LENGTH % (b"%d" % (MESSAGE_LIMIT + 1)) + b"{}"))
    with pytest.raises(UnreadableMessage, match="more than"):
        short.next()
    assert short.next() is None


def test_a_header_of_megabytes_is_not_read() -> None:
    file = BytesIO(b"a" * 2**22)
    with pytest.raises(UnreadableMessage):
        MessageStream(file).next()
    assert file.tell() <= HEADER_LIMIT + 1


def test_spoilt_streams() -> None:
    sound = b"Content-Length: 17\r\nContent-Type: a; charset=utf-8\r\n\r\n" + b'{"jsonrpc":"2.0"}'
    for seed in range(3000):
        chance = random.Random(seed)
        data = bytearray(sound * 2)
        for _ in range(chance.randint(1, 4)):
            place = chance.randint(0, len(data))
            data[place : place + chance.randint(0, 3)] = chance.randbytes(chance.randint(0, 3))
        stream = MessageStream(BytesIO(data))
        for _ in range(len(data)):
            try:
                if stream.next() is None:
                    break
            except UnreadableMessage as fault:
                if fault.lost:
                    break
        else:
            pytest.fail(f"no end: {seed}")


def answered(client: Client) -> dict[str, Any]:
    error: dict[str, Any] = client.response(None)["error"]
    return error


FATAL = ("a huge length", "no length", "binary garbage", "a line of megabytes", "two lengths")


@pytest.mark.parametrize(
    ("initialized", "name"),
    some([*product([True], FATAL[:2]), *product([False], FATAL), *product([True], FATAL[2:])], 3),
)
def test_a_server_ends_where_the_frame_is_lost(
    started: Start, name: str, initialized: bool
) -> None:
    data, said = LOST[name]
    client = started()
    if initialized:
        client.initialize()
    with suppress(BrokenPipeError):  # it does not wait for the rest
        client.raw(data)
    error = answered(client)
    assert error["code"] == -32600
    assert said in error["message"]
    assert client.process.wait(PATIENCE) == 1
    assert client.next() is None
    [line] = told(client)
    assert line == f"srgc lsp: ERROR: the connection ends: {error['message']}"


def told(client: Client) -> list[str]:
    """The lines on standard error."""
    client.reader.join(PATIENCE)
    return b"".join(client.log).decode().splitlines()


@pytest.mark.parametrize("data", some([b"Content-Length: 20\r\n\r\n{}", b"Content-Length: 2"], 1))
def test_an_end_within_a_message(started: Start, data: bytes) -> None:
    client = started()
    client.initialize()
    client.raw(data)
    assert client.process.stdin is not None
    client.process.stdin.close()
    assert "the input ends" in answered(client)["message"]
    assert client.process.wait(PATIENCE) == 1
    assert len(told(client)) == 1


def test_a_server_goes_on_where_it_can(started: Start) -> None:
    client = started()
    client.initialize()
    client.raw(b"X-Unknown: 1\r\ncontent-type: a; charset=utf-8\r\n")
    assert client.ask("workspace/symbol", {"query": ""}) == []
    client.raw(b"\r\n\r\ncontent-length: 0\r\n\r\n")
    assert answered(client)["code"] == -32700
    client.raw(b"Content-Type: a; charset=latin-1\r\nContent-Length: 2\r\n\r\n{}")
    assert "UTF-8" in answered(client)["message"]
    client.raw(LENGTH % (b"%d" % (MESSAGE_LIMIT + 1)))
    assert "67,108,864" in answered(client)["message"]
    for _ in range(64):
        client.raw(b" " * 2**20)
    client.raw(b" ")
    assert client.ask("workspace/symbol", {"query": ""}) == []
    assert client.close() == 0
    assert told(client) == []


def test_a_port_is_no_other(started: Start) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    client = started("--tcp", str(port))
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            connection = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
            break
        except OSError:
            assert time.monotonic() < deadline
            time.sleep(0.05)
    with connection, connection.makefile("rwb") as stream:
        stream.write(NEXT + b"Content-Length: -1\r\n\r\n")
        stream.flush()
        for said in ("this is no message", "a Content-Length that is no length"):
            header = stream.readline()
            assert header.startswith(b"Content-Length: ")
            while stream.readline() != b"\r\n":
                pass
            body = json.loads(stream.read(int(header.split()[1])))
            assert body["id"] is None
            assert body["error"] == {"code": -32600, "message": said}
        assert stream.read() == b""
    assert client.process.wait(PATIENCE) == 1
    assert len(told(client)) == 1

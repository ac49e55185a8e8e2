"""The life of a server over raw JSON-RPC: its beginning and end, and messages that are none."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.language_server.client import PATIENCE, Client
from tests.oracles.some_cases import some

ROOT = Path(__file__).parents[2]
SPEC = (ROOT / "specs" / "planar_arm.srg").read_text(encoding="utf-8")
Start = Callable[..., Client]


def test_a_life_in_order(started: Start) -> None:
    client = started()
    assert client.error("textDocument/hover", {})["code"] in {-32002, -32602}
    assert client.error("workspace/symbol", {"query": ""})["code"] == -32002
    result = client.initialize(textDocument={"rename": {"prepareSupport": True}})
    assert result["serverInfo"]["name"] == "srgc"
    assert result["capabilities"]["positionEncoding"] == "utf-16"
    assert result["capabilities"]["renameProvider"] == {"prepareProvider": True}
    assert client.error("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
    assert client.ask("shutdown") is None
    assert client.error("workspace/symbol", {"query": ""})["code"] == -32600
    client.notify("exit")
    assert client.process.wait(PATIENCE) == 0
    assert client.next() is None
    assert b"Traceback" not in b"".join(client.log)


def test_a_hover_has_the_form_that_the_client_shows(started: Start) -> None:
    """Emacs without a mode for Markdown asks for plain text, and shows what it gets as it is."""
    module, production = (SPEC.count("\n", 0, SPEC.index(t)) for t in ("module JO", "  link: N"))
    told = {}
    for kind, formats in (("plaintext", ["plaintext"]), ("markdown", ["markdown", "plaintext"])):
        client = started()
        client.initialize(textDocument={"hover": {"contentFormat": formats}})
        assert client.open("untitled:Untitled-1", SPEC) == []
        for line, column in ((module, 8), (production, 3)):
            params = client.at("untitled:Untitled-1", line, column)
            found = client.ask("textDocument/hover", params)["contents"]
            assert found["kind"] == kind
            told[kind, line] = found["value"]
    plain = told["plaintext", module].splitlines()
    assert plain[:3] == ["module JO {", "  role joint;", "  dof q: revolute z in [-180, 180] deg;"]
    for line in (module, production):
        assert not any(mark in told["plaintext", line] for mark in ("`", "**"))
        # The same words otherwise.
        marked = told["markdown", line].replace("```srg\n", "").replace("```\n", "")
        assert "**" in marked or line == module
        assert told["plaintext", line] == marked.replace("`", "").replace("**", "")


def test_an_end_in_the_middle_of_work(started: Start) -> None:
    """Nothing goes wrong inside, and the end is an end."""
    client = started()
    client.initialize()
    uri = "untitled:Untitled-1"
    item = {"uri": uri, "languageId": "srg", "version": 1, "text": SPEC * 20}
    client.notify("textDocument/didOpen", {"textDocument": item})
    client.versions[uri] = 1
    for _ in range(5):
        client.change(uri, {"text": SPEC * 20})
        client.begin("textDocument/hover", client.at(uri, 3, 8))
    assert client.close() == 0
    assert b"Traceback" not in b"".join(client.log), b"".join(client.log).decode()


@pytest.mark.parametrize("politely", some([False, True], 1))
def test_an_end_without_shutdown(started: Start, politely: bool) -> None:
    client = started()
    client.initialize()
    if politely:
        client.notify("exit")
    else:
        assert client.process.stdin is not None
        client.process.stdin.close()
    assert client.process.wait(PATIENCE) == 1


def test_messages_that_are_none(started: Start) -> None:
    """Each has its answer, and the server goes on."""
    client = started()
    client.initialize()

    def answer(body: bytes) -> int:
        client.raw(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        found = client.response(None)["error"]["code"]
        assert isinstance(found, int)
        return found

    assert answer(b"{this is no JSON") == -32700
    assert answer(b"\xff\xfe") == -32700
    assert answer(b"[]") == -32600
    assert answer(b"42") == -32600
    assert answer(b'{"id": 3}') == -32600
    assert answer(b"[" * 100_000) == -32700
    assert client.error("textDocument/hover", {"textDocument": 7})["code"] == -32602
    assert client.error("no/such/method", {})["code"] == -32601
    command = {"command": "srgc.check", "arguments": [1, 2, 3]}
    assert client.error("workspace/executeCommand", command)["code"] == -32602
    command = {"command": "no.such", "arguments": []}
    assert client.error("workspace/executeCommand", command)["code"] == -32602
    client.notify("no/such/notification", {"x": 1})
    client.notify("textDocument/didChange", {"textDocument": {"uri": "u", "version": 1}})
    change = {"textDocument": {"uri": "file:///never", "version": 2}, "contentChanges": []}
    client.notify("textDocument/didChange", change)
    client.notify("textDocument/didClose", {"textDocument": {"uri": "file:///never"}})
    client.raw(b"Content-Type: application/vscode-jsonrpc; charset=utf-8\r\n")
    client.notify("$/cancelRequest", {"id": 999})
    assert client.ask("textDocument/hover", client.at("file:///never", 0, 0)) is None
    assert client.ask("workspace/symbol", {"query": "x"}) == []
    assert client.close() == 0


def test_a_port(started: Start) -> None:
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
        body = (
            b'{"jsonrpc": "2.0", "id": 1, "method": "initialize", "params":'
            b' {"processId": null, "rootUri": null, "capabilities": {}}}'
        )
        stream.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        stream.flush()
        assert stream.readline().startswith(b"Content-Length: ")
    assert client.process.wait(PATIENCE) == 1


def test_nothing_heavy_is_loaded_before_it_is_needed() -> None:
    """Not for the start, nor for the findings, hover and outline of a file without formulas."""
    program = """
import sys
from srgc.language_server.server import Server
Server()
heavy = {"casadi", "z3", "numpy", "scipy", "clarabel", "pysat", "flint", "networkx"}
print(sorted(heavy & set(sys.modules)))
from pathlib import Path
from srgc.language_server.documents.analysis import analyse
from srgc.language_server.hovers.hover import hover
analysis = analyse(sys.argv[1], Path(sys.argv[1]).read_text("utf-8"), {})
analysis.findings
text = analysis.sources[0].text
assert hover(analysis, 0, text.index("obstacle O") + 9) and hover(analysis, 0, text.index("link:"))
print(sorted(heavy & set(sys.modules)))
"""
    spec = str(ROOT / "specs" / "planar_arm.srg")
    command = [sys.executable, "-c", program, spec]
    ran = subprocess.run(command, capture_output=True, cwd=ROOT, check=True)
    assert ran.stdout.split() == [b"[]", b"[]"]

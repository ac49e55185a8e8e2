"""URIs and texts with paths that no file has: answers, no faults, and no waiting for ever."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from srgc.language_server.documents.projects import bytes_of, included, is_folder
from srgc.language_server.documents.uris import path_of
from tests.language_server.client import Client
from tests.oracles.small_specs import SLIDER
from tests.oracles.some_cases import some

Start = Callable[..., Client]

URIS = (
    "", "untitled:", "file:", "file://", "file:///%00", "file:///a%00b.srg", "file:///a\0b.srg",
    "file://host/x.srg", "file://a:b:c/x.srg", "file:///%", "file:///%zz.srg", "file:///%ff.srg",
    "file:///%ed%a0%80.srg", "\ud800", "file:///\ud800.srg", f"file:///{'n' * 5000}.srg",
    f"file:///{'d/' * 3000}x.srg", f"file:///{'%2e%2e/' * 1000}x.srg", "http://[", "file://[x/a.srg",
    "a\0b", "/a\0b.srg", "/a.srg", "relative.srg", "C:\\x.srg", "file:///c%3A/x.srg",
    "file:///dev/zero", "file:///dev/null/x.srg", "vscode-notebook-cell:/x#1", "git:/a.srg?{}",
)  # fmt: skip
TEXTS = (
    'include "a\0b.srg";\n',
    'include "a\ud800b.srg";\n',
    'workspace W { plane xy; obstacles from "a\0.yaml"; }\n',
    f'include "{"n" * 5000}.srg";\n',
    f'include "{"d/" * 3000}x.srg";\n',
    'include "loop.srg";\n',
    'include "loop.srg/x.srg";\n',
    'include "pipe.srg";\n',
    "\0",
    "// \ud800\n",
    SLIDER.replace("task Slide", f"task {'T' * 5000}"),
)
REQUESTS = (
    "hover definition references documentHighlight prepareRename rename completion signatureHelp "
    "formatting documentSymbol foldingRange semanticTokens/full documentLink codeLens codeAction"
)
REFUSED = {-32602, -32803}
"""What is refused has its reason; -32603 is a fault inside."""


def uses(client: Client, uri: str, text: str) -> None:
    """All requests about a document."""
    item = {"uri": uri, "languageId": "srg", "version": 1, "text": text}
    client.notify("textDocument/didOpen", {"textDocument": item})
    start = {"line": 0, "character": 0}
    params = {
        **client.at(uri, 0, 10),
        "newName": "\ud800",
        "options": {"tabSize": 2, "insertSpaces": True},
        "context": {"includeDeclaration": True, "diagnostics": []},
        "range": {"start": start, "end": start},
    }
    numbers = [client.begin(f"textDocument/{name}", params) for name in REQUESTS.split()]
    for task in ("Slide", "T" * 5000, "a\0b"):
        for what in ("check", "verify"):
            command = {"command": f"srgc.{what}", "arguments": [uri, task]}
            numbers.append(client.begin("workspace/executeCommand", command))
    client.notify("workspace/didChangeWatchedFiles", {"changes": [{"uri": uri, "type": 1}]})
    numbers.append(client.begin("workspace/symbol", {"query": ""}))
    for number in numbers:
        answer: Any = client.response(number)
        assert "error" not in answer or answer["error"]["code"] in REFUSED, (uri[:50], answer)
    client.notify("textDocument/didClose", {"textDocument": {"uri": uri}})


def ended(client: Client) -> None:
    assert client.close() == 0
    client.reader.join(10)
    assert client.log == []


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "loop.srg").symlink_to("loop.srg")
    os.mkfifo(tmp_path / "pipe.srg")
    (tmp_path / "endless.srg").symlink_to("/dev/zero")
    results = tmp_path / "out" / "Slide"
    results.mkdir(parents=True)
    os.mkfifo(results / "design.json")
    return tmp_path


def test_documents(started: Start, folder: Path) -> None:
    client = started()
    client.initialize(folder)
    for uri in URIS:
        uses(client, uri, SLIDER)
    ended(client)


def test_texts(started: Start, folder: Path) -> None:
    client = started()
    client.initialize(folder)
    (folder / "t.srg").write_text(SLIDER, encoding="utf-8")
    for text in TEXTS:
        uses(client, "untitled:Untitled-1", text)
        uses(client, (folder / "t.srg").as_uri(), text)
    uses(client, (folder / "t.srg").as_uri(), SLIDER)
    ended(client)


def test_folders(started: Start) -> None:
    """Of the whole disk as a folder every file would be looked at."""
    odd = [uri for uri in URIS if path_of(uri) is None]
    folders = [{"uri": uri, "name": "x"} for uri in odd]
    client = started()
    params = {"processId": None, "rootUri": None, "capabilities": {}, "workspaceFolders": folders}
    assert client.ask("initialize", params)["serverInfo"]["name"] == "srgc"
    client.notify("initialized", {})
    event = {"added": folders, "removed": []}
    client.notify("workspace/didChangeWorkspaceFolders", {"event": event})
    assert client.ask("workspace/symbol", {"query": ""}) == []
    event = {"added": [], "removed": folders}
    client.notify("workspace/didChangeWorkspaceFolders", {"event": event})
    uses(client, "untitled:x", SLIDER)
    ended(client)


@pytest.mark.parametrize(
    "uri", some(["http://[", "file:///%00", "file://[x/a.srg", "\ud800", ""], 2)
)
def test_a_root(started: Start, uri: str) -> None:
    client = started()
    params = {"processId": None, "rootUri": uri, "rootPath": uri, "capabilities": {}}
    assert client.ask("initialize", params)["serverInfo"]["name"] == "srgc"
    client.notify("initialized", {})
    assert client.ask("workspace/symbol", {"query": ""}) == []
    ended(client)


def test_what_is_no_file_is_not_read(folder: Path) -> None:
    assert bytes_of(folder / "pipe.srg") is None
    assert bytes_of(folder / "endless.srg") is None
    assert bytes_of(folder) is None
    assert bytes_of(Path("a\0b")) is None
    (folder / "x").write_bytes(b"1234")
    assert bytes_of(folder / "x", 3) is None
    assert bytes_of(folder / "x", 4) == b"1234"
    assert not is_folder(Path("n" * 5000))


def test_comments_without_end_are_passed_once() -> None:
    text = 'include "a.srg"; /* include "b.srg"; */ include "c.srg"; // include "d.srg";'
    assert included(text) == ["a.srg", "c.srg"]
    assert included("/*" * 10**6 + 'include "a.srg";') == []
    assert included("/*" + "*" * 10**6 + '/include "a.srg";') == ["a.srg"]

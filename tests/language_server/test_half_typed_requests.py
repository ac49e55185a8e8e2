"""Every request over the wire, on texts that are being typed: no answer is an error."""

from __future__ import annotations

import random
from typing import Any

import pytest

from tests.language_server.client import Client, uri_of
from tests.language_server.test_half_typed import texts

LSP_REFUSED = -32803


def requests(client: Client, uri: str, line: int, column: int) -> list[tuple[str, Any]]:
    at = client.at(uri, line, column)
    document = {"textDocument": {"uri": uri}}
    place = {"start": at["position"], "end": at["position"]}
    return [
        ("textDocument/hover", at),
        ("textDocument/definition", at),
        ("textDocument/references", at | {"context": {"includeDeclaration": True}}),
        ("textDocument/documentHighlight", at),
        ("textDocument/completion", at),
        ("textDocument/signatureHelp", at),
        ("textDocument/documentSymbol", document),
        ("textDocument/foldingRange", document),
        ("textDocument/semanticTokens/full", document),
        ("textDocument/documentLink", document),
        ("textDocument/codeLens", document),
        ("textDocument/codeAction", document | {"range": place, "context": {"diagnostics": []}}),
        ("textDocument/formatting", document | {"options": {"tabSize": 2, "insertSpaces": True}}),
        ("workspace/symbol", {"query": "a"}),
    ]


def type_and_ask(client: Client, seed: int, number: int) -> None:
    uri = uri_of(client.folder / f"typed {seed}.srg")
    client.open(uri, "")
    for _, text, chance in texts(seed, number):
        client.change(uri, {"text": text})
        line, column = chance.randrange(80), chance.randrange(90)
        begun = [client.begin(*each) for each in requests(client, uri, line, column)]
        at = client.at(uri, line, column)
        refusable = [
            client.begin("textDocument/prepareRename", at),
            client.begin("textDocument/rename", at | {"newName": "Renamed"}),
        ]
        for request in begun:
            assert "error" not in client.response(request)
        for request in refusable:
            answer = client.response(request)
            assert answer.get("error", {}).get("code", LSP_REFUSED) == LSP_REFUSED
    client.notify("textDocument/didClose", {"textDocument": {"uri": uri}})


def test_typing_and_asking(client: Client) -> None:
    type_and_ask(client, 100, 6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(101, 105))
def test_typing_and_asking_for_long(client: Client, seed: int) -> None:
    type_and_ask(client, seed, 60)


@pytest.mark.slow
def test_keys_one_by_one(client: Client) -> None:
    """As one types: every key a change, with requests in between that are cancelled."""
    uri = uri_of(client.folder / "keys.srg")
    client.open(uri, "")
    chance = random.Random(3)
    text = next(texts(5, 1))[1][:600]
    written = ""
    for letter in text:
        line = written.replace("\r\n", "\n").replace("\r", "\n").count("\n")
        column = 10_000
        at = {"line": line, "character": column}
        client.change(uri, {"range": {"start": at, "end": at}, "text": letter})
        written += letter
        if chance.random() < 0.2:
            number = client.begin("textDocument/completion", client.at(uri, line, column))
            client.notify("$/cancelRequest", {"id": number})
            answer = client.response(number)
            assert answer.get("error", {}).get("code", -32800) == -32800


def test_nothing_was_logged(client: Client) -> None:
    """The last test of this module."""
    assert client.close() == 0
    assert b"Traceback" not in b"".join(client.log), b"".join(client.log).decode()

"""A thousand modules: everything is answered, and outdated work is not done."""

from __future__ import annotations

import pytest

from tests.language_server.client import Client, uri_of

MODULES = 1000


def big() -> str:
    parts = [
        f"module M{i} {{ role link; param length in [0.5, 5] m; const density = 1 kg/m; }}"
        for i in range(MODULES)
    ]
    rules = [f"  l{i}: N -> N eps M{i};" for i in range(MODULES)]
    blocks = [
        f"  l{i} {{ this.frame = N.frame * move(x, M{i}.length); rod(frame: N.frame, axis: x, "
        f"length: M{i}.length, density: M{i}.density); }}"
        for i in range(MODULES)
    ]
    lines = [
        *parts,
        "module B { role base; }",
        "module E { role effector; }",
        "edge eps;",
        "grammar G {",
        "  start N;",
        "  base: N -> B;",
        "  tool: N -> N eps E;",
        *rules,
        "  accept ends with E;",
        "}",
        "semantics G {",
        "  base { this.frame = world; }",
        "  tool { this.frame = N.frame; effector(frame: N.frame); }",
        *blocks,
        "}",
    ]
    return "\n".join(lines) + "\n"


@pytest.mark.slow
def test_typing_in_a_big_file(client: Client) -> None:
    text = big()
    path = client.folder / "big.srg"
    uri = uri_of(path)
    client.open(uri, text)
    line = next(i for i, each in enumerate(text.splitlines()) if each == "edge eps;")
    start = len(client.notifications)
    for letter in reversed("edge late; "):
        at = {"line": line, "character": 0}
        version = client.change(uri, {"range": {"start": at, "end": at}, "text": letter})
    found = client.findings(uri, version)
    assert ["`late`" in each["message"] for each in found] == [True]
    told = [each["params"].get("version") for each in client.notifications[start:]]
    assert len([each for each in told if each is not None]) <= 2, "every key was answered"
    at = client.at(uri, 10, 8)
    assert "module M10" in client.ask("textDocument/hover", at)["contents"]["value"]
    symbols = client.ask("textDocument/documentSymbol", {"textDocument": {"uri": uri}})
    assert len(symbols) == MODULES + 6
    place = client.at(uri, line + 4, len("  tool: N -> N eps "))
    items = client.ask("textDocument/completion", place)["items"]
    assert len({item["label"] for item in items if item["detail"] == "module"}) == MODULES + 2

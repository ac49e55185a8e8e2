"""Every feature over raw JSON-RPC, with the changes that an editor sends."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.language_server.client import Client, uri_of

ROOT = Path(__file__).parents[2]
SPEC = (ROOT / "specs" / "planar_arm_body.srg").read_text(encoding="utf-8")
PARTS = """\
module B { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module L { role link; param length in [0.5, 5] m; const density = 1 kg/m; }
module EN { role effector; }
edge eps;
"""


def place(text: str, word: str, after: str = "") -> tuple[int, int]:
    """Line and UTF-16 column of the first ``word`` behind ``after``."""
    offset = text.index(word, text.index(after) if after else 0)
    line = text.count("\n", 0, offset)
    return line, len(text[text.rfind("\n", 0, offset) + 1 : offset].encode("utf-16-le")) // 2


def document(uri: str) -> dict[str, Any]:
    return {"textDocument": {"uri": uri}}


@pytest.fixture(scope="module")
def spec(client: Client) -> str:
    """The URI of the running example, open."""
    path = client.folder / "the arm.srg"
    path.write_text(SPEC, encoding="utf-8")
    uri = uri_of(path)
    assert "%20" in uri
    assert client.open(uri, SPEC) == []
    return uri


def labels(client: Client, uri: str, text: str, word: str, after: str = "") -> list[str]:
    params = client.at(uri, *place(text, word, after))
    return [item["label"] for item in client.ask("textDocument/completion", params)["items"]]


def test_hover_definition_highlight(client: Client, spec: str) -> None:
    at = client.at(spec, *place(SPEC, "L.length"))
    assert "module L" in client.ask("textDocument/hover", at)["contents"]["value"]
    (found,) = client.ask("textDocument/definition", at)
    line, column = place(SPEC, "L {")
    assert (found["uri"], found["range"]["start"]) == (spec, {"line": line, "character": column})
    assert len(client.ask("textDocument/documentHighlight", at)) == 5
    context = {"context": {"includeDeclaration": False}}
    assert len(client.ask("textDocument/references", at | context)) == 4


def test_prepare_and_rename(client: Client, spec: str) -> None:
    at = client.at(spec, *place(SPEC, "L.length"))
    found = client.ask("textDocument/prepareRename", at)
    assert found["end"]["character"] - found["start"]["character"] == 1
    keyword = client.at(spec, *place(SPEC, "accept"))
    assert client.ask("textDocument/prepareRename", keyword) is None
    edit = client.ask("textDocument/rename", at | {"newName": "Arm2"})
    assert len(edit["changes"][spec]) == 5
    error = client.error("textDocument/rename", at | {"newName": "EN"})
    assert "already the name of module `EN`" in error["message"]


def test_outline_symbols_folding_links_tokens(client: Client, spec: str) -> None:
    symbols = client.ask("textDocument/documentSymbol", document(spec))
    names = [symbol["name"] for symbol in symbols]
    assert names == ["B", "JO", "L", "EN", "eps", "PlanarArm", "PlanarArm", "Bench",
                     "PickAndPlaceWithBody"]  # fmt: skip
    productions = [child["name"] for child in symbols[5]["children"]]
    assert productions == ["base", "joint", "link", "tool"]
    found = client.ask("workspace/symbol", {"query": "pickbody"})
    assert [symbol["name"] for symbol in found] == ["PickAndPlaceWithBody"]
    folds = client.ask("textDocument/foldingRange", document(spec))
    assert len(folds) == 5
    data = client.ask("textDocument/semanticTokens/full", document(spec))["data"]
    assert len(data) % 5 == 0
    assert min(data) >= 0
    assert client.ask("textDocument/documentLink", document(spec)) == []


def test_completion_and_signature(client: Client, spec: str) -> None:
    assert labels(client, spec, SPEC, "PlanarArm;") == ["PlanarArm"]
    assert labels(client, spec, SPEC, "S at") == ["S", "O", "T"]
    assert labels(client, spec, SPEC, "body margin") == ["body", "effector"]
    assert labels(client, spec, SPEC, "revolute") == ["prismatic", "revolute"]
    assert labels(client, spec, SPEC, "link; p", "module L") == [
        "base",
        "joint",
        "link",
        "effector",
    ]
    assert set(labels(client, spec, SPEC, "N eps L", "link:")) >= {"N", "L", "eps", "JO", "empty"}
    assert labels(client, spec, SPEC, "length);", "move(x") == ["length", "density"]
    assert "N*m" in labels(client, spec, SPEC, "N*m;")
    assert labels(client, spec, SPEC, "judged") == []
    itself = SPEC.replace("avoid O", "avoid self with body, except L L; avoid O")
    uri = uri_of(client.folder / "itself.srg")
    assert {"severity": 1} not in [
        {"severity": each["severity"]} for each in client.open(uri, itself)
    ]
    assert labels(client, uri, itself, "L; avoid") == ["B", "JO", "L", "EN"]
    carried = itself.replace("avoid self", "carry 1 kg from S to T; avoid self")
    other = uri_of(client.folder / "carried.srg")
    client.open(other, carried)
    for word in ("S to", "T; avoid"):
        assert labels(client, other, carried, word) == ["S", "O", "T"]
    assert set(labels(client, spec, SPEC, "horizon")) >= {"reach", "avoid", "horizon", "satisfy"}
    params = client.at(spec, *place(SPEC, "L.density);"))
    help_ = client.ask("textDocument/signatureHelp", params)
    assert help_["signatures"][0]["parameters"][help_["activeParameter"]]["label"] == "density"


def test_typing(client: Client, spec: str) -> None:
    """A misspelt name, told and mended by its quick fix; only the text changes, not the file."""
    line, column = place(SPEC, "Bench;")
    ends = [{"line": line, "character": column + n} for n in (0, 5)]
    version = client.change(
        spec, {"range": dict(zip(("start", "end"), ends, strict=True)), "text": "Bnch"}
    )
    found = client.findings(spec, version)
    (wrong,) = [each for each in found if each["severity"] == 1]
    assert wrong["code"] == "SRG0201"
    assert wrong["codeDescription"]["href"].endswith("SRG0201.md")
    assert wrong["range"]["start"] == ends[0]
    assert "did you mean `Bench`?" in wrong["message"]
    params = document(spec) | {"range": wrong["range"], "context": {"diagnostics": [wrong]}}
    (fix,) = client.ask("textDocument/codeAction", params)
    (edit,) = fix["edit"]["changes"][spec]
    version = client.change(spec, {"range": edit["range"], "text": edit["newText"]})
    assert client.findings(spec, version) == []


def test_formatting(client: Client) -> None:
    uri = "untitled:Untitled-1"
    text = "module   B{role base;}\r\n// \U0001f916 e\u0301\r\n\r\n\r\n\r\nedge   eps ;\r\n"
    client.open(uri, text)
    options = {"options": {"tabSize": 2, "insertSpaces": True}}
    edits = client.ask("textDocument/formatting", document(uri) | options)
    lines = text.split("\r\n")
    for edit in reversed(edits):
        start, end = edit["range"]["start"], edit["range"]["end"]
        assert start["character"] == end["character"] == 0
        lines[start["line"] : end["line"]] = edit["newText"].split("\r\n")[:-1]
    made = "\r\n".join(lines)
    assert made.startswith("module B { role base; }\r\n// \U0001f916 e\u0301\r\n")
    assert made.endswith("edge eps;\r\n")
    assert "\n" not in made.replace("\r\n", "")
    client.change(uri, {"text": "module B {"})
    assert client.ask("textDocument/formatting", document(uri) | options) == []
    client.notify("textDocument/didClose", document(uri))


def test_columns_count_utf_16(client: Client) -> None:
    uri = "untitled:Untitled-2"
    text = "/* \U0001f916\U0001f916e\u0301 */\tmodule B { role bse; }"
    found = client.open(uri, text)
    (wrong,) = [each for each in found if each["severity"] == 1]
    line, column = place(text, "bse")
    assert (line, column) == (0, text.index("bse") + 2)
    assert wrong["range"]["start"] == {"line": 0, "character": column}
    assert wrong["range"]["end"] == {"line": 0, "character": column + 3}
    client.notify("textDocument/didClose", document(uri))


def test_unused_fades(client: Client) -> None:
    uri = "untitled:Untitled-3"
    found = client.open(uri, SPEC.replace("edge eps;", "edge eps, never;"))
    (unused,) = found
    assert (unused["severity"], unused["tags"]) == (2, [1])
    client.notify("textDocument/didClose", document(uri))


def test_an_included_buffer(client: Client) -> None:
    """What counts of an open file is its buffer; renaming goes through both files."""
    folder = client.folder / "sub folder"
    folder.mkdir()
    parts, main = folder / "my parts.srg", folder / "main.srg"
    rest = SPEC[SPEC.index("grammar") :]
    text = 'include "my parts.srg";\n' + rest
    parts.write_text("module B { role base; }\n", encoding="utf-8")
    main.write_text(text, encoding="utf-8")
    found = client.open(uri_of(main), text)
    assert any("`JO`" in each["message"] for each in found)
    # Opened and completed, but not saved.
    assert client.open(uri_of(parts), PARTS) == []
    assert client.findings(uri_of(main), 1) == []
    (link,) = client.ask("textDocument/documentLink", document(uri_of(main)))
    assert link["target"] == uri_of(parts)
    at = client.at(uri_of(main), *place(text, "L.length"))
    (there,) = client.ask("textDocument/definition", at)
    assert there["uri"] == uri_of(parts)
    edit = client.ask("textDocument/rename", at | {"newName": "Rod"})
    assert {uri: len(each) for uri, each in edit["changes"].items()} == {
        uri_of(parts): 1,
        uri_of(main): 4,
    }
    # From the part itself, too: its uses are in the file that includes it.
    at = client.at(uri_of(parts), *place(PARTS, "L {"))
    context = {"context": {"includeDeclaration": True}}
    assert len(client.ask("textDocument/references", at | context)) == 5
    # A mistake in the part is told there, at once.
    version = client.change(uri_of(parts), {"text": PARTS.replace("[0.5, 5] m", "[5, 0.5] m")})
    assert client.findings(uri_of(parts), version)
    for path in (main, parts):
        client.notify("textDocument/didClose", document(uri_of(path)))


def test_errors_of_a_file_that_is_not_open(client: Client) -> None:
    """``srgc check`` names them; the file that includes it looks sound by itself."""
    folder = client.folder / "beside"
    folder.mkdir()
    parts, main = folder / "parts.srg", folder / "main.srg"
    text = 'include "parts.srg";\n' + SPEC[SPEC.index("grammar") :]
    parts.write_text(PARTS + "module Broken { rol link; }\n", encoding="utf-8")
    main.write_text(text, encoding="utf-8")
    there = uri_of(parts)

    def told() -> list[str]:
        found = client.notified("textDocument/publishDiagnostics", lambda p: p["uri"] == there)
        return [each["code"] for each in found["diagnostics"]]

    assert client.open(uri_of(main), text) == []
    assert told() == ["SRG0104"]
    # No longer a part of it, and a part of it again.
    version = client.change(uri_of(main), {"text": text.replace("include", "// include")})
    assert client.findings(uri_of(main), version)
    assert told() == []
    version = client.change(uri_of(main), {"text": text})
    assert told() == ["SRG0104"]
    # Open, what counts is the buffer, and its version.
    assert client.open(there, PARTS) == []
    client.notify("textDocument/didClose", document(there))
    assert told() == ["SRG0104"]
    client.notify("textDocument/didClose", document(uri_of(main)))
    assert told() == []


def test_lenses_and_check(client: Client, spec: str) -> None:
    lenses = client.ask("textDocument/codeLens", document(spec))
    commands = [(lens["command"]["command"], lens["command"]["title"]) for lens in lenses]
    assert commands == [("srgc.check", "check"), ("srgc.synth", "synth")]
    arguments = lenses[0]["command"]["arguments"]
    assert arguments == [spec, "PickAndPlaceWithBody"]
    command = {"command": "srgc.check", "arguments": arguments}
    assert client.ask("workspace/executeCommand", command) == {"errors": 0, "warnings": 0}
    command = {"command": "srgc.verify", "arguments": arguments}
    assert "synthesise first" in client.error("workspace/executeCommand", command)["message"]
    command = {"command": "srgc.check", "arguments": [spec, "Other"]}
    assert "no task" in client.error("workspace/executeCommand", command)["message"]


def test_nothing_was_logged(client: Client) -> None:
    """The last test of this module: no request has gone wrong inside."""
    assert client.close() == 0
    assert b"Traceback" not in b"".join(client.log)

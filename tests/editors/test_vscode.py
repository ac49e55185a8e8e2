"""The extension for VS Code: its package, its grammar in VS Code's tokeniser, its client."""

from __future__ import annotations

import json
import re
import struct
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from srgc.language_server.documents.analysis import analyse
from srgc.language_server.outlines.semantic_tokens import LEGEND, semantic_tokens
from tests.editors.conftest import EXTENSION, ROOT, run
from tests.oracles.textmate import Grammar

GRAMMAR = EXTENSION / "syntaxes" / "srg.tmLanguage.json"
TEXTS = {
    str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
    for folder in ("specs", "srgc/starters", "editors/vscode/tests/grammar")
    for path in sorted((ROOT / folder).glob("*.srg"))
}
COLUMN = re.compile(r"^//.*[\^-]")


def read_json(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


MANIFEST = read_json(EXTENSION / "package.json")


# --- the package --------------------------------------------------------------------------------


@pytest.mark.editor
def test_the_package_holds_what_it_needs_and_no_more(vsix: Path) -> None:
    with zipfile.ZipFile(vsix) as package:
        names = {name.removeprefix("extension/") for name in package.namelist()}
        assert names == {
            "[Content_Types].xml", "extension.vsixmanifest", "package.json", "readme.md",
            "changelog.md", "LICENSE.txt", "icon.png", "language-configuration.json",
            "syntaxes/srg.tmLanguage.json", "snippets/srg.json", "dist/extension.js",
            "dist/THIRD_PARTY_NOTICES.txt",
        }  # fmt: skip
        assert package.read("extension/syntaxes/srg.tmLanguage.json") == GRAMMAR.read_bytes()
        assert json.loads(package.read("extension/package.json"))["main"] == "./dist/extension.js"
        bundle = package.read("extension/dist/extension.js").decode()
        notices = package.read("extension/dist/THIRD_PARTY_NOTICES.txt").decode()
    assert len(bundle) < 1_000_000
    # All but the editor and what comes with Node is in the bundle.
    required = set(re.findall(r"""\brequire\(["']([^"'./]+)["']\)""", bundle))
    assert "vscode" in required
    assert {name.removeprefix("node:") for name in required - {"vscode"}} <= {
        "child_process", "crypto", "fs", "net", "os", "path", "readline", "timers", "url", "util",
        "worker_threads",
    }  # fmt: skip
    assert "vscode-languageclient" in notices
    assert notices.count("Permission") + notices.count("permission") >= 4


def files_named(node: Any) -> Iterator[str]:
    """The relative paths in a manifest."""
    if isinstance(node, dict):
        for value in node.values():
            yield from files_named(value)
    elif isinstance(node, list):
        for value in node:
            yield from files_named(value)
    elif isinstance(node, str) and node.startswith("./"):
        yield node


def test_the_manifest_names_files_that_are_there() -> None:
    named = {*files_named(MANIFEST), MANIFEST["icon"]} - {"./dist/extension.js"}
    assert len(named) == 4
    assert [name for name in named if not (EXTENSION / name).is_file()] == []


def test_versions_and_licences_are_those_of_srgc() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert MANIFEST["version"] == project["version"]
    assert f"## {project['version']}" in (EXTENSION / "CHANGELOG.md").read_text(encoding="utf-8")
    assert (EXTENSION / "LICENSE").read_bytes() == (ROOT / "LICENSE").read_bytes()


def test_every_setting_is_on_the_page_of_the_extension() -> None:
    page = (EXTENSION / "README.md").read_text(encoding="utf-8")
    settings = MANIFEST["contributes"]["configuration"]["properties"]
    assert set(re.findall(r"^\| `(srgc\.[\w.]+)` \|", page, re.MULTILINE)) == set(settings)


def test_commands_that_run_srgc_need_a_trusted_workspace() -> None:
    limits = MANIFEST["capabilities"]["untrustedWorkspaces"]
    assert limits["supported"] == "limited"
    assert limits["restrictedConfigurations"] == ["srgc.path"]
    commands = {c["command"]: c.get("enablement") for c in MANIFEST["contributes"]["commands"]}
    assert commands.pop("srgc.showOutput") is None
    assert set(commands.values()) == {"isWorkspaceTrusted"}


def test_the_icon_is_a_png_of_128_pixels() -> None:
    head = (EXTENSION / "icon.png").read_bytes()[:24]
    assert head[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", head[16:]) == (128, 128)


def test_the_lock_file_names_no_registry() -> None:
    packages = read_json(EXTENSION / "package-lock.json")["packages"]
    assert len(packages) > 50
    assert [name for name, entry in packages.items() if "resolved" in entry] == []
    assert all(entry.get("integrity") or not name for name, entry in packages.items())


# --- brackets, comments, indentation ------------------------------------------------------------


def test_the_language_configuration() -> None:
    rules = read_json(EXTENSION / "language-configuration.json")
    assert rules["comments"] == {"lineComment": "//", "blockComment": ["/*", "*/"]}
    assert rules["brackets"] == [["{", "}"], ["[", "]"], ["(", ")"]]
    indent = re.compile(rules["indentationRules"]["increaseIndentPattern"])
    outdent = re.compile(rules["indentationRules"]["decreaseIndentPattern"])
    assert all(map(indent.search, ("task T {", "  link {", "module M { role base;")))
    assert not any(map(indent.search, ("module M { role base; }", "// task T {", "  reach T;")))
    assert outdent.search("  } m;")
    assert not outdent.search("  base { }")
    word = re.compile(rules["wordPattern"])
    assert word.findall("left.at2 = N*m_1;") == ["left", "at2", "N", "m_1"]
    block, line = rules["onEnterRules"]
    assert re.search(block["beforeText"], "  /* begun")
    assert not re.search(block["beforeText"], "  /* ended */")
    assert re.search(line["beforeText"], "  // a comment")
    assert not re.search(line["beforeText"], "reach T;  // a remark")


# --- the grammar in VS Code's own tokeniser -----------------------------------------------------


@pytest.mark.editor
def test_the_scopes_are_those_expected_by_hand(vsix: Path) -> None:
    out = run("npm", "run", "--silent", "test:grammar")
    files = sorted((EXTENSION / "tests" / "grammar").glob("*.srg"))
    assert len(files) >= 7
    assert all(path.name in out for path in files)


def test_there_are_expectations_of_every_scope() -> None:
    """A scope of the grammar that no expectation names could be renamed unseen."""
    scopes = set(re.findall(r'"name": "([a-z.-]+)\.srg"', GRAMMAR.read_text(encoding="utf-8")))
    expected = {
        scope.removesuffix(".srg")
        for path in (EXTENSION / "tests" / "grammar").glob("*.srg")
        for line in path.read_text(encoding="utf-8").splitlines()
        if COLUMN.match(line)
        for scope in line.split()
    }
    shapes = {scope for scope in scopes if scope.startswith(("meta.", "punctuation.section"))}
    assert scopes - shapes - expected == {"string.quoted"}  # of `from`, where it is either


@pytest.mark.editor
def test_the_two_tokenisers_agree_on_all_texts(vsix: Path) -> None:
    """So what the other tests show with our own tokeniser holds in VS Code."""
    grammar = Grammar(read_json(GRAMMAR))
    found = json.loads(run("node", "tests/tokens.js", given=json.dumps([*TEXTS.values()])))
    for (name, text), tokens in zip(TEXTS.items(), found, strict=True):
        lines = text.split("\n")
        theirs = {
            (line, at): tuple(scopes)
            for line, start, end, scopes in tokens
            for at in range(start, min(end, len(lines[line])))
        }
        ours = {
            (piece.line, at): piece.scopes
            for piece in grammar.tokenise(text)
            for at in range(piece.start, piece.end)
        }
        shown = [place for place in ours if not lines[place[0]][place[1]].isspace()]
        assert len(shown) > 100, name
        assert [(name, place) for place in shown if ours[place] != theirs.get(place)] == []


@pytest.mark.parametrize("name", [name for name in TEXTS if "unfinished" not in name])
def test_no_text_has_an_invalid_scope(name: str) -> None:
    pieces = Grammar(read_json(GRAMMAR)).tokenise(TEXTS[name])
    assert not [piece for piece in pieces if any("invalid" in s for s in piece.scopes)]


def test_colours_stay_when_the_language_server_starts() -> None:
    """Its tokens take the colours of the grammar where VS Code would give them others.

    Left alone, it paints `keyword` as `keyword.control`, a unit as a type, a task as nothing.
    """
    [mapped] = MANIFEST["contributes"]["semanticTokenScopes"]
    assert mapped["language"] == "srg"
    scopes: dict[str, list[str]] = mapped["scopes"]
    assert {"keyword", "type", "event"} <= set(scopes) <= set(LEGEND.token_types)
    text = TEXTS["specs/planar_arm.srg"]
    analysis = analyse("untitled:arm", text, {})
    data = semantic_tokens(analysis, 0).data
    coloured: dict[str, set[str]] = {}
    line = column = 0
    painted = {
        (piece.line, at): piece.scopes[-1]
        for piece in Grammar(read_json(GRAMMAR)).tokenise(text)
        for at in range(piece.start, piece.end)
    }
    for down, right, _, kind, _ in zip(*[iter(data)] * 5, strict=True):
        line, column = line + down, right if down else column + right
        coloured.setdefault(LEGEND.token_types[kind], set()).add(painted[line, column])
    for kind, chosen in scopes.items():
        assert any(scope.startswith(f"{chosen[0]}.") for scope in coloured[kind]), kind


def test_words_that_a_theme_of_vs_code_colours() -> None:
    """The themes that come with it know nothing of `support.constant` and `operator.logical`."""
    names = set(re.findall(r'"name": "([a-z.-]+)\.srg"', GRAMMAR.read_text(encoding="utf-8")))
    assert {"constant.language.role", "keyword.operator.wordlike"} <= names


# --- the client ---------------------------------------------------------------------------------


@pytest.mark.editor
def test_the_client_in_a_stub_of_the_editor(vsix: Path) -> None:
    """It finds srgc, starts its language server, shows its findings, and runs its commands."""
    srgc = Path(sys.executable).parent / "srgc"
    out = run("npm", "run", "--silent", "test:unit", SRGC=str(srgc))
    assert int(re.findall(r"^# pass (\d+)", out, re.MULTILINE)[-1]) >= 25
    assert re.findall(r"^# (?:fail|cancelled) (\d+)", out, re.MULTILINE) == ["0", "0"]

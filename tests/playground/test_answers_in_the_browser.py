"""The page says what the commands say: findings, canonical form, graphs, explanations."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from grammar_lang.diagnostics.code_pages import has_page, page_text, read_page
from grammar_lang.diagnostics.diagnostic import Code
from srgc.cli import run
from tests.oracles.small_specs import TURNER
from tests.playground.conftest import ROOT, Playground

pytestmark = pytest.mark.playground

SHIPPED = sorted([*ROOT.glob("specs/*.srg"), *ROOT.glob("srgc/starters/*.srg")])
VIEWS = ("grammar", "sra", "fra", "dfa", "words", "robot")
WORD = "B eps JO eps L eps EN"

Said = Callable[..., str]


@pytest.fixture
def said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Said:
    """What a command prints about a text that is in `spec.srg`."""
    monkeypatch.chdir(tmp_path)

    def say(text: str, *arguments: str) -> str:
        Path("spec.srg").write_text(text, encoding="utf-8", newline="\n")
        capsys.readouterr()
        run([*arguments])
        return capsys.readouterr().out

    return say


@pytest.mark.parametrize("spec", SHIPPED, ids=lambda path: path.stem)
def test_findings_and_canonical_form_of_shipped_specs(
    page: Playground, said: Said, spec: Path
) -> None:
    text = spec.read_text(encoding="utf-8")
    found = page.ask(ask="check", text=text)["answer"]
    assert found["findings"] == json.loads(said(text, "check", "--json", "spec.srg"))
    formulas = re.findall(r"^\s*satisfy\b", text, re.MULTILINE)
    assert bool(found["unchecked"]) == bool(formulas)
    loose = text.replace(";", " ;")
    made = page.ask(ask="fmt", text=loose)["answer"]
    said(loose, "fmt", "spec.srg")
    assert made == {"text": Path("spec.srg").read_text(encoding="utf-8"), "changes": True}


def broken() -> dict[str, str]:
    """The smallest file of every code that shows one file, as the catalogue has it."""
    found: dict[str, str] = {}
    for code in filter(has_page, Code):
        example = read_page(page_text(code)).failing
        if example.command is None and len(example.files) == 1:
            found[code.value] = example.files[0][1]
    return found


def test_findings_of_broken_specs(page: Playground, said: Said) -> None:
    """All of them, but for those about formulas, which a browser cannot check and says so."""
    beyond = []
    for code, text in broken().items():
        expected = json.loads(said(text, "check", "--json", "spec.srg"))
        found = page.ask(ask="check", text=text)
        answer = found.get("answer")
        if answer is None:
            beyond.append(code)
            assert "which no browser has" in found["fault"], (code, found)
        elif answer["findings"] != expected:
            beyond.append(code)
            assert answer["unchecked"], (code, answer["findings"], expected)
            assert all(each in expected for each in answer["findings"]), code
    assert len(beyond) < len(broken()) / 10, beyond


@pytest.mark.parametrize("view", VIEWS)
def test_graphs(page: Playground, said: Said, view: str) -> None:
    word = ("--word", WORD) if view == "robot" else ("--highlight", WORD)
    expected = said(TURNER, "graph", "spec.srg", "--of", view, *word)
    found = page.ask(ask="graph", text=TURNER, of=view, grammar="", word=WORD, depth=0)
    assert found["answer"]["dot"] == expected
    assert found["answer"]["svg"].count('class="node"') >= 1


@pytest.mark.parametrize("code", ["", "301", "SRG0001x"])
def test_explanations(page: Playground, said: Said, code: str) -> None:
    found = page.ask(ask="explain", text="", code=code)
    if code == "SRG0001x":
        assert "there is no code 'SRG0001x'" in found["fault"]
    else:
        shown = re.sub(r"\x1b\[\d*m", "", found["answer"]["shown"])
        assert shown == said("", "explain", *filter(None, [code]))

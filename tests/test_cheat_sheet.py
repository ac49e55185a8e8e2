"""The cheat sheet: its files check, and have every rule, word, emission and function there is."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import srgc.cli
from docs._extensions import cheat_sheet
from grammar_lang.elaboration import emissions, typecheck
from grammar_lang.parsing import tree_builder
from grammar_lang.units import UNIT_NAMES
from tests.conftest import ROOT
from tests.oracles.pages import files
from tests.test_language_reference import UNSEEN, language, tokens

PAGE = (ROOT / "docs" / "reference" / "cheat-sheet.md").read_text(encoding="utf-8")
FILES = files(PAGE)
SPECS = "".join(FILES.values())


def test_its_files_check(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, body in FILES.items():
        (tmp_path / name).write_text(body, encoding="utf-8")
    shutil.copy(ROOT / "specs" / "imports" / "machine.stl", tmp_path / "part.stl")
    monkeypatch.chdir(tmp_path)
    assert srgc.cli.run(["check", *FILES]) == 0, capsys.readouterr().out


def test_it_has_every_rule_and_every_word() -> None:
    rules = {str(tree.data) for tree in language().parse(SPECS).iter_subtrees()}
    assert set(tree_builder.BUILDERS) - UNSEEN - rules == set()
    written = re.sub(r"//.*", lambda comment: comment[0].removeprefix("//"), PAGE)
    words = {
        terminal.pattern.value
        for terminal in language().terminals
        if terminal.pattern.value.isalpha()
    }
    assert {word for word in words if not re.search(rf"\b{word}\b", written)} == set()


def test_it_has_every_emission_function_and_unit() -> None:
    whole = language(keep_all_tokens=True)
    assert "UNIT" in set(tokens(whole.parse(SPECS)))
    for name in (*emissions._ARGUMENTS, *typecheck.FUNCTIONS):
        assert re.search(rf"\b{name}\b", PAGE), name
    assert set(UNIT_NAMES) == set(PAGE.partition("Units: `")[2].partition("`")[0].split())


def test_the_printed_page_is_this_one() -> None:
    """One page, that `make pictures` has written anew since the sheet was changed."""
    made = cheat_sheet.sheet(PAGE)
    assert made.pages_count == 1
    assert bytes(made.output()) == cheat_sheet.PRINTED.read_bytes()
    printed = [line.text for line in cheat_sheet.sheet_lines(PAGE) if line.kind == "code"]
    assert printed == "".join(FILES.values()).splitlines()

"""The glossary is sorted, says something of every term, and names what the code has."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from tests.conftest import ROOT

PAGE = (ROOT / "docs" / "reference" / "glossary.md").read_text(encoding="utf-8")
PACKAGES = ("grammar_lang", "compiler", "solvers", "srgc")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith("|")
][2:]
DEFINED = r"(?m)^\s*(?:class|def) {0}\b|^{0}(?::[^=]+)? = |^    {0}: "
"""A class, a function, a value of a module, or a field."""


@cache
def code() -> str:
    files = [file for package in PACKAGES for file in sorted(Path(ROOT / package).rglob("*.py"))]
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def test_every_row_has_a_term_its_definition_and_its_name_in_the_code() -> None:
    assert len(ROWS) > 50
    for row in ROWS:
        term, definition, _, name = row
        assert len(row) == 4, row
        assert term, row
        assert re.search(r"^`\w+`(, `\w+`)*$", name), row
        assert definition[0].islower(), row
        assert not definition.endswith("."), row


def test_terms_are_sorted_and_occur_once() -> None:
    terms = [term.casefold() for term, *_ in ROWS]
    assert terms == sorted(set(terms))


@pytest.mark.parametrize(
    "name", sorted({n for row in ROWS for n in re.findall(r"`(\w+)`", row[3])})
)
def test_what_stands_for_a_term_is_defined_in_the_code(name: str) -> None:
    assert re.search(DEFINED.format(name), code())


def test_words_in_code_font_are_keywords_or_names() -> None:
    grammar = (ROOT / "grammar_lang" / "parsing" / "srg.lark").read_text(encoding="utf-8")
    for _, definition, symbol, _ in ROWS:
        for word in re.findall(r"`([^`]+)`", definition + symbol):
            assert f'"{word}"' in grammar or re.search(DEFINED.format(word), code()), word

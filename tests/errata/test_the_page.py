"""The errata: a section per correction, and every test that a section names is there and runs."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from tests.oracles import pages

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "explanation" / "errata.md").read_text(encoding="utf-8")
ROWS = [f"4.{number}" for number in range(1, 19)]
HEADING = re.compile(r"^## (.+)$", re.MULTILINE)
PARTS = ["The paper.", "The problem.", "srgc", "Shown by"]


def sections() -> dict[str, str]:
    """The text below each heading of the page, by the heading's first word."""
    _, *found = HEADING.split(pages.prose(PAGE))
    return {heading.split()[0]: text for heading, text in zip(found[::2], found[1::2], strict=True)}


SECTIONS = sections()


@cache
def defined(file: str) -> dict[str, bool]:
    """The tests of a file, and whether each is run by the fast suite."""
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert Path(file).name.startswith("test_")
    return {
        node.name: "slow" not in " ".join(map(ast.unparse, node.decorator_list))
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }


def own_file(row: str) -> str:
    return f"tests/errata/test_row_4_{int(row.partition('.')[2]):02d}.py"


def named(text: str) -> list[tuple[str, str]]:
    return re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", text)


def test_there_is_a_section_per_row() -> None:
    assert [key for key in SECTIONS if key.startswith("4.")] == ROWS


@pytest.mark.parametrize("row", ROWS)
def test_a_section_says_what_is_wrong_what_is_done_and_what_shows_it(row: str) -> None:
    assert re.findall(r"^\*\*([\w .]+)\*\*", SECTIONS[row], re.MULTILINE) == PARTS


@pytest.mark.parametrize("row", ROWS)
def test_a_section_names_all_tests_of_its_row(row: str) -> None:
    own = [test for file, test in named(SECTIONS[row]) if file == own_file(row)]
    assert sorted(own) == sorted(defined(own_file(row)))
    assert all(defined(own_file(row)).values())


def test_every_test_that_is_named_exists() -> None:
    for file, test in named(PAGE):
        assert test in defined(file), (file, test)


def test_corrections_named_in_the_code_are_listed() -> None:
    found = {
        row
        for package in ("grammar_lang", "compiler", "solvers", "srgc")
        for file in (ROOT / package).rglob("*.py")
        for row in re.findall(r"(?:correction|row) (4\.\d+)", file.read_text(encoding="utf-8"))
    }
    assert {"4.9", "4.12", "4.18"} <= found <= set(ROWS)

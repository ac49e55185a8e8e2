"""A file with forty mistakes in forty items: each is reported, in whatever order they stand."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from grammar_lang.diagnostics.code_pages import examples
from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity
from grammar_lang.load import load_text
from grammar_lang.parsing.tokens import cut, tokenise
from srgc.session import check_loaded

PAGE = Path(__file__).parent / "golden" / "forty-mistakes.md"
NUMBER = re.compile(r"// (\d+): [^\n]*\n\Z")
WRONG = 40


def items() -> list[tuple[int | None, str]]:
    """The items of the page with their numbers; the sound ones have none."""
    (page,) = examples(PAGE.read_text(encoding="utf-8"))
    ((_, text),) = page.files
    tokens = tokenise(text)
    found: list[tuple[int | None, str]] = []
    end = 0
    for raw in cut(tokens):
        span = tokens.span(raw.first, raw.stop - 1)
        number = NUMBER.search(text[end : span.start])
        found.append((None if number is None else int(number[1]), text[span.start : span.end]))
        end = span.end
    return found


ITEMS = items()
SOUND = [(number, text) for number, text in ITEMS if number is None]
TWIN_OF = 11  # it repeats the name of a sound item, which has to stand before it
CHECKED_PAIRS = 5
"""Each mistake is checked beside so many of those that follow it, in a circle."""


def checked(chosen: list[tuple[int | None, str]]) -> dict[int | None, list[Diagnostic]]:
    """The errors of a file of these items, by the number of the item that each is in."""
    text = "\n\n".join(piece for _, piece in chosen)
    ends, place = [], 0
    for _, piece in chosen:
        ends.append(place + len(piece))
        place += len(piece) + 2
    result: dict[int | None, list[Diagnostic]] = {}
    for found in check_loaded(load_text(text, "t.srg")).diagnostics:
        if found.severity is Severity.ERROR:
            index = next(i for i, end in enumerate(ends) if found.span.start <= end)
            result.setdefault(chosen[index][0], []).append(found)
    return result


def codes(found: dict[int | None, list[Diagnostic]]) -> dict[int | None, list[str]]:
    return {number: [d.code.value for d in errors] for number, errors in found.items()}


EXPECTED = codes(checked(ITEMS))


def test_each_of_the_forty_is_reported_and_nothing_else() -> None:
    assert sorted(n for n, _ in ITEMS if n is not None) == list(range(1, WRONG + 1))
    assert len(SOUND) >= 10
    assert set(EXPECTED) == set(range(1, WRONG + 1))
    assert all(len(found) == 1 for found in EXPECTED.values())


def test_they_are_of_all_kinds() -> None:
    """Files and syntax, names, sorts and units, grammars, semantics, geometry, tasks."""
    assert {found[0][3:5] for found in EXPECTED.values()} == {f"0{k}" for k in range(1, 8)}


def test_the_sound_items_are_sound() -> None:
    """But for grammars whose semantics is among the mistakes; no task asks for them."""
    assert checked(SOUND) == {}


@pytest.mark.parametrize("seed", range(12))
def test_the_order_of_the_items_does_not_matter(seed: int) -> None:
    shuffled = random.Random(seed).sample(ITEMS, len(ITEMS))
    twin = next(item for item in ITEMS if item[0] == TWIN_OF)
    shuffled.remove(twin)
    assert codes(checked([*shuffled, twin])) == EXPECTED


def test_pairs_of_mistakes() -> None:
    for first in range(WRONG):
        for step in range(1, CHECKED_PAIRS + 1):
            pair = (first + 1, (first + step) % WRONG + 1)
            chosen = [(number, text) for number, text in ITEMS if number is None or number in pair]
            assert codes(checked(chosen)) == {number: EXPECTED[number] for number in pair}, pair


@pytest.mark.parametrize("seed", range(12))
def test_any_twenty_of_them(seed: int) -> None:
    drawn = set(random.Random(seed).sample(range(1, WRONG + 1), 20))
    chosen = [(number, text) for number, text in ITEMS if number is None or number in drawn]
    assert codes(checked(chosen)) == {number: EXPECTED[number] for number in drawn}

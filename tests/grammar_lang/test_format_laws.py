"""The laws of the formatter, on the specs, on every program of the pages, and on random ones.

What the text means is compared by the parser; tokens and comments by a scanner of this file.
"""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lark.grammar import Rule

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.parsing.parse import parse
from grammar_lang.parsing.tables import tables
from tests.oracles.programs import (
    NAMES,
    grammar,
    programs,
    random_program,
    random_tokens,
    scattered,
)

ROOT = Path(__file__).parents[2]
FENCE = re.compile(r"^```srg[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
SCAN = re.compile(r"('[^'\n]*'|\"[^\"\n]*\")|(//[^\n]*|/\*.*?\*/)|\s+", re.DOTALL)

SPECS = {str(p.relative_to(ROOT)): p.read_text("utf-8") for p in ROOT.glob("specs/**/*.srg")}
PAGES = [
    *ROOT.glob("*.md"),
    *ROOT.glob("docs/**/*.md"),
    *ROOT.glob("tests/golden/*.md"),
    *ROOT.glob("grammar_lang/diagnostics/catalogue/*.md"),
]


def programs_of_pages() -> dict[str, str]:
    """Every program of a page that parses, each once."""
    found: dict[str, str] = {}
    for page in sorted(PAGES):
        for number, text in enumerate(FENCE.findall(page.read_text("utf-8"))):
            if text not in found.values() and parses(text):
                found[f"{page.relative_to(ROOT)} {number}"] = text
    return found


def parses(text: str) -> bool:
    sink = Sink()
    parse(text, sink)
    return not sink.found


def formatted(text: str) -> str:
    sink = Sink()
    made = canonical(text, sink)
    assert made is not None, sink.found
    return made


def comments(text: str) -> list[list[str]]:
    """The comments of a text, each as its lines without the blanks at their ends."""
    found = [m[2] for m in SCAN.finditer(text) if m[2]]
    return [[line.rstrip(" \t\r\f\v") for line in comment.split("\n")] for comment in found]


def ink(text: str) -> str:
    """A text without comments and blanks, quoted strings whole."""
    return SCAN.sub(lambda m: m[1] or "", text)


def lawful(text: str) -> str:
    made = formatted(text)
    assert formatted(made) == made
    sink = Sink()
    assert parse(made, sink) == parse(text, sink)
    assert not sink.found
    assert comments(made) == comments(text)
    assert ink(made) == ink(text)
    assert made.endswith("\n") or not made
    assert not made.startswith("\n")
    assert not made.endswith("\n\n")
    assert "\n\n\n" not in made
    assert not re.search(r"[ \t\r\f\v]$", made, re.MULTILINE)
    return made


SHOWN = programs_of_pages()


def test_there_are_programs_on_the_pages() -> None:
    assert len(SPECS) >= 2
    assert len(SHOWN) > 50
    assert sum(name.startswith("docs/reference/language.md") for name in SHOWN) >= 5


@pytest.mark.parametrize("name", SPECS)
def test_the_specs_are_canonical(name: str) -> None:
    assert lawful(SPECS[name]) == SPECS[name]


@pytest.mark.parametrize("name", SHOWN)
def test_programs_of_the_pages(name: str) -> None:
    made = lawful(SHOWN[name])
    for line in made.split("\n"):
        code = re.sub(r" *(//.*|/\*.*)$", "", line)
        assert len(code) <= 100 or "/*" in made
        assert (len(code) - len(code.lstrip(" "))) % 2 == 0 or "/*" in made


@pytest.mark.parametrize("page", sorted(ROOT.glob("docs/**/*.md")), ids=lambda page: page.name)
def test_every_program_of_the_documentation_parses(page: Path) -> None:
    """But for those of the catalogue, which are to fail."""
    if page.name != "codes.md":
        assert all(parses(text) for text in FENCE.findall(page.read_text("utf-8")))


# --- random programs ----------------------------------------------------------------------------


def test_every_alternative_of_every_rule_is_drawn() -> None:
    drawn: set[Rule] = set()
    missing = set(grammar().rules)
    for seed in range(1000):
        used: set[Rule] = set()
        random_tokens(random.Random(seed), 4, used)
        drawn |= used
        if drawn >= missing:
            return
    pytest.fail(f"never drawn: {missing - drawn}")


def test_the_same_seed_gives_the_same_program() -> None:
    program = random_program(random.Random(7), 5)
    assert program == random_program(random.Random(7), 5)
    assert program != random_program(random.Random(8), 5)


@settings(deadline=None)
@given(programs())
def test_random_programs(program: str) -> None:
    assert parses(program)
    lawful(program)


def spread(seed: int, density: float) -> tuple[str, str]:
    """A program with one blank between its tokens, and the same one with random gaps."""
    choose = random.Random(seed)
    texts = random_tokens(choose, choose.randint(1, 4))
    return " ".join(texts), scattered(choose, texts, density)


@pytest.mark.parametrize("seed", [30576, 131753799])
def test_at_after_horizon_is_no_name_of_a_random_program(seed: int) -> None:
    """The first seed drew it as one; the second draws `at most`."""
    lawful(spread(seed, 0.02)[1])


@settings(deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.05, 0.2, 0.6]))
def test_random_gaps_with_comments(seed: int, density: float) -> None:
    lawful(spread(seed, density)[1])


@settings(deadline=None)
@given(st.integers(0, 2**32))
def test_without_comments_only_blank_lines_are_the_authors(seed: int) -> None:
    """However a text was broken and indented, all else comes out the same."""
    plain, ragged = spread(seed, 0)
    lines = [line for line in formatted(ragged).split("\n") if line]
    assert lines == [line for line in formatted(plain).split("\n") if line]


@pytest.mark.slow
def test_keywords_in_the_place_of_names() -> None:
    """Where they may stand there, they are names; the blanks around them then differ."""
    words = sorted(tables().words)
    read = 0
    for seed in range(300):
        choose = random.Random(seed)
        texts = random_tokens(choose, 2)
        rare = (choose.random() < 0.15 for _ in texts)
        named = (t in NAMES and r for t, r in zip(texts, rare, strict=True))
        text = " ".join(choose.choice(words) if n else t for t, n in zip(texts, named, strict=True))
        if parses(text):
            lawful(text)
            read += 1
    assert read > 50


@pytest.mark.slow
@settings(max_examples=5000, deadline=None)
@given(st.integers(0, 2**32), st.sampled_from([0.02, 0.05, 0.1, 0.2, 0.4, 0.8]))
def test_many_random_gaps(seed: int, density: float) -> None:
    lawful(spread(seed, density)[1])

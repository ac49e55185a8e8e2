"""What is written of syntax nodes is read as the same nodes: specs, pages, random programs."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.formatting.syntax_text import syntax_text
from grammar_lang.parsing.parse import parse
from tests.oracles.programs import programs

ROOT = Path(__file__).parents[2]
FILES = sorted(
    path.relative_to(ROOT).as_posix()
    for pattern in ("specs/**/*.srg", "grammar_lang/library/*.srg")
    for path in ROOT.glob(pattern)
)


def nodes(text: str) -> tuple[object, ...]:
    sink = Sink()
    file = parse(text, sink)
    assert not sink.found
    return file.items


@pytest.mark.parametrize("path", FILES)
def test_files_are_written_as_they_are_read(path):
    given = nodes((ROOT / path).read_text(encoding="utf-8"))
    text = syntax_text(given)
    assert nodes(text) == given
    assert canonical(text, Sink()) == text


@given(programs())
@settings(max_examples=40, deadline=None)
def test_random_programs_are_written_as_they_are_read(program):
    given = nodes(program)
    try:
        text = syntax_text(given)
    except ValueError as error:
        assert "too large" in str(error)  # noqa: PT017 - the only one that may be
    else:
        assert nodes(text) == given


EXPRESSIONS = [
    "a - (b - c)", "(a - b) - c", "a / (b * c)", "-(a + b) * c", "(-a)^2", "-a^2", "a^-b",
    "(a^b)^c", "a^b^c", "(2 m)^2", "2 m^2", "(a + 1) m", "f(a) m", "(a, -b, 3) cm", "--a",
    "world * move(x, 2 mm) * rot(z, -(q))", "0.1 + 1e-9", "1e40", "a * (b + c) m",
]  # fmt: skip


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_parentheses_stand_where_they_are_needed(text):
    given = nodes(f"module M {{ const k = {text}; }}")
    assert nodes(syntax_text(given)) == given


@pytest.mark.parametrize(
    ("given", "written"),
    [
        ("((a) + (b)) * (c)", "(a + b) * c"),
        ("a + (b * c)", "a + b * c"),
        ("(0.50 m)", "0.5 m"),
        ("1e-3 m", "0.001 m"),
    ],
)
def test_no_others_do(given, written):
    [module] = nodes(f"module M {{ const k = {given}; }}")
    assert syntax_text([module]) == f"module M {{ const k = {written}; }}\n"


def test_a_number_that_is_too_large_is_not_written():
    given = s.Module(s.Ident("M"), (s.Const(s.Ident("k"), s.Number(None, None)),))
    with pytest.raises(ValueError, match="too large"):
        syntax_text([given])

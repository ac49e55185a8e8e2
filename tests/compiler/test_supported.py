from __future__ import annotations

import pytest

from compiler.checks.supported import unsupported
from grammar_lang.diagnostics.diagnostic import Code, Severity
from tests.oracles.formulas import SHAPES, program, spec

CLAUSES = "start at (0); reach A; avoid C with body;"


def marked(clauses: str) -> list[tuple[str, str]]:
    """What is said not to be compiled, and the text of each place."""
    text = spec(CLAUSES + clauses, SHAPES["disjoint"])
    found = program(text)
    errors = unsupported(found.tasks["P"])
    for error in errors:
        assert error.code is Code.NOT_SUPPORTED
        assert error.severity is Severity.ERROR
        assert error.hint
        assert not error.notes
    return [
        (error.message.split(" cannot")[0], text[error.span.start : error.span.end])
        for error in errors
    ]


@pytest.mark.parametrize(
    ("clauses", "found"),
    [
        ("bounds with body; gravity (0, -9.81); modules <= 3;", []),
        ("avoid self with body;", [("`avoid self`", "avoid self with body;")]),
        ("avoid self, C with body;", [("`avoid self`", "avoid self, C with body;")]),
        ("from B;", []),
        ("satisfy always not C; satisfy eventually A;", []),
        ("robust start 1 mm; robust effort 5 %; control open loop;", []),
        ("robust effort 2 % of bound; robust mass 3 %; robust measure 1 mm; control feedback;", []),
    ],
)
def test_clauses(clauses: str, found: list[tuple[str, str]]) -> None:
    assert marked(clauses) == found

from __future__ import annotations

import pytest

from compiler.checks.task_checks import task_diagnostics
from grammar_lang.diagnostics.diagnostic import Code, Sink
from tests.oracles.formulas import ONE_ARM, SHAPES, TWO_ARMS, program, spec

START = "start at (0);"


def findings(clauses: str, arms: str = ONE_ARM) -> list[tuple[Code, str, str]]:
    """Code, marked text and hint of each finding."""
    text = spec(clauses, SHAPES["disjoint"], arms=arms)
    sink = Sink()
    task_diagnostics(program(text), sink)
    return [(d.code, text[d.span.start : d.span.end], d.hint or "") for d in sink.found]


def test_a_plain_region_where_there_are_several_effectors() -> None:
    clauses = f"{START} satisfy always (A implies eventually C by effector 2);"
    assert findings(clauses) == []
    assert findings(clauses, TWO_ARMS) == [(Code.BAD_VALUE, "A", "write `A by effector 1`")]
    numbered = f"{START} satisfy always (A by effector 1 implies C by effector 2);"
    assert findings(numbered, TWO_ARMS) == []
    assert findings(f"{START} reach A; avoid C with effector;", TWO_ARMS) == []


def test_a_robot_with_several_effectors_that_is_not_accepted() -> None:
    text = spec(f"{START} satisfy A;", SHAPES["disjoint"]).replace(
        f"accept matches B {ONE_ARM};", "accept count(E) <= 1;"
    )
    sink = Sink()
    task_diagnostics(program(text), sink)
    assert sink.found == []
    task_diagnostics(program(text.replace("count(E) <= 1", "count(E) <= 2")), sink)
    assert [d.code for d in sink.found] == [Code.BAD_VALUE]


@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("B", None),
        ("B eps J eps L eps E", None),
        ("B eps E eps E", None),  # derived, and not accepted: a robot may be mended
        ("B eps", "this is only the beginning of a word: continue with more modules"),
        ("J", "no word of the grammar begins with `J`"),
        ("B eps J L", "no word of the grammar begins with `B eps J L`"),
        ("B eps J eps eps", "no word of the grammar begins with `B eps J eps eps`"),
    ],
)
def test_the_existing_robot_is_one_of_the_family(word: str, hint: str | None) -> None:
    found = findings(f"{START} reach A; from {word};")
    expected = [] if hint is None else [(Code.BAD_VALUE, f"from {word};", hint)]
    assert found == expected

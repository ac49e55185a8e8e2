"""``repeat``: a task whose motion goes on for ever, and what such a task cannot ask."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]

TASK = """
task P {{
  robot G; workspace W; start in S; effort <= 10 N*m; horizon 80 steps of 0.125 s;
  {}
}}
"""


def errors(check: Check, text: str) -> list[tuple[str, str]]:
    """What is found of the task; the rest of the text has a constant that nothing uses."""
    return [found for found in check(text) if found[0] != "UNUSED_NAME"]


def test_repeat_is_a_mark_of_the_task(build: Build) -> None:
    for text, repeats in (("reach T;", False), ("reach T; repeat;", True)):
        loaded = load_text(build(task=TASK.format(text)), "t")
        assert loaded.program is not None, loaded.diagnostics
        task = loaded.program.tasks["P"]
        assert task.repeat is repeats
        assert ("repeat" in task.clauses) is repeats


@pytest.mark.parametrize(
    "text",
    [
        "reach T; repeat;",
        "satisfy always (eventually T and eventually S); repeat;",
        "satisfy eventually always[0 s, 900 s] T; repeat;",
        "satisfy S until next T; repeat;",
        "reach T at rest; satisfy last[1 s] T;",
    ],
)
def test_what_may_be_asked(build: Build, check: Check, text: str) -> None:
    assert errors(check, build(task=TASK.format(text))) == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("reach T at rest; repeat;", [("REST_WITHOUT_END", "reach T at rest;")]),
        ("repeat; satisfy last[1 s] T;", [("LAST_WITHOUT_END", "last[1 s] T")]),
        (
            "repeat; satisfy not (S until (T or next last[1 s] S)) implies eventually last[0 s] T;",
            [("LAST_WITHOUT_END", "last[1 s] S"), ("LAST_WITHOUT_END", "last[0 s] T")],
        ),
        (
            "repeat; satisfy last[1 s] last[2 s] T;",
            [("LAST_WITHOUT_END", "last[1 s] last[2 s] T"), ("LAST_WITHOUT_END", "last[2 s] T")],
        ),
        ("reach T; repeat; repeat;", [("REPEATED_CLAUSE", "repeat;")]),
    ],
)
def test_what_has_no_end(
    build: Build, check: Check, text: str, found: list[tuple[str, str]]
) -> None:
    assert errors(check, build(task=TASK.format(text))) == found

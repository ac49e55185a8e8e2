"""Every snippet, as it is put in and with every choice, is in the language."""

from __future__ import annotations

import json
import re

import pytest

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.load import load_text
from grammar_lang.parsing.parse import parse
from srgc.session import check_loaded
from tests.editors.conftest import EXTENSION

SNIPPETS = json.loads((EXTENSION / "snippets" / "srg.json").read_text(encoding="utf-8"))
AROUND = {
    "Production": "grammar G { start N; %s }",
    "Accept": "grammar G { start N; %s }",
    "Rod": "semantics G { p { %s } }",
    "Box": "workspace W { %s }",
    "Tilted box": "workspace W { %s }",
    "Hull": "workspace W { %s }",
    "Avoid with margin": "task T { %s }",
    "Formula": "task T { %s }",
    "Gravity": "task T { %s }",
    "Disturbances": "task T { %s }",
    "Feedback": "task T { %s }",
    "For ever": "task T { %s }",
}
"""Where a snippet goes that is not an item of a file."""
FILE = ("Base module", "Joint module", "Link module", "Effector module", "Edge", "Grammar",
        "Semantics", "Workspace in the plane", "Task")  # fmt: skip
STOP = re.compile(
    r"\$\{(?P<choice>\d+)\|(?P<choices>(?:\\.|[^|])*)\|\}|\$\{(?P<filled>\d+):(?P<text>[^{}]*)\}|\$(?P<again>\d+)"
)


def expansions(name: str) -> list[str]:
    """The text of a snippet, once for every entry of its longest choice."""
    body = "\n".join(SNIPPETS[name]["body"])
    lists = [
        re.split(r"(?<!\\),", stop["choices"]) for stop in STOP.finditer(body) if stop["choice"]
    ]
    return [expanded(body, number) for number in range(max(map(len, lists), default=1))]


def expanded(body: str, number: int) -> str:
    """With this entry of every choice, or its last."""
    filled: dict[str, str] = {}

    def fill(stop: re.Match[str]) -> str:
        if stop["again"]:
            return filled[stop["again"]]
        if stop["choice"]:
            choices = re.split(r"(?<!\\),", stop["choices"])
            text = choices[min(number, len(choices) - 1)].replace("\\,", ",")
            return filled.setdefault(stop["choice"], text)
        assert stop["filled"] not in filled, "a tab stop that is filled twice"
        return filled.setdefault(stop["filled"], stop["text"])

    text = STOP.sub(fill, body)
    assert "$" not in text
    stops = sorted(map(int, filled))
    assert stops == list(range(1, len(stops) + 1)), "tab stops are counted from 1"
    return text


def findings(text: str) -> list[str]:
    """The messages of all findings about a text."""
    return [
        f"{d.code} {d.message}" for d in check_loaded(load_text(text, "snippet.srg")).diagnostics
    ]


def is_in_the_language(text: str) -> bool:
    sink = Sink()
    parse(text, sink)
    return not sink.has_errors


@pytest.mark.parametrize("name", SNIPPETS)
def test_every_expansion_is_in_the_language(name: str) -> None:
    for text in expansions(name):
        placed = AROUND.get(name, "%s") % text
        assert is_in_the_language(placed), placed


def test_a_broken_text_is_not() -> None:
    """So that the test above can fail."""
    assert not is_in_the_language("module A { role }")


def test_the_snippets_go_together() -> None:
    """Module by module, grammar, semantics, workspace and task: a whole file without findings."""
    assert findings("\n\n".join(expansions(name)[0] for name in FILE)) == []


def test_the_whole_file() -> None:
    assert [findings(text) for text in expansions("Whole arm")] == [[]]


def test_no_prefix_stands_for_two_snippets() -> None:
    prefixes: list[str] = []
    for snippet in SNIPPETS.values():
        given = snippet["prefix"]
        prefixes += [given] if isinstance(given, str) else given
    assert len(prefixes) == len(set(prefixes))
    kinds = ("module joint", "link", "grammar", "semantics", "workspace", "task")
    assert set(kinds) <= set(prefixes)

"""What an editor says of missions."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from lsprotocol import types as lsp

from grammar_lang.load import load_text
from srgc.language_server.completions.completion import ITEMS, STATEMENTS, completions
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.places import definition, references
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.edits.rename import RenameRefused, rename
from srgc.language_server.hovers.hover import hover
from srgc.language_server.outlines.outline import folding, outline, workspace_symbols
from srgc.language_server.outlines.semantic_tokens import TYPES, semantic_tokens
from tests.language_server.test_half_typed import ask_everything, broken

PATH = Path("/nowhere/spec.srg")
TEXT = """\
module B { role base; const price = 40; }
module J { role joint; const price = 120; dof q: revolute z in [-2, 2]; }
module L { role link; param length in [1, 2] m; param width in [1, 2] cm; const price = 1; }
module E { role effector; const price = 7; }
module Other { role link; param size in [1, 2] m; }
grammar Arm {
  start N;
  base: N -> B;
  arm: N -> N J L;
  tool: N -> N E;
}
semantics Arm {
  base { this.frame = world; }
  arm { this.frame = N.frame * rot(z, J.q) * move(x, L.length + L.width); }
  tool { effector(frame: N.frame); this.frame = N.frame; }
}
workspace W { plane xy; bounds box [0, 5] x [0, 5] m; region S box [1, 2] x [1, 2] m; }
task Morning { robot Arm; workspace W; start in S; reach S; effort <= 1 N*m;
  horizon 4 steps of 1 s; }
task Noon { robot Arm; workspace W; start in S; reach S; effort <= 1 N*m; horizon 4 steps of 1 s; }
mission Day {
  tasks Morning, Noon;
  one robot;
  minimize sum(price);
}
mission Night {
  tasks Noon, Morning;
  reconfigure add 2, remove 1, change 0.5;
  free L.length;
  changes <= 4.5;
  minimize changes within 5 % then effort;
}
"""


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    found = analyse(str(PATH), TEXT, {})
    assert found.program is not None
    return found


def places(word: str) -> list[int]:
    """Where a word stands in the text."""
    found, at = list[int](), TEXT.find(word)
    while at >= 0:
        found.append(at)
        at = TEXT.find(word, at + 1)
    return found


# --- names -------------------------------------------------------------------------------------


def test_a_task_is_found_from_missions(analysis: Analysis) -> None:
    declared, day, night = places("Morning")
    (found,) = definition(analysis, 0, night + 1, uri_of)
    assert analysis.lines(0).offset(found.range.start) == declared
    known = references([analysis], str(PATH), declared, uri_of, declarations=True)
    assert [analysis.lines(0).offset(each.range.start) for each in known] == [declared, day, night]


def renamed(analysis: Analysis, place: int, name: str) -> str:
    """The text after a change of the name at a place."""
    edit = rename([analysis], str(PATH), place, name, {}, uri_of)
    assert edit is not None
    assert edit.changes is not None
    ((_, edits),) = edit.changes.items()
    text, lines = TEXT, analysis.lines(0)
    for each in sorted(edits, key=lambda edit: lines.offset(edit.range.start), reverse=True):
        start, end = (lines.offset(at) for at in (each.range.start, each.range.end))
        text = f"{text[:start]}{each.new_text}{text[end:]}"
    return text


@pytest.mark.parametrize(
    ("old", "new", "count"),
    [("Morning", "Dawn", 3), ("Night", "Rebuilt", 1), ("length", "extent", 3), ("L.", "Tube.", 3)],
)
def test_names_of_missions_are_changed_with_the_rest(
    analysis: Analysis, old: str, new: str, count: int
) -> None:
    text = renamed(analysis, places(old)[-1], new.strip("."))
    assert text.count(new) == count
    before, after = (load_text(each, "spec.srg").program for each in (TEXT, text))
    assert before is not None
    assert after is not None
    assert len(after.missions) == 2
    old_name, new_name = old.strip("."), new.strip(".")
    wanted = [
        tuple(new_name if name == old_name else name for name in each.tasks)
        for each in before.missions.values()
    ]
    assert [each.tasks for each in after.missions.values()] == wanted


def test_the_sum_of_a_mission_is_renamed_in_all_modules(analysis: Analysis) -> None:
    text = renamed(analysis, TEXT.index("sum(price)") + 4, "value")
    assert text.count("value") == 5
    assert "price" not in text


def test_a_name_that_is_taken(analysis: Analysis) -> None:
    with pytest.raises(RenameRefused) as refused:
        rename([analysis], str(PATH), places("Day")[0], "Night", {}, uri_of)
    assert "`Night` is already the name of mission `Night`" in str(refused.value)


# --- hover -------------------------------------------------------------------------------------


def told(analysis: Analysis, place: int) -> str:
    found = hover(analysis, 0, place)
    assert found is not None
    assert isinstance(found.contents, lsp.MarkupContent)
    return found.contents.value


def test_hover_of_missions(analysis: Analysis) -> None:
    assert told(analysis, places("Day")[0]) == (
        "A mission for robots of `Arm`: one robot does these tasks.\n\n"
        "1. `Morning` in `W`\n2. `Noon` in `W`\n\n- minimizes `sum(price)`"
    )
    assert told(analysis, places("Night")[0]) == (
        "A mission for robots of `Arm`: robots that are rebuilt do these tasks.\n\n"
        "1. `Noon` in `W`\n2. `Morning` in `W`\n\n"
        "- a module that is added costs 2, one that is removed 1\n"
        "- free to change, each time for 0.5: `L.length`\n"
        "- all changes together cost at most 4.5\n"
        "- minimizes `changes` within 5 % then `effort`"
    )


def test_hover_of_a_mission_with_errors() -> None:
    text = TEXT.replace("changes <= 4.5", "changes <= -4.5")
    shown = told(analyse(str(PATH), text, {}), text.index("Night"))
    assert shown == "Mission `Night`."


def test_hover_of_names_in_a_mission(analysis: Analysis) -> None:
    assert "A task for robots of `Arm` in `W`." in told(analysis, places("Noon")[-1])
    place = TEXT.index("L.length;")
    assert "A module, used" in told(analysis, place)
    assert "param length in [1, 2] m" in told(analysis, place + 2)


@pytest.mark.parametrize(
    "word", ["tasks", "one", "robot;", "reconfigure", "add", "remove", "change", "free", "changes"]
)
def test_hover_of_the_words(analysis: Analysis, word: str) -> None:
    place = TEXT.index(word, TEXT.index("mission"))
    assert f"`{word.strip(';')}" in told(analysis, place) or "one robot" in told(analysis, place)
    minimize = TEXT.index("minimize changes")
    assert "minimize changes" in told(analysis, minimize + len("minimize "))


# --- completion --------------------------------------------------------------------------------


def offered(clause: str, mission: str = "Night", text: str = TEXT) -> list[str]:
    """What may follow an unfinished clause at the end of a mission."""
    head, found, tail = text.partition(f"mission {mission} {{\n")
    body, _, rest = tail.partition("}\n")
    begun = f"{head}{found}{body}  {clause}"
    known = analyse(str(PATH), text, {})
    return [each.label for each in completions(known, f"{begun}\n}}\n{rest}", len(begun))]


def test_tasks_are_offered() -> None:
    assert offered("tasks ") == ["Morning", "Noon"]
    assert offered("tasks Noon, ") == ["Morning"]


def test_free_parameters_are_offered() -> None:
    assert offered("free ") == ["L"]
    assert offered("free L.") == ["length", "width"]
    assert offered("free L.length, ") == ["L"]
    unknown = TEXT.replace("robot Arm", "robot Nothing")
    assert offered("free ", text=unknown) == ["L", "Other"]


def test_objectives_are_offered() -> None:
    common = ["modules", "mass", "time", "energy", "effort", "sum"]
    assert offered("minimize ") == ["changes", *common]
    assert offered("minimize changes then ") == ["changes", *common]
    assert offered("minimize ", "Day") == common
    assert set(offered("minimize sum(")) == {"price", "length", "width"}


def test_prices_and_clauses_are_offered() -> None:
    assert offered("reconfigure ") == ["add", "change", "remove"]
    assert {"remove", "add"} <= set(offered("reconfigure add 2, "))
    assert offered("one ") == ["robot"]
    clauses = ["tasks", "one robot", "reconfigure", "free", "changes", "minimize"]
    assert offered("") == clauses


def test_what_is_offered_as_a_whole_can_be_read() -> None:
    assert "mission" in ITEMS
    for body in STATEMENTS["mission"].values():
        plain = body
        for mark in ("${", "}", "|", "1:", "2:", "3:"):
            plain = plain.replace(mark, "" if mark != "|" else " ")
        words = plain.replace("1 changes,effort,modules,mass ", "changes")
        text = TEXT[: TEXT.index("mission Night")] + f"mission Extra {{ {words} }}"
        codes = [each.code.value for each in load_text(text, "spec.srg").diagnostics]
        assert not any(code.startswith("SRG01") for code in codes), words


# --- outline, folding, colours -----------------------------------------------------------------


def test_outline_and_symbols(analysis: Analysis) -> None:
    found = [each for each in outline(analysis, 0) if each.detail == "mission"]
    assert [each.name for each in found] == ["Day", "Night"]
    assert found[1].range.end.line == len(TEXT.splitlines()) - 1
    symbols = workspace_symbols([analysis], "Nigh", uri_of)
    assert [each.name for each in symbols] == ["Night"]


def test_missions_fold(analysis: Analysis) -> None:
    lines = TEXT.splitlines()
    starts = [lines[each.start_line] for each in folding(TEXT, analysis.lines(0))]
    assert {"mission Day {", "mission Night {"} <= set(starts)


def test_colours(analysis: Analysis) -> None:
    data = semantic_tokens(analysis, 0).data
    lines, line, column, seen = TEXT.splitlines(), 0, 0, list[tuple[str, str]]()
    for index in range(0, len(data), 5):
        down, right, size, kind, _ = data[index : index + 5]
        line, column = line + down, right if down else column + right
        seen.append((lines[line][column : column + size], TYPES[kind]))
    night = seen[seen.index(("Night", "event")) - 1 :]
    assert night == [
        ("mission", "keyword"), ("Night", "event"),
        ("tasks", "keyword"), ("Noon", "event"), ("Morning", "event"),
        ("reconfigure", "keyword"), ("add", "keyword"), ("2", "number"), ("remove", "keyword"),
        ("1", "number"), ("change", "keyword"), ("0.5", "number"),
        ("free", "keyword"), ("L", "class"), ("length", "property"),
        ("changes", "keyword"), ("4.5", "number"),
        ("minimize", "keyword"), ("within", "keyword"), ("5", "number"),
        ("then", "keyword"),
    ]  # fmt: skip


# --- half of a mission -------------------------------------------------------------------------


def test_broken_missions() -> None:
    """Whatever is cut out or put in, every request is answered."""
    chance = random.Random(29)
    start = TEXT.index("mission Day")
    for _ in range(40):
        text = TEXT[:start] + broken(TEXT[start:], chance)
        ask_everything(PATH, text, [chance.randrange(start, len(text) + 1) for _ in range(4)],
                       names=True)  # fmt: skip

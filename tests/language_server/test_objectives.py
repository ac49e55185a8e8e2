"""What an editor says of the attributes that a task sums up, which several modules have."""

from __future__ import annotations

from pathlib import Path

import pytest
from lsprotocol import types as lsp

from grammar_lang.load import load_text
from srgc.language_server.completions.completion import completions
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.documents.line_map import UTF16, LineMap
from srgc.language_server.documents.places import definition, highlights, references
from srgc.language_server.documents.uris import uri_of
from srgc.language_server.edits.quick_fixes import quick_fixes
from srgc.language_server.edits.rename import RenameRefused, rename
from srgc.language_server.hovers.hover import hover

PATH = Path("/nowhere/spec.srg")
TEXT = """\
module B { role base; const price = 40; const cost = 3; }
module J { role joint; const price = 120; dof q: revolute z in [-2, 2]; }
module L { role link; param price in [1, 2]; param length in [1, 2] m; const mine = price * 2; }
module E { role effector; const state = 7; }
module Other { role link; const price = 9; const others = 1; }
grammar Arm {
  start N;
  base: N -> B;
  arm: N -> N J L;
  tool: N -> N E;
}
semantics Arm {
  base { this.frame = world; }
  arm { this.frame = N.frame * rot(z, J.q) * move(x, L.length); }
  tool { effector(frame: N.frame); this.frame = N.frame; }
}
workspace W { plane xy; bounds box [0, 5] x [0, 5] m; region S box [1, 2] x [1, 2] m; }
task T {
  robot Arm;
  workspace W;
  start in S;
  reach S;
  effort <= 1 N*m;
  horizon 4 steps of 1 s;
  minimize sum(price) within 5 % then modules;
}
task U { robot Arm; workspace W; start in S; reach S; effort <= 1 N*m; horizon 4 steps of 1 s;
  minimize modules then sum(price); }
"""
PRICES = [TEXT.index(f"price {sign}") for sign in ("= 40", "= 120", "in [1")]
SUMS = [TEXT.index("sum(price)") + 4, TEXT.rindex("sum(price)") + 4]
READ = TEXT.index("price * 2")


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    return analyse(str(PATH), TEXT, {})


def starts(analysis: Analysis, ranges: list[lsp.Range]) -> list[int]:
    return [analysis.lines(0).offset(each.start) for each in ranges]


# --- names -------------------------------------------------------------------------------------


def test_a_sum_is_declared_in_each_module(analysis: Analysis) -> None:
    for place in SUMS:
        found = [each.range for each in definition(analysis, 0, place + 1, uri_of)]
        assert sorted(starts(analysis, found)) == PRICES


def test_references_of_a_sum_and_of_one_attribute(analysis: Analysis) -> None:
    def found(place: int) -> list[int]:
        known = references([analysis], str(PATH), place, uri_of, declarations=True)
        return starts(analysis, [each.range for each in known])

    assert found(SUMS[0]) == [*PRICES, READ, *SUMS]
    assert found(PRICES[0]) == [PRICES[0], *SUMS]
    assert found(TEXT.index("price = 9")) == [TEXT.index("price = 9")]
    marked = [each.range for each in highlights(analysis, 0, SUMS[0])]
    assert sorted(starts(analysis, marked)) == [*PRICES, READ, *SUMS]


@pytest.mark.parametrize("place", [PRICES[0], PRICES[2], READ, SUMS[1]])
def test_what_is_summed_up_is_renamed_together(analysis: Analysis, place: int) -> None:
    edit = rename([analysis], str(PATH), place, "value", {}, uri_of)
    assert edit is not None
    assert edit.changes is not None
    ((_, edits),) = edit.changes.items()
    assert starts(analysis, [each.range for each in edits]) == [*PRICES, READ, *SUMS]
    text = TEXT
    for start in reversed([*PRICES, READ, *SUMS]):
        text = f"{text[:start]}value{text[start + len('price') :]}"
    before, after = (load_text(each, "spec.srg").program for each in (TEXT, text))
    assert before is not None
    assert after is not None
    assert after.tasks["T"].minimize[0].amounts == before.tasks["T"].minimize[0].amounts


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("cost", "`cost` is already the name of `cost` of module `B`"),
        ("length", "`length` is already the name of `length` of module `L`"),
        # Module E would be summed up, too.
        ("state", "other names would mean something else"),
    ],
)
def test_names_that_are_taken(analysis: Analysis, name: str, said: str) -> None:
    for place in (SUMS[0], PRICES[1]):
        with pytest.raises(RenameRefused) as refused:
            rename([analysis], str(PATH), place, name, {}, uri_of)
        assert said in str(refused.value)


def test_an_attribute_that_no_task_sums_up_is_renamed_alone(analysis: Analysis) -> None:
    place = TEXT.index("price = 9")
    edit = rename([analysis], str(PATH), place, "value", {}, uri_of)
    assert edit is not None
    assert edit.changes is not None
    ((_, edits),) = edit.changes.items()
    assert starts(analysis, [each.range for each in edits]) == [place]


# --- hover -------------------------------------------------------------------------------------


def told(analysis: Analysis, place: int) -> str:
    found = hover(analysis, 0, place)
    assert found is not None
    assert isinstance(found.contents, lsp.MarkupContent)
    return found.contents.value


def test_hover_shows_what_is_summed_up(analysis: Analysis) -> None:
    shown = told(analysis, SUMS[0])
    lines = "B: const price = 40\nJ: const price = 120\nL: param price in [1, 2]"
    assert f"```srg\n{lines}\n```" in shown
    assert "count as 0" in shown
    assert "Of module `B`, used 2 times." in told(analysis, PRICES[0])


def test_hover_of_a_task_and_of_the_words(analysis: Analysis) -> None:
    task = told(analysis, TEXT.index("T {"))
    assert "- minimizes `sum(price)` within 5 % then `modules`" in task
    for word in ("minimize", "sum", "modules"):
        assert "minimize" in told(analysis, TEXT.index(word, TEXT.index("minimize")))
    assert "later objectives" in told(analysis, TEXT.index("within"))
    assert "before it leave" in told(analysis, TEXT.index("then"))


def test_many_modules_are_not_all_shown() -> None:
    more = "".join(f"module X{n} {{ role link; const price = {n}; }}\n" for n in range(30))
    text = more + TEXT.replace(
        "arm: N", "".join(f"x{n}: N -> N X{n};" for n in range(30)) + "arm: N"
    )
    shown = told(analyse(str(PATH), text, {}), text.index("sum(price)") + 4)
    assert "X23: const price = 23\n// 9 more\n" in shown


# --- completion --------------------------------------------------------------------------------


def offered(clause: str, text: str = TEXT) -> list[str]:
    """What may follow an unfinished clause in task T."""
    written = "minimize sum(price) within 5 % then modules;\n}\ntask U"
    begun, _, rest = text.partition(written)
    analysis = analyse(str(PATH), text, {})
    found = completions(analysis, f"{begun}{clause}\n}}\ntask U{rest}", len(begun) + len(clause))
    return [each.label for each in found]


def test_objectives_are_offered() -> None:
    assert offered("minimize ") == ["modules", "mass", "time", "energy", "effort", "sum"]
    assert offered("minimize ma") == ["modules", "mass", "time", "energy", "effort", "sum"]
    assert offered("minimize modules then ") == [
        "modules",
        "mass",
        "time",
        "energy",
        "effort",
        "sum",
    ]


def test_any_number_of_steps_is_offered() -> None:
    assert "at most" in offered("horizon ")
    assert "at" not in offered("horizon ")
    assert offered("horizon at ") == ["most"]
    assert "at most" not in offered("start ")
    assert "at most" not in offered("horizon at most ")


def test_attributes_of_the_modules_of_the_grammar_are_offered() -> None:
    due = ["price", "cost", "length", "mine", "state"]
    assert sorted(offered("minimize sum(")) == sorted(due)
    assert sorted(offered("minimize modules then sum(pr")) == sorted(due)
    assert offered("minimize mass(") == []
    assert offered("minimize sum(", TEXT.replace("robot Arm", "robot Nothing")) == []


def test_words_behind_an_objective_are_offered() -> None:
    assert offered("minimize modules ") == ["then", "within"]
    assert offered("minimize sum(price) ") == ["then", "within"]
    assert offered("minimize sum(price) within 5 % ") == ["then"]
    assert "minimize" in offered("")


# --- quick fixes -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wrong", "fixed"),
    [
        ("minimize price;", "minimize sum(price);"),
        ("minimize module;", "minimize modules;"),
        ("minimize summ(price);", "minimize sum(price);"),
        ("minimize sum(prices);", "minimize sum(price);"),
    ],
)
def test_hints_that_repair(wrong: str, fixed: str) -> None:
    text = TEXT.replace("minimize modules then sum(price);", wrong)
    found = analyse("untitled:x", text, {})
    lines = LineMap(text, UTF16)
    (error,) = [each for each in found.findings if each.severity.value == "error"]
    at = lsp.Range(lines.position(error.span.start), lines.position(error.span.end))
    published = lsp.Diagnostic(at, error.message, source="srgc", data={"hint": error.hint})
    (action,) = quick_fixes("untitled:x", text, lines.offset, [published])
    assert action.edit is not None
    assert action.edit.changes is not None
    ((_, (edit,)),) = action.edit.changes.items()
    start, end = (lines.offset(place) for place in (edit.range.start, edit.range.end))
    assert f"{text[:start]}{edit.new_text}{text[end:]}" == text.replace(wrong, fixed)

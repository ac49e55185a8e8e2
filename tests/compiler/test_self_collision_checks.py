"""The note on which bodies may touch."""

from __future__ import annotations

from pathlib import Path

import pytest

from grammar_lang.diagnostics.diagnostic import Severity
from grammar_lang.load import load_text
from srgc.session import check_loaded

SPEC = Path(__file__).parents[2] / "specs" / "planar_arm_body.srg"
TEXT = SPEC.read_text(encoding="utf-8").replace(
    "accept contains EN and starts with B eps JO;", "accept matches B (eps JO eps L)+ eps EN;"
)


def notes(clause: str, bound: str = "", accept: str = "") -> list[str]:
    """What is said of arms of joints and links in turn, with a clause and a bound on modules."""
    text = TEXT.replace("avoid O with body margin 0.02 m;", f"avoid O with body; {clause} {bound}")
    text = text.replace("eps L)+ eps EN;", f"eps L)+ eps EN{accept};")
    found = check_loaded(load_text(text, "t")).diagnostics
    assert all(each.severity is not Severity.ERROR and each.hint for each in found), found
    return [each.message for each in found if each.code.value == "SRG0718"]


def test_nothing_is_said_without_the_clause() -> None:
    assert notes("") == []


@pytest.mark.parametrize(
    "clause", ["avoid self with body;", "avoid self, O with body margin 1 mm;"]
)
def test_the_smallest_robot_with_bodies_apart(clause: str) -> None:
    """Three links on three joints."""
    (said,) = notes(clause)
    assert said.startswith("in `B eps JO eps L eps JO eps L eps JO eps L eps EN` 1 pair of bodies")
    assert "body 1 (L at symbol 4) and body 2 (L at symbol 8)" in said
    assert "body 2 (L at symbol 8) and body 3 (L at symbol 12)" in said
    assert "body 1 (L at symbol 4) and body 3" not in said


@pytest.mark.parametrize(
    ("clause", "bound"),
    [("avoid self with body;", "modules <= 7;"), ("avoid self with body, except L L;", "")],
)
def test_no_bodies_have_to_stay_apart(clause: str, bound: str) -> None:
    (said,) = notes(clause, bound)
    assert said.startswith("no bodies of the")


def test_long_words_are_passed_over() -> None:
    """The smallest robot of these has 300 links: nothing is said, and soon."""
    assert notes("avoid self with body;", accept=" and count(L) >= 300") == []

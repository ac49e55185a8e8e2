"""``srgc graph DIR --of lemmas``: what is left of a family."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.oracles.small_specs import BEYOND_REACH, replaced
from tests.srgc.conftest import Ran

Srgc = Callable[..., Ran]


FAR = replaced(
    replaced(BEYOND_REACH, "modules <= 4;", ""), "contains EN", "contains EN and count(L) <= 0"
)
"""Without end, and without a link that would reach."""


def test_nothing_is_left(srgc: Srgc, tmp_path: Path) -> None:
    (tmp_path / "far.srg").write_text(FAR, encoding="utf-8")
    assert srgc("synth", tmp_path / "far.srg", "-o", tmp_path / "out").status == 3
    ran = srgc("graph", tmp_path / "out", "--of", "lemmas")
    assert ran.status == 0
    assert re.findall('-> "(.*)"', ran.out) == ["s0"]
    assert ran.err.startswith("note: nothing is left: all words satisfy the condition of a lemma")
    assert srgc("verify", tmp_path / "out").out.startswith("valid: impossible, level validated")


def test_the_first_word_that_is_left(srgc: Srgc, made: Callable[[str], Path]) -> None:
    """The arm of the first page: without a link it turns about a point, with one it is found."""
    ran = srgc("graph", made("turner") / "out", "--of", "lemmas")
    assert ran.status == 0
    assert ran.err == ("note: left by `count(L) <= 0`: the first word is B eps JO eps L eps EN\n")
    assert ran.out.count("->") > 4


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["turner.srg", "--of", "lemmas"], "turner.srg is a file"),
        ([".", "--of", "lemmas"], ". has no design.json"),
        (["out", "--of", "lemmas", "--depth", "2"], "--of lemmas goes with -o alone"),
    ],
)
def test_refused(
    srgc: Srgc, made: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch,
    arguments: list[str], said: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(made("turner"))
    ran = srgc("graph", *arguments)
    assert (ran.status, ran.out) == (2, "")
    assert said in ran.err


def test_a_result_without_lemmas(srgc: Srgc, made: Callable[[str], Path]) -> None:
    ran = srgc("graph", made("beyond_reach") / "out", "--of", "lemmas")
    assert ran.status == 2
    assert "has no lemmas" in ran.err

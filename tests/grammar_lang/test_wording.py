from __future__ import annotations

import pytest

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.diagnostics.wording import did_you_mean, nearest


@pytest.mark.parametrize(
    ("name", "found"),
    [("lenght", "length"), ("LENGTH", "length"), ("masse", "mass"), ("zzz", None), ("", None)],
)
def test_the_nearest_name(name: str, found: str | None) -> None:
    assert nearest(name, ("density", "length", "mass")) == found


def test_the_first_of_equally_near_names() -> None:
    assert nearest("arm3", ("arm1", "arm2")) == "arm1"
    assert nearest("arm3", ("arm2", "arm1")) == "arm2"
    assert nearest("arm3", ("arm2", "arm30")) == "arm30"


def test_a_hint_says_what_there_is() -> None:
    assert did_you_mean("lenght", ("length",), "name", Sink()) == "did you mean `length`?"
    assert did_you_mean("a", (), "region", Sink()) == "no region is declared here"
    assert did_you_mean("zzz", "abc", "name", Sink()) == "known: `a`, `b`, `c`"
    assert did_you_mean("zzz", "abcabc", "name", Sink()) == "known: `a`, `b`, `c`"
    assert did_you_mean("9", "abcdefg", "name", Sink()).endswith("`e`, `f`, …")


def test_the_search_ends_with_the_comparisons() -> None:
    sink, known = Sink(comparisons=25), tuple(f"arm{i}" for i in range(10))
    hints = [did_you_mean("arn1", known, "name", sink) for _ in range(4)]
    assert hints[:2] == ["did you mean `arm1`?"] * 2
    assert hints[2:] == ["known: `arm0`, `arm1`, `arm2`, `arm3`, `arm4`, `arm5`, …"] * 2


def test_long_names_are_not_compared() -> None:
    assert nearest("a" * 100_000, ("a" * 99_999, "b")) is None
    assert nearest("a", ("a" * 100_000,)) is None

"""Bounds on the size of robots that ``why`` suggests: ``modules``, and counts in ``accept``."""

from __future__ import annotations

import pytest

from compiler.robots.normal_form import family_of
from compiler.words.structures import structures
from solvers.explanation.explanation import Asked, Tried, explain
from solvers.explanation.size_bounds import beyond, exceeds, size_lines, with_size_of
from solvers.explanation.suggestions import SuggestionSearch
from solvers.run_context import RunContext
from tests.oracles.small_specs import TURNER, replaced
from tests.solvers.test_changes import Vain, posed

SHORT = replaced(
    replaced(TURNER, "[1, 2] m", "[0.5, 1] m"),
    "accept contains EN and starts with B eps JO;",
    "accept CONDITION;",
)
"""Start and target are at least 1.2 m from the base, so that one link does not do; two do."""
ONE_HAND = "starts with B eps JO and ends with EN and count(EN) == 1"


def short(condition: str, task: str = "") -> str:
    return replaced(SHORT, "CONDITION", condition).replace("reach T;", f"reach T; {task}")


def test_a_bound_on_modules() -> None:
    asked = posed(short(ONE_HAND, "modules <= 4;"))
    bound = next(each for each in size_lines(asked) if each.kind == "modules")
    (longer,) = [each for each in words(beyond(asked, bound), 5) if each.word.count("L") == 2]
    change = with_size_of(asked, bound, longer)
    assert (change.says, change.posed.task.modules) == ("with `modules <= 5`", 5)
    kinds = [each.kind for each in size_lines(posed(short(ONE_HAND)))]
    assert kinds == ["accept"]  # count(EN) == 1


def words(asked, modules: int):
    family = family_of(asked.program, asked.task)
    return list(structures(family.language, modules))


@pytest.mark.parametrize(
    ("condition", "written", "says", "changed"),
    [
        ("length <= 7", "length <= 7", "a robot has at most 7 symbols", "length <= 9"),
        ("length < 8", "length < 8", "a robot has at most 7 symbols", "length <= 9"),
        ("count(L) <= 1", "count(L) <= 1", "a robot has at most 1 `L`", "count(L) <= 2"),
        ("count( L )== 1", "count( L )== 1", "a robot has 1 `L`", "count(L) <= 2"),
        ("(count(L) < 2 or count(EN) >= 4)", "count(L) < 2", "a robot has at most 1 `L`",
         "count(L) <= 2"),
    ],
)  # fmt: skip
def test_a_count_in_accept(condition: str, written: str, says: str, changed: str) -> None:
    text = short(f"{ONE_HAND} and {condition}")
    asked = posed(text)
    (bound,) = [each for each in size_lines(asked) if "`EN`" not in each.says]
    assert bound.says == says
    assert text[bound.span.start : bound.span.end] == written
    two = ("B", "eps", "JO", "eps", "L", "eps", "L", "eps", "EN")
    (longer,) = [each for each in words(beyond(asked, bound), 5) if each.word == two]
    assert exceeds(asked, bound, longer)
    change = with_size_of(asked, bound, longer)
    assert change.says == f"with `{changed}` in `accept`"
    wanted = posed(short(f"{ONE_HAND} and {condition.replace(written, changed)}"))
    assert change.posed.program.grammars == wanted.program.grammars


@pytest.mark.parametrize("condition", ["length >= 3", "not length > 7", "count(L) > 1"])
def test_other_counts_bound_nothing_from_above(condition: str) -> None:
    asked = posed(short(f"starts with B eps JO and {condition}"))
    assert size_lines(asked) == ()


def test_the_least_count_with_poses_is_tried() -> None:
    asked = posed(short(f"{ONE_HAND} and length <= 7"))
    runs = Vain(RunContext(), limit=9)
    SuggestionSearch(asked, runs).after_conflicts([], size_lines(asked))
    assert "with `length <= 9` in `accept`" in [change.says for change in runs.failed]


@pytest.mark.slow
def test_a_run_finds_a_robot_with_one_more_link() -> None:
    text = short(f"{ONE_HAND} and count(L) <= 1 and count(JO) == 1")
    asked = posed(text)
    tried = Tried("impossible", "", (("tool", "link", "joint", "base"),))
    found = explain(asked, tried, Asked(runs=8))
    assert found.bound is not None
    assert text[found.bound.span.start : found.bound.span.end] == "count(L) <= 1"
    assert found.beyond.count("L") == 2
    said = {one.change.says: one.word for one in found.suggestions}
    assert said["with `count(L) <= 2` in `accept`"].count("L") == 2

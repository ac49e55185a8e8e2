"""A search that goes on after the first design, and where it ends."""

from __future__ import annotations

from pathlib import Path

import pytest

import solvers.search.family_search
from compiler.time_limits.time_limit import OutOfTimeError
from grammar_lang import ir
from grammar_lang.load import load
from solvers.run_context import RunContext
from solvers.search.synthesis import Synthesis, synthesise
from tests.oracles.extended_arm import extended_arm
from tests.oracles.small_specs import replaced


def program_of(folder: Path, text: str) -> ir.Program:
    path = folder / "arm.srg"
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    assert program is not None
    return program


def search(program: ir.Program, context: RunContext | None = None, *, every: bool) -> Synthesis:
    (task,) = program.tasks.values()
    return synthesise(program, task, context or RunContext(), every=every)


def test_the_first_design_is_that_of_an_ordinary_search(tmp_path: Path) -> None:
    program = program_of(tmp_path, extended_arm("[0, 1]"))
    one, every = search(program, every=False), search(program, every=True)
    assert [len(one.records), len(every.records)] == [1, 2]
    assert one.design is not None
    assert every.design is not None
    assert every.design.inputs == one.design.inputs
    assert every.design.parameters == one.design.parameters
    assert every.design is every.designs[0].design


def test_counts_of_the_designs_add_up(tmp_path: Path) -> None:
    every = search(program_of(tmp_path, extended_arm("[0, 1]")), every=True)
    for name in ("structures", "paths", "evaluations"):
        assert sum(proved.counts[name] for proved in every.designs) == every.counts[name]
    assert sum(len(each.samples) for each in every.samples) == every.counts["evaluations"]


@pytest.mark.slow
def test_without_a_bound_it_ends_at_a_limit_that_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solvers.search.family_search, "DEFAULT_DESIGNS", 1)
    text = replaced(extended_arm("[0, 1]"), "  modules <= 5;\n", "")
    every = search(program_of(tmp_path, text), every=True)
    assert every.verdict == "found"
    assert len(every.designs) == 1
    assert every.ended is not None
    assert "limit of 1 designs" in every.ended
    assert not every.unfinished
    # A bound in the task is kept to, however many designs that makes.
    bounded = search(program_of(tmp_path, extended_arm("[0, 1]")), every=True)
    assert len(bounded.designs) == 2
    assert bounded.ended is None


def test_out_of_time_before_the_first_design_is_unknown(tmp_path: Path) -> None:
    def out_of_time() -> bool:
        raise OutOfTimeError

    program = program_of(tmp_path, extended_arm("[0, 1]"))
    result = search(program, RunContext(out_of_time=out_of_time), every=True)
    assert (result.verdict, result.designs, result.unfinished) == ("unknown", (), True)
    assert result.reason == "the time limit was reached"


def test_out_of_time_says_what_was_under_way(tmp_path: Path) -> None:
    asked = 0

    def out_of_time() -> bool:
        nonlocal asked
        asked += 1
        return asked > 4

    program = program_of(tmp_path, extended_arm("[0, 1]"))
    result = search(program, RunContext(out_of_time=out_of_time), every=True)
    assert result.verdict == "unknown"
    assert str(result.reason).startswith("the time limit was reached while a motion of B eps JO")

"""``--time-limit``: what is written after the search keeps to it, and another run completes it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

import srgc.time_limit as module
from compiler.time_limits.time_limit import OutOfTimeError, check_time, time_limit
from grammar_lang.load import load, load_text
from solvers.explanation.conflict import ConflictSearch
from solvers.explanation.explanation import Asked, explain
from solvers.run_context import RunContext
from solvers.search.synthesis import OUT_OF_TIME, Synthesis, synthesise
from solvers.verifier.verification import Outcome, verify_directory
from srgc.results.synthesis_run import PICTURES, SynthesisOptions, run_synthesis
from srgc.results.why_folder import tried_folder
from srgc.text_reports.synthesis_report import synthesis_text
from srgc.text_reports.why_report import ending
from srgc.time_limit import TimeLimit
from tests.oracles.limits import Asked as Often
from tests.oracles.small_specs import TURNER

Made = Callable[[str], Path]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time of day, to be set."""
    now = [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now[0])
    return now


def test_a_limit_counts_from_the_beginning_of_the_command(clock: list[float]) -> None:
    limit, none = TimeLimit(3.0, begun=clock[0]), TimeLimit(None, begun=clock[0])
    with limit.holds():
        check_time()
        clock[0] += 3.5
        with pytest.raises(OutOfTimeError):
            check_time()
        with none.holds():
            check_time()
    assert limit.reached()
    assert not none.reached()


def test_a_limit_that_was_passed_by_far_says_so(clock: list[float]) -> None:
    limit = TimeLimit(3.0, begun=clock[0])
    clock[0] += 4.0
    assert limit.overrun("a problem was solved") == ""
    clock[0] += 2.2
    assert limit.overrun("a problem was solved") == (
        "; it was passed by 3.2 s, in which a problem was solved"
    )
    assert limit.overrun("") == "; it was passed by 3.2 s, in a step that cannot be interrupted"
    assert TimeLimit(None, begun=0.0).overrun("") == ""


@dataclass(frozen=True)
class OnceSearched(TimeLimit):
    """Reached as soon as a file is there."""

    file: Path = Path()

    def reached(self) -> bool:
        return self.file.exists()


def run(folder: Path, limit: TimeLimit | None) -> Synthesis:
    path = folder / "turner.srg"
    path.write_text(TURNER, encoding="utf-8")
    program = load(path).program
    assert program is not None
    options = SynthesisOptions(folder / "out", 0, 1, limit, force=False, quiet=True)
    return run_synthesis(path, program, program.tasks["Turn"], options)


def result_lines(result: Synthesis) -> str:
    """What is printed of a synthesis."""
    program = load_text(TURNER, "turner.srg").program
    assert program is not None
    return synthesis_text(result, program.tasks["Turn"], "out")


def content(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != "log.json")
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_a_design_without_time_for_pictures_is_written(tmp_path: Path, made: Made) -> None:
    """The next run draws them, and leaves what a run without a limit leaves."""
    out, whole = tmp_path / "out", content(made("turner") / "out")
    result = run(tmp_path, OnceSearched(1.0, file=out / "evaluations.csv"))
    assert (result.verdict, result.unfinished) == ("found", True)
    assert f"{OUT_OF_TIME} before it was improved or drawn" in result_lines(result)
    written = content(out)
    assert written.pop("journal.jsonl")
    assert written == {name: data for name, data in whole.items() if name not in PICTURES}
    assert verify_directory(out).outcome is Outcome.VALID
    again = run(tmp_path, None)
    assert not again.unfinished
    assert "drawn" not in result_lines(again)
    assert content(out) == whole


def test_a_shorter_limit_keeps_what_an_earlier_run_has_proved(tmp_path: Path, made: Made) -> None:
    out = tmp_path / "out"
    assert run(tmp_path, OnceSearched(1.0, file=out / "design.json")).verdict == "found"
    before = content(out)
    late = run(tmp_path, TimeLimit(1e-9))
    assert (late.verdict, late.unfinished) == ("unknown", True)
    assert str(late.reason).endswith("the design that an earlier run proved is kept")
    assert {**content(out), "journal.jsonl": b""} == {**before, "journal.jsonl": b""}
    assert verify_directory(out).outcome is Outcome.VALID
    assert run(tmp_path, None).verdict == "found"
    assert content(out) == content(made("turner") / "out")


def test_a_cut_run_says_by_how_much_the_limit_was_passed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "TOLERATED", -1.0)
    result = run(tmp_path, TimeLimit(1e-9))
    assert result.verdict == "unknown"
    told = "in which srgc was started and the spec was read"
    assert str(result.reason).startswith(f"{OUT_OF_TIME}; it was passed by ")
    assert str(result.reason).endswith(told)
    assert json.loads((tmp_path / "out" / "design.json").read_text())["reason"] == result.reason
    # Not so where the limit was not reached, however long the search took.
    whole = run(tmp_path, TimeLimit(1e9))
    assert (whole.verdict, whole.reason, whole.unfinished) == ("found", None, False)


def test_the_conflict_at_the_end_keeps_to_the_limit(made: Made) -> None:
    tried = tried_folder(made("beyond_reach") / "out")
    searched = synthesise(tried.posed.program, tried.posed.task, RunContext(lemmas=False))
    assert searched.verdict == "impossible"
    last = "next:    srgc why out  # what would make it possible"
    whole = ending(searched, tried.posed, RunContext(), "out")
    assert len(whole.splitlines()) > 2
    assert whole.endswith(last)
    with time_limit(lambda: True):
        short = ending(searched, tried.posed, RunContext(), "out")
    assert short.splitlines()[-1] == last
    assert len(short) < len(whole)


def test_conflicts_found_before_the_limit_are_kept(
    made: Made, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = tried_folder(made("beyond_reach") / "out")
    assert tried.tried is not None
    given, asked = ConflictSearch.conflict, []

    def late(search: ConflictSearch, derivation: object) -> object:
        asked.append(derivation)
        if len(asked) > 1:
            raise OutOfTimeError
        return given(search, derivation)  # type: ignore[arg-type]

    monkeypatch.setattr(ConflictSearch, "conflict", late)
    found = explain(tried.posed, tried.tried, Asked(runs=0))
    assert found.ended == OUT_OF_TIME
    assert len(found.conflicts.found) == 1
    assert found.conflicts.left == len(tried.tried.refuted) - 1


def test_an_explanation_ends_wherever_it_is(made: Made) -> None:
    tried = tried_folder(made("beyond_reach") / "out")
    assert tried.tried is not None
    limit = Often()
    with time_limit(limit):
        whole = explain(tried.posed, tried.tried, Asked(runs=0))
    assert whole.ended is None
    for part in (0.0, 0.5, 0.95):
        with time_limit(Often(int(part * limit.times))):
            assert explain(tried.posed, tried.tried, Asked(runs=0)).ended == OUT_OF_TIME

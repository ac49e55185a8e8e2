"""The estimate, against work whose length is known, and the line it stands in."""

from __future__ import annotations

import io
import re
import sys
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import pytest

from compiler.robots.normal_form import family_of
from compiler.robots.state_and_input import family_unit
from compiler.tasks.obstacle_pieces import expanded
from compiler.words.structures import structures
from grammar_lang.load import load_text
from srgc.api.search_arguments import is_quiet
from srgc.results import progress_display
from srgc.results.progress_display import (
    NO_ESTIMATE,
    SILENCE,
    LiveProgress,
    NotebookProgress,
    PlainProgress,
    QuietProgress,
    duration_text,
    estimate_text,
    progress,
    remaining,
)
from srgc.results.synthesis_run import structure_total
from srgc.session import program_of
from tests.oracles.small_specs import MOTOR, SLIDER, TURNER


@pytest.mark.parametrize("count", [4, 10, 100])
@pytest.mark.parametrize("each", [0.001, 2.0, 500.0])
def test_equal_parts_are_estimated_exactly(count, each):
    for left in (0, 1, 7):
        low, high = remaining([each] * count, 0.0, left)
        assert low == pytest.approx(each * left)
        assert high == pytest.approx(each * left)


def test_parts_that_become_longer_are_within_the_range_for_a_while():
    """Part i takes 1 + i / 10 seconds: the next few are what the range says."""
    durations = [1 + i / 10 for i in range(40)]
    for done in range(8, 40):
        low, high = remaining(durations[:done], 0.0, 1)
        assert low <= high < durations[done]
        assert low == pytest.approx(sum(durations[:done]) / done)
        assert high > durations[done] * 0.75


def test_a_part_that_takes_long_raises_the_estimate():
    highs = [remaining([1.0] * 8, running, 10)[1] for running in (0.0, 1.0, 5.0, 50.0, 500.0)]
    assert highs[0] == highs[1] == 10
    assert all(a < b for a, b in pairwise(highs[1:]))
    assert remaining([1.0] * 8, 500.0, 10)[0] == 10


def test_too_little_is_known():
    assert remaining([1.0] * 3, 1.0, 5) is None
    assert estimate_text([1.0] * 3, 1.0, 5) == NO_ESTIMATE
    assert estimate_text([1.0] * 30, 1.0, None) == NO_ESTIMATE


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0, "1 s"), (0.2, "1 s"), (42.4, "42 s"), (99.4, "99 s"), (100, "2 min"), (3600, "60 min"),
     (6001, "2 h"), (360000, "100 h"), (3.6e6, "1000 h")],
)  # fmt: skip
def test_durations(seconds, text):
    assert duration_text(seconds) == text


class Clock:
    now = 100.0

    def monotonic(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(progress_display, "time", clock)
    return clock


def test_the_line_of_a_synthesis(clock):
    live = LiveProgress("synth Turn", "structures", lambda: 12)
    live._total = 12
    assert live.text() == "synth Turn · 1 s · no estimate"
    for number in range(7):
        live.structure(number, ("B", "eps", "EN"))
        clock.now += 2
    live.robustness(0.5)
    live.robustness(0.25)
    # Six took two seconds each and the seventh has: six are left.
    assert live.text() == (
        "synth Turn · 6 of 12 structures · 14 s · 12 s left for all · robustness 0.5 · B eps EN"
    )
    assert live.text().index(" · B eps EN") < 80  # seen on a usual terminal
    clock.now += 100
    assert "12 s to" in live.text()
    live.note("trying a\nwider margin")
    assert live.text().endswith("trying a wider margin")


def test_structures_that_were_skipped_share_the_time(clock):
    """A search resumed from a journal, or a landscape, goes on by more than one at once."""
    live = LiveProgress("landscape", "points", lambda: None)
    live.part(0, 100)
    clock.now += 10
    live.part(50, 100)
    assert "50 of 100 points · 10 s · 10 s left for all" in live.text()


def test_plain_lines_about_a_grid_are_sparse(clock, capsys):
    plain = PlainProgress()
    for done in range(101):
        plain.part(done, 100)
        clock.now += 0.5
    lines = capsys.readouterr().err.splitlines()
    assert [line.split("] ")[1] for line in lines] == [f"{n} of 100" for n in (20, 40, 60, 80, 100)]


def test_plain_lines_about_steps_break_long_silence_alone(clock, capsys):
    plain = PlainProgress()
    for second in range(30):
        if second == 14:
            plain.note("a note")
        plain.step(f"step {second}")
        clock.now += 1
    lines = capsys.readouterr().err.splitlines()
    assert [line.split("] ")[1] for line in lines] == ["step 10", "a note", "step 24"]


def test_a_step_is_shown_until_the_next(clock):
    live = LiveProgress("why", "", lambda: None)
    live.step("robot 1 of 2")
    assert live.text().endswith(" · robot 1 of 2")
    live.step("robot 2 of 2")
    assert live.text().endswith(" · robot 2 of 2")


def test_quiet_and_piped(monkeypatch, capsys):
    for display in (progress("x", quiet=True), progress("x", quiet=False, plain=False)):
        with display as told:
            told.structure(0, ("a",))
            told.path(("a",))
            told.robustness(1.0)
            told.note("note")
            told.step("step")
            told.part(1, 2)
    assert capsys.readouterr().err == ""
    assert type(progress("x", quiet=False)) is PlainProgress

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setattr("sys.stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    assert isinstance(progress("x", quiet=False), LiveProgress)
    assert type(progress("x", quiet=True)) is QuietProgress
    monkeypatch.setenv("TERM", "dumb")
    assert type(progress("x", quiet=False)) is PlainProgress


def test_how_many_structures_there_are(arm_file):
    program = program_of(arm_file.with_name("l_shaped.srg"))
    task = program.tasks["Lift"]
    every = list(structures(family_of(*expanded(program, task)).language, task.modules))
    assert structure_total(program, task) == len(every) > 5
    # Without a bound there is only a limit, and no total.
    program = program_of(arm_file)
    task = program.tasks["PickAndPlace"]
    assert structure_total(program, task) is None
    assert structure_total(program, replace(task, modules=3)) == 1
    assert structure_total(program, replace(task, modules=14)) is None


def test_the_live_line_leaves_room_for_an_interrupt(clock, monkeypatch):
    """A terminal writes `^C` behind it: in the last columns that would begin a line of its own."""
    screen = io.StringIO()
    monkeypatch.setattr(screen, "isatty", lambda: True)
    monkeypatch.setattr("sys.stderr", screen)
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(progress_display, "SILENCE", -1.0)
    with LiveProgress("synth Store", "structures", lambda: 2) as display:
        display.structure(1, ("L",) * 60)
    shown = re.split(r"\x1b\[[?0-9;]*[A-Za-z]|[\r\n]", screen.getvalue())
    assert any(line.startswith("synth Store") for line in shown)
    assert max(map(len, shown)) <= 40 - len("^C") - 1


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        (TURNER, "N*m"),
        (SLIDER, "N"),
        (MOTOR, "V"),  # which has no free input
        (TURNER.replace("module L ", "module P { role joint; dof d: prismatic x; }\nmodule L ")
         .replace("  link:", "  rail:  N -> N eps P;\n  link:")
         .replace("  link  {", "  rail  { this.frame = N.frame * move(x, P.d); }\n  link  {")
         .replace("effort <= 10 N*m;", "effort <= 10 N*m; effort <= 10 N;"), ""),
    ],
    ids=["N*m", "N", "V", "two units"],
)  # fmt: skip
def test_robustness_has_the_unit_of_all_inputs(clock, capsys, text, unit):
    program = load_text(text, "a.srg").program
    (task,) = program.tasks.values()
    measure = family_unit(program, task)
    assert measure == unit
    live, plain = LiveProgress("synth", "", lambda: None, measure), PlainProgress(measure)
    live.robustness(0.5)
    plain.robustness(0.5)
    shown = f"robustness 0.5 {unit}".rstrip()
    assert live.text().endswith(shown)
    assert capsys.readouterr().err.endswith(f"best robustness: 0.5 {unit}".rstrip() + "\n")


# --- notebooks ------------------------------------------------------------------------------------


class _Shown:
    """Stands for IPython and its displays: the lines that a cell has shown, in order."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.shells = {"kernel": object()}

    def get_ipython(self):
        return SimpleNamespace(**self.shells)

    def display(self, data, *, raw, display_id):
        assert raw
        assert display_id
        self.update(data, raw=raw)
        return self

    def update(self, data, *, raw):
        assert raw
        self.lines.append(data["text/plain"])


@pytest.fixture
def notebook(monkeypatch):
    shown, clock = _Shown(), [100.0]
    monkeypatch.setitem(sys.modules, "IPython", shown)
    monkeypatch.setitem(sys.modules, "IPython.display", shown)
    monkeypatch.setattr(progress_display, "time", SimpleNamespace(monotonic=lambda: clock[0]))
    return shown, clock


def test_a_notebook_has_a_line_that_is_gone_at_the_end(notebook, capsys):
    shown, clock = notebook
    with progress("synth T", quiet=False, unit="structures", count=lambda: 5) as display:
        assert isinstance(display, NotebookProgress)
        display.structure(1, ("A", "B"))
        assert shown.lines == []
        clock[0] += SILENCE
        display.robustness(0.5)
        display.robustness(0.6)  # too soon after the line before
        clock[0] += 1
        display.structure(2, ("A", "C"))
    assert len(shown.lines) == 3
    assert shown.lines[0].startswith("synth T · 1 of 5 structures · 1 s")
    assert "robustness 0.5" in shown.lines[0]
    assert "2 of 5 structures" in shown.lines[1]
    assert shown.lines[1].endswith("A C")
    assert shown.lines[-1] == ""
    assert capsys.readouterr() == ("", "")


def test_what_is_soon_done_shows_nothing(notebook):
    shown, _ = notebook
    with progress("synth T", quiet=False) as display:
        display.note("found")
    assert shown.lines == []


def test_only_the_kernel_of_a_notebook_is_one(notebook, monkeypatch):
    shown, _ = notebook
    assert not is_quiet(None)
    assert is_quiet(progress=False)
    shown.shells.clear()  # IPython on a terminal
    assert is_quiet(None)
    assert not is_quiet(progress=True)
    monkeypatch.delitem(sys.modules, "IPython")
    assert is_quiet(None)

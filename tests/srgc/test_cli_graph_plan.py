from __future__ import annotations

import shutil
import subprocess

import pytest

from tests.oracles.small_specs import SLIDER, replaced


@pytest.mark.parametrize("what", ["sra", "dfa", "words", "grammar", "workspace"])
def test_dot_on_stdout_or_in_a_file(srgc, arm_file, tmp_path, what):
    ran = srgc("graph", arm_file, "--of", what)
    assert (ran.status, ran.err) == (0, "")
    first = ran.out.split(None, 1)[0]
    assert first in ("digraph", "graph")
    assert ran.out.count("{") == ran.out.count("}")
    target = tmp_path / "view.dot"
    assert srgc("graph", arm_file, "--of", what, "-o", target).status == 0
    assert target.read_text(encoding="utf-8") == ran.out


def test_the_words_to_a_depth(srgc, arm_file):
    shallow = srgc("graph", arm_file, "--of", "words", "--depth", "1").out
    deep = srgc("graph", arm_file, "--of", "words", "--depth", "4").out
    assert len(shallow.splitlines()) < len(deep.splitlines())


def test_the_task_chooses(srgc, arm_file):
    plain = srgc("graph", arm_file, "--of", "workspace").out
    assert srgc("graph", arm_file, "--of", "workspace", "--task", "PickAndPlace").out == plain
    for option in ("--task", "--workspace"):
        ran = srgc("graph", arm_file, "--of", "workspace", option, "Nope")
        assert (ran.status, ran.out) == (2, "")
        assert "`Nope`" in ran.err


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_a_picture_without_graphviz_is_one_message(srgc, arm_file, tmp_path, monkeypatch, suffix):
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    target = tmp_path / f"view{suffix}"
    ran = srgc("graph", arm_file, "--of", "sra", "-o", target)
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.count("\n") == 1
    assert "Graphviz" in ran.err
    assert not target.exists()


def test_a_picture_is_drawn_by_graphviz(srgc, arm_file, tmp_path, monkeypatch):
    calls = []

    def draw(command, **options):
        calls.append((command, options["input"]))
        return subprocess.CompletedProcess(command, 0, b"<svg/>", b"")

    monkeypatch.setattr(shutil, "which", lambda name: f"/bin/{name}")
    monkeypatch.setattr(subprocess, "run", draw)
    target = tmp_path / "view.svg"
    assert srgc("graph", arm_file, "--of", "sra", "-o", target).status == 0
    ((command, text),) = calls
    assert command == ["/bin/dot", "-Tsvg"]
    assert text.startswith(b"digraph")
    assert target.read_bytes() == b"<svg/>"


def test_a_place_that_cannot_be_written(srgc, arm_file, tmp_path):
    ran = srgc("graph", arm_file, "--of", "sra", "-o", tmp_path / "no" / "view.dot")
    assert ran.status == 2
    assert ran.err.count("\n") == 1


def test_the_path_of_the_example(srgc, arm_file):
    ran = srgc("plan", arm_file)
    assert (ran.status, ran.err) == (0, "")
    cells = ran.out.split()
    assert cells[0] == "S"
    assert cells[-1] == "T"
    assert "O" not in cells
    assert srgc("plan", arm_file, "--task", "PickAndPlace").out == ran.out


def test_no_path_past_a_wall(srgc, spec):
    wall = "obstacle O box [1, 1.5] x [-1, 1] m;\n  target"
    text = replaced(replaced(SLIDER, "target", wall), "reach T;", "reach T; avoid O with effector;")
    ran = srgc("plan", spec(text))
    assert ran.status == 3
    assert "no path" in ran.out


def test_a_planner_without_an_answer(srgc, arm_file, monkeypatch):
    from solvers.planner import Planner
    from solvers.verdict import Reason, Unknown

    monkeypatch.setattr(Planner, "next_path", lambda _self: Unknown(Reason.RESOURCE_LIMIT))
    ran = srgc("plan", arm_file)
    assert ran.status == 4
    assert ran.out.startswith("unknown: ")


@pytest.mark.parametrize("command", ["plan", "synth"])
def test_an_unknown_task(srgc, arm_file, command):
    ran = srgc(command, arm_file, "--task", "Nope")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == "error: there is no task `Nope`; the file has: PickAndPlace\n"


def test_a_task_has_to_be_chosen(srgc, spec):
    second = SLIDER[SLIDER.index("task Slide") :].replace("Slide {", "Again {")
    path = spec(SLIDER + second)
    ran = srgc("plan", path)
    assert ran.status == 2
    assert "Slide, Again" in ran.err
    assert srgc("plan", path, "--task", "Again").status == 0
    none = spec(SLIDER[: SLIDER.index("task Slide")], "none.srg")
    assert srgc("plan", none).status == 2


def test_too_many_words_to_draw_are_refused(srgc, arm_file):
    """At most n modules: 1 + 3 + ... + 3 ** (n - 1) words, above 5,000 from n = 9 on."""
    ran = srgc("graph", arm_file, "--of", "words", "--depth", "400")
    assert ran.status == 2
    assert "choose a --depth below 9" in ran.err

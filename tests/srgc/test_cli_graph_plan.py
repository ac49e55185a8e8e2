from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from srgc import graph, load
from srgc.session import UsageFault
from tests.oracles.small_specs import SLIDER, replaced


@pytest.mark.parametrize("what", ["sra", "fra", "dfa", "dpda", "words", "grammar", "workspace"])
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


ROOT = Path(__file__).parents[2]
FIGURE = "B eps JO eps JO eps JO eps L eps JO eps L eps JO eps EN"
WITH_RUNS = ["sra", "fra", "dfa", "dpda", "words", "grammar"]


@pytest.mark.parametrize("what", WITH_RUNS)
def test_the_run_of_a_word_in_red(srgc, arm_file, what):
    plain = srgc("graph", arm_file, "--of", what)
    ran = srgc("graph", arm_file, "--of", what, "--highlight", FIGURE)
    assert (ran.status, ran.err) == (0, "")
    assert "#d00000" in ran.out
    assert "#d00000" not in plain.out


@pytest.mark.parametrize("what", WITH_RUNS)
def test_a_word_without_a_run_is_one_message(srgc, arm_file, what):
    for word, message in [
        ("B eps X eps EN", "error: `X` is not a symbol of the words\n"),
        ("B eps L eps EN", "error: the word `B eps L eps EN` is not accepted\n"),
        ("", "error: the empty word is not accepted\n"),
    ]:
        ran = srgc("graph", arm_file, "--of", what, "--highlight", word)
        assert (ran.status, ran.out, ran.err) == (2, "", message)


def test_a_grammar_that_is_not_lr_has_no_deterministic_automaton(srgc, spec, arm_file):
    text = arm_file.read_text(encoding="utf-8")
    twice = text.replace("joint: N -> N eps JO;", "joint: N -> N eps JO; again: N -> N eps JO;")
    twice = twice.replace("joint {", "again { this.frame = N.frame * rot(z, JO.q); } joint {")
    ran = srgc("graph", spec(twice), "--of", "dpda")
    assert (ran.status, ran.out) == (2, "")
    assert "not LR(1)" in ran.err
    assert ran.err.count("\n") == 1


def red_nodes(dot):
    return re.findall(r'^  "w\d+" \[label="([^"]*)".*color="#d00000"', dot, re.MULTILINE)


@pytest.mark.slow
def test_figure_two_from_any_depth(srgc, arm_file):
    """The robot of Figure 1c has 9 modules: B and what is added in 8 transitions."""
    words = ("graph", arm_file, "--of", "words", "--highlight", FIGURE)
    for depth in ("1", "7"):
        ran = srgc(*words, "--depth", depth)
        assert (ran.status, len(red_nodes(ran.out))) == (0, 9)
        assert ran.err == (
            f"note: the word has 9 modules: beyond --depth {depth} only its run is drawn\n"
        )
    assert srgc(*words).err == ""
    whole = srgc(*words, "--whole", "--depth", "4").out
    assert len(re.findall(r'^  "w\d+" \[', whole, re.MULTILINE)) == 1 + 3 + 9 + 27 + 5
    near = srgc(*words)
    assert srgc(*words, "--near").out == near.out
    assert (near.status, near.err, len(red_nodes(near.out))) == (0, "", 9)
    assert len(re.findall(r'^  "w\d+" \[', near.out, re.MULTILINE)) == 1 + 8 * 3
    assert near.out.count("->") == 1 + 8 * 3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--of", "workspace", "--highlight", "B"), "--highlight shows a run"),
        (("--of", "robot", "--word", "B eps JO eps EN", "--highlight", "B"), "--highlight shows"),
        (("--of", "words", "--near"), "--near and --whole go with --highlight"),
        (("--of", "robot"), "--of robot needs the word"),
        (("--of", "sra", "--word", "B"), "go with --of robot"),
        (("--of", "sra", "--derivation", "1"), "go with --of robot"),
        (("--of", "robot", "--word", "B eps Q"), "`Q` is not a symbol"),
        (("--of", "robot", "--word", "B"), "`B` is not accepted"),
        (
            ("--of", "robot", "--word", "B eps JO eps EN", "--derivation", "2"),
            "the word has 1 derivation: there is no --derivation 2",
        ),
    ],
)
def test_choices_that_do_not_fit(srgc, arm_file, arguments, message):
    ran = srgc("graph", arm_file, *arguments)
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert message in ran.err


def test_no_word_is_as_shallow_as_asked(srgc, spec):
    ran = srgc("graph", spec(TWO), "--of", "words", "--depth", "1")
    assert (ran.status, "peripheries" in ran.out) == (0, False)
    assert ran.err == "note: no word has 1 modules or fewer: give a greater --depth\n"


TWO = """
module A { role base; }
module J { role joint; dof q: revolute z; }
edge eps;
grammar G {
  start S;
  once: S -> A eps T;
  one: T -> J;
  left: T -> T eps J;
  right: T -> J eps T;
}
"""


def test_the_robot_of_a_derivation(srgc, spec):
    path = spec(TWO)
    one = srgc("graph", path, "--of", "robot", "--word", "A eps J")
    assert (one.status, one.err) == (0, "")
    assert one.out.count("->") == 2
    several = ("graph", path, "--of", "robot", "--word", "A eps J eps J eps J")
    ran = srgc(*several)
    assert ran.status == 0
    assert ran.err == "note: the word has several derivations: --derivation 2 shows the next\n"
    # Every J but the last is added on the left or on the right.
    for derivation in range(1, 5):
        chosen = srgc(*several, "--derivation", derivation)
        assert (chosen.status, chosen.err) == (0, "")
    assert srgc(*several, "--derivation", 1).out == ran.out
    ran = srgc(*several, "--derivation", 5)
    assert (ran.status, ran.out) == (2, "")
    assert "has 4 derivations" in ran.err


def test_a_word_with_endless_derivations(srgc, spec):
    path = spec(TWO.replace("one: T -> J;", "one: T -> J;\n  same: T -> T;"))
    ran = srgc("graph", path, "--of", "robot", "--word", "A eps J")
    assert ran.status == 0
    assert "derives itself: one derivation is shown" in ran.err
    assert re.findall(r'^  "m\d+" \[label="(\w+)', ran.out, re.MULTILINE) == ["A", "J"]
    ran = srgc("graph", path, "--of", "grammar", "--highlight", "A eps J")
    assert ran.status == 0


def test_a_family_without_semantics_has_no_fra(srgc, spec):
    ran = srgc("graph", spec(TWO), "--of", "fra")
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert "no semantics" in ran.err


def test_the_command_does_not_load_networkx(arm_file):
    program = (
        "import sys; from srgc.cli import run\n"
        f"arguments = ['graph', {str(arm_file)!r}, '--of', 'words', '--highlight', {FIGURE!r}]\n"
        "assert run(arguments) == 0\n"
        "assert 'networkx' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, check=True)


def test_the_python_interface(arm_file):
    program = load(arm_file)
    run = graph(program, "words", highlight=FIGURE.split(), near=True).networkx()
    assert len(run) == 25
    assert sum(red for _, red in run.nodes(data="highlighted")) == 9
    robot = graph(program, "robot", word=("B", "eps", "JO", "eps", "EN")).networkx()
    assert [label for _, label in robot.nodes(data="label")] == ["B", "JO", "EN"]
    with pytest.raises(UsageFault, match="no view `fsa`"):
        graph(program, "fsa")


def test_edges_without_bound_are_counted_too(srgc, spec):
    """2 ** k words A eps (u|v)^k J: of two modules, but as many as the length allows."""
    endless = TWO.replace("edge eps;", "edge eps, u, v;").replace("T -> T eps J", "T -> u T")
    path = spec(endless.replace("T -> J eps T", "T -> v T"))
    ran = srgc("graph", path, "--of", "words", "--depth", "300")
    assert ran.status == 2
    # At most 2 * depth + 1 symbols: 1 + 2 + ... + 2 ** (2 * depth - 2), above 5,000 from 7 on.
    assert ran.err == "error: more than 5000 words to draw: choose a --depth below 7\n"


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

    monkeypatch.setattr(Planner, "next_plan", lambda _self: Unknown(Reason.RESOURCE_LIMIT))
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

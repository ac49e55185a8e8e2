"""A task in words: its numbers with units, as the spec has them."""

from __future__ import annotations

from pathlib import Path

import pytest

from grammar_lang.load import load
from srgc.report.task_sentences import task_sentences
from tests.oracles.small_specs import SLIDER, TURNER, replaced


def words(text: str, folder: Path) -> str:
    path = folder / "spec.srg"
    path.write_text(text, encoding="utf-8")
    program = load(path).program
    assert program is not None
    (task,) = program.tasks.values()
    return " ".join(task_sentences(program, task))


@pytest.mark.parametrize(
    ("spec", "old", "new", "said"),
    [
        (TURNER, "start in S at rest", "start in S rates <= 0.1", "at most 0.1 rad/s, with"),
        (SLIDER, "start in S", "start in S rates <= 0.1", "at most 0.1 m/s, with"),
        (TURNER, "reach T", "reach T at rest for 0.3 s", "is in `T`, at rest, for the last 0.3 s"),
        (TURNER, "reach T", "reach T rates <= 0.02", "with rates of at most 0.02 rad/s."),
        (TURNER, "horizon 10 steps", "horizon 1 steps", "(1 step of 0.2 s)"),
        (TURNER, "horizon 10 steps", "horizon at most 10 steps",
         "At the end of the motion the same effector is in `T`"),
        (TURNER, "horizon 10 steps", "horizon at most 10 steps",
         "The motion takes at most 10 steps of 0.2 s, 2 s."),
        (TURNER, "  horizon 10 steps", "  repeat;\n  horizon at most 10 steps",
         "for ever: the horizon of at most 2 s is a prefix"),
        (TURNER, "O with effector", "O with effector margin 5 mm", "by at least 0.005 m"),
        (TURNER, "  reach T;", "  reach T;\n  robust start 2 deg, 3 deg/s;",
         "off by up to 2°, 3°/s"),
        (TURNER, "  reach T;", "  reach T;\n  robust measure 2 deg, 3 deg/s;",
         "what is measured is off by up to 2°, 3°/s"),
        (TURNER, "  reach T;", "  reach T;\n  robust effort 2 % of bound;",
         "every input is off by up to 2 % of its bound"),
        (TURNER, "  reach T;", "  reach T;\n  robust mass 3 %;",
         "all masses are off by up to 3 % alike"),
        (TURNER, "  reach T;", "  reach T;\n  robust mass 3 % of L;",
         "the masses of each `L` are off by up to 3 % alike"),
        (TURNER, "  reach T;", "  reach T;\n  avoid self with body;",
         "The robot's bodies stay apart, except those of one link, those of links that one joint"),
        (TURNER, "  reach T;", "  reach T;\n  avoid self with body, margin 5 mm, except L L;",
         "one joint connects, and those of `L` and `L`."),
        (TURNER, "  reach T;", "  reach T;\n  control open loop;",
         "The inputs are fixed in advance"),
        (TURNER, "  reach T;", "  reach T;\n  control feedback;",
         "The inputs follow what is measured"),
        (TURNER, "  reach T;", "  reach T;\n  repeat;", "At some time the same effector is in `T`"),
        (TURNER, "  reach T;", "  reach T aligned x to (0, 1) within 5 deg;\n  repeat;",
         "is in `T`, the axis x of its frame along (0, 1) within 5°"),
        (TURNER, "  reach T;", "  reach T;\n  repeat;", "for ever: the horizon of 2 s is a"),
    ],
)  # fmt: skip
def test_numbers_have_their_units(tmp_path: Path, spec: str, old: str, new: str, said: str) -> None:
    assert said in words(replaced(spec, old, new), tmp_path)

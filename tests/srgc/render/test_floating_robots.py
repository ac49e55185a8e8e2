"""Drones and platforms stand on nothing: no line leads to them along their coordinates."""

from __future__ import annotations

import re

import numpy as np
import pytest

from compiler.robots.normal_form import family_of
from compiler.words.structures import derivations_of
from grammar_lang.load import load_text
from srgc.render.robot_drawing import drawn_robot, pose_marks
from srgc.render.svg import from_above

WORKS = """
workspace W { plane xy; bounds box [-4, 4] x [-4, 4] m; region A box [0, 1] x [0, 1] m; }
task T { robot G; workspace W; start in A; reach A; effort <= 9 N; horizon 5 steps of 0.1 s; }
"""
PLATFORM = """
module B { role base; port out: P; frame out = in; }
module M {
  role joint;
  dof s: prismatic x; dof h: prismatic y;
  port in: P; port out: Q;
  frame out = in * move(x, s) * move(y, h);
  point(frame: out, mass: 1 kg);
}
module E { role effector; port in: Q; effector(frame: in * move(x, 0.5 m)); }
grammar G from ports { start B; with M, E; }
"""
PORTAL = """
module B { role base; port out: P; frame out = in; }
module X { role joint; dof s: prismatic x; port in: P; port out: R; frame out = in * move(x, s);
  point(frame: out, mass: 1 kg); }
module Y { role joint; dof h: prismatic y; port in: R; port out: Q; frame out = in * move(y, h); }
module E { role effector; port in: Q; point(frame: in, mass: 1 kg);
  effector(frame: in * move(x, 0.5 m)); }
grammar G from ports { start B; with X, Y, E; }
"""


@pytest.mark.parametrize(
    ("robot", "lines", "joints"),
    [
        (PLATFORM, [((2, 3), (2.5, 3))], []),
        (PORTAL, [((0, 0), (2, 0)), ((2, 0), (2, 3)), ((2, 3), (2.5, 3))], [(2, 0), (2, 3)]),
    ],
    ids=["platform", "portal"],
)
def test_lines_lead_along_slides_of_modules_of_one_axis_alone(
    robot: str, lines: list[tuple[tuple[float, float], ...]], joints: list[tuple[float, float]]
) -> None:
    program = load_text(robot + WORKS, "robot.srg").program
    family = family_of(program, program.tasks["T"])
    model = family.robot(next(iter(derivations_of(family.language, _word(robot)))))
    drawn = drawn_robot(model, np.array([]))
    points = drawn.points(np.array([[2.0, 3.0]]))[0]
    view = from_above(np.array([[-4.0, -4.0], [4.0, 4.0]]))
    marks = pose_marks(drawn, points, view)
    found = re.findall(r'class="bone" x1="(.*?)" y1="(.*?)" x2="(.*?)" y2="(.*?)"', marks)
    due = [view.project(np.array(line, dtype=float)).ravel() for line in lines]
    assert np.array(found, dtype=float) == pytest.approx(np.array(due), abs=0.06)
    placed = re.findall(r'class="joint" transform="translate\((.*?) (.*?)\)"', marks)
    assert [tuple(map(float, each)) for each in placed] == [
        pytest.approx(tuple(view.project(np.array(joint, dtype=float))), abs=0.06)
        for joint in joints
    ]
    assert marks.count('class="foot"') == (1 if joints else 0)


def _word(robot: str) -> tuple[str, ...]:
    return tuple(re.findall(r"module (\w+)", robot))

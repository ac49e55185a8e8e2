"""Common values of the robots of a mission, chosen by one program for all motions."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.missions.joint_motions import joint_values, least_share
from solvers.missions.shared_values import Candidate, agreed
from solvers.missions.task_robots import TaskRobots
from solvers.run_context import RunContext

SLIDES = """\
module B { role base; }
module P { role joint; dof q: prismatic x in [-4, 4] m; }
module M { role link; param mass in [1, 6] kg; }
module EN { role effector; }
edge eps;

grammar Slide {
  start N;
  base: N -> B;
  slide: N -> N eps P;
  load: N -> N eps M;
  tool: N -> N eps EN;
  accept matches B eps P eps M eps EN;
}

semantics Slide {
  base { this.frame = world; }
  slide { this.frame = N.frame * move(x, P.q); }
  load { this.frame = N.frame; point(frame: N.frame, mass: M.mass); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}

workspace W {
  plane xy;
  bounds box [-5, 5] x [-1, 1] m;
  region S box [-0.1, 0.1] x [-0.1, 0.1] m;
  target Near box [0.9, 1.1] x [-0.1, 0.1] m;
  target Far box [2.9, 3.1] x [-0.1, 0.1] m;
}

task Short {
  robot Slide;
  workspace W;
  start in S at rest;
  reach Near;
  effort <= 20 N;
  horizon 10 steps of 0.1 s;
}

task Long {
  robot Slide;
  workspace W;
  start in S at rest;
  reach Far;
  effort <= 60 N;
  horizon 10 steps of 0.1 s;
}
"""


def robots_of(name: str) -> TaskRobots:
    program = load_text(SLIDES, "slides.srg").program
    assert program is not None
    return TaskRobots(program, program.tasks[name], RunContext())


def candidate(robots: TaskRobots, mass: str) -> Candidate:
    """The slide with a load of so many kg, though all masses are allowed."""
    derivation = robots.family.replay(("tool", "load", "slide", "base"))
    box = robots.box(derivation)
    only = (ir.Choices((ir.Num(Fraction(mass)),)),)
    design = robots.motions(derivation, only, 0).first()
    assert design is not None
    return Candidate(robots, derivation, box, design)


@pytest.fixture(scope="module")
def pair() -> list[Candidate]:
    return [candidate(robots_of("Short"), "5"), candidate(robots_of("Long"), "5")]


def test_the_lightest_load_suits_both(pair: list[Candidate]) -> None:
    """Forces are mass times acceleration: the least mass leaves most, whatever the way."""
    tasks, boxes = [each.robots for each in pair], [each.box for each in pair]
    values = joint_values(tasks, boxes, [each.design for each in pair], [((0, 0), (1, 0))], {})
    assert values is not None
    assert values[0, 0] == values[1, 0]
    assert 1 <= values[0, 0] < Fraction("1.05")


def test_what_is_given_stays(pair: list[Candidate]) -> None:
    group = ((0, 0), (1, 0))
    tasks, boxes = [each.robots for each in pair], [each.box for each in pair]
    designs = [each.design for each in pair]
    assert joint_values(tasks, boxes, designs, [group], {group: Fraction(5)}) is None


def test_designs_get_the_better_values(pair: list[Candidate]) -> None:
    tasks = [each.robots for each in pair]
    before = least_share(tasks, [each.design for each in pair])
    found = agreed(pair, [((0, 0), (1, 0))], {}, 0)
    assert found is not None
    first, second = (design.parameters[0].stated for design in found.designs)
    assert first == second < Fraction("1.05")
    assert least_share(tasks, found.designs) > before


def test_lists_of_values_are_not_chosen_from(tmp_path: Path) -> None:
    text = SLIDES.replace("[1, 6] kg", "{1, 5} kg")
    program = load_text(text, "slides.srg", tmp_path).program
    assert program is not None
    tasks = [TaskRobots(program, program.tasks[name], RunContext()) for name in ("Short", "Long")]
    pair = [candidate(each, "5") for each in tasks]
    boxes, designs = [each.box for each in pair], [each.design for each in pair]
    assert joint_values(tasks, boxes, designs, [((0, 0), (1, 0))], {}) is None

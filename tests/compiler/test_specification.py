from fractions import Fraction

import pytest

from compiler.encodings.specification import path_problem
from compiler.geometry.abstraction import abstract
from grammar_lang.ir import Num, StartAt, Workspace
from tests.oracles.planes import bench, box
from tests.oracles.tasks import avoid, task


def test_the_running_example():
    abstraction = abstract(bench())
    problem = path_problem(abstraction, task(avoid("O")))
    names = [
        [abstraction.cells[i].name for i in part]
        for part in (problem.start, problem.target, problem.forbidden)
    ]
    assert names == [["S"], ["T"], ["O"]]


def test_overlapping_regions_and_who_avoids():
    workspace = Workspace(
        "W",
        2,
        box("bounds", "bounds", (0, 4), (0, 1)),
        (
            box("S", "region", (0, 2), (0, 1)),
            box("O", "obstacle", (1, 3), (0, 1)),
            box("T", "target", (3, 4), (0, 1)),
        ),
    )
    abstraction = abstract(workspace)
    both = {n for n in abstraction.describe() if n.startswith("O")}
    assert both == {"O.1", "O.2"}
    problem = path_problem(abstraction, task(avoid("O"), avoid("T", subject="body")))
    assert {abstraction.cells[i].name for i in problem.start} == {"S", "O.1"}
    assert {abstraction.cells[i].name for i in problem.forbidden} == both
    assert path_problem(abstraction, task()).forbidden == ()


def test_a_start_pose_needs_its_cells():
    abstraction = abstract(bench())
    given = task(start=StartAt((Num(Fraction(0)),)))
    assert path_problem(abstraction, given, start_cells=[3, 2, 3]).start == (2, 3)
    with pytest.raises(ValueError, match="depends on the robot"):
        path_problem(abstraction, given)

"""What tasks ask of paths."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from compiler.tasks.sampled_formula import sampled
from compiler.tasks.specification import planning_problem
from compiler.workspaces.abstraction import Abstraction, abstract
from grammar_lang import ir
from grammar_lang.ir import Num, Satisfy, StartAt, StartIn, Workspace
from tests.oracles.planes import bench, box
from tests.oracles.tasks import avoid, task

T = ir.Atom("T", 1)
EVER = ir.Window(Fraction(0), None)


def named(abstraction: Abstraction, cells: tuple[int, ...] | None) -> list[str]:
    assert cells is not None
    return [abstraction.cells[i].name for i in cells]


def test_the_running_example() -> None:
    abstraction = abstract(bench())
    problem = planning_problem(abstraction, task(avoid("O")), 0)
    (planned,) = problem.effectors
    found = [named(abstraction, c) for c in (planned.start, planned.end, planned.forbidden)]
    assert found == [["S"], ["T"], ["O"]]
    assert (problem.timed, problem.by_samples, problem.formula) == (False, False, None)
    assert (problem.steps, problem.changes, planned.effector) == (10, 10, 0)
    assert problem.neighbours == abstraction.neighbours
    assert problem.name(planned.start[0]) == "S"


def test_overlapping_regions_and_who_avoids() -> None:
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
    given = task(avoid("O"), avoid("T", subject="body"))
    (planned,) = planning_problem(abstraction, given, 0).effectors
    assert set(named(abstraction, planned.start)) == {"S", "O.1"}
    assert set(named(abstraction, planned.forbidden)) == both
    (planned,) = planning_problem(abstraction, task(), 0).effectors
    assert planned.forbidden == ()


def test_a_start_pose_needs_its_cells() -> None:
    abstraction = abstract(bench())
    given = task(start=StartAt((Num(Fraction(0)),)))
    (planned,) = planning_problem(abstraction, given, 0, {0: [3, 2, 3]}).effectors
    assert planned.start == (2, 3)
    (planned,) = planning_problem(abstraction, given, 0).effectors
    assert planned.start == tuple(range(len(abstraction.cells)))


def test_formulas_name_the_effectors_that_are_planned() -> None:
    """The second effector starts, the first one reaches, the third one is named."""
    abstraction = abstract(bench())
    formula = ir.Eventually(ir.Atom("S", 3), EVER)
    given = replace(
        task(avoid("O"), start=StartIn("S", 2, Fraction(0))), satisfy=(Satisfy(formula),)
    )
    problem = planning_problem(abstraction, given, 0)
    assert [one.effector for one in problem.effectors] == [0, 2]
    anywhere = tuple(range(len(abstraction.cells)))
    assert [one.start for one in problem.effectors] == [anywhere, anywhere]
    assert [one.end is None for one in problem.effectors] == [False, True]
    assert all(named(abstraction, one.forbidden) == ["O"] for one in problem.effectors)
    assert (problem.timed, problem.by_samples, problem.changes) == (False, True, 20)
    problem = planning_problem(abstraction, given, 1)
    assert named(abstraction, problem.effectors[0].start) == ["S"]


def test_formulas_with_times_are_planned_by_samples() -> None:
    abstraction = abstract(bench())
    soon = ir.Eventually(T, ir.Window(Fraction(0), Fraction(1)))
    given = replace(task(), reach=None, satisfy=(Satisfy(soon), Satisfy(ir.Not(T))))
    problem = planning_problem(abstraction, given, 0)
    assert (problem.timed, problem.by_samples) == (True, True)
    assert problem.effectors[0].end is None
    assert problem.formula == sampled(ir.And((soon, ir.Not(T))), Fraction(1, 8), 10)
    given = replace(given, satisfy=(Satisfy(ir.Eventually(T, EVER)),))
    assert not planning_problem(abstraction, given, 0).by_samples

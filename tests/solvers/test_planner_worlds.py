"""Plans in workspaces: tasks with formulas, regions and obstacles, against trying everything."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

from hypothesis import event, given, settings
from hypothesis import strategies as st

from compiler.tasks.sampled_formula import is_timed
from compiler.tasks.specification import planning_problem
from compiler.workspaces.abstraction import abstract
from grammar_lang import ir
from solvers.planner import Planner
from solvers.verdict import Fails, Holds
from tests.oracles.formulas import SHAPES, TWO_ARMS, formulas, program, spec
from tests.oracles.plans import Case, brute_force, changes, untimed
from tests.oracles.some_cases import examples
from tests.oracles.word_semantics import true_at

STARTS = "region S box [-1, 0] x [-1, 0] m;"
OBSTACLES = [
    "",
    "obstacle O box [1, 1.5] x [-1, 2] m;",
    "obstacle O hull (0, 0), (2, 1), (0, 3) m;",
]
CASES = st.tuples(
    st.sampled_from(sorted(SHAPES)), st.sampled_from(OBSTACLES), st.integers(1, 2), st.booleans()
).flatmap(lambda case: st.tuples(st.just(case), formulas(3, case[2], deep=4)))


@settings(max_examples=examples(15, 80), deadline=None)
@given(CASES)
def test_tasks_with_formulas(case: tuple[tuple[str, str, int, bool], ir.Formula]) -> None:
    (shape, obstacle, effectors, timed), formula = case
    steps = 4 - effectors
    clauses = "start in S by effector 1;" + (" avoid O with effector;" if obstacle else "")
    text = spec(
        clauses + " satisfy eventually S by effector 1;",
        SHAPES[shape] + STARTS + obstacle,
        horizon=f"{steps} steps of 1 s",
        arms=TWO_ARMS,
    )
    given = program(text)
    if not timed and is_timed(formula):
        formula = untimed(formula)
    task = replace(given.tasks["P"], satisfy=(ir.Satisfy(formula),))
    cells = abstract(given.workspaces["W"])
    problem = planning_problem(cells, task, 0)
    assert problem.timed is is_timed(formula)
    everything = brute_force(Case(problem, formula))
    verdict = Planner(problem).next_plan()
    event(f"{problem.by_samples}: {bool(everything)}")
    if isinstance(verdict, Fails):
        assert not everything
        return
    assert isinstance(verdict, Holds)
    plan = verdict.witness
    assert plan.changes == min(map(changes, everything))
    words = []
    for path, planned in zip(plan.paths, problem.effectors, strict=True):
        names = [cells.cells[cell].name for cell in path.cells]
        assert not any(name.startswith("O") for name in names)
        assert all((min(p), max(p)) in cells.facets for p in pairwise(path.cells))
        assert names[0].startswith("S") or path.effector == 1
        ends = (*path.entries[1:], steps + 1) if path.entries is not None else ()
        stays = [1] * len(names)
        if path.entries is not None:
            stays = [end - entry for entry, end in zip(path.entries, ends, strict=True)]
        words.append([c for c, stay in zip(path.cells, stays, strict=True) for _ in range(stay)])
        assert path.effector == planned.effector
    labels = [
        {
            planned.effector + 1: cells.cells[cell].propositions
            for planned, cell in zip(problem.effectors, at, strict=True)
        }
        for at in zip(*words, strict=True)
    ]
    asked = problem.formula
    if not problem.by_samples:
        shorter = replace(task, steps=len(labels) - 1)
        asked = planning_problem(cells, shorter, 0).formula
    assert asked is not None
    assert true_at(asked, labels, 0)
    assert task.step == Fraction(1)

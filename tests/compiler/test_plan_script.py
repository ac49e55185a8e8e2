"""Problems as text, solved by z3 through pysmt, against trying everything."""

from __future__ import annotations

import io
import re
from dataclasses import replace

from hypothesis import event, given, settings
from hypothesis import strategies as st
from pysmt.shortcuts import Not, Or, Solver, Symbol
from pysmt.smtlib.parser import SmtLibParser

from compiler.tasks.plan_script import dimacs, smt2
from compiler.tasks.specification import PlannedEffector, PlanningProblem
from tests.oracles.plans import Case, brute_force, cases
from tests.oracles.some_cases import examples

KINDS = st.sampled_from([(1, False), (1, True), (2, True)]).flatmap(
    lambda kind: cases(effectors=kind[0], by_samples=kind[1])
)


def is_satisfiable_cnf(text: str) -> bool:
    """DIMACS, read by the book: comments, one problem line, clauses that end with 0."""
    lines = [line for line in text.splitlines() if not line.startswith("c")]
    match = re.fullmatch(r"p cnf (\d+) (\d+)", lines[0])
    assert match is not None
    numbers = [int(word) for line in lines[1:] for word in line.split()]
    clauses: list[list[int]] = [[]]
    for number in numbers:
        if number:
            clauses[-1].append(number)
        else:
            clauses.append([])
    assert clauses.pop() == []
    assert len(clauses) == int(match[2])
    assert all(abs(number) <= int(match[1]) for number in numbers)
    with Solver(name="z3") as solver:
        for clause in clauses:
            atoms = [(Symbol(f"x{abs(n)}"), n > 0) for n in clause]
            solver.add_assertion(Or([atom if sign else Not(atom) for atom, sign in atoms]))
        return bool(solver.solve())


def is_satisfiable_script(text: str) -> bool:
    script = SmtLibParser().get_script(io.StringIO(text))
    with Solver(name="z3", logic="QF_UF") as solver:
        (answer,) = [value for name, value in script.evaluate(solver) if name == "check-sat"]
    return bool(answer)


@settings(max_examples=examples(10, 40), deadline=None)
@given(KINDS)
def test_satisfiable_iff_there_is_a_plan(case: Case) -> None:
    expected = bool(brute_force(case))
    event(f"{case.problem.by_samples}: {expected}")
    assert is_satisfiable_cnf("\n".join(dimacs(case.problem))) is expected
    assert is_satisfiable_script("\n".join(smt2(case.problem))) is expected


LINE = PlanningProblem(
    ((1,), (0, 2), (1,)),
    (frozenset(),) * 3,
    (PlannedEffector(0, (0,), (), (2,)),),
    None,
    False,
    4,
    4,
    ("S", "free.1", "T"),
)


def test_variables_have_readable_names() -> None:
    text = "\n".join(dimacs(LINE))
    assert re.search(r"^c \d+ effector 1 in free\.1 at position 1$", text, re.MULTILINE)
    assert text.startswith("c a plan of at most 4 changes of cell\n")
    script = "\n".join(smt2(replace(LINE, timed=True)))
    assert "(declare-fun |effector 1 in T at position 4| () Bool)" in script
    assert "(declare-fun |effector 1 is at position 2 by sample 3| () Bool)" in script
    declared = re.findall(r"declare-fun (\|[^|]*\|)", script)
    assert len(set(declared)) == len(declared)


def test_no_way_is_unsatisfiable() -> None:
    apart = replace(LINE, effectors=(PlannedEffector(0, (0,), (1,), (2,)),))
    far = replace(LINE, steps=1, changes=1)
    for problem in (apart, far, replace(apart, timed=True), replace(far, timed=True)):
        assert not is_satisfiable_cnf("\n".join(dimacs(problem)))
        assert not is_satisfiable_script("\n".join(smt2(problem)))

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solvers.backends.cadical import SatSolver
from solvers.verdict import Fails, Holds, Reason, Unknown
from tests.oracles.some_cases import examples

VARIABLES = 5
literal = st.integers(1, VARIABLES).flatmap(lambda v: st.sampled_from([v, -v]))
clauses = st.lists(st.lists(literal, min_size=1, max_size=3), max_size=24)


def satisfied(formula, bits):
    return all(any((lit > 0) == bits[abs(lit) - 1] for lit in clause) for clause in formula)


def satisfiable(formula):
    return any(satisfied(formula, bits) for bits in product([False, True], repeat=VARIABLES))


def solver_of(formula):
    solver = SatSolver()
    for clause in formula:
        solver.add(np.array([clause]))
    return solver


@settings(max_examples=examples(75, 150), deadline=None)
@given(clauses, clauses, st.lists(literal, max_size=3))
def test_the_truth_table_incrementally_and_under_assumptions(first, second, assumed):
    solver = SatSolver()
    formula = []
    for more in (first, second):
        for clause in more:
            solver.add(np.array([clause]))
        formula += more
        for assumptions in (assumed, []):
            units = [[lit] for lit in assumptions]
            match solver.solve(assumptions, conflicts=1000):
                case Holds(witness=model):
                    bits = [*model.true[1:].tolist(), *[False] * VARIABLES][:VARIABLES]
                    known = [lit for lit in assumptions if abs(lit) < len(model.true)]
                    assert satisfied([*formula, *([lit] for lit in known)], bits)
                    assert satisfiable([*formula, *units])
                case Fails(counterexample=core):
                    assert not satisfiable([*formula, *units])
                    assert set(core.assumptions) <= set(assumptions)
                    assert not satisfiable([*formula, *([lit] for lit in core.assumptions)])
                case Unknown():
                    pytest.fail("a tiny formula needs no budget")


def pigeons(holes):
    number = np.arange(1, (holes + 1) * holes + 1).reshape(holes + 1, holes)
    pairs = [
        [-number[p, h], -number[q, h]]
        for h in range(holes)
        for p in range(holes + 1)
        for q in range(p)
    ]
    return number, np.array(pairs)


def test_a_conflict_limit_is_no_answer():
    solver = SatSolver()
    for part in pigeons(8):
        solver.add(part)
    first = solver.solve(conflicts=10)
    assert isinstance(first, Unknown)
    assert first.reason is Reason.CONFLICT_LIMIT
    assert isinstance(solver.solve(conflicts=1_000_000), Fails)
    solver.close()


def test_the_budget_is_deterministic():
    def answers():
        solver = SatSolver()
        for part in pigeons(7):
            solver.add(part)
        found = []
        while not found or isinstance(found[-1], Unknown):
            found.append(solver.solve(conflicts=50))
        return found

    assert answers() == answers()


def test_bad_input():
    solver = SatSolver()
    with pytest.raises(ValueError, match="literal"):
        solver.add(np.array([[1, 0]]))
    with pytest.raises(ValueError, match="literal"):
        solver.add(np.zeros((1, 0), dtype=np.int64))
    with pytest.raises(ValueError, match="budget"):
        solver.solve(conflicts=0)
    solver.add(np.zeros((0, 2), dtype=np.int64))
    assert isinstance(solver.solve(conflicts=1), Holds)
